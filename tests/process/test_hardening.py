"""What the programs of the packages are built with, by what is in them (decision 0514)."""

import re
import subprocess

from rig import BIN, ProcessTest

PROGRAMS = ("thimbled", "thimble", "thimble-guard", "thimble-board", "thimble-simdev")


class Hardening(ProcessTest):
    def read(self, program, what):
        return subprocess.run(["readelf", "--wide", what, BIN / program], capture_output=True, text=True, check=True, env={"LC_ALL": "C", "PATH": "/usr/bin:/bin"}).stdout

    def test_each_lies_anywhere_and_has_bound_what_it_calls_before_it_begins(self):
        for program in PROGRAMS:
            with self.subTest(program):
                self.assertRegex(self.read(program, "--file-header"), r"Type:\s+DYN \(Position-Independent Executable")
                self.assertRegex(self.read(program, "--dynamic"), r"\(FLAGS\)\s+BIND_NOW")
                self.assertIn("GNU_RELRO", self.read(program, "--program-headers"))

    def test_each_watches_its_stack_and_its_copies(self):
        for program in PROGRAMS:
            with self.subTest(program):
                called = set(re.findall(r"UND (\w+)@", self.read(program, "--dyn-syms")))
                self.assertIn("__stack_chk_fail", called)
                self.assertTrue(any(re.fullmatch(r"__\w+_chk", name) for name in called), sorted(called))

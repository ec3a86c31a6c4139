#!/usr/bin/env python3
"""An episode is the same one in whatever environment it is played again: its trace says so."""

import os
import re
import subprocess
import sys
import unittest

PROGRAM = sys.argv.pop()


def trace(**environment):
    answer = subprocess.run([PROGRAM, "--seed", "1", "--episode", "0"], env={**os.environ, **environment},
                            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return re.search(r"^trace (\d+)$", answer.stdout, re.MULTILINE).group(1)


class Replay(unittest.TestCase):
    def test_no_variable_of_the_c_library_makes_it_another(self):
        plain = trace(GLIBC_TUNABLES="")
        self.assertEqual(trace(GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX512F"), plain)
        self.assertEqual(trace(GLIBC_TUNABLES="glibc.malloc.check=0"), plain)


if __name__ == "__main__":
    unittest.main()

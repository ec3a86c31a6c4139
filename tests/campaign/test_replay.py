#!/usr/bin/env python3
"""An episode is the same one whenever and wherever it is played again: its trace, its breach, and what is left of it."""

import os
import re
import shlex
import subprocess
import sys
import unittest

PROGRAM = sys.argv.pop()


def campaign(*arguments, **environment):
    return subprocess.run([PROGRAM, *arguments], env={**os.environ, **environment},
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)


def trace(**environment):
    answer = campaign("--seed", "1", "--episode", "0", **environment)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return re.search(r"^trace (\d+)$", answer.stdout, re.MULTILINE).group(1)


class Replay(unittest.TestCase):
    def test_no_variable_of_the_c_library_makes_it_another(self):
        plain = trace(GLIBC_TUNABLES="")
        self.assertEqual(trace(GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX512F"), plain)
        self.assertEqual(trace(GLIBC_TUNABLES="glibc.malloc.check=0"), plain)

    def test_what_a_failing_campaign_prints_plays_its_breach_again_and_shrinks_it_alike(self):
        failed = campaign("--quiet", "--ticks", "400000", "--seed", "1", "--plant-breach")
        self.assertEqual(failed.returncode, 1, failed.stdout + failed.stderr)
        self.assertNotIn("no rule was broken", failed.stdout)
        words = shlex.split(re.search(r"^replay: (.*)$", failed.stdout, re.MULTILINE).group(1))
        self.assertEqual(words[:2], ["./run", "campaign"])

        again = campaign(*words[2:])
        self.assertEqual(again.returncode, 1, again.stdout + again.stderr)
        # From the breach, with its tick and time, to the last line of what is left of the episode.
        story = failed.stdout[failed.stdout.index("BROKEN: "):]
        self.assertEqual(again.stdout[again.stdout.index("BROKEN: "):], story)
        self.assertRegex(story, r"BROKEN: .*tick \d+")
        left = story[story.index("after "):]
        self.assertEqual(re.findall(r"\bestop\b", left), ["estop"], left)
        self.assertNotIn("estop", story[:story.index("shrinking")])
        self.assertRegex(left, r"(?m)^break .*e-stop pressed")


if __name__ == "__main__":
    unittest.main()

import contextlib
import io
import pathlib
import sys

from planted_tree import HERE, PlantedTreeTest

sys.path.insert(0, str(HERE.parent / "support"))
import summarise_tests  # noqa: E402

PASSED = '<testcase name="A.Passes" status="run"/>'
FAILED = '<testcase name="A.Fails" status="fail"><failure message=""/></testcase>'
SKIPPED = ('<testcase name="A.Skips" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION"/>'
           "<system-out>a_test.cpp:7: Skipped\nno strace here\n</system-out></testcase>")


class SummariseTests(PlantedTreeTest):
    def summarise(self, *cases):
        self.plant("unit.xml", f"<testsuite>{''.join(cases)}</testsuite>")
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            status = summarise_tests.main(pathlib.Path(self.root))
        return status, output.getvalue()

    def test_counts_and_says_that_nothing_was_skipped(self):
        status, said = self.summarise(PASSED, PASSED)

        self.assertEqual(status, 0)
        self.assertIn("nothing was skipped\n2 passed, 0 failed\n", said)

    def test_fails_and_names_what_failed(self):
        status, said = self.summarise(PASSED, FAILED)

        self.assertEqual(status, 1)
        self.assertIn("FAILED  unit: A.Fails\n", said)
        self.assertTrue(said.endswith("\n1 passed, 1 failed\n"), said)

    def test_gives_the_reason_of_a_skip(self):
        status, said = self.summarise(PASSED, SKIPPED)

        self.assertEqual(status, 0)
        self.assertIn("skipped unit: A.Skips: no strace here\n", said)
        self.assertIn("1 passed, 0 failed", said)

    def test_names_what_a_whole_program_left_out(self):
        whole = ('<testcase name="unit_a" status="run"><system-out>a_test.cpp:7: Skipped\nno strace here\n'
                 "b_test.cpp:9: Skipped\nnot under a sanitizer\n</system-out></testcase>")

        status, said = self.summarise(whole)

        self.assertEqual(status, 0)
        self.assertIn("skipped unit: unit_a: a_test.cpp:7: no strace here\n"
                      "skipped unit: unit_a: b_test.cpp:9: not under a sanitizer\n1 passed, 0 failed", said)

    def test_fails_when_nothing_ran(self):
        self.assertEqual(self.summarise()[0], 1)

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

    def test_names_failures_at_the_end_behind_what_was_skipped(self):
        other = FAILED.replace("A.Fails", "B.Fails")
        _, said = self.summarise(FAILED, SKIPPED, other)

        self.assertLess(said.index("skipped unit: A.Skips"), said.index("FAILED  unit: A.Fails"))
        self.assertTrue(said.endswith("FAILED in all: unit: A.Fails, unit: B.Fails\n0 passed, 2 failed\n"), said)

    def test_says_in_a_few_lines_why_something_failed(self):
        output = "".join(f"line {i}\n" for i in range(100))
        race = output + "a.cpp:3: Failure\nExpected: 1\n  actual: 2\n" + output + "SUMMARY: ThreadSanitizer: race in f\n"
        status, said = self.summarise(f'<testcase name="A" status="fail"><system-out>{race}</system-out></testcase>')

        self.assertIn("FAILED  unit: A\n    a.cpp:3: Failure\n    Expected: 1\n      actual: 2\n    line 0\n"
                      "    SUMMARY: ThreadSanitizer: race in f\n", said)
        self.assertEqual(status, 1)

    def test_keeps_a_sanitizers_summary_behind_many_failures(self):
        output = 20 * "a.cpp:3: Failure\nwrong\n" + "SUMMARY: AddressSanitizer: leak\nx.y.VmError: no\n"
        _, said = self.summarise(f'<testcase name="A" status="fail"><system-out>{output}</system-out></testcase>')

        self.assertEqual(said.count("wrong"), summarise_tests.MOST_LINES // 2)
        self.assertIn("    SUMMARY: AddressSanitizer: leak\n", said)

    def test_knows_an_exception_by_its_modules_name(self):
        output = "x.y.VmError: no\n" + 20 * "more\n"
        _, said = self.summarise(f'<testcase name="A" status="fail"><system-out>{output}</system-out></testcase>')

        self.assertIn("FAILED  unit: A\n    x.y.VmError: no\n", said)

    def test_gives_the_end_of_what_a_failure_said_that_tells_nothing(self):
        output = "".join(f"line {i}\n" for i in range(100))
        _, said = self.summarise(f'<testcase name="A" status="fail"><system-out>{output}</system-out></testcase>')

        self.assertIn("FAILED  unit: A\n    line 88\n", said)
        self.assertIn("    line 99\n", said)

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

    def test_names_what_a_file_of_unittest_left_out(self):
        file = ('<testcase name="process.a" status="run"><system-out>test_b (test_a.A.test_b) ... ok\n'
                "test_c (test_a.A.test_c) ... skipped 'no strace here'\n"
                'test_d (test_a.A.test_d)\nIn a sentence. ... skipped "nobody\'s"\nOK (skipped=2)\n</system-out></testcase>')

        status, said = self.summarise(file)

        self.assertEqual(status, 0)
        self.assertIn("skipped unit: process.a: test_c: no strace here\n"
                      "skipped unit: process.a: test_d: nobody's\n1 passed, 0 failed", said)

    def test_fails_when_nothing_ran(self):
        self.assertEqual(self.summarise()[0], 1)

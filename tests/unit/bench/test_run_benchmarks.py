import contextlib
import io
import json
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "bench"))
import run_benchmarks as sut  # noqa: E402


def figure(name="tick", value=200, reference=50, ratio=4.0, is_met=True):
    return {"name": name, "unit": "ns", "value": value, "reference": reference, "ratio": ratio,
            "goal": {"of": "value", "at_most": 300}, "is_met": is_met}


class RunBenchmarks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = os.path.join(folder.name, "figures.json")

    def refusal(self, text):
        pathlib.Path(self.file).write_text(text, encoding="utf-8")
        with self.assertRaises(sut.UsageError) as caught:
            sut.read_file(self.file)
        self.assertIn(self.file, str(caught.exception))

    def test_line_says_met_or_missed(self):
        self.assertIn("200         50 ns          4   <= 300 ns      met", sut.table_line(figure()))
        self.assertIn("<= 300 ns      MISSED", sut.table_line(figure(is_met=False)))

    def test_lines_are_as_wide_as_the_header(self):
        self.assertEqual(sut.header(False).index("goal"), sut.table_line(figure()).index("<="))
        line = sut.table_line(figure(), figure())
        self.assertEqual(len(sut.header(True)), len(line))

    def test_what_was_written_is_read_back(self):
        sut.write_file(self.file, [figure("a", 1 / 3), figure("b", reference=None, ratio=None)])

        before = sut.read_file(self.file)

        self.assertEqual(before["a"]["value"], 1 / 3)
        self.assertIsNone(before["b"]["ratio"])

    def test_compares_ratios_so_that_a_slower_machine_cancels_out(self):
        twice_as_slow = figure(value=400, reference=100, ratio=4.0)
        self.assertEqual(sut.change(twice_as_slow, figure()), "x 1.000")
        self.assertEqual(sut.change(figure(ratio=6.0), figure()), "x 1.500")

    def test_compares_values_of_figures_that_stand_alone(self):
        alone = figure(value=30, reference=None, ratio=None)
        self.assertEqual(sut.change(alone, figure(value=20, reference=None, ratio=None)), "x 1.500")

    def test_a_figure_that_the_earlier_run_had_not_is_new(self):
        self.assertEqual(sut.change(figure(), {}), "new")
        self.assertEqual(sut.change(figure(), figure(value=0, ratio=None)), "-")

    def test_refuses_a_file_that_it_did_not_write(self):
        self.refusal("")
        self.refusal("[]")
        self.refusal('{"format": 2, "figures": []}')
        self.refusal('{"format": 1}')
        self.refusal('{"format": 1, "figures": [{"name": "x"}]}')
        self.refusal(json.dumps({"format": 1, "figures": [figure(value="fast")]}))
        self.refusal(json.dumps({"format": 1, "figures": [figure(value=None)]}))
        self.refusal("[" * 100000)
        self.refusal(" " * (sut.MAX_FILE_BYTES + 1))

    def test_refuses_a_file_that_is_not_there(self):
        with self.assertRaises(sut.UsageError):
            sut.read_file(self.file)

    def test_refuses_a_benchmark_that_does_not_exist(self):
        with self.assertRaises(sut.UsageError) as caught:
            sut.parse_arguments(["servo_tok"])
        self.assertIn("servo_tick", str(caught.exception))


class RunBenchmarksMain(unittest.TestCase):
    """main() with programs that print what they are told to."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "build/release/bin").mkdir(parents=True)
        for name, value in (("ROOT", self.root), ("ALL", ("one", "two"))):
            patch = mock.patch.object(sut, name, value)
            patch.start()
            self.addCleanup(patch.stop)
        self.make_benchmark("one", [figure("tick")])
        self.make_benchmark("two", [figure("step"), figure("wake", reference=None, ratio=None)])

    def make_benchmark(self, name, figures, status=0):
        lines = "".join(json.dumps(entry) + "\n" for entry in figures)
        program = self.root / f"build/release/bin/bench_{name}"
        program.write_text(f"#!/bin/sh\ncat <<'END'\n{lines}END\nexit {status}\n", encoding="utf-8")
        program.chmod(0o755)

    def run_main(self, *arguments):
        out, err = io.StringIO(), io.StringIO()
        before = os.getcwd()
        os.chdir(self.root)  # as run does
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                status = sut.main(list(arguments))
        finally:
            os.chdir(before)
        return status, out.getvalue().splitlines(), err.getvalue()

    def test_json_without_a_name_writes_the_file_that_the_help_names(self):
        for arguments, names in ((("--json",), ["tick", "step", "wake"]),
                                 (("--json", "one"), ["tick"]),
                                 (("two", "--json"), ["step", "wake"])):
            with self.subTest(arguments):
                self.assertEqual(self.run_main(*arguments)[0], 0)
                self.assertEqual(list(sut.read_file(self.root / sut.DEFAULT_FILE)), names)

    def test_json_writes_the_file_that_it_is_given(self):
        self.assertEqual(self.run_main("--json", "mine.json", "one")[0], 0)

        self.assertEqual(list(sut.read_file(self.root / "mine.json")), ["tick"])
        self.assertFalse((self.root / sut.DEFAULT_FILE).exists())

    def test_json_says_which_file_it_cannot_write(self):
        status, lines, err = self.run_main("--json", "no/such/folder.json")

        self.assertEqual((status, len(lines)), (1, 4))
        self.assertIn("no/such/folder.json", err)

    def test_compare_tells_what_changed_what_is_new_and_what_is_gone(self):
        self.run_main("--json", "old.json")
        self.make_benchmark("one", [figure("tick", ratio=6.0)])
        self.make_benchmark("two", [figure("sprint")])

        status, lines, _ = self.run_main("--compare", "old.json")

        self.assertEqual(status, 0)
        self.assertEqual([(line.split()[0], line.split()[-1]) for line in lines[1:]],
                         [("tick", "1.500"), ("sprint", "new"), ("step", "gone"), ("wake", "gone")])
        self.assertEqual({len(line) for line in lines}, {len(lines[0])})

    def test_compare_of_one_benchmark_misses_no_figure_of_the_others(self):
        self.run_main("--json", "old.json")

        lines = self.run_main("one", "--compare", "old.json")[1]

        self.assertEqual([line.split()[0] for line in lines[1:]], ["tick"])

    def test_a_benchmark_that_fails_is_named_and_the_others_run(self):
        self.make_benchmark("one", [], status=3)
        status, lines, err = self.run_main()

        self.assertEqual((status, len(lines)), (1, 3))
        self.assertIn("bench_one failed", err)


if __name__ == "__main__":
    unittest.main()

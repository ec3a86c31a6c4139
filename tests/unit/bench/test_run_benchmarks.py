import json
import os
import pathlib
import sys
import tempfile
import unittest

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


if __name__ == "__main__":
    unittest.main()

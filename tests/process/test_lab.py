"""The experiments of `thimble lab` that write findings, as a person runs them."""

import csv
import json
import unittest

from rig import ProcessTest, is_sanitized


class Lab(ProcessTest):
    def run_experiment(self, *arguments, **how):
        return self.run_program("thimble", "lab", *arguments, **how)

    def test_table_4_1_is_as_the_facts_have_it_and_is_written(self):
        folder = self.folder / "out"
        shown = self.run_experiment("table-4.1", "--contacts", "600", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout + shown.stderr)
        self.assertEqual(shown.stdout.count("as it must be: "), 6)
        document = json.loads((folder / "table-4.1.json").read_text())
        self.assertEqual(document["parameters"]["contacts_per_row"]["value"], 600)
        self.assertEqual(document["parameters"]["seed"]["value"], 1)
        with (folder / "table-4.1-kinematic.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(document["tables"]["kinematic"]["rows"]))
        streamed = {row["delay [ms]"]: row["mean [mm]"] for row in rows
                    if row["reading"] == "streamed" and row["network"] == "constant"}
        self.assertEqual(streamed["500"], "end of reach")
        self.assertAlmostEqual(float(streamed["100"]), 19.6, delta=0.1)
        self.assertIn("set ylabel 'offset [mm]'", (folder / "table-4.1-offsets.gp").read_text())

    def test_the_same_seed_prints_the_same(self):
        once, again, other = (self.run_experiment("table-4.1", "--contacts", "3", "--seed", seed)
                              for seed in ("4", "4", "5"))
        self.assertEqual(once.stdout, again.stdout)
        self.assertNotEqual(once.stdout, other.stdout)

    @unittest.skipIf(is_sanitized(), "takes ten minutes there; Compare.* play the same scenarios")
    def test_schemes_are_compared_and_ranked(self):
        folder = self.folder / "compared"
        shown = self.run_experiment("compare", "--out", folder, timeout=280)
        self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
        with (folder / "compare-ranking.csv").open() as file:
            rows = list(csv.DictReader(file))
        for delay in ("1", "5", "10", "20", "50", "100", "200", "500"):
            places = [row["place"] for row in rows if row["delay [ms]"] == delay]
            # Equals share a place.
            for i, place in enumerate(places):
                self.assertIn(place, {str(i + 1), places[max(0, i - 1)]})
            self.assertEqual(places[0], "1")
            self.assertGreater(len(places), 5)

    def test_constraint_models_hold_as_the_figures_draw_them(self):
        folder = self.folder / "figures"
        shown = self.run_experiment("constraint-models", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
        self.assertEqual(shown.stdout.count("as it must be: "), 4)
        with (folder / "constraint-models-trace-side.csv").open() as file:
            trace = list(csv.DictReader(file))
        end = trace[-1]
        self.assertLess(float(end["simple_proxy_y [mm]"]), float(end["hand_y [mm]"]) - 1, "figure 3-8e")
        self.assertEqual(end["cells_proxy_y [mm]"], end["hand_y [mm]"], "figure 3-9")

    def test_what_cannot_be_done_is_said(self):
        shown = self.run_experiment("table-4.1", "--contacts", "1", "--out", "/proc/none")
        self.assertNotEqual(shown.returncode, 0)
        self.assertIn("/proc/none", shown.stderr)
        self.assertNotEqual(self.run_experiment("table-4.1", "--contacts", "0").returncode, 0)
        self.assertNotEqual(self.run_experiment("table-4.9").returncode, 0)

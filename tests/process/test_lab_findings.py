"""The experiments of `thimble lab` that reckon for minutes, as a person runs them: `./run test` plays them while there is time (decision 0497)."""

import csv
import json

from lab_rig import LabTest, reckons


@reckons
class Findings(LabTest):
    def test_table_4_1_is_as_the_facts_have_it_and_is_written(self):
        folder = self.folder / "out"
        shown = self.run_experiment("table-4.1", "--contacts", "600", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout + shown.stderr)
        self.assertEqual(shown.stdout.count("as it must be: "), 9)
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

    def test_schemes_are_compared_and_ranked(self):
        folder = self.folder / "compared"
        shown = self.run_experiment("compare", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
        parameters = json.loads((folder / "compare.json").read_text())["parameters"]
        for name, value in (("finger: mass", 0.15), ("weight: stiffness", 3), ("wave, b = 40: impedance", 40),
                            ("composite: hysteresis", 0.0005), ("edge: speed", 0.1), ("buffer-zone: buffer", 0.03),
                            ("gate: rise", 2), ("gate: energy", 0.001), ("yardstick: onset", 0.1)):
            self.assertEqual(parameters[name]["value"], value, name)
        with (folder / "compare-ranking.csv").open() as file:
            rows = list(csv.DictReader(file))
        for delay in ("1", "5", "10", "20", "50", "100", "200", "500"):
            places = [row["place"] for row in rows if row["delay [ms]"] == delay]
            # Equals share a place.
            for i, place in enumerate(places):
                self.assertIn(place, {str(i + 1), places[max(0, i - 1)]})
            self.assertEqual(places[0], "1")
            self.assertGreater(len(places), 5)
        with (folder / "compare-left-out.csv").open() as file:
            left_out = list(csv.DictReader(file))
        metrics = list(left_out[0])[3:]
        self.assertEqual(len(metrics), 10)
        self.assertEqual(len(left_out), len(rows))
        for places, row in zip(left_out, rows):
            for name in ("delay [ms]", "scheme", "place"):
                self.assertEqual(places[name], row[name])
            among = [int(places[name]) for name in ("place", *metrics)]
            self.assertEqual(str(min(among)), row["best_without_one"])
            self.assertEqual(str(max(among)), row["worst_without_one"])
        self.assertRegex(shown.stdout, "delay \\[ms\\] +scheme +place +" + " +".join(metrics))

    def test_they_are_compared_before_a_wall_that_moves_and_with_a_guard(self):
        # Half a minute of two processors each. Before the wall that moves guards are left to a person: docs/lab.md.
        for name, criteria in (("compare-moving", 2), ("compare-guarded", 3), ("compare-two-port", 3)):
            with self.subTest(name):
                shown = self.run_experiment(name, "--out", self.folder / name)
                self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
                self.assertEqual(shown.stdout.count("as it must be: "), criteria)

    def test_the_largest_stable_stiffnesses_are_those_of_theory(self):
        folder = self.folder / "stability"
        shown = self.run_experiment("stability", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout[-800:] + shown.stderr)
        with (folder / "stability-limits.csv").open() as file:
            rows = list(csv.DictReader(file))
        # teleop.md 2(a), its own simulation: N/m at 10 ms.
        found = {row["hand_damping [N.s/m]"]: float(row["measured [N/m]"]) for row in rows
                 if row["scheme"] == "remote-force" and row["delay [ms]"] == "10"}
        for damping, expected in (("2", 195), ("4", 399), ("8", 827)):
            self.assertAlmostEqual(found[damping], expected, delta=0.02 * expected)
        parameters = json.loads((folder / "stability.json").read_text())["parameters"]
        self.assertIsNone(parameters["remote-force, hand of 2 N.s/m: stiffness"]["value"], "it is what is sought")
        plot = (folder / "stability-schemes.gp").read_text()
        self.assertIn("set ylabel 'largest stable stiffness [N/m]'", plot)
        self.assertIn("thesis, wall of 800 N/m", plot)

    def test_the_frame_gets_away_when_theory_says(self):
        folder = self.folder / "drift"
        shown = self.run_experiment("drift", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout[-800:] + shown.stderr)
        with (folder / "drift-critical.csv").open() as file:
            found = {(row["scheme"], row["delay [ms]"]): float(row["measured [1/s]"])
                     for row in csv.DictReader(file)}
        # teleop.md 2(e), "Drift".
        for delay, expected in (("50", 2.5), ("100", 1.2), ("200", 0.6)):
            self.assertAlmostEqual(found["ghost-point", delay], expected, delta=0.15 * expected)

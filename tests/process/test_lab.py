"""The experiments of `thimble lab` that write findings, as a person runs them."""

import contextlib
import csv
import json
import os
import pathlib
import pty
import re
import select
import shutil
import struct
import subprocess
import unittest
import xml.etree.ElementTree
import zlib

from rig import BIN, ROOT, TIMEOUT_S, ProcessTest, clean_environment, die_with_parent, is_sanitized


_reckons = unittest.skipIf(is_sanitized(), "reckons for minutes there; the release build plays it")
_SVG = "{http://www.w3.org/2000/svg}"


def pixels_of_png(content):
    """Width, height and the inflated rows of a picture."""
    if not content.startswith(b"\x89PNG\r\n\x1a\n"):
        raise AssertionError("it has not the signature of PNG")
    place, packed, size = 8, b"", None
    while place < len(content):
        length, kind = struct.unpack_from(">I4s", content, place)
        data = content[place + 8:place + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack_from(">II", data)
        elif kind == b"IDAT":
            packed += data
        place += 12 + length
    return (*size, zlib.decompress(packed))


class Lab(ProcessTest):
    def run_experiment(self, *arguments):
        # A minute of one processor, at most, and several on one that others use.
        shown = self.run_program("thimble", "lab", *arguments, timeout=280)
        if "--out" in arguments and shutil.which("gnuplot"):
            folder = pathlib.Path(arguments[arguments.index("--out") + 1])
            if folder.is_dir():  # also where a criterion is not met
                self.assert_all_is_drawn(folder)
        return shown

    def assert_all_is_drawn(self, folder):
        plots = sorted(folder.glob("*.gp"))
        self.assertTrue(plots, "nothing to draw")
        for plot in plots:
            with self.subTest(plot.name):
                drawn = xml.etree.ElementTree.parse(plot.with_suffix(".svg"))
                self.assertTrue(any(group.get("id", "").startswith("gnuplot_plot_") for group in drawn.iter(_SVG + "g")))
                _, _, rows = pixels_of_png(plot.with_suffix(".png").read_bytes())
                # Rows are stored as differences: an empty picture has hardly any that is not 0.
                self.assertGreater(len(rows) - rows.count(0), 10000)

    @_reckons
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

    @_reckons
    def test_the_same_seed_prints_the_same(self):
        once, again, other = (self.run_experiment("table-4.1", "--contacts", "3", "--seed", seed)
                              for seed in ("4", "4", "5"))
        self.assertEqual(once.stdout, again.stdout)
        self.assertNotEqual(once.stdout, other.stdout)

    @_reckons
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

    @_reckons
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

    @_reckons
    def test_they_are_compared_before_a_wall_that_moves_and_with_a_guard(self):
        # Half a minute of two processors each. Before the wall that moves guards are left to a person: docs/lab.md.
        for name, criteria in (("compare-moving", 2), ("compare-guarded", 3), ("compare-two-port", 3)):
            with self.subTest(name):
                shown = self.run_experiment(name, "--out", self.folder / name)
                self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
                self.assertEqual(shown.stdout.count("as it must be: "), criteria)

    @_reckons
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

    @_reckons
    def test_the_ball_of_the_thesis_swings_only_where_forces_come_back_late(self):
        shown = self.run_experiment("hello-sphere", "--out", self.folder / "sphere")
        self.assertEqual(shown.returncode, 0, shown.stdout[-800:] + shown.stderr)
        self.assertEqual(shown.stdout.count("as it must be: "), 3)

    @_reckons
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

    def test_a_configuration_is_played_unchanged(self):
        folder = self.folder / "run"
        config = self.folder / "hello.toml"
        config.write_text("""
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "box"
[arm.hand]
motion = "explore"
[[world]]
name = "box"
source = "box:3"
""")
        shown = self.run_experiment("run", config, "--for", "6", "--out", folder)
        self.assertEqual(shown.returncode, 0, shown.stdout + shown.stderr)
        self.assertRegex(shown.stdout, r"virtual time went \d+ times as fast as real time")
        document = json.loads((folder / "run.json").read_text())
        self.assertEqual(document["parameters"]["configuration"]["value"], config.read_text())
        self.assertIn('motion = "explore"', document["parameters"]["configuration"]["value"])
        again = self.run_experiment("run", config, "--for", "6", "--out", self.folder / "again")
        self.assertEqual(again.returncode, 0)
        self.assertEqual((self.folder / "again/run.json").read_bytes(), (folder / "run.json").read_bytes())
        arms = document["tables"]["arms"]
        state = [column["name"] for column in arms["columns"]].index("state")
        self.assertEqual(arms["rows"][0][state].lower(), "active")
        with (folder / "run-trace-1.csv").open() as file:
            self.assertGreater(len(list(csv.DictReader(file))), 1000)

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed (Debian: gnuplot-nox)")
    def test_plots_are_drawn_by_gnuplot(self):
        folder = self.folder / "drawn"
        shown = self.run_experiment("table-4.1", "--contacts", "1", "--out", folder)
        self.assertEqual(shown.stderr, "")
        for kind in (".svg", ".png"):
            self.assertIn(f"written: {folder / 'table-4.1-offsets'}{kind}\n", shown.stdout)
        drawn = xml.etree.ElementTree.parse(folder / "table-4.1-offsets.svg")
        words = {"".join(text.itertext()).strip() for text in drawn.iter(_SVG + "text")}
        self.assertLessEqual({"offset [mm]", "round-trip delay [ms]", "thesis, table 4.1"}, words)
        series = [group for group in drawn.iter(_SVG + "g") if group.get("id", "").startswith("gnuplot_plot_")]
        self.assertEqual(len(series), (folder / "table-4.1-offsets.gp").read_text().count(" << EOD\n"))
        for one in series:
            self.assertTrue(list(one.iter(_SVG + "use")) + list(one.iter(_SVG + "path")), "a series without a mark")
        width, height, _ = pixels_of_png((folder / "table-4.1-offsets.png").read_bytes())
        self.assertEqual((width, height), (1350, 900))

    def run_on_a_terminal(self, *arguments):
        """Exit code, standard output, and what a terminal at standard error was shown."""
        ours, theirs = pty.openpty()
        self.addCleanup(os.close, ours)
        output = self.folder / "stdout"
        with output.open("wb") as file, open(theirs, "wb", closefd=True) as terminal:
            process = subprocess.Popen([str(BIN / "thimble"), "lab", *map(str, arguments)], stdin=subprocess.DEVNULL,
                                       stdout=file, stderr=terminal, env=clean_environment(),
                                       preexec_fn=die_with_parent)
        told = b""
        # A terminal that nobody writes to any more answers with EIO.
        with contextlib.suppress(OSError):
            while select.select([ours], [], [], TIMEOUT_S)[0]:
                told += os.read(ours, 65536)
        return process.wait(TIMEOUT_S), output.read_text(), told.decode()

    def test_a_terminal_is_shown_how_far_it_is_and_a_file_is_not(self):
        _, printed, told = self.run_on_a_terminal("table-4.1", "--contacts", "1")
        bars = re.findall(r"\r(#*)(\.*) (\d+) of (\d+)", told)
        done = [int(bar[2]) for bar in bars]
        count = int(bars[0][3])
        self.assertGreater(count, 10)
        self.assertEqual(done, list(range(1, count + 1)), "each run that ends moves it")
        filled = [len(bar[0]) for bar in bars]
        self.assertEqual({len(bar[0] + bar[1]) for bar in bars}, {40})
        self.assertEqual(filled, sorted(filled))
        self.assertLess(filled[0], filled[-1])
        self.assertEqual(filled[-1], 40, "it is full")
        self.assertTrue(told.endswith("\r\x1b[K"), "its line is empty again")
        self.assertNotIn("\r", printed)
        piped = self.run_experiment("table-4.1", "--contacts", "1")
        self.assertEqual(piped.stdout, printed)
        self.assertEqual(piped.stderr, "", "no terminal, no bar")

    def test_no_time_and_no_seed_is_refused(self):
        for option, wrong in (("--for", "nan"), ("--for", "inf"), ("--for", "0x10"), ("--seed", "-1")):
            shown = self.run_program("thimble", "lab", "run", ROOT / "examples/hello-voxel.toml", option, wrong)
            self.assertEqual((shown.returncode, shown.stdout), (2, ""), wrong)
            self.assertIn(f"{option}: expected a", shown.stderr)

    def test_what_keeps_real_time_is_not_played(self):
        config = self.folder / "real.toml"
        config.write_text("""
[[arm]]
name = "here"
device = "hid:1234"
model = "premium-1.5"
amplifier_max_a = 3.0
world = "box"
[[world]]
name = "box"
source = "box:3"
""")
        shown = self.run_experiment("run", config)
        self.assertNotEqual(shown.returncode, 0)
        self.assertIn("device: a real one keeps real time", shown.stderr)

    def test_hosts_are_played_along_a_serial_line(self):
        host, guest = (ROOT / "examples" / f"{end}-host.toml" for end in ("world", "arm"))
        link = ("--set", "arm-host:arm.link='serial:/dev/ttyS0@115200'")
        alone = self.run_experiment("run", guest, *link)
        self.assertNotEqual(alone.returncode, 0)
        self.assertIn("link: nobody listens at serial:/dev/ttyS0@115200; give the configuration of that host, too, "
                      "with the same device there", alone.stderr)
        shown = self.run_experiment("run", host, guest, "--for", "3", *link,
                                    "--set", "world-host:world.listen='serial:/dev/ttyS0@115200'")
        self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
        self.assertNotIn("damaged frames", shown.stdout)
        garbled = self.run_experiment("run", host, guest, "--for", "3", *link,
                                      "--set", "world-host:world.listen='serial:/dev/ttyS0@57600'")
        self.assertIn("world-host: world 'box': listen: nothing but damaged frames: does the other end run at 57600 bit/s?",
                      garbled.stdout)
        self.assertIn("arm-host: arm 'right': link: nobody answers", garbled.stdout)

    def test_hosts_that_are_coupled_are_played_together(self):
        host, guest = (ROOT / "examples" / f"teleoperation-{end}.toml" for end in ("host", "guest"))
        alone = self.run_experiment("run", guest)
        self.assertNotEqual(alone.returncode, 0)
        self.assertIn("link: nobody listens at udp://127.0.0.1:5001; give the configuration of that host, too",
                      alone.stderr)
        shown = self.run_experiment("run", host, guest, "--for", "2",
                                    "--set", "teleoperation-guest:arm.impairment.delay_s=0.1")
        self.assertEqual(shown.returncode, 0, shown.stdout[-400:] + shown.stderr)
        for arm in ("teleoperation-host: here", "teleoperation-guest: there"):
            self.assertIn(arm, shown.stdout)
        wrong = self.run_experiment("run", host, "--set", "guest:arm.hand.seed=1")
        self.assertIn("no configuration is called 'guest'", wrong.stderr)

    def test_what_cannot_be_done_is_said(self):
        shown = self.run_experiment("table-4.1", "--contacts", "1", "--out", "/proc/none")
        self.assertNotEqual(shown.returncode, 0)
        self.assertIn("/proc/none", shown.stderr)
        self.assertNotEqual(self.run_experiment("table-4.1", "--contacts", "0").returncode, 0)
        self.assertNotEqual(self.run_experiment("table-4.9").returncode, 0)

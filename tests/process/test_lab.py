"""The experiments of `thimble lab` that write findings, as a person runs them."""

import csv
import json
import re
import shutil
import unittest
import xml.etree.ElementTree

from lab_rig import SVG, LabTest, pixels_of_png, reckons
from rig import HELLO, ROOT


class Lab(LabTest):
    @reckons
    def test_the_same_seed_prints_the_same(self):
        once, again, other = (self.run_experiment("table-4.1", "--contacts", "3", "--seed", seed)
                              for seed in ("4", "4", "5"))
        self.assertEqual(once.stdout, again.stdout)
        self.assertNotEqual(once.stdout, other.stdout)

    @reckons
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

    @reckons
    def test_the_ball_of_the_thesis_swings_only_where_forces_come_back_late(self):
        shown = self.run_experiment("hello-sphere", "--out", self.folder / "sphere")
        self.assertEqual(shown.returncode, 0, shown.stdout[-800:] + shown.stderr)
        self.assertEqual(shown.stdout.count("as it must be: "), 3)

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
        words = {"".join(text.itertext()).strip() for text in drawn.iter(SVG + "text")}
        self.assertLessEqual({"offset [mm]", "round-trip delay [ms]", "thesis, table 4.1"}, words)
        series = [group for group in drawn.iter(SVG + "g") if group.get("id", "").startswith("gnuplot_plot_")]
        self.assertEqual(len(series), (folder / "table-4.1-offsets.gp").read_text().count(" << EOD\n"))
        for one in series:
            self.assertTrue(list(one.iter(SVG + "use")) + list(one.iter(SVG + "path")), "a series without a mark")
        width, height, _ = pixels_of_png((folder / "table-4.1-offsets.png").read_bytes())
        self.assertEqual((width, height), (1350, 900))

    def test_a_terminal_is_shown_how_far_it_is_and_a_file_is_not(self):
        _, printed, told = self.run_on_a_terminal("lab", "table-4.1", "--contacts", "1")
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

    def test_a_count_has_no_zeros_before_it(self):
        for words in (("lab", "table-4.1", "--contacts", "0100"), ("calibrate-force", "--steps", "010"),
                      ("cam", "run", "life", "--size", "64x64", "--steps", "1", "--threads", "010"),
                      ("cam", "run", "life", "--size", "64x64", "--steps", "1", "--modules", "010")):
            shown = self.run_program("thimble", *words)
            self.assertEqual((shown.returncode, shown.stdout), (2, ""), words)
            self.assertIn(f"{words[-2]}: expected a whole number from ", shown.stderr)

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

    def test_a_place_that_takes_no_files_is_refused_before_the_run(self):
        file = self.write("file", "kept")
        config = self.write("short.toml", HELLO)
        for words in (("hello-sphere",), ("table-4.1",), ("run", config, "--for", "1e5")):
            for place, said in ((file, "is there, and is no folder"), ("/proc/none", "/proc/none")):
                with self.subTest(words=words, place=place):
                    shown = self.run_experiment(*words, "--out", place)
                    self.assertEqual((shown.returncode, shown.stdout), (1, ""), shown.stderr)
                    self.assert_one_sentence(shown.stderr, str(place), said)
            empty = self.run_program("thimble", "lab", *words, "--out", "")
            self.assertEqual((empty.returncode, empty.stdout), (2, ""), empty.stderr)
            self.assertIn('--out: expected a name, found ""', empty.stderr)
        self.assertEqual(file.read_text(), "kept")
        self.assertEqual(self.run_experiment("separate", "--write", "").returncode, 2)

    def test_what_cannot_be_done_is_said(self):
        shown = self.run_experiment("table-4.1", "--contacts", "1", "--out", "/proc/none")
        self.assertNotEqual(shown.returncode, 0)
        self.assertIn("/proc/none", shown.stderr)
        self.assertNotEqual(self.run_experiment("table-4.1", "--contacts", "0").returncode, 0)
        self.assertNotEqual(self.run_experiment("table-4.9").returncode, 0)

"""Worlds of a CAM without an arm, and step lists for a board, as a person looks at them."""

import json
import re
import struct
import unittest

from rig import ROOT, ProcessTest, is_sanitized

DELAY, STOP = 3 << 29, 1 << 14


def list_file(*descriptors):
    """Descriptors one behind the other; each links to the next."""
    words = b"".join(struct.pack("<4I", opcode, buffer, length, 32 + 16 * i)
                     for i, (opcode, buffer, length) in enumerate(descriptors))
    return b"CAMLIST1" + struct.pack("<2I", 16, 0) + words


class StepLists(ProcessTest):
    def disassemble(self, content, *options):
        file = self.folder / "steps.cam"
        file.write_bytes(content)
        return self.run_program("thimble", "cam", "disassemble", *options, file)

    def test_a_list_is_told_step_by_step(self):
        shown = self.disassemble(list_file((0x20001002, 0, 30), (DELAY | STOP, 0, 40)))
        self.assertEqual((shown.returncode, shown.stderr), (0, ""))
        self.assertEqual(shown.stdout.splitlines(),
                         ["0x10      write kick, wait: 0", "0x20      delay 40 clocks; stop",
                          "2 steps, 30 words, 0 runs, 0 reads"])

    def test_a_list_that_no_board_is_given_is_shown_and_refused(self):
        shown = self.disassemble(list_file((0x2000001d, 0, 1), (DELAY | STOP, 0, 40)))
        self.assertEqual(shown.returncode, 1)
        self.assertIn("write register 29", shown.stdout)
        self.assert_one_sentence(shown.stderr, "step 1 at 0x10: register 29 does not exist")

    def test_sync_pulses_are_believed(self):
        frame = list_file((0x20005001, 0x0000ffff, 6))
        self.assertEqual(self.disassemble(frame).returncode, 1)
        self.assertEqual(self.disassemble(frame, "--sync").returncode, 0)

    def test_a_transfer_is_as_long_as_a_module_of_the_board(self):
        # A read of all sites of a module of 2^24: more than the window of this file has.
        whole = list_file((0x40001010, 0x100, 1 << 24), (DELAY | STOP, 0, 40))
        small, large = self.disassemble(whole), self.disassemble(whole, "--sites", "24")
        self.assert_one_sentence(small.stderr, "scan-io takes 1 to 4194304 words")
        self.assert_one_sentence(large.stderr, "its buffer of 33554432 bytes")
        for wrong in ("23", "0", "-1", "two"):
            self.assertEqual(self.disassemble(whole, "--sites", wrong).returncode, 2, wrong)

    def test_what_is_no_list_is_one_sentence(self):
        for content in (b"", b"CAMLIST1", b"\x7fELF" * 100):
            shown = self.disassemble(content)
            self.assertEqual((shown.returncode, shown.stdout), (1, ""), content)
            self.assert_one_sentence(shown.stderr, "steps.cam", "no step list")
        missing = self.run_program("thimble", "cam", "disassemble", self.folder / "none")
        self.assertEqual((missing.returncode, missing.stdout), (1, ""))


class Separating(ProcessTest):
    @unittest.skipIf(is_sanitized(), "reckons for minutes there; the release build plays it")
    def test_pieces_are_moved_apart_and_the_same_seed_moves_them_alike(self):
        once, again = (self.run_program("thimble", "lab", "separate", "--seed", "13")
                       for _ in range(2))
        self.assertEqual((once.returncode, once.stderr), (0, ""))
        self.assertIn(" 16 apart after ", once.stdout)
        self.assertEqual(once.stdout, again.stdout)

    def test_the_layout_of_the_example_is_what_they_begin_with(self):
        file = self.folder / "layout.npy"
        shown = self.run_program("thimble", "lab", "separate", "--seed", "1", "--write", file)
        self.assertEqual((shown.returncode, shown.stdout, shown.stderr), (0, f"the pieces are written to {file}\n", ""))
        self.assertEqual(file.read_bytes(), (ROOT / "examples/interlocking.npy").read_bytes())

    def test_where_no_layout_can_be_written_nothing_is_moved(self):
        for name, said in (("layout.txt", "ending in .npy or .nrrd"), ("no/layout.npy", "cannot be written")):
            shown = self.run_program("thimble", "lab", "separate", "--write", self.folder / name)
            self.assertEqual((shown.returncode, shown.stdout), (1, ""), name)
            self.assert_one_sentence(shown.stderr, name, said)

    def test_a_seed_is_a_number(self):
        for wrong in ("one", "1.5", "-1", "010", "0x10", "9007199254740993"):
            shown = self.run_program("thimble", "lab", "separate", "--seed", wrong)
            self.assertEqual((shown.returncode, shown.stdout), (2, ""), wrong)


class Latencies(ProcessTest):
    ROW = re.compile(r"^(\d boards.*?) +\d+ +\d+ +\d+ +\d+ +[\d.]+ / (\d+) +([\d.]+) +([\d.]+) +(\d+) ms +(\d+) mm +([+-][\d.]+) %$",
                     re.MULTILINE)

    @unittest.skipIf(is_sanitized(), "reckons for minutes there; the release build plays it")
    def test_those_of_the_thesis_come_out_of_the_simulated_board(self):
        shown = self.run_program("thimble", "lab", "cam-latency")
        self.assertEqual((shown.returncode, shown.stderr), (0, ""))
        self.assertTrue(shown.stdout.startswith("At 25 MHz, "), shown.stdout)
        rows = self.ROW.findall(shown.stdout)
        self.assertEqual([(row[0], row[1], row[4], row[5]) for row in rows],
                         [("4 boards", "1", "250", "50"), ("8 boards", "1", "125", "25"),
                          ("8 boards, leap", "7", "35", "7")])
        for name, _, latency_ms, offset_mm, thesis_ms, _, off_percent in rows:
            off = 100 * (float(latency_ms) / float(thesis_ms) - 1)
            self.assertAlmostEqual(off, float(off_percent), delta=0.2, msg=name)
            self.assertLessEqual(abs(off), 10, name)
            self.assertAlmostEqual(float(offset_mm), 0.2 * float(latency_ms), delta=0.1, msg=name)
        cells, host_ms = re.search(r" (\d+) cells of the plane an update, ([\d.]+) ms of host", shown.stdout).groups()
        self.assertEqual(len(re.findall(r"(?m)^64\^3, 8 boards.* \d", shown.stdout)), 5)
        self.assertRegex(shown.stdout, r"(?m)^8 boards, trail .* \d")
        slower = self.run_program("thimble", "lab", "cam-latency", "--clock-mhz", "20")
        self.assertEqual((slower.returncode, slower.stderr), (0, ""))
        self.assertTrue(slower.stdout.startswith("At 20 MHz, "), slower.stdout)
        # What a person would believe of a host of 1995 and a hand.
        self.assertTrue(30 <= int(cells) <= 45, cells)
        self.assertLessEqual(float(host_ms), 0.3)


class Worlds(ProcessTest):
    def run_world(self, world, *options):
        return self.run_program("thimble", "cam", "run", world, *options)

    def test_they_are_named(self):
        shown = self.run_program("thimble", "cam", "list")
        self.assertEqual((shown.returncode, shown.stderr), (0, ""))
        named = json.loads(self.run_program("thimble", "cam", "list", "--json").stdout)
        self.assertEqual([line.split()[0] for line in shown.stdout.splitlines()],
                         [world["name"] for world in named])
        self.assertIn("life", [world["name"] for world in named])

    def test_a_glider_goes_round_the_torus(self):
        glider, after = self.folder / "glider.rle", self.folder / "after.rle"
        glider.write_text("x = 3, y = 3, rule = B3/S23\nbob$2bo$3o!\n")
        told = []
        for steps, engine in (("0", "auto"), ("64", "auto"), ("64", "general"), ("64", "reference")):
            shown = self.run_world("life", "--size", "16x16", "--steps", steps, "--pattern", glider,
                                   "--engine", engine, "--write", after, "--json")
            self.assertEqual((shown.returncode, shown.stderr), (0, ""))
            told.append((json.loads(shown.stdout)["population"], after.read_text()))
        self.assertEqual(told[0][0], [5] * 9 + [0] * 7)
        self.assertEqual(told, [told[0]] * 4)

    def test_a_person_is_told_layers_clocks_and_time(self):
        shown = self.run_world("hpp", "--size", "32x32", "--steps", "10", "--modules", "2")
        self.assertEqual((shown.returncode, shown.stderr), (0, ""))
        self.assertRegex(shown.stdout, r"(?m)^hpp, 32x32 sites, 10 steps by compiled")
        self.assertRegex(shown.stdout, r"(?m)^board  \d+ clocks, .* at 25 MHz on 2 modules$")

    def test_a_board_has_one_of_three_clocks(self):
        boards = []
        for clock_mhz in (20, 21, 25):
            of = ("life", "--size", "64x64", "--steps", "3", "--clock-mhz", str(clock_mhz))
            shown = self.run_world(*of, "--json")
            self.assertEqual((shown.returncode, shown.stderr), (0, ""))
            boards.append(json.loads(shown.stdout)["board"])
            self.assertEqual(boards[-1]["clock_mhz"], clock_mhz)
            self.assertAlmostEqual(boards[-1]["time_s"], boards[0]["clocks"] / (1e6 * clock_mhz), delta=1e-9)
            self.assertIn(f" at {clock_mhz} MHz on 1 module\n", self.run_world(*of).stdout)
        self.assertEqual({board["clocks"] for board in boards}, {boards[0]["clocks"]})
        for wrong in "22", "0", "25.5", "nan":
            shown = self.run_world("life", "--size", "8x8", "--steps", "1", "--clock-mhz", wrong)
            self.assertEqual((shown.returncode, shown.stdout), (2, ""), wrong)
        self.assertIn("expected a finite number", shown.stderr)

    def test_what_the_simulated_board_does_not_model_is_counted(self):
        shown = self.run_world("hpp", "--size", "32x32", "--steps", "10", "--modules", "2", "--json")
        self.assertEqual(json.loads(shown.stdout)["board"]["unmodelled"], 0)

    def test_threads_share_a_world_and_come_to_the_same(self):
        worlds = []
        for threads in "1", "3":
            shown = self.run_world("fhp", "--size", "512x256", "--steps", "20", "--engine", "general",
                                   "--threads", threads, "--json")
            self.assertEqual((shown.returncode, shown.stderr), (0, ""))
            worlds.append(json.loads(shown.stdout))
            self.assertEqual(worlds[-1]["threads"], int(threads))
        self.assertEqual(worlds[0]["population"], worlds[1]["population"])
        shown = self.run_world("life", "--size", "8x8", "--steps", "1", "--threads", "2")
        self.assertIn(") on 2 threads\n", shown.stdout)
        shown = self.run_world("life", "--size", "8x8", "--steps", "1", "--threads", "2", "--engine", "reference")
        self.assert_one_sentence(shown.stderr, "the reference engine has one thread")
        self.assertEqual(self.run_world("life", "--size", "8x8", "--steps", "1", "--threads", "0").returncode, 2)

    def test_a_terminal_is_told_what_is_under_way_and_a_file_is_not(self):
        command = ("cam", "run", "life", "--size", "64x64", "--steps", "3", "--write", self.folder / "after.npy")
        code, printed, told = self.run_on_a_terminal(*command)
        self.assertEqual(code, 0)
        lines = told.split("\r\x1b[K")
        self.assertEqual((lines[0], lines[1], lines[-2:]), ("", "making the first sites", [f"writing them to {self.folder}/after.npy", ""]))
        self.assertIn("step 1 of 3", lines)
        self.assertNotIn("\x1b", printed)
        self.assertEqual(self.run_program("thimble", *command).stderr, "")

    def test_what_cannot_be_is_one_sentence(self):
        for world, options, said in (("no-such", ("--size", "8x8", "--steps", "1"), "cam list"),
                                     ("life", ("--size", "9x8", "--steps", "1"), "powers of two"),
                                     ("life", ("--size", "8x8", "--steps", "1", "--write", "x.txt"), ".npy or .rle")):
            shown = self.run_world(world, *options)
            self.assertEqual((shown.returncode, shown.stdout), (1, ""))
            self.assert_one_sentence(shown.stderr, said)
        self.assertEqual(self.run_world("life", "--size", "8x8").returncode, 2)
        for option in "--write", "--pattern":
            shown = self.run_world("life", "--size", "8x8", "--steps", "1", option, "")
            self.assertEqual((shown.returncode, shown.stdout), (2, ""), option)
            self.assertIn(f'{option}: expected a name, found ""', shown.stderr)
        for wrong in "-1", "010", "1.5", "18446744073709551616":
            for numbers in (("--steps", wrong), ("--steps", "1", "--seed", wrong)):
                shown = self.run_world("life", "--size", "8x8", *numbers)
                self.assertEqual((shown.returncode, shown.stdout), (2, ""), numbers)
                self.assertIn("expected a whole number", shown.stderr)
        self.assertEqual(self.run_world("life", "--size", "8x8", "--steps", "1", "--engine", "x").returncode, 2)

"""Worlds of the real program: the sphere, what does not go with it, and edits under the hand."""

import json
import math
import random
import re
import time

from rig import EXAMPLES, HELLO, TIMEOUT_S, ProcessTest, free_udp_port, http_over, http_request, unix_connection

SPHERE = ("--config", EXAMPLES / "sphere.toml")


FAR = """
[[arm]]
name = "left"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
link = "udp://127.0.0.1:{port}"
protocol = "thimble"
[arm.hand]
motion = "explore"
reach_m = 0.03
seed = 7
"""


class Sphere(ProcessTest):
    def test_the_example_is_felt_and_has_no_cells(self):
        daemon = self.start(*SPHERE, "--set", "arm.hand.speed_m_per_s=0.1")
        status = daemon.status_when(
            lambda s: s["arms"][0]["contacts"] > 0 and s["arms"][0]["peak_force_newton"] > 0.3)
        self.assertEqual(status["arms"][0]["faults"], [])
        world = status["worlds"][0]
        self.assertEqual((world["source"], world["cells"], world["cell_m"], world["probes"]),
                         ("sphere", [0, 0, 0], 0, 1))
        shown = self.thimble(daemon, "status")
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("sphere", shown.stdout)
        self.assertNotIn("0 x 0", shown.stdout)
        self.assertEqual(daemon.stop(), 0)

    def test_what_does_not_go_with_it_is_refused_at_its_key(self):
        for setting, key, reason in (
                ("world.constraint_model=simple", "world.0.constraint_model", "works on cells"),
                ("world.sphere.floor_m=0.5", "world.0.sphere.floor_m", "below the top"),
                ("arm.coupling.scheme=thesis-literal", "arm.0.coupling", "across the axes only")):
            result = self.thimbled(*SPHERE, "--set", setting, "--check")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assert_one_sentence(result.stderr, key, reason)
        # Our own datagrams carry its faces.
        self.assertEqual(self.thimbled(*SPHERE, "--set", "world.listen=udp://127.0.0.1:0", "--check").returncode, 0)


class Pieces(ProcessTest):
    def ask_the_board(self, daemon, *words):
        """A busy machine holds a board up beyond its time: it says so, is opened anew, and is asked again."""
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            told = self.thimble(daemon, *words)
            if "the board" not in told.stdout + told.stderr or time.monotonic() > deadline:
                return told

    def switch_free_motion(self, daemon, is_on):
        """What a board that was held up did not do in time it may yet do: then the state says whether to ask again."""
        def is_so():
            return daemon.status()["worlds"][0]["pieces"]["is_free_motion"] == is_on

        was_held_up = False
        deadline = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline:
            told = self.thimble(daemon, "free")
            if "the board" in told.stdout + told.stderr:
                was_held_up = True
                looked_until = time.monotonic() + 2
                while not is_so() and time.monotonic() < looked_until:
                    time.sleep(0.02)
            else:
                self.assertEqual((told.returncode, told.stderr), (0, ""), told.stdout)
                self.assertRegex(told.stdout, "world desk: free motion is (on|off)\n$")
                self.assertTrue(was_held_up or told.stdout.endswith("on\n" if is_on else "off\n"), told.stdout)
            if is_so():
                return
        self.fail(f"it was never switched\n{daemon.log()}")

    def assert_done(self, daemon, verb, outcome, code):
        told = self.ask_the_board(daemon, verb)
        self.assertEqual((told.returncode, told.stderr), (code, ""), f"{verb}: {told.stdout}")
        self.assertEqual(told.stdout, f"world desk: {outcome}\n")

    def test_the_example_is_felt_and_takes_commands(self):
        daemon = self.start("--config", EXAMPLES / "pieces.toml", "--set", "world.pieces.cells=32",
                            "--set", "world.pieces.count=3")
        daemon.status_when(lambda s: s["arms"][0]["contacts"] > 0 and s["arms"][0]["peak_force_newton"] > 0.3)
        for verb in ("drop", "delete"):
            self.assert_done(daemon, verb, "no piece is held", 1)
        for is_on in (True, False):
            self.switch_free_motion(daemon, is_on)
        self.assert_done(daemon, "reset", "all pieces are as they were at first", 0)
        pieces = daemon.status()["worlds"][0]["pieces"]
        self.assertEqual((pieces["held"], pieces["is_free_motion"]), (0, False))
        self.assertTrue(all(0 <= place < cells for place, cells in zip(pieces["grasp_cell"], (32, 32, 1), strict=True)), pieces)
        self.switch_free_motion(daemon, True)
        self.assertIn("free motion", self.thimble(daemon, "status").stdout)
        refused = self.thimble(daemon, "world", "clear")
        self.assertEqual(refused.returncode, 1)
        self.assert_one_sentence(refused.stderr, "the cells of pieces are the board's", "drop")
        self.assertEqual(http_over(daemon.socket, "POST", "/v1/worlds/elsewhere/select")[0], 404)
        self.assertEqual(daemon.status()["arms"][0]["faults"], [])
        self.assertEqual(daemon.stop(), 0)

    def test_what_cells_press_back_with_is_told_here_and_over_the_link(self):
        port = free_udp_port()
        said = ("--set", "world.pieces.cells=32", "--set", "world.pieces.count=3", "--set", "world.pieces.pressure_newton_per_m=500")
        example = (EXAMPLES / "pieces.toml").read_text()
        self.start(*said, "--set", f"world.listen=udp://127.0.0.1:{port}", name="world",
                   config=example[example.index("[[world]]"):])  # it has one hand, the other host's
        for where, daemon in (("here", self.start("--config", EXAMPLES / "pieces.toml", *said)),
                              ("there", self.start(name="far", config=FAR.format(port=port)))):
            with self.subTest(where):
                status = daemon.status_when(lambda s: math.hypot(*s["arms"][0]["felt"].get("pressure_newton", [0])) > 0.01)
                self.assertEqual(status["arms"][0]["faults"], [])

    def test_their_layout_is_written_and_read_again(self):
        said = ("--config", EXAMPLES / "pieces-3d.toml", "--set", "world.pieces.cells=32", "--set", "world.pieces.count=3")
        daemon = self.start(*said)
        first, array = self.folder / "first.nrrd", self.folder / "first.npy"
        for file in (first, array):
            told = self.ask_the_board(daemon, "world", "save", "--file", file)
            self.assertEqual((told.returncode, told.stderr), (0, ""))
            self.assertEqual(told.stdout, f"world {daemon.status()['worlds'][0]['name']}: layout saved to {file}\n")
        other = self.folder / "layout.txt"
        told = self.ask_the_board(daemon, "world", "save", "--file", other)
        self.assertEqual((told.returncode, told.stdout), (1, ""))
        self.assert_one_sentence(told.stderr, str(other), "a layout is written to a file ending in .npy or .nrrd")
        self.assertFalse(other.exists(), "world.pieces.layout would refuse it")
        self.assertEqual(daemon.stop(), 0)
        self.assertEqual(array.read_bytes()[-32 ** 3:], first.read_bytes()[-32 ** 3:])
        self.assertEqual(set(first.read_bytes()[-32 ** 3:]), {0, 1, 2, 3})
        for file in (first, array):
            text = re.sub("(?m)^(axes|cells|count) =.*$", "", (EXAMPLES / "pieces-3d.toml").read_text())
            daemon = self.start("--set", f"world.pieces.layout={file}", name=file.suffix[1:], config=text)
            again = self.folder / "again.nrrd"
            self.assertEqual(self.ask_the_board(daemon, "world", "save", "--file", again).returncode, 0)
            self.assertEqual(again.read_bytes(), first.read_bytes())
            self.assertEqual(daemon.stop(), 0)

    def test_a_world_without_pieces_says_so(self):
        daemon = self.start(config=HELLO)
        told = self.thimble(daemon, "select")
        self.assertEqual(told.returncode, 1)
        self.assert_one_sentence(told.stderr, "it has no pieces")

    def test_what_does_not_go_with_it_is_refused_at_its_key(self):
        result = self.thimbled("--config", EXAMPLES / "pieces.toml", "--set", "world.constraint_model=simple", "--check")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assert_one_sentence(result.stderr, "world.0.constraint_model", "works on cells")
        crowded = self.thimbled("--config", EXAMPLES / "pieces.toml", "--set", "world.pieces.cells=32",
                                "--set", "world.pieces.count=63", "--check")
        self.assertEqual(crowded.returncode, 2, crowded.stderr)
        self.assert_one_sentence(crowded.stderr, "world.0.source", "room for")


class Live(ProcessTest):
    def test_the_examples_run_while_they_are_felt(self):
        for name, least in (("life.toml", 100), ("crystal.toml", 2)):
            daemon = self.start("--config", EXAMPLES / name, "--set", "world.automaton.steps_per_s=200", name=name)
            daemon.status_when(lambda s: s["worlds"][0]["occupied_cells"] >= least)
            self.assertEqual(daemon.status()["arms"][0]["faults"], [])
            self.assertEqual(daemon.stop(), 0)

    def test_a_state_that_was_saved_is_gone_on_from(self):
        daemon = self.start("--config", EXAMPLES / "life.toml", "--set", "world.automaton.steps_per_s=0")
        first = occupied(daemon.status())
        file = self.folder / "dish.nrrd"
        told = self.thimble(daemon, "world", "save", "--file", file)
        self.assertEqual((told.returncode, told.stdout), (0, f"world dish: saved to {file}\n"), told.stderr)
        self.assertTrue(file.read_bytes().startswith(b"NRRD0004\n"))
        self.assertEqual(self.thimble(daemon, "world", "clear").returncode, 0)
        self.assertEqual(occupied(daemon.status()), 0)
        told = self.thimble(daemon, "world", "load", "--file", file)
        self.assertEqual((told.returncode, told.stdout), (0, f"world dish: goes on from {file}\n"), told.stderr)
        self.assertEqual(occupied(daemon.status()), first)
        file.write_bytes(file.read_bytes()[:-1])
        told = self.thimble(daemon, "world", "load", "--file", file)
        self.assertEqual(told.returncode, 1)
        self.assert_one_sentence(told.stderr, "dish", "data: expected 32768 bytes, found 32767")
        self.assertEqual(occupied(daemon.status()), first)
        self.assertEqual(daemon.stop(), 0)

    def test_any_world_of_cells_is_drawn_to_what_is_named_a_png(self):
        for name, config in (("life", ("--config", EXAMPLES / "life.toml")), ("box", ("--config", EXAMPLES / "hello-voxel.toml"))):
            daemon = self.start(*config, name=name)
            picture, other = self.folder / f"{name}.png", self.folder / f"{name}.jpg"
            told = self.thimble(daemon, "snapshot", "--file", picture)
            self.assertEqual((told.returncode, told.stderr), (0, ""))
            self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
            told = self.thimble(daemon, "snapshot", "--file", other)
            self.assertEqual((told.returncode, told.stdout), (2, ""))
            self.assertIn("a picture is written to a file ending in .png", told.stderr)
            self.assertFalse(other.exists())
            told = self.thimble(daemon, "snapshot", "", "--file", self.folder / "unset.png")
            self.assertEqual((told.returncode, told.stdout), (2, ""))
            self.assertIn("expected a name of ", told.stderr)
            self.assertFalse((self.folder / "unset.png").exists())
            self.assertEqual(daemon.stop(), 0)

    def test_a_state_that_cannot_be_read_is_no_daemon_that_is_not_there(self):
        daemon = self.start("--config", EXAMPLES / "life.toml", "--set", "world.automaton.steps_per_s=0")
        first = occupied(daemon.status())
        for file, said in ((self.folder / "nope", "cannot open it"), (self.folder, "cannot read it"),
                           ("/dev/zero", "has more than 516 KiB, which no saved state has")):
            with self.subTest(file=file):
                told = self.thimble(daemon, "world", "load", "--file", file)
                self.assertEqual((told.returncode, told.stdout), (1, ""), told.stderr)
                self.assert_one_sentence(told.stderr, f"thimble: {file}: ", said)
        self.assertEqual(occupied(daemon.status()), first)
        told = self.run_program("thimble", "--socket", self.folder / "none", "world", "load", "--file", self.folder / "nope")
        self.assertEqual(told.returncode, 3, "the connection comes first")

    def test_a_world_that_does_not_run_has_no_state(self):
        daemon = self.start(config=HELLO)
        told = self.thimble(daemon, "world", "save", "--file", self.folder / "none")
        self.assertEqual(told.returncode, 1)
        self.assert_one_sentence(told.stderr, "it does not run by itself")
        self.assertFalse((self.folder / "none").exists())


def occupied(status):
    return status["worlds"][0]["occupied_cells"]


class Edits(ProcessTest):
    def edit(self, daemon, edits, world="box"):
        body = edits if isinstance(edits, str) else json.dumps(edits)
        code, _, answer = http_over(daemon.socket, "POST", f"/v1/worlds/{world}/edits", body)
        return code, json.loads(answer)

    def test_cells_change_while_the_arm_is_active_and_the_status_says_so(self):
        daemon = self.start(config=HELLO)
        before = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        self.assertEqual(occupied(before), 26)
        code, answer = self.edit(daemon, [
            {"clear": {"min": [0, 1, 1], "max": [2, 1, 1]}},
            {"fill": {"min": [1, 1, 1], "max": [1, 1, 1], "cell": 1}}])
        self.assertEqual((code, answer), (200, {"world": "box", "edits": 2, "changed_cells": 3}))
        status = daemon.status()
        self.assertEqual(occupied(status), 25, "an answer comes when the edits are in")
        self.assertEqual((status["worlds"][0]["edits_applied"], status["worlds"][0]["edits_waiting"]),
                         (2, 0))
        self.assertEqual(self.edit(daemon, {"clear": {"min": [0, 0, 0], "max": [2, 2, 2]}})[0], 200)
        self.assertEqual(occupied(daemon.status()), 0)
        self.assert_servo_goes_on(daemon)
        self.assertEqual(daemon.status()["arms"][0]["faults"], [])

    def test_a_storm_of_edits_does_not_stop_the_servo(self):
        daemon = self.start(config=HELLO.replace("box:3", "box:32"))
        daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        chance = random.Random(1)
        sent = 0
        with unix_connection(daemon.socket) as connection:
            for _ in range(60):
                center = [chance.uniform(-0.015, 0.015) for _ in range(3)]
                edits = [{"paint": {"center_m": center, "radius_m": 0.006, "cell": chance.randrange(2)}}
                         for _ in range(10)]
                code, _, answer = http_request(connection, "POST", "/v1/worlds/box/edits",
                                               json.dumps(edits))
                self.assertEqual(code, 200, answer)
                sent += len(edits)
        status = daemon.status()
        self.assertEqual(status["worlds"][0]["edits_applied"], sent)
        self.assertEqual(status["arms"][0]["faults"], [])
        self.assert_servo_goes_on(daemon)

    def test_a_fill_of_a_large_world_is_acknowledged_without_a_stall(self):
        daemon = self.start(config=HELLO.replace("box:3", "box:512"))
        daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        with unix_connection(daemon.socket) as connection:
            body = json.dumps({"fill": {"min": [0, 0, 0], "max": [511, 511, 511]}})
            connection.sendall(b"POST /v1/worlds/box/edits HTTP/1.1\r\nHost: t\r\n"
                               + f"Content-Length: {len(body)}\r\n\r\n{body}".encode())
            self.assert_servo_goes_on(daemon)  # and the API answers others meanwhile
            done = daemon.status_when(lambda s: s["worlds"][0]["edits_waiting"] == 0
                                      and s["worlds"][0]["edits_applied"] == 1)
        self.assertEqual(occupied(done), 512 ** 3)
        self.assertEqual(done["arms"][0]["faults"], [])

    def test_each_refusal_is_one_sentence_and_changes_nothing(self):
        daemon = self.start(config=HELLO)
        good = {"clear": {"min": [0, 0, 0], "max": [0, 0, 0]}}
        for edits, code, part in (
                ("", 400, "expected an edit"), ("[[[[", 400, "no JSON"), ({"smooth": {}}, 400, "expected an edit"),
                ([good, {"fill": {"min": [0, 0, 0], "max": [0, 0, 3]}}], 400, "edit 1: min, max: along z"),
                ({"box": {"min": [0, 0, 0], "max": [1, 1, 1], "cell": 2}}, 400, "cell: 2"),
                ({"paint": {"center_m": [0, 0, 0], "radius_m": -1}}, 400, "radius_m")):
            found, answer = self.edit(daemon, edits)
            self.assertEqual(found, code, (edits, answer))
            self.assertIn(part, answer["error"]["message"])
            self.assertNotIn("\n", answer["error"]["message"])
        self.assertEqual(self.edit(daemon, good, world="elsewhere")[0], 404)
        self.assertEqual(occupied(daemon.status()), 26)
        self.assertEqual(http_over(daemon.socket, "GET", "/v1/worlds/box/edits")[0], 405)

    def test_a_sphere_refuses_with_the_reason(self):
        daemon = self.start(*SPHERE)
        code, answer = self.edit(daemon, {"clear": {"min": [0, 0, 0], "max": [0, 0, 0]}}, "hello")
        self.assertEqual(code, 501)
        self.assertIn("made of no cells", answer["error"]["message"])
        told = self.thimble(daemon, "world", "fill")
        self.assertEqual(told.returncode, 1)
        self.assert_one_sentence(told.stderr, "made of no cells")

    def test_the_command_line_fills_clears_boxes_and_paints(self):
        daemon = self.start(config=HELLO.replace("box:3", "box:6"))
        for words, changed, left in (
                (["clear"], 216 - 8, 0),
                (["box", "box"], 216 - 64, 152),
                (["fill", "--min", 1, 1, 1, "--max", 2, 1, 1], 2, 154),
                (["fill", "box", "--min", 1, 1, 1, "--max", 2, 1, 1, "--cell", 0], 2, 152),
                (["paint", "--center", -0.0075, "-.0075", "+.0075", "--radius", 0.001], 1, 153)):
            told = self.thimble(daemon, "world", *words)
            self.assertEqual((told.returncode, told.stderr), (0, ""), words)
            self.assertEqual(told.stdout, f"world box: {changed} cell{'s' * (changed != 1)} changed\n")
            self.assertEqual(occupied(daemon.status()), left)
        for words, code in ((["paint"], 2), (["fill", "left"], 1), (["smooth"], 2),
                            (["fill", "--min", 1, 2], 2), (["paint", "--radius", "nan"], 2)):
            self.assertEqual(self.thimble(daemon, "world", *words).returncode, code, words)
        for words in (["fill", "--cell", ""], ["fill", "--cell", "010"], ["fill", "--cell", "-1"],
                      ["fill", "--min", "", "", "", "--max", 1, 1, 1],
                      ["paint", "--center", "", 0, 0, "--radius", 0.001]):
            told = self.thimble(daemon, "world", *words)
            self.assertEqual(told.returncode, 2, (words, told.stdout))
            self.assertIn("expected a", told.stderr)
        for words in (["deactivate", ""], ["deactivate", "x y"], ["activate", "right/../left"],
                      ["clear-fault", "R"], ["world", "fill", ""], ["world", "fill", "a\x1b[31m"]):
            told = self.thimble(daemon, *words)
            self.assertEqual(told.returncode, 2, (words, told.stdout))
            self.assertIn("expected a name of 1 to 32 of a-z, 0-9 and -, found", told.stderr)
            self.assertNotIn("\x1b", told.stderr)
        for words, part in ((["clear", "--cell", 1], "--cell does not go with clear"),
                            (["fill", "--center", 0, 0, 0], "--center does not go with fill")):
            told = self.thimble(daemon, "world", *words)
            self.assertEqual(told.returncode, 2, (words, told.stdout))
            self.assertIn(part, told.stderr)
        self.assertEqual(occupied(daemon.status()), left, "what is refused changes nothing")
        # What no daemon could take is refused before one is looked for.
        for words, part in ((["paint", "--radius", 1], "paint needs --center"),
                            (["paint", "--center", 0, 0, 0], "paint needs --radius"),
                            (["fill", "--min", 0, 0, 0], "fill needs --max"),
                            (["clear", "--max", 0, 0, 0], "clear needs --min"),
                            (["box", "--min", 1, 1, 1, "--max", 1, 0, 1], "--max along y"),
                            (["paint", "--center", 0, 0, 0, "--radius", 0], "--radius"),
                            (["paint", "--center", 0, 0, 0, "--radius", -1], "--radius"),
                            (["paint", "--center", 0, 2e6, 0, "--radius", 1], "--center"),
                            (["fill", "--cell", 256], "--cell")):
            told = self.run_program("thimble", "world", *words, "--socket", self.folder / "none")
            self.assertEqual((told.returncode, told.stdout), (2, ""), words)
            self.assertIn(part, told.stderr)
        none = self.run_program("thimble", "world", "fill", "--socket", self.folder / "none")
        self.assertEqual(none.returncode, 3)

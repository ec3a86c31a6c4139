"""A world of pieces on some CAM board, felt with a HID arm: the same moves, which lead to the same on every board."""

import json

import arms
import guest
import simdev

# Of this seed, in cells of 2 mm: piece 3 to the left of the middle and below it, piece 1 above.
WORLD = """
world = "desk"

[[world]]
name = "desk"
source = "pieces"
workspace_m = 0.064

[world.pieces]
cells = 32
count = 3
seed = 2
board = "{board}"
"""
# Each a stroke along an axis, so that nothing depends on how soon the board answers; and the cell that the grasp point ends in: where the hand is, or where pieces
# stop it.
PLAY = (
    ("move 0.001 -0.005 0 0.3", [16, 13, 0]),  # beside piece 3
    ("thimble reset", [16, 13, 0]),
    ("move -0.009 -0.005 0 0.5", [14, 13, 0]),  # against it, from the right
    ("thimble select", [11, 13, 0]),
    ("move -0.011 -0.005 0 0.5", [10, 13, 0]),
    ("move -0.011 0.021 0 0.8", [10, 26, 0]),  # up, to the left of piece 1
    ("move 0.009 0.021 0 0.8", [12, 26, 0]),  # against piece 1, with piece 3
    ("thimble drop", [20, 26, 0]),
    ("move 0.009 0.001 0 0.5", [20, 16, 0]),  # away, and up again below what was dropped
    ("move -0.013 0.001 0 0.5", [9, 16, 0]),
    ("move -0.013 0.025 0 0.5", [9, 23, 0]),
)
# What lies where in the end, cell by cell.
SAVE = "timeout 20 thimble world save --file /tmp/desk.npy > /dev/null && sha256sum < /tmp/desk.npy"
AGAINST_PIECE_3 = 3  # so many steps
PIECE_3_IN_HAND = 5
CELL = "worlds.0.pieces.grasp_cell"
REST_S = 0.3  # in which it goes no further


class Pieces(guest.GuestTest):
    """Begins with an arm; its `start()` is called by whoever has the board."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest)

    def start(self, board, *, is_there=True):
        self.guest.run("sed -i '/^world = /,$ d' /etc/thimble/thimble.toml; "
                       f"cat >> /etc/thimble/thimble.toml <<'E'\n{WORLD.format(board=board)}E\nsystemctl restart thimbled")
        self.arm.activate()
        self.wait_for_board(is_there=is_there)

    def trouble(self):
        return next(sentence for sentence in self.status()["degraded"] if sentence.startswith("world 'desk': "))

    def wait_for_board(self, *, is_there):
        test = "! " if is_there else ""
        return self.guest.wait_for(f"said=$(thimble status --json) && {test}grep -q \"world 'desk': \" <<< \"$said\"")

    def status(self):
        return json.loads(self.guest.run("thimble status --json"))

    def pieces(self):
        return self.status()["worlds"][0]["pieces"]

    def do(self, step, cell):
        """What was said of it, the cell in which the grasp point ended, and which piece is held then."""
        if step.startswith("move"):
            self.arm.say(step)
            self.guest.sleep(float(step.split()[-1]))
            said = ""
        else:
            said = self.guest.run(f"timeout 20 {step}").strip()
        self.guest.wait_for_module("status_until", CELL, json.dumps(cell))
        self.guest.sleep(REST_S)
        pieces = self.pieces()
        return said, pieces["grasp_cell"], pieces["held"]

    def play(self, steps=len(PLAY)):
        """What each step led to; of a whole play, where the pieces lie afterwards."""
        report = [self.do(*step) for step in PLAY[:steps]]
        return report if steps < len(PLAY) else [*report, self.guest.run(SAVE).split()[0]]

    def assert_grasped_moved_and_dropped(self, report):
        said, cells, held = zip(*report[:-1])
        self.assertEqual([words for words in said if words],
                         [f"world desk: {done}" for done in ("all pieces are as they were at first", "selected", "dropped")])
        self.assertEqual(list(cells), [cell for _, cell in PLAY])
        self.assertEqual(list(held), 3 * [0] + 4 * [3] + 4 * [0])
        self.assertGreater(simdev.norm(self.arm.felt(0.2)), 1)

    def assert_let_go(self):
        self.guest.sleep(1.5)  # frozen first, then fading
        arm = self.status()["arms"][0]
        self.assertEqual((arm["state"], arm["faults"], arm["force_newton"]), ("active", [], [0, 0, 0]))
        self.assertLess(max(self.arm.forces(0.3)), simdev.NOTHING_NEWTON)

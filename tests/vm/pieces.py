"""A world of pieces on some CAM board, felt with an arm on hidraw: the same moves, which lead to the same on every board."""

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
# What lies where, cell by cell.
SAVE = "thimble world save --file /tmp/desk.npy"
# Each a stroke along an axis, so that nothing depends on how soon the board answers, or what is done.
PLAY = (
    "move 0.001 -0.005 0 0.3",  # beside piece 3
    "thimble reset",
    "move -0.009 -0.005 0 0.5",  # against it, from the right
    "thimble select",
    "move -0.011 -0.005 0 0.5",
    "move -0.011 0.021 0 0.8",  # up, to the left of piece 1
    "move 0.009 0.021 0 0.8",  # against piece 1, with piece 3
    "thimble drop",
    "move 0.009 0.001 0 0.5",  # away, and up again below what was dropped
    "move -0.013 0.001 0 0.5",
    "move -0.013 0.025 0 0.5",
    SAVE,
)
AGAINST_PIECE_3 = 3  # so many steps
PIECE_3_IN_HAND = 5
MOVE_S = 2.5


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

    def do(self, step):
        """What was said of it; of a move, the cell in which the grasp point ended: where the hand is, or where pieces stop it; or the digest of what was
        saved.
        """
        if step == SAVE:
            return self.guest.run(f"timeout 20 {step} > /dev/null && sha256sum < /tmp/desk.npy").split()[0]
        if not step.startswith("move"):
            return self.guest.run(f"timeout 20 {step}").strip()
        self.arm.say(step)
        self.guest.run(f"sleep {MOVE_S}")
        return self.pieces()["grasp_cell"]

    def play(self, steps=len(PLAY)):
        """Of each step its end, and which piece is held then."""
        return [(step, self.do(step), self.pieces()["held"]) for step in PLAY[:steps]]

    def assert_grasped_moved_and_dropped(self, report):
        self.assertEqual([done for step, done, _ in report if step.startswith("thimble") and step != SAVE],
                         [f"world desk: {done}" for done in ("all pieces are as they were at first", "selected", "dropped")])
        self.assertEqual([held for _, _, held in report], 3 * [0] + 4 * [3] + 5 * [0])
        self.assertGreater(simdev.norm(self.arm.felt(0.2)), 1)

    def assert_let_go(self):
        self.guest.run("sleep 1.5")  # frozen first, then fading
        arm = self.status()["arms"][0]
        self.assertEqual((arm["state"], arm["faults"], arm["force_newton"]), ("active", [], [0, 0, 0]))
        self.assertLess(max(self.arm.forces(0.3)), simdev.NOTHING_NEWTON)

"""Pieces on a CAM board that hangs on the guest's kernel over USB/IP: grasped, moved, dropped; the board's plug pulled while a held piece moves, and
while one is pushed. What the same moves lead to on a board within the daemon comes of them there, too.
"""

import nodes
import pieces
import simdev

PRESSED_NEWTON = 1


class Board(simdev.Simdev):
    """A real one has a processor of its own; here an arm must not wait for its scans."""

    policy = ""


class CamUsb(pieces.Pieces):
    """Numbered: each test goes on where the one before it ended."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.board = Board(cls.guest, "board", "--vhci", "cam-8")
        cls.board.attach()
        cls.guest.wait_for("thimble devices | grep -q 'CAM-8 board'")

    def pull(self, *before):
        """`before`: steps of the guest that come just before it."""
        self.guest.steps(*before, self.board.step("unplug"))
        self.wait_for_board(is_there=False)
        self.assert_let_go()

    def plug(self):
        self.board.say("plug")
        self.board.attach()
        self.wait_for_board(is_there=True)
        self.assertEqual(self.pieces()["held"], 0, "its memory had no power: all begins anew")

    def test_1_its_node_is_the_daemons(self):
        port = self.guest.run("dirname $(grep -lx 'CAM-8 board' /sys/bus/usb/devices/*/product)").strip()
        node = "/dev/" + self.guest.run(f"udevadm info --query=name {port}").strip()
        nodes.assert_closed(self, self.guest, node)
        self.assertEqual(self.guest.run(f"cat {port}/power/control").strip(), "on")

    def test_2_pieces_on_it_are_grasped_moved_and_dropped(self):
        self.start("usb")
        type(self).played = self.play()
        self.assert_grasped_moved_and_dropped(self.played)

    def test_3_pulled_out_while_a_piece_is_moved_the_arm_is_let_go_and_plugged_in_all_is_felt_again(self):
        self.assertEqual(self.play(pieces.PIECE_3_IN_HAND), self.played[:pieces.PIECE_3_IN_HAND])
        self.assertEqual(self.pieces()["held"], 3)
        self.pull(self.arm.step("move -0.011 0.021 0 2"), ("sleep", 0.5))
        self.plug()
        self.assertEqual(self.play(), self.played)

    def test_4_pulled_out_while_it_is_pushed_the_constraints_fade(self):
        self.play(pieces.AGAINST_PIECE_3)
        pushed = self.arm.felt(0.2)
        self.assertGreater(pushed[0], PRESSED_NEWTON)
        self.pull(("sleep", 0.2))
        # Never more than there was, and no push the other way.
        for entry in self.arm.samples(2):
            self.assertLess(entry["force_newton"][0], pushed[0] + 0.3)
            self.assertGreater(entry["force_newton"][0], -0.3)
        self.plug()

    def test_5_on_a_board_within_the_daemon_the_same_moves_lead_to_the_same(self):
        self.start("sim")
        self.assertEqual(self.play(), self.played)

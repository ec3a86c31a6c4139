"""A HID arm through uhid, and one with a Teensy, whose reports have 64 bytes: hid_arm.py."""

import arms
import hid_arm
import one_arm
import simdev


class Uhid(hid_arm.HidArm):
    way = "uhid"
    walls = [(axis, sign) for axis in range(3) for sign in (1, -1)]

    def test_5b_upgraded_while_the_hand_pushes_it_is_let_go_and_comes_back(self):
        """By the same package, which is what an upgrade does to a service; its guard has the arm meanwhile."""
        self.assertGreater(simdev.norm(self.press()), one_arm.WALL_NEWTON)
        before = self.properties("MainPID")
        self.guest.install("thimbled", words="--no-triggers")
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertNotEqual(self.properties("MainPID"), before)
        self.assertEqual(self.properties("ActiveState", "NRestarts"), {"ActiveState": "active", "NRestarts": "0"})
        self.assertLess(max(self.arm.forces(0.2)), simdev.NOTHING_NEWTON)
        self.arm.activate()


class Teensy(hid_arm.HidArm):
    """The form of the family that reports 64 bytes, on USB: they leave over its hiddev, too."""

    way = "usb"
    walls = ((2, 1),)
    rest_m = (0.0, -0.034, 0.0495)  # its home
    to_wall_m = 0.0145
    test_7_gone_with_its_daemon_it_keeps_no_guard_at_work = None  # over its hiddev as any arm on USB

    @classmethod
    def plug_in(cls):
        return arms.TeensyArm(cls.guest, cls.way)

    def test_2b_its_reports_are_those_of_that_form(self):
        log = self.arm.log(0.1)
        for way in ("in", "out"):
            self.assertEqual({len(entry[way]) // 2 for entry in log if way in entry}, {64}, way)
        self.assert_guard_has_hiddev()

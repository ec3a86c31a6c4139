"""A HID arm on the kernel's own HID stack: the packaged daemon claims it through hidapi, a hand calibrates it and feels the box.

Through uhid and over USB/IP. What is felt is judged by the arm's own log, of what its motors did.
"""

import arms
import guest
import simdev


class Uhid(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED
    way = "uhid"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest, cls.way)

    def test_1_its_node_is_the_daemons_and_the_daemon_has_it_open(self):
        self.guest.wait_for("systemctl is-active thimbled")
        node = self.guest.run("ls -d /sys/bus/hid/devices/0003:1234:0006.*/hidraw/hidraw*").strip().rsplit("/", 1)[1]
        self.assertEqual(self.guest.run(f"stat -c '%U:%G %a' /dev/{node}").strip(), "root:thimble 660")
        self.guest.wait_for(f"ls -l /proc/$(systemctl show thimbled -p MainPID --value)/fd | grep -q /dev/{node}")
        self.assertTrue(self.arm.status()["open"])
        self.assertEqual(self.arm.status()["counters"]["malformed"], 0)
        # Of those on USB: it never sleeps.
        self.assertEqual(self.guest.run(f"path=$(readlink -f /sys/class/hidraw/{node}/device/../../power/control); "
                                        "case $path in */usb*) cat $path;; *) echo on;; esac").strip(), "on")

    def test_2_held_in_its_home_pose_it_is_calibrated_and_becomes_active(self):
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertTrue(all(simdev.norm(entry["force_newton"]) < 1e-6 for entry in self.arm.samples()))
        self.arm.calibrate()
        simdev.wait_for_state(self.guest, "active")

    def test_3_in_the_middle_of_the_box_nothing_is_felt(self):
        self.arm.say("move 0 0 0 0.3")
        self.guest.run("sleep 0.8")
        self.assertLess(simdev.norm(self.arm.felt()), 0.1)

    def test_4_each_wall_of_the_box_pushes_back(self):
        for axis in range(3):
            for sign in (1, -1):
                with self.subTest(axis=axis, sign=sign):
                    point = [0.0, 0.0, 0.0]
                    point[axis] = sign * 0.018
                    self.arm.say("move {} {} {} 0.3".format(*point))
                    self.guest.run("sleep 0.8")
                    force = self.arm.felt()
                    self.assertLess(sign * force[axis], -0.3, force)
                    self.arm.say("move 0 0 0 0.3")
                    self.guest.run("sleep 0.35")

    def test_5_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        self.arm.say("move 0.018 0 0 0.3")
        self.guest.run("sleep 0.8")
        self.assertGreater(simdev.norm(self.arm.felt()), 0.3)
        self.guest.run("systemctl stop thimbled; sleep 0.2")
        self.assertLess(max(simdev.norm(entry["force_newton"]) for entry in self.arm.samples(0.1)), 1e-6)
        self.guest.wait_for("! ls -l /proc/*/fd 2>/dev/null | grep -q /dev/hidraw")


class Usbip(Uhid):
    way = "usbip"

    def test_2b_its_guard_has_the_second_way_which_is_nobody_elses(self):
        """The kernel makes a hiddev of the arm, and the guard holds it (decision 0341)."""
        self.guest.run("ls -l /proc/$(pgrep -x thimble-guard)/fd | grep -q /dev/usb/hiddev")
        self.assertEqual(self.guest.run("stat -c '%U:%G %a' /dev/usb/hiddev0").strip(), "root:thimble 660")

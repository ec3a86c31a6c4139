"""A Falcon on the kernel's own USB stack: the packaged daemon uploads a firmware to its boot-loader through libusb, a hand homes it and feels the box.

The firmware is made up here: a boot stream as the processor's maker defines it, with noise for code, which the simulated arm takes
for one. What is felt is judged by the arm's own log.
"""

import arms
import guest
import simdev


class Falcon(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = cls.plug_in()

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest)

    def test_1_its_node_is_the_daemons_and_the_daemon_has_claimed_it(self):
        self.guest.wait_for("systemctl is-active thimbled")
        node = self.guest.run("udevadm info --query=name /sys/bus/usb/devices/" + self.arm.address.removeprefix("usb:")).strip()
        self.assertEqual(self.guest.run(f"stat -c '%U:%G %a' /dev/{node}").strip(), "root:thimble 660")
        self.assertEqual(self.guest.run("cat /sys/bus/usb/devices/" + self.arm.address.removeprefix("usb:") + "/power/control").strip(), "on")
        self.guest.wait_for(f"ls -l /proc/$(systemctl show thimbled -p MainPID --value)/fd | grep -q /dev/{node}")
        self.assertEqual(self.arm.status()["counters"]["malformed"], 0)

    def test_2_its_firmware_is_uploaded_and_brought_home_it_becomes_active(self):
        simdev.wait_for_state(self.guest, "calibrating")
        self.arm.say("home 0.6")
        simdev.wait_for_state(self.guest, "active")

    def test_3_in_the_middle_of_the_box_nothing_is_felt(self):
        self.arm.say("move 0 0 0 0.3")
        self.guest.run("sleep 1")
        self.assertLess(simdev.norm(self.arm.felt(0.2)), 0.1)

    def test_4_a_wall_of_the_box_in_each_direction_pushes_back(self):
        for axis, sign in ((0, 1), (1, -1), (2, 1)):
            with self.subTest(axis=axis, sign=sign):
                point = [0.0, 0.0, 0.0]
                point[axis] = sign * 0.018
                self.arm.say("move {} {} {} 0.2".format(*point))
                self.guest.run("sleep 0.8")
                force = self.arm.felt(0.2)
                self.assertLess(sign * force[axis], -0.3, force)
                self.arm.say("move 0 0 0 0.2")
                self.guest.run("sleep 0.3")

    def test_5_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        self.arm.say("move 0.018 0 0 0.3")
        self.guest.run("sleep 0.8")
        self.assertGreater(simdev.norm(self.arm.felt(0.2)), 0.3)
        self.guest.run("systemctl stop thimbled; sleep 0.2")
        self.assertLess(max(simdev.norm(entry["force_newton"]) for entry in self.arm.samples(0.1)), 1e-6)

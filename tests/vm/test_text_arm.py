"""An arm with the text protocol on the stock kernel: over USB/IP, its cdc_acm makes a terminal of it, and the packaged daemon drives that.

What is felt is judged by the arm's own log, of what its motors did.
"""

import arms
import guest
import simdev


class TextArm(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.TextArm(cls.guest)

    def test_1_its_node_is_the_daemons_and_no_modem_managers(self):
        node = self.arm.node
        self.guest.wait_for("systemctl is-active thimbled")
        self.assertEqual(self.guest.run(f"stat -c '%U:%G %a' /dev/{node}").strip(), "root:thimble 660")
        self.assertIn("ID_MM_DEVICE_IGNORE=1", self.guest.run(f"udevadm info --query=property /dev/{node}").split())
        self.assertEqual(self.guest.run(f"basename $(readlink -f /sys/class/tty/{node}/device/driver)").strip(), "cdc_acm")
        self.guest.wait_for(f"ls -l /proc/$(systemctl show thimbled -p MainPID --value)/fd | grep -q /dev/{node}")
        self.assertTrue(self.arm.status()["open"])
        self.assertEqual(self.arm.status()["counters"]["malformed"], 0)

    def test_2_held_in_its_home_pose_it_is_calibrated_and_becomes_active(self):
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertTrue(all(simdev.norm(entry["force_newton"]) < 1e-6 for entry in self.arm.samples()))
        self.arm.calibrate()
        simdev.wait_for_state(self.guest, "active")

    def test_3_in_the_middle_of_the_box_nothing_is_felt(self):
        self.arm.say("move 0 0 0 0.3")
        self.guest.run("sleep 1.5")
        self.assertLess(simdev.norm(self.arm.felt()), 0.1)

    def test_4_a_wall_of_the_box_pushes_back(self):
        self.arm.say("move 0.018 0 0 0.3")
        self.guest.run("sleep 1.5")
        force = self.arm.felt()
        self.assertLess(force[0], -0.3, force)

    def test_5_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        self.assertGreater(simdev.norm(self.arm.felt()), 0.3)
        self.guest.run("systemctl stop thimbled; sleep 0.2")
        self.assertLess(max(simdev.norm(entry["force_newton"]) for entry in self.arm.samples(0.1)), 1e-6)
        self.guest.wait_for(f"! ls -l /proc/*/fd 2>/dev/null | grep -q /dev/{self.arm.node}")

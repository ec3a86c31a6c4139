"""An arm with the text protocol on the stock kernel: over USB/IP, its cdc_acm makes a terminal of it, and the packaged daemon drives that."""

import arms
import one_arm


class TextArm(one_arm.OneArm):
    walls = ((0, 1),)
    watchdog_s = 0.1

    def pull(self):
        """And then its supply, as its instruction asks for: where it is calibrated a press is not seen."""
        super().pull()
        self.arm.say("unplug")

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest)

    def test_1_its_node_is_the_daemons_and_no_modem_managers(self):
        self.assert_node(f"/dev/{self.arm.node}")
        self.assertIn("ID_MM_DEVICE_IGNORE=1", self.guest.run(f"udevadm info --query=property /dev/{self.arm.node}").split())
        self.assertEqual(self.guest.run(f"basename $(readlink -f /sys/class/tty/{self.arm.node}/device/driver)").strip(), "cdc_acm")
        self.assertEqual(self.guest.run(f"cat /sys/class/tty/{self.arm.node}/device/../power/control").strip(), "on")
        self.assertTrue(self.arm.status()["open"])

    def test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        super().test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force()
        self.guest.wait_for(f"! ls -l /proc/*/fd 2>/dev/null | grep -q /dev/{self.arm.node}")

"""A Falcon on the kernel's own USB stack: the packaged daemon uploads a firmware to its boot-loader through libusb.

The firmware is made up (arms.firmware); the simulated arm takes it for one.
"""

import arms
import one_arm


class Falcon(one_arm.OneArm):
    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest)

    def test_1_its_node_is_the_daemons_and_the_daemon_has_claimed_it(self):
        port = f"/sys/bus/usb/devices/{self.arm.address.removeprefix('usb:')}"
        self.assert_node("/dev/" + self.guest.run(f"udevadm info --query=name {port}").strip())
        self.assertEqual(self.guest.run(f"cat {port}/power/control").strip(), "on")

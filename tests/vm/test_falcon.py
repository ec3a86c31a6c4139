"""A Falcon on the kernel's own USB stack: the packaged daemon uploads a firmware to its boot-loader through libusb.

The firmware is made up (arms.firmware); the simulated arm takes it for one.
"""

import json

import arms
import one_arm
import simdev


class Falcon(one_arm.OneArm):
    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, way="usbip")

    def test_1_its_node_is_the_daemons_and_the_daemon_has_claimed_it(self):
        port = f"/sys/bus/usb/devices/{self.arm.address.removeprefix('usb:')}"
        self.assert_node("/dev/" + self.guest.run(f"udevadm info --query=name {port}").strip())
        self.assertEqual(self.guest.run(f"cat {port}/power/control").strip(), "on")

    def test_1b_its_boot_loader_was_given_the_whole_firmware_once(self):
        simdev.wait_for_state(self.guest, "calibrating")
        # What it was sent since it came; the rest of its log is long, and stays in the guest.
        lines = self.guest.run(f"{self.arm.command('log 60')} | grep '\"out\"'").splitlines()
        self.assertEqual(b"".join(bytes.fromhex(json.loads(line)["out"]) for line in lines).count(arms.firmware()), 1)

"""A HID arm over USB/IP: hid_arm.py."""

import hid_arm


class Usbip(hid_arm.HidArm):
    way = "usbip"

    def test_2b_its_guard_has_the_way_out_which_is_nobody_elses(self):
        """The kernel makes a hiddev of the arm, and the guard holds it (decision 0488)."""
        self.assert_guard_has_hiddev()
        self.assertEqual(self.guest.run("stat -c '%U:%G %a' /dev/usb/hiddev0").strip(), "root:thimble 660")

"""A HID arm on the kernel's USB stack that misbehaves while a Falcon beside it presses on a wall; then devices that lie in their descriptors, also of HID, plugged in where it was: misbehaviour.py."""

import guest
import misbehaviour

# As guest/lying_usb.py has them; the last one is what it says, and answers no transfer.
LIES = ("hid-short-class hid-endless-class hid-huge-reports hid-stalled-reports hid-no-input hid-no-packets hid-no-class hid-many-classes "
        "hid-longer-reports hid-no-reports hid-cut-reports hid-no-output hid-bulk hid-small-packets hid")


class MisbehavingBesideFalcon(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_the_hid_arm_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.LEFT)

    def test_3_devices_that_lie_are_in_place_of_it(self):
        self.lie_in_place_of(misbehaviour.LEFT, misbehaviour.HID_IDS, LIES)

"""A Falcon and a HID arm on the kernel's USB stack, one beside the other, that misbehave in turn; then devices that lie in their descriptors, plugged in where one of them was: misbehaviour.py."""

import guest
import misbehaviour

# As guest/lying_usb.py has them; the others are in test_lies.py. Each list ends with one that is what it says, and answers no transfer.
LIES = "longer more-endpoints both-in no-serial vendor"
HID_LIES = "hid-short-class hid-endless-class hid-huge-reports hid-stalled-reports hid-no-input hid-no-packets hid"


class Misbehaving(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_the_falcon_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.RIGHT)

    def test_3_the_hid_arm_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.LEFT)

    def test_4_devices_that_lie_are_in_place_of_the_falcon(self):
        self.lie_in_place_of(misbehaviour.RIGHT, misbehaviour.FALCON_IDS, LIES)

    def test_5_devices_that_lie_are_in_place_of_the_hid_arm(self):
        self.lie_in_place_of(misbehaviour.LEFT, misbehaviour.HID_IDS, HID_LIES)

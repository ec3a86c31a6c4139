"""More devices that lie in their descriptors, plugged in where a Falcon was, or a HID arm, while the other one presses on a wall: misbehaviour.py."""

import guest
import misbehaviour

# As in test_misbehaviour.py, which has the others.
LIES = "shorter no-endpoints long-length large-packets interrupts strange-serial vendor"
HID_LIES = "hid-no-class hid-many-classes hid-longer-reports hid-no-reports hid-cut-reports hid-no-output hid-bulk hid-small-packets hid"


class Lies(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_in_place_of_the_falcon(self):
        self.lie_in_place_of(misbehaviour.RIGHT, misbehaviour.FALCON_IDS, LIES)

    def test_3_in_place_of_the_hid_arm(self):
        self.lie_in_place_of(misbehaviour.LEFT, misbehaviour.HID_IDS, HID_LIES)

"""More devices that lie in their descriptors, plugged in where a Falcon was, while a HID arm presses on a wall: misbehaviour.py."""

import guest
import misbehaviour

# As in test_misbehaviour.py, which has the others.
LIES = "shorter no-endpoints long-length large-packets interrupts strange-serial vendor"


class Lies(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_in_place_of_the_falcon(self):
        self.lie_in_place_of(misbehaviour.RIGHT, misbehaviour.FALCON_IDS, LIES)

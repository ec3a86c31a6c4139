"""A Falcon that misbehaves on the kernel's USB stack while a HID arm beside it presses on a wall; then devices that lie in their descriptors, plugged in where it was: misbehaviour.py."""

import guest
import misbehaviour

# As guest/lying_usb.py has them; the others are in test_lies.py. Each list ends with one that is what it says, and answers no transfer.
LIES = "longer more-endpoints both-in no-serial vendor"


class Misbehaving(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_the_falcon_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.RIGHT)

    def test_3_devices_that_lie_are_in_its_place(self):
        self.lie_in_place_of(misbehaviour.RIGHT, misbehaviour.FALCON_IDS, LIES)

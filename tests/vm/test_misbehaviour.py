"""A Falcon and a HID arm on the kernel's USB stack, one beside the other, that misbehave in turn: misbehaviour.py."""

import guest
import misbehaviour


class Misbehaving(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_the_falcon_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.RIGHT)

    def test_3_the_hid_arm_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.LEFT)

"""A HID arm on the kernel's USB stack that misbehaves while a Falcon beside it presses on a wall; then devices that lie in their descriptors, also of HID, plugged in where it was: misbehaviour.py."""

import guest
import misbehaviour

# As guest/lying_usb.py has them; the last one is what it says, and answers no transfer.
LIES = ("hid-short-class hid-endless-class hid-huge-reports hid-stalled-reports hid-no-input hid-no-packets hid-no-class hid-many-classes "
        "hid-no-reports hid-cut-reports hid-no-output hid-bulk hid-small-packets hid")


class MisbehavingBesideFalcon(misbehaviour.FalconBesideHid, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    def test_2_the_hid_arm_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.LEFT)

    def test_3_devices_that_lie_are_in_place_of_it(self):
        self.lie_in_place_of(misbehaviour.LEFT, misbehaviour.HID_IDS, LIES)


class LongReports(misbehaviour.FalconBesideHid, guest.GuestTest):
    """A descriptor of reports that is 4 KiB of nothing, which the kernel reads for 0.2 s of this processor without giving way to anybody: where it does (`preempt=full`) no arm is stopped (decision 0524)."""

    gives_way = True

    def test_2_in_place_of_the_hid_arm(self):
        self.lie_in_place_of(misbehaviour.LEFT, misbehaviour.HID_IDS, "hid-longer-reports hid")

"""A HID arm that is plugged in and pulled out 1,000 times through uhid and 50 times on the USB stack: plugs.py. Others: test_plug_cycles_kinds.py."""

import arms
import guest
import plugs

# By then it has all that it needs once.
WARM_UP, CYCLES, HOLD = 100, 900, 30
LIES = 60
USB_CYCLES = 15  # of each block: with the warm-up 50


class PlugCycles(plugs.PlugCycles, guest.GuestTest):
    def test_1_through_uhid(self):
        arm = arms.HidArm(self.guest)
        self.addCleanup(arm.stop)
        self.live(arm, arm.activate)
        arm.say("unplug")
        self.cycle(f"uhid {WARM_UP} {HOLD} {arms.SERIAL}")
        self.live_again(arm)
        before = self.look()
        self.cycle_in_blocks(before, lambda _: self.assertEqual(self.cycle(f"uhid {CYCLES // plugs.BLOCKS} {HOLD} {arms.SERIAL}"), CYCLES // plugs.BLOCKS // HOLD))
        self.live_again(arm)
        after = self.look()
        self.assert_nothing_kept(before, after)
        before = after
        taken = []
        self.cycle_in_blocks(before, lambda number: taken.append(self.cycle(f"lies {LIES // plugs.BLOCKS} {arms.SERIAL} {number}")))
        self.assertGreater(sum(taken), LIES // 10)
        self.assert_nothing_kept(before, self.look())
        self.live_again(arm)

    def test_2_a_hid_arm_on_the_usb_stack(self):
        self.plug_often(arms.HidArm(self.guest, "usb"), USB_CYCLES)

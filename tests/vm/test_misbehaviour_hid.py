"""Two HID arms and a puck on the kernel's USB stack: an arm and the puck misbehave in turn, and the others must not notice: misbehaviour.py.

What they have in common in the kernel is more than a Falcon and a HID arm have: usbhid, and hidraw with its one lock (decision 0488).
"""

import json

import arms
import commanded
import guest
import misbehaviour
import simdev

PUCK = "VM-PUCK-1"
PUSHED = "push 0 5 0"


class Misbehaving(misbehaviour.Misbehaviour, guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    judge = commanded.Phantom("phantom-vintage")

    @classmethod
    def plug_in(cls):
        right = arms.HidArm(cls.guest, "usb", arms.FULL_HZ, is_named=False)
        beside = misbehaviour.arm_beside(cls.guest, "--vhci")
        cls.puck = simdev.Simdev(cls.guest, "puck", "--vhci", "--serial", PUCK, "spacemouse")
        for device in (beside, cls.puck):
            device.attach()
        address = cls.guest.wait_for("thimble devices --json | grep -o 'hid:[^\"]*' | grep -v ARM").split()[0]
        cls.more_words = f'world = "box"\n\n[[arm]]\nname = "puck"\ndevice = "{address}"\n'
        return right, beside

    def test_2_an_arm_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.RIGHT)

    def test_3_the_puck_misbehaves(self):
        both = misbehaviour.RIGHT, misbehaviour.LEFT
        before = [self.status(arm) for arm in both]
        for verb in misbehaviour.TROUBLES:
            with self.subTest(verb):
                self.puck.say(PUSHED)
                _, logs = self.strike(self.puck, verb, *self.arms)
                for arm, log in zip(both, logs):
                    self.assert_presses(arm, log)
                self.assertEqual([self.status(arm) for arm in both], before)

    def test_4_the_puck_moves_its_point_again(self):
        self.guest.run("thimble clear-fault puck || true")
        simdev.wait_for_state(self.guest, "active", arm=2)
        places = []
        for verb in ("push 10 0 0", "push -10 0 0"):
            self.puck.say(verb)
            self.guest.sleep(0.5)
            places.append(json.loads(self.guest.run("thimble status --json"))["arms"][2]["position_m"][0])
        self.assertLess(places[1], places[0])

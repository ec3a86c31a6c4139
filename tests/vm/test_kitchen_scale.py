"""The force of a Falcon's counts, measured with a kitchen scale: docs/calibrate-force.md."""

import re

import arms
import guest
import simdev


class Measured(guest.GuestTest):
    pace = guest.COUNTED
    true_newton_per_count = 10 / 4095  # of the simulated arm

    def test_a_scale_that_is_30_percent_off_is_found_within_5(self):
        assumed = 0.7 * self.true_newton_per_count
        arm = arms.Falcon(self.guest, is_named=False)
        arm.words = f"{arm.words}\nactivate = false".replace(str(arms.NEWTON_PER_COUNT), f"{assumed:.8f}")
        arm.configure()
        simdev.wait_for_state(self.guest, "calibrating", "inactive")
        arm.say("home 0.3")
        simdev.wait_for_state(self.guest, "inactive")
        arm.say("move 0 0 0 0.2")
        printed = self.guest.call("kitchen_scale", arm.socket, "right", timeout_s=300)
        found = float(re.search(r"^newton_per_count = (\S+)$", printed, re.MULTILINE)[1])
        self.assertAlmostEqual(found / self.true_newton_per_count, 1, delta=0.05)
        self.assertAlmostEqual(found / assumed, 1 / 0.7, delta=0.05)

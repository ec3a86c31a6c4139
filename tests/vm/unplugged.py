"""The plug of an arm is pulled while a hand presses on a wall: it stops, says why and has recorded it; plugged in again and calibrated it
waits for a clear, and then goes on. The arm beside it notices nothing of all this.

The cable alone: both controllers have a supply of their own, and the pulled arm's watchdog ends its force.
"""

import json

import one_arm
import simdev
import two_arms


class Unplugged(two_arms.TwoArms):
    """Numbered: each test goes on where the one before it ended."""

    def plug(self):
        """Steps of the guest."""
        return (self.right.step("plug"),)

    def assert_not_cleared(self, why):
        code, printed = self.guest.ask("thimble clear-fault right")
        self.assertNotEqual(code, 0)
        self.assertIn(why, printed)

    def test_1_both_arms_press_on_a_wall(self):
        self.press_both()

    def test_2_pulled_out_it_is_lost_and_the_arm_beside_presses_on(self):
        at_s, left, right = self.log_around(self.right.step("pull-cable"), seconds=2)
        self.assertGreater(min(force for when_s, force in two_arms.forces(right) if when_s < at_s), two_arms.WALL_NEWTON)
        one_arm.assert_ended_by_its_watchdog(self, right, one_arm.OneArm.watchdog_s, two_arms.WALL_NEWTON)
        self.assert_pressed_without_a_gap(left)

    def test_3_its_fault_is_latched_and_says_why_and_shows_what_it_recorded(self):
        arm = json.loads(simdev.wait_for_state(self.guest, "lost"))
        self.assertEqual(arm["force_newton"], [0, 0, 0])
        self.assertEqual([fault["code"] for fault in arm["faults"]], ["disconnected"])
        self.assertIn("the arm was unplugged", arm["faults"][0]["message"])
        self.assertGreater(arm["faults"][0]["number"], 0)
        self.assert_not_cleared("can be cleared when it is back")
        self.guest.wait_for("thimble status --json | grep -Eq '\"recording\": ?\"/'")
        arm = json.loads(simdev.wait_for_state(self.guest, "lost"))
        shown = self.guest.run(f"thimble flight show '{arm['faults'][0]['recording']}'")
        self.assertIn("disconnected", shown)
        self.assertIn("touch", shown)

    def test_4_plugged_in_again_it_is_not_driven_before_it_is_calibrated(self):
        before = self.of_the_arm_beside()
        _, left, _ = self.log_around(*self.plug())
        self.assert_pressed_without_a_gap(left)
        arm = json.loads(simdev.wait_for_state(self.guest, "calibrating"))
        self.assertEqual([fault["code"] for fault in arm["faults"]], ["disconnected"])
        self.assert_not_cleared("is not calibrated yet")
        self.assertLess(max(self.right.forces(0.5)), simdev.NOTHING_NEWTON)
        self.assert_nothing_happened_beside(before)

    def test_5_calibrated_it_waits_for_its_clear_and_forgets_nothing(self):
        before = self.of_the_arm_beside()
        self.assertIn("thimble clear-fault right", self.right.bring_back()["instruction"])
        # For longer than its own watchdog waits for a word.
        self.guest.sleep(1)
        arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
        self.assertEqual((arm["calibration"], [fault["code"] for fault in arm["faults"]]), ("ok", ["disconnected"]))
        self.assertLess(max(self.right.forces(1)), simdev.NOTHING_NEWTON)
        self.assert_nothing_happened_beside(before)

    def test_6_cleared_it_resumes(self):
        before = self.of_the_arm_beside()
        self.right.clear()
        self.press(self.right)
        self.assert_nothing_happened_beside(before)
        self.assertLess(self.left.felt(0.2)[0], -two_arms.WALL_NEWTON)

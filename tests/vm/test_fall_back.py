"""A simulated arm until the one that is named comes."""

import json

import arms
import guest
import one_arm
import simdev


class FallBack(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest, is_named=False)
        cls.arm.say("unplug")
        cls.arm.words += '\nfallback = "simulated"'
        cls.arm.configure()

    def status(self):
        """Of the daemon, and of its arm."""
        whole = json.loads(self.guest.run("thimble status --json"))
        return whole, whole["arms"][0]

    def assert_stands_in(self):
        whole, arm = self.status()
        self.assertEqual((arm["device"], arm["stands_in_for"], arm["state"]), ("sim:phantom-vintage", f"hid:{arms.SERIAL}", "active"))
        return whole["degraded"]

    def test_1_a_simulated_one_stands_in_and_the_status_says_so(self):
        simdev.wait_for_state(self.guest, "active")
        self.assertIn(f"arm 'right': hid:{arms.SERIAL} is not there; a simulated arm stands in for it (sim:phantom-vintage)", self.assert_stands_in())

    def test_2_plugged_in_while_that_is_active_the_arm_waits_untouched(self):
        self.arm.say("plug")
        self.arm.plug()
        self.guest.wait_for("thimble status --json | grep -q 'it takes over as soon as the simulated arm is inactive: thimble deactivate right'")
        self.guest.sleep(2)  # it is looked for again meanwhile
        self.assert_stands_in()
        arm = self.arm.status()
        self.assertEqual((arm["open"], arm["counters"]["from_host"]), (False, 0))

    def test_3_it_takes_over_when_that_rests_and_is_not_active_unasked(self):
        self.guest.run("thimble deactivate right")
        taken = json.loads(simdev.wait_for_state(self.guest, "calibrating"))
        self.assertEqual((taken["device"], taken["stands_in_for"]), (f"hid:{arms.SERIAL}", ""))
        self.arm.calibrate()
        simdev.wait_for_state(self.guest, "inactive")
        self.arm.say("move 0.018 0 0 0.2")
        self.guest.sleep(1)
        self.assertEqual(self.status()[1]["state"], "inactive")
        self.assertLess(max(self.arm.forces(1)), simdev.NOTHING_NEWTON)

    def test_4_asked_for_it_is_active_and_its_walls_are_felt(self):
        self.arm.say("move 0 0 0 0.2")
        self.guest.run("thimble activate right")
        simdev.wait_for_state(self.guest, "active")
        self.arm.say("move 0.018 0 0 0.2")
        self.guest.sleep(0.8)
        self.assertLess(self.arm.felt(0.1)[0], -one_arm.WALL_NEWTON)

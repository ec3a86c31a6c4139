"""A daemon that is killed, stopped or hangs while a hand presses on a wall: the arm's guard lets it go, and nothing comes back unasked.

What lets go before the arm's own watchdog does, if it has one, is the guard. The guest's clock counts instructions, so that the time between the blow and the last force may be asserted. The blow is
told by CLOCK_MONOTONIC, the force by the machine's time, CLOCK_BOOTTIME (decision 0410): both agree in a guest that has never slept.
"""

import json

import guest
import simdev

LET_GO_S = 0.05


class LetsGo:
    """Whatever happens to the daemon. `plug_in()`: makes the arm; `STARTED_ANEW`: the state that the next daemon finds it in."""

    pace = guest.COUNTED
    STARTED_ANEW = "calibrating"
    FREE, IN_A_WALL = "move 0 0 0 0.1", "move 0.018 0 0 0.15"
    # Of systemd's seconds, those that surely pass: RestartSec, and WatchdogSec before it.
    RESTART_S = 1.2
    WATCHDOG_S = 3.9
    is_first = True

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = cls.plug_in()

    def start_anew(self):
        self.guest.run("systemctl reset-failed thimbled; systemctl restart thimbled")

    def bring_home(self):
        """For a daemon that has begun anew."""
        self.arm.calibrate()

    def setUp(self):
        if not self.is_first:  # the daemon of that one has just begun
            self.start_anew()
        type(self).is_first = False
        self.arm.activate()
        self.arm.say(self.FREE)
        self.guest.sleep(0.15)
        self.arm.say(self.IN_A_WALL)
        self.guest.sleep(0.3)
        self.guest.run("systemctl list-units --no-legend 'thimble-guard@*' | grep -q running")

    def let_go_after(self, blow):
        """The blow, a step which prints when it fell, and when the motors' last force was: the time between."""
        (fell_s, *_), (log,) = simdev.words_and_logs(self.guest.steps(blow, ("sleep", 0.3), self.arm.step("log 2.5")))
        fell_s = float(fell_s)
        samples = [(entry["machine_s"], simdev.norm(entry["force_newton"])) for entry in log if "tip_m" in entry]
        before = [force for at_s, force in samples if fell_s - 0.05 < at_s < fell_s]
        self.assertTrue(before and min(before) > 0.3, before)
        self.assertGreater(samples[-1][0], fell_s + 0.2)
        return max(at_s for at_s, force in samples if force > simdev.NOTHING_NEWTON) - fell_s

    def assert_without_force(self, seconds=1):
        self.assertLess(max(self.arm.forces(seconds)), simdev.NOTHING_NEWTON)

    def assert_started_anew_without_force(self, after_s):
        # In the guest, and seldom: each look is half as dear as the time that passes between.
        self.guest.run(f"sleep {after_s}; until systemctl show thimbled -p NRestarts | grep -qx NRestarts=1 && systemctl is-active thimbled; do sleep 0.3; done", 240)
        arm = json.loads(simdev.wait_for_state(self.guest, self.STARTED_ANEW))
        self.assertEqual(arm["lease"], "none")
        self.guest.sleep(0.5)
        self.assert_without_force()
        return arm

    def test_killed(self):
        self.assertLess(self.let_go_after(("signal", "SIGKILL")), LET_GO_S)
        if self.assert_started_anew_without_force(self.RESTART_S)["state"] == "calibrating":
            self.bring_home()
        # Nor does anything with a person who brings the arm home, and into the wall.
        arm = json.loads(simdev.wait_for_state(self.guest, "inactive"))
        self.assertEqual(arm["lease"], "none")
        self.arm.say(self.IN_A_WALL)
        self.guest.sleep(0.3)
        self.assert_without_force(0.2)

    def test_stopped(self):
        self.assertLess(self.let_go_after(("signal", "SIGSTOP")), LET_GO_S)
        self.assert_started_anew_without_force(self.WATCHDOG_S)

    def test_a_servo_that_hangs(self):
        self.assertLess(self.let_go_after(("hang", "servo-right", 0.5)), LET_GO_S)
        arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
        self.assertIn("servo-late", [fault["code"] for fault in arm["faults"]])
        self.guest.sleep(0.5)
        self.assert_without_force(0.5)

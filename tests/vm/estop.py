"""An arm on uhid whose safety lines are those of a CP2112, under the kernel's own hid-cp2112 and the real libgpiod: it presses on a wall, and what it feels, its own log says."""

import json
import sys

import arms
import lines
import simdev

# Between two readings of the lines (kGpioReadPeriod of hal/bus), and what the transfers take: what docs/safety-wiring.md says that a CP2112 costs until the daemon knows; in which time it acts then, and
# the period in which zero leaves.
READ_S = 0.02
TRANSFERS_S = 0.005
ACT_S = 0.002
PRESSED_S = READ_S + TRANSFERS_S + ACT_S + 1 / arms.QUIET_HZ
# Since the kernel was told of it, which an answer to the question after another line does, too (gpio_transfers.cpp asks for the stop's last): the arm's own log has a frame more, and so has the
# adapter's clock.
TOLD_S = ACT_S + 1 / arms.QUIET_HZ + 0.002
# In two seconds, of 4: the first and the last may fall outside.
BLINKS = 2
LOG = "log 2"  # holds what the arm felt before its lines opened, 0.5 s ago


class Arm(arms.HidArm):
    daemon_words = lines.SAFETY


class Estop(lines.GuestWithLines):
    """Numbered: each test goes on where the one before it ended."""

    arm_kind = Arm

    def wait_for(self, state):
        return self.wait_until("safety.state", state)

    def press(self):
        """For as long as a person does: until both channels were read open together (decision 0355), not only the first of them."""
        self.adapter.say("press 0", "press 1")
        self.guest.sleep(0.3)

    def release(self):
        """A reading that falls between the two is followed by the next one soon enough."""
        self.adapter.say("release 0", "release 1")
        self.guest.sleep(0.3)

    def clear(self):
        return self.guest.ask("thimble clear-fault right")

    def lamp(self):
        """How it looks to a person who has two seconds."""
        before = self.adapter.status()["readings"]
        self.guest.sleep(2)
        after = self.adapter.status()["readings"]
        changes = after["changes_4"] - before["changes_4"]
        if changes == 0:
            return "lit" if after["line_4"] else "dark"
        return "blinks" if changes >= BLINKS else f"{changes} change(s)"

    def start_again(self, was_killed=False, adapter=None):
        """`was_killed`: the daemon, after which a person has to ask for the arm. `adapter`: in place of the usual one."""
        self.wait_for("waiting")
        self.take_hold(adapter)
        self.wait_until("safety.is_deadman_held", "true")
        self.assertEqual(self.clear()[0], 0)
        self.wait_until_enable_beats()
        states = ("calibrating", "inactive") if was_killed else ("calibrating", "active")
        if json.loads(simdev.wait_for_state(self.guest, *states))["calibration"] == "needs-user":
            self.arm.calibrate()
        if was_killed:
            simdev.wait_for_state(self.guest, "inactive")
            self.guest.run("thimble activate right")
        simdev.wait_for_state(self.guest, "active")

    def lean(self):
        """On a wall: it is felt."""
        self.arm.say("move 0 0 0 0.1", "move 0.018 0 0 0.3")
        self.guest.sleep(0.8)
        self.assertLess(self.arm.felt(0.1)[0], -0.3)

    def assert_no_force(self):
        self.guest.sleep(0.3)  # until what was before is out of the log that is read
        self.assertLess(max(self.arm.forces(0.2)), simdev.NOTHING_NEWTON)

    def felt_after(self, adapter, *verbs):
        """The arm pressed until the adapter was told so: for how long there was a force afterwards."""
        fell_s, last_s = self.ended_after(adapter, *verbs)
        return last_s - fell_s

    def ended_after(self, adapter, *verbs):
        """When that was, and the last force, both on the machine's clock."""
        (before, *_), (log,) = simdev.words_and_logs(self.guest.steps(adapter.step("status", *verbs), ("sleep", 0.5), self.arm.step(LOG)))
        fell_s = json.loads(before)["machine_s"]
        return fell_s, self.last_force_since(fell_s, log)

    def last_force_since(self, fell_s, log):
        """When it was felt. Until then the arm was pressed."""
        samples = [(entry["machine_s"], simdev.norm(entry["force_newton"])) for entry in log if "tip_m" in entry]
        self.assertGreater(min(force for at_s, force in samples if fell_s - 0.05 < at_s < fell_s), 0.3)
        self.assertGreater(samples[-1][0], fell_s + 0.3)
        return max(at_s for at_s, force in samples if force > simdev.NOTHING_NEWTON)

    def assert_ends_in_time(self, what, verbs, fade_s=0, unheard_s=0):
        """The force, which fades for so long, since the adapter was told so, and since it told the kernel of that, of which the daemon may not hear for so long."""
        fell_s, last_s = self.ended_after(self.adapter, *verbs)
        said = self.adapter.status()
        told_s = said["readings"]["told_s"] - said["t_s"] + said["machine_s"]
        print(f"{what}: the kernel was told after {told_s - fell_s:.4f} s, the last force was felt {last_s - told_s:.4f} s later", file=sys.stderr)
        self.assertLess(last_s - fell_s, PRESSED_S + fade_s)
        self.assertLess(last_s - told_s, TOLD_S + fade_s + unheard_s)

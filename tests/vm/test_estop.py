"""Emergency stop, deadman and heartbeat on the lines of a CP2112: the kernel's own hid-cp2112 on the simulated adapter, the real
libgpiod, the packaged daemon. The arm hangs on uhid and presses on a wall; what it feels, its own log says.
"""

import json
import sys

import arms
import lines
import nodes
import simdev

# What docs/safety-wiring.md says that a CP2112 costs until the daemon knows, in which time it acts then, and the period in which zero leaves.
POLL_S = 0.05
ACT_S = 0.002
PRESSED_S = POLL_S + ACT_S + 1 / arms.QUIET_HZ
# Since the kernel was told of it: the arm's own log has a frame more, and so has the adapter's clock.
TOLD_S = ACT_S + 1 / arms.QUIET_HZ + 0.002
# That page's 200 ms since its last answer, the 20 ms between two looks at it, and the tick.
SILENT_S = 0.23
# In two seconds, of 4: the first and the last may fall outside.
BLINKS = 2


class Arm(arms.HidArm):
    daemon_words = lines.SAFETY


class Estop(lines.GuestWithLines):
    arm_kind = Arm

    def wait_for(self, state):
        return self.wait_until("safety.state", state)

    def press(self):
        self.adapter.say("press 0", "press 1")

    def release(self):
        """Again, as the daemon asks for, where a look of the kernel's fell between the two: the next is more than 50 ms later, and they disagree."""
        for _ in range(5):
            self.adapter.say("release 0", "release 1")
            self.guest.sleep(0.3)
            if self.status()["safety"]["trouble"] != "disagree":
                return
            self.press()
            self.wait_until("safety.trouble", "open")

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

    def start_again(self, was_killed=False):
        """`was_killed`: the daemon, after which a person has to ask for the arm."""
        self.wait_for("waiting")
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
        before, *_ = self.guest.steps(adapter.step("status", *verbs), ("sleep", 0.5))
        fell_s = json.loads(before)["machine_s"]
        samples = [(entry["machine_s"], simdev.norm(entry["force_newton"])) for entry in self.arm.samples(2)]
        self.assertGreater(min(force for at_s, force in samples if fell_s - 0.05 < at_s < fell_s), 0.3)
        self.assertGreater(samples[-1][0], fell_s + 0.3)
        return fell_s, max(at_s for at_s, force in samples if force > simdev.NOTHING_NEWTON)

    def test_1_the_nodes_of_chip_and_adapter_are_the_daemons(self):
        found = nodes.under(self.guest, "$(readlink -f /sys/bus/hid/devices/*:10C4:EA90.*)")
        self.assertEqual([node.rstrip("0123456789") for node in found], ["/dev/gpiochip", "/dev/hidraw"])
        for node in found:
            nodes.assert_closed(self, self.guest, node)

    def test_2_nothing_moves_and_nothing_beats_before_somebody_clears(self):
        self.wait_for("waiting")
        self.assertEqual(self.beats(), 0)
        self.assertEqual(self.lamp(), "blinks")
        self.assertEqual(self.status()["arms"][0]["faults"][0]["code"], "estop")
        self.start_again()
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        self.assertEqual(self.lamp(), "lit")
        self.lean()

    def test_3_pressed_is_zero_in_time_and_latched_and_the_heartbeat_stops(self):
        fell_s, last_s = self.ended_after(self.adapter, "press 0", "press 1")
        said = self.adapter.status()
        told_s = said["readings"]["told_s"] - said["t_s"] + said["machine_s"]
        print(f"e-stop: the kernel was told after {told_s - fell_s:.4f} s, the last force was felt {last_s - told_s:.4f} s later", file=sys.stderr)
        self.assertLess(last_s - fell_s, PRESSED_S)
        self.assertLess(last_s - told_s, TOLD_S)
        self.assertEqual(self.wait_for("stopped")["trouble"], "open")
        simdev.wait_for_state(self.guest, "fault")
        self.assert_no_force()
        self.assertEqual(self.beats(), 0)
        self.assertEqual(self.lamp(), "dark")
        code, printed = self.clear()
        self.assertNotEqual(code, 0)
        self.assertIn("emergency stop is pressed", printed)

    def test_4_released_it_does_not_resume_and_cleared_it_does(self):
        self.release()
        self.wait_for("waiting")
        self.assertEqual(self.beats(), 0)
        self.assertEqual(self.lamp(), "blinks")
        self.assertEqual(self.status()["arms"][0]["state"], "fault")
        self.assert_no_force()
        self.start_again()
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        self.lean()

    def test_5_one_channel_alone_is_a_defect_until_both_were_open(self):
        self.adapter.say("press 0")
        self.wait_for("stopped")
        self.guest.sleep(0.5)
        self.adapter.say("release 0")
        self.wait_until("safety.trouble", "disagree")
        self.assertNotEqual(self.clear()[0], 0)
        self.press()
        self.wait_until("safety.trouble", "open")
        self.release()
        self.start_again()

    def test_6_without_the_deadman_there_is_no_force_and_no_fault(self):
        self.lean()
        self.adapter.say("press 2")
        self.wait_until("safety.is_deadman_held", "false")
        self.guest.sleep(0.3)  # until it has faded
        self.assert_no_force()
        self.assertEqual(self.status()["safety"]["state"], "free")
        self.assertEqual(self.status()["arms"][0]["state"], "active")
        self.adapter.say("release 2")
        self.wait_until("safety.is_deadman_held", "true")
        self.lean()

    def test_7_a_lost_adapter_is_a_stop_and_its_return_does_not_resume(self):
        self.adapter.say("unplug")
        self.wait_until("safety.trouble", "no-lines")
        self.assert_no_force()
        self.adapter.say("plug")
        self.start_again()

    def assert_silence_is_a_stop(self, adapter, verb):
        """One that does not answer, until a person looks at its cable: `adapter` is told so by the verb."""
        self.arm.say("move 0 0 0 0.1")  # out of the wall, where one that became active in it is not pushed
        self.guest.sleep(0.2)
        self.lean()
        self.assertLess(self.felt_after(adapter, f"{verb} 600"), SILENT_S)
        self.assertEqual(self.wait_until("safety.trouble", "silent")["state"], "stopped")
        changes = adapter.status()["readings"]["changes_3"]
        code, printed = self.clear()
        self.assertNotEqual(code, 0)
        self.assertIn("does not answer", printed)
        adapter.say(f"{verb} 0")
        self.wait_for("waiting")
        self.assertEqual(self.status()["arms"][0]["state"], "fault")
        self.assert_no_force()
        # A beat that was under way, and the line put to rest after it, if that was not refused: a level that stays is off, too.
        self.assertLessEqual(adapter.status()["readings"]["changes_3"], changes + 2)
        self.assertEqual(self.beats(adapter), 0)

    def test_7b_an_adapter_that_refuses_to_answer_is_a_stop_and_its_next_answer_does_not_resume(self):
        self.assert_silence_is_a_stop(self.adapter, "stall")
        self.start_again()

    def test_7c_so_is_one_that_never_answers_the_kernel(self):
        """On USB, where who asks it waits; through uhid it could refuse only."""
        self.adapter.say("unplug")
        self.wait_until("safety.trouble", "no-lines")
        adapter = simdev.Simdev(self.guest, "cp2112-usb", "--vhci", "cp2112")
        adapter.attach()
        self.start_again()
        self.assert_silence_is_a_stop(adapter, "nak")
        self.start_again()
        adapter.stop()
        self.wait_until("safety.trouble", "no-lines")
        self.adapter.say("plug")
        self.start_again()

    def test_7d_one_that_answers_nonsense_can_stop_the_arm_and_the_stop_works_meanwhile_and_after_it(self):
        pid = self.properties("MainPID")
        for verb, trouble in (("corrupt", "corrupted"), ("short", "shortened"), ("babble", "babbled")):
            with self.subTest(verb):
                self.arm.say("move 0 0 0 0.1")
                self.guest.sleep(0.2)
                self.lean()
                felt_newton = max(self.arm.forces(0.3))
                done = self.adapter.status()["trouble"][trouble]
                self.adapter.say(f"{verb} 100000")
                self.guest.sleep(0.5)
                self.assertGreater(self.adapter.status()["trouble"][trouble], done + 5)
                self.assertLess(max(self.arm.forces(0.5)), 1.05 * felt_newton)
                self.press()
                # A look of the kernel's may be told that it is not pressed; not one after the other.
                self.guest.sleep(0.5)
                self.assert_no_force()
                self.adapter.say(f"{verb} 0")
                self.wait_for("stopped")
                self.release()
                self.start_again()
        self.assertEqual(self.properties("MainPID"), pid)

    def test_8_the_heartbeat_stops_with_a_daemon_that_hangs_is_killed_or_stopped(self):
        for signal in ("STOP", "KILL"):
            with self.subTest(signal):
                self.assertGreaterEqual(self.beats(), lines.BEATS)
                self.guest.steps(("signal", f"SIG{signal}"), ("sleep", 0.2))
                self.assertEqual(self.beats(), 0)
                if signal == "STOP":
                    self.guest.steps(("signal", "SIGCONT"))
                self.start_again(was_killed=signal == "KILL")

    def test_8b_it_stops_with_a_servo_that_hangs_and_comes_back_with_it(self):
        """All else in the daemon runs on: nobody but the servo could have let it beat."""
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        # It hangs for less than WatchdogSec, and says when it has begun.
        hangs = f"python3 -B /run/tests/hang_thread.py {arms.SERVO} 2 > /run/hung 2>&1 & until [ -s /run/hung ]; do sleep 0.05; done"
        look = self.adapter.step("status")
        printed = self.guest.steps(("run", hangs), ("sleep", 0.2), look, ("sleep", 0.5), look)
        first, second = (json.loads(line)["readings"]["changes_3"] for line in printed)
        self.assertEqual(second - first, 0)
        arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
        self.assertIn("servo-late", [fault["code"] for fault in arm["faults"]])
        self.assertGreaterEqual(self.beats(), lines.BEATS)

    def test_9_it_stops_with_a_daemon_that_is_stopped(self):
        self.guest.run("systemctl stop thimbled")
        self.assertEqual(self.beats(), 0)
        self.assertEqual(self.adapter.status()["readings"]["line_3"], 0)

    def test_9b_a_stop_of_one_channel_stops_in_the_same_time_and_nobody_misses_the_other(self):
        self.arm.daemon_words = lines.SAFETY.replace('["0", "1"]', '["0"]')
        self.assertNotEqual(self.arm.daemon_words, lines.SAFETY)
        self.arm.configure()
        self.start_again()
        self.adapter.say("press 1")  # nobody's line
        self.lean()
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        self.assertLess(self.felt_after(self.adapter, "press 0"), PRESSED_S)
        self.assertEqual(self.wait_for("stopped")["trouble"], "open")
        self.adapter.say("release 0")
        self.wait_for("waiting")
        self.assert_no_force()
        self.start_again()
        self.lean()

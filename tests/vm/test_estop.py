"""Emergency stop, deadman and heartbeat on the lines of a CP2112: estop.py."""

import json

import arms
import estop
import lines
import nodes
import simdev

# In which the force of a deadman that is let go is gone.
FADE_S = 0.02


class Estop(estop.Estop):
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
        self.assert_ends_in_time("e-stop", ("press 0", "press 1"))
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
        self.assert_ends_in_time("deadman", ("press 2",), FADE_S, estop.READ_S)
        self.wait_until("safety.is_deadman_held", "false")
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

    def test_8_the_heartbeat_stops_with_a_daemon_that_hangs_is_killed_or_stopped(self):
        for signal in ("STOP", "KILL"):
            with self.subTest(signal):
                self.assertGreaterEqual(self.beats(), lines.BEATS)
                # In one go: between two commands an idle guest's clock runs ahead, and systemd ends one that is stopped for long.
                look = self.adapter.step("status")
                goes_on = [("signal", "SIGCONT")] if signal == "STOP" else []
                printed = self.guest.steps(("signal", f"SIG{signal}"), ("sleep", 0.2), look, ("sleep", 1), look, *goes_on)
                first, last = (json.loads(line)["readings"]["changes_3"] for line in printed[1:3])
                self.assertEqual(last - first, 0)
                self.start_again(was_killed=signal == "KILL")

    def test_8b_it_stops_with_a_servo_that_hangs_and_does_not_come_back_by_itself(self):
        """All else in the daemon runs on: nobody but the servo could have let it beat."""
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        # It hangs for less than WatchdogSec, also where the newest ping is old already, and says when it has begun.
        hangs = f"python3 -B /run/tests/hang_thread.py {arms.SERVO} 1.5 > /run/hung 2>&1 & until [ -s /run/hung ]; do sleep 0.05; done"
        look = self.adapter.step("status")
        printed = self.guest.steps(("run", hangs), ("sleep", 0.2), look, ("sleep", 0.5), look)
        first, second = (json.loads(line)["readings"]["changes_3"] for line in printed)
        self.assertEqual(second - first, 0)
        arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
        self.assertIn("servo-late", [fault["code"] for fault in arm["faults"]])
        self.assertEqual(self.beats(), 0, "the relay has fallen: who is behind it gets no power back before somebody clears (decision 0525)")
        self.start_again()
        self.assertGreaterEqual(self.beats(), lines.BEATS)

    def test_9_it_stops_with_a_daemon_that_is_stopped(self):
        self.guest.run("systemctl stop thimbled")
        self.assertEqual(self.beats(), 0)
        self.assertEqual(self.adapter.status()["readings"]["line_3"], 0)

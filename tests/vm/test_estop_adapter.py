"""An adapter of safety lines that does not answer, or answers nonsense, and a stop of one channel: estop.py."""

import arms
import estop
import lines
import simdev

# The 200 ms of docs/safety-wiring.md since its last answer, the 20 ms between two looks at it, and the tick.
SILENT_S = 0.23


class Adapter(estop.Estop):
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

    def test_1_cleared_the_arm_is_driven(self):
        self.start_again()

    def test_2_an_adapter_that_refuses_to_answer_is_a_stop_and_its_next_answer_does_not_resume(self):
        self.assert_silence_is_a_stop(self.adapter, "stall")
        self.start_again()

    def test_3_so_is_one_that_never_answers_the_kernel(self):
        """On USB, where who asks it waits; through uhid it could refuse only."""
        self.adapter.say("unplug")
        self.wait_until("safety.trouble", "no-lines")
        adapter = simdev.Simdev(self.guest, "cp2112-usb", "--vhci", "cp2112")
        adapter.attach()
        self.start_again(adapter=adapter)
        self.assert_silence_is_a_stop(adapter, "nak")
        self.start_again(adapter=adapter)
        adapter.stop()
        self.wait_until("safety.trouble", "no-lines")
        self.adapter.say("plug")
        self.start_again()

    def test_4_one_that_answers_nonsense_can_stop_the_arm_and_the_stop_works_meanwhile_and_after_it(self):
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
                # It is stopped already. Both channels are to be read open once, by a clean reading, before they close.
                self.wait_until("safety.trouble", "open")
                self.guest.sleep(0.3)
                self.release()
                self.start_again()
        self.assertEqual(self.properties("MainPID"), pid)

    def test_5_a_stop_of_one_channel_stops_in_the_same_time_and_nobody_misses_the_other(self):
        self.arm.daemon_words = lines.SAFETY.replace('["0", "1"]', '["0"]')
        self.assertNotEqual(self.arm.daemon_words, lines.SAFETY)
        self.arm.configure()
        self.start_again()
        self.adapter.say("press 1")  # nobody's line
        self.lean()
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        self.assertLess(self.felt_after(self.adapter, "press 0"), estop.PRESSED_S)
        self.assertEqual(self.wait_for("stopped")["trouble"], "open")
        self.adapter.say("release 0")
        self.wait_for("waiting")
        self.assert_no_force()
        self.start_again()
        self.lean()

"""A Falcon in a lab with the circuit of docs/safety-wiring.md, its cable pulled while it pushes: no program reaches it any more and it has no watchdog, so the heartbeat stops, and with it the relay's
power (decision 0494). The relay is the test: it takes the arm's supply once the line rests.
"""

import json

import arms
import lines
import one_arm
import simdev

# Until a line that has no beat any more rests: the kernel tells the daemon of a pulled cable at once; 0.2 s are what the page's relay holds at the most.
LAST_BEATS = 10


class Falcon(arms.Falcon):
    daemon_words = lines.SAFETY


class OutOfReach(lines.GuestWithLines):
    arm_kind = Falcon

    def test_1_it_beats_while_the_arm_presses(self):
        self.wait_until("safety.state", "waiting")
        self.take_hold()
        self.guest.run("thimble clear-fault right")
        self.wait_until_enable_beats()
        self.arm.activate()
        one_arm.press_from_the_middle(self, self.arm, one_arm.WALL_NEWTON)
        self.assertGreaterEqual(self.beats(), lines.BEATS)

    def test_2_its_cable_pulled_it_pushes_on_and_the_heartbeat_stops(self):
        pressed_newton = simdev.norm(self.arm.felt(0.1))
        pulled = self.arm.step("pull-cable"), ("sleep", 0.3), ("run", "thimble status --json > /run/pulled.json")
        self.assertLess(self.beats(during=pulled), LAST_BEATS)
        self.assertEqual(self.beats(), 0)
        status = json.loads(self.guest.run("cat /run/pulled.json"))
        self.assertEqual((status["safety"]["state"], status["safety"]["trouble"]), ("stopped", "arm-out-of-reach"))
        self.assertIn("'right'", status["safety"]["message"])
        self.assertEqual((status["arms"][0]["state"], status["arms"][0]["faults"][0]["code"]), ("lost", "disconnected"))
        self.assertEqual(self.status()["safety"]["state"], "waiting")
        self.assertAlmostEqual(simdev.norm(self.arm.felt(0.1)), pressed_newton, delta=0.1 * pressed_newton)

    def test_3_the_relay_has_fallen_it_is_without_force_and_nothing_comes_back_by_itself(self):
        self.arm.say("unplug")
        self.guest.sleep(1)
        self.assertLess(max(self.arm.forces(0.5)), simdev.NOTHING_NEWTON)
        self.assertEqual(self.beats(), 0)

    def test_4_cleared_and_plugged_in_it_presses_again(self):
        self.take_hold()
        refused, said = self.guest.ask("thimble clear-fault right")
        self.assertNotEqual(refused, 0, "it is lost still")
        self.wait_until_enable_beats()
        self.assertGreaterEqual(self.beats(), lines.BEATS, said)
        self.arm.say("plug")
        self.arm.plug()
        self.arm.resume()
        one_arm.press_from_the_middle(self, self.arm, one_arm.WALL_NEWTON)

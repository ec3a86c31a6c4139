"""A Falcon on the kernel's own USB stack that does what the sheet says they do: echoes get lost, boot-loaders are deaf at first, replies are short or glued, the bridge's latency timer stands at 16 ms; and packets of which it takes half."""

import json

import arms
import guest
import one_arm
import simdev

FIRMWARE_BYTES = len(arms.firmware())
RUN_REQUEST = "3c"  # how one begins, in the log: "<"
LONGEST_HOLE_S = 0.03


class FalconInTrouble(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.Falcon(cls.guest, is_named=False)

    def press(self):
        one_arm.press_from_the_middle(self, self.arm, one_arm.WALL_NEWTON)

    def pressed(self):
        """Anew: with which force, and since when on the arm's clock."""
        self.press()
        pressed_newton = simdev.norm(self.arm.felt(0.1))
        self.assertGreater(pressed_newton, 4 * one_arm.WALL_NEWTON)
        return pressed_newton, self.arm.status()["t_s"]

    def test_1_a_lost_echo_is_found_and_the_firmware_sent_again(self):
        self.arm.say(f"fault lost-echo {FIRMWARE_BYTES // 2}", "fault deaf 3")
        self.arm.configure()
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertEqual(self.arm.status()["readings"]["uploads"], 2)
        self.arm.activate()
        self.press()

    def assert_lets_go_for_moments_only(self, pressed_newton, since_s):
        """Each time something is lost the newest sample is stale, 6 ms old, and the force fades until there is a new one. It is never more than
        before, and mostly less: what was let go is met again where the finger is by then."""
        log = self.arm.samples(3)
        self.assertLess(log[0]["t_s"], since_s)
        samples = [sample for sample in log if sample["t_s"] > since_s]
        forces = [simdev.norm(sample["force_newton"]) for sample in samples]
        self.assertLess(max(forces), 1.02 * pressed_newton)
        felt_s = [sample["t_s"] for sample, force in zip(samples, forces) if force > one_arm.WALL_NEWTON]
        holes = [gap_s for gap_s, _ in simdev.gaps([samples[0]["t_s"], *felt_s, samples[-1]["t_s"]])]
        self.assertLess(max(holes), LONGEST_HOLE_S)
        self.assertLess(min(forces), one_arm.WALL_NEWTON, "it lost something")
        status = json.loads(self.guest.run("thimble status --json"))
        self.assertEqual((status["arms"][0]["state"], status["arms"][0]["faults"]), ("active", []))

    def malformed_reports(self):
        return json.loads(self.guest.run("thimble status --json"))["servos"][0]["malformed_reports"]

    def test_2_short_and_glued_replies_do_not_end_the_wall(self):
        pressed_newton, since_s = self.pressed()
        malformed = self.malformed_reports()
        self.arm.say("fault short-replies 20", "fault glued-replies 33")
        self.guest.sleep(0.5)
        self.arm.say("fault short-replies 0", "fault glued-replies 0")
        self.guest.sleep(0.1)
        self.assert_lets_go_for_moments_only(pressed_newton, since_s)
        self.assertGreater(self.malformed_reports(), malformed)

    def test_3_packets_of_which_it_takes_half_do_not_end_the_wall(self):
        pressed_newton, since_s = self.pressed()
        cut = self.arm.status()["trouble"]["cut"]
        self.arm.say("short-out 3")
        self.guest.sleep(0.3)
        self.assertEqual(self.arm.status()["trouble"]["cut"], cut + 3)
        self.assert_lets_go_for_moments_only(pressed_newton, since_s)

    def test_4_a_latency_timer_of_16_ms_is_a_fault_as_often_as_it_is_cleared_until_it_is_mended(self):
        self.arm.say("fault latency 16")
        numbers = []
        for _ in range(2):
            arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
            self.assertEqual([fault["code"] for fault in arm["faults"]], ["missed-exchanges"])
            numbers.append(arm["faults"][0]["number"])
            self.guest.sleep(0.2)
            self.assertLess(max(self.arm.forces(0.1)), simdev.NOTHING_NEWTON)
            self.guest.run("thimble clear-fault right")
        numbers.append(json.loads(simdev.wait_for_state(self.guest, "fault"))["faults"][0]["number"])
        self.assertEqual(sorted(set(numbers)), numbers, "each clear had a new one to clear")
        self.arm.say("fault latency 0")
        self.guest.sleep(0.2)
        self.arm.clear()
        self.press()

    def test_5_a_boot_loader_that_stays_deaf_is_told_and_works_as_soon_as_it_hears(self):
        self.arm.say("fault deaf 1000000", "unplug", "plug")
        self.arm.plug()
        self.guest.wait_for("thimble status | grep -q 'boot-loader does not answer'")
        log = self.arm.log(0.5)
        said = [entry["out"] for entry in log if "out" in entry]
        self.assertGreater(len(said), 0, "it is asked again and again")
        self.assertEqual([out for out in said if out.startswith(RUN_REQUEST)], [])
        self.assertLess(max(simdev.norm(entry["force_newton"]) for entry in log if "force_newton" in entry), simdev.NOTHING_NEWTON)
        self.arm.say("fault deaf 0")
        self.arm.resume()
        self.press()

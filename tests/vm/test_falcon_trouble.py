"""A Falcon on the kernel's own USB stack that does what the sheet says they do: echoes get lost, boot-loaders are deaf at first, replies are short or glued, the bridge's latency timer stands at 16 ms; and packets of which it takes half."""

import json
import statistics

import arms
import guest
import one_arm
import simdev

FIRMWARE_BYTES = len(arms.firmware())


class FalconInTrouble(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.Falcon(cls.guest, is_named=False)

    def press(self):
        one_arm.press_from_the_middle(self, self.arm, one_arm.WALL_NEWTON)

    def test_1_a_lost_echo_is_found_and_the_firmware_sent_again(self):
        self.arm.say(f"fault lost-echo {FIRMWARE_BYTES // 2}", "fault deaf 3")
        self.arm.configure()
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertEqual(self.arm.status()["readings"]["uploads"], 2)
        self.arm.activate()
        self.press()

    def assert_lets_go_for_moments_only(self):
        """Each time something is lost the newest sample is stale, 6 ms old, and the force fades until there is a new one."""
        forces = self.arm.forces(0.4)
        self.assertGreater(statistics.median(forces), one_arm.WALL_NEWTON)
        self.assertGreater(forces[-1], one_arm.WALL_NEWTON)
        status = json.loads(self.guest.run("thimble status --json"))
        self.assertEqual((status["arms"][0]["state"], status["arms"][0]["faults"]), ("active", []))
        return status["servos"][0]

    def test_2_short_and_glued_replies_do_not_end_the_wall(self):
        self.arm.say("fault short-replies 20", "fault glued-replies 33")
        self.guest.run("sleep 0.5")
        self.arm.say("fault short-replies 0", "fault glued-replies 0")
        self.guest.run("sleep 0.1")
        self.assertGreater(self.assert_lets_go_for_moments_only()["malformed_reports"], 0)

    def test_3_packets_of_which_it_takes_half_do_not_end_the_wall(self):
        cut = self.arm.status()["trouble"]["cut"]
        self.arm.say("short-out 3")
        self.guest.run("sleep 0.3")
        self.assertEqual(self.arm.status()["trouble"]["cut"], cut + 3)
        self.assert_lets_go_for_moments_only()

    def test_4_a_latency_timer_of_16_ms_is_a_fault_as_often_as_it_is_cleared_until_it_is_mended(self):
        self.arm.say("fault latency 16")
        for _ in range(2):
            arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
            self.assertEqual([fault["code"] for fault in arm["faults"]], ["missed-exchanges"])
            self.guest.run("sleep 0.2")
            self.assertLess(max(self.arm.forces(0.1)), simdev.NOTHING_NEWTON)
            self.guest.run("thimble clear-fault right")
        simdev.wait_for_state(self.guest, "fault")
        self.arm.say("fault latency 0")
        self.guest.run("sleep 0.2")
        self.arm.clear()
        self.press()

    def test_5_a_boot_loader_that_stays_deaf_is_told_and_works_as_soon_as_it_hears(self):
        self.arm.say("fault deaf 1000000", "unplug", "plug")
        self.arm.plug()
        self.guest.wait_for("thimble status | grep -q 'boot-loader does not answer'")
        self.assertLess(max(self.arm.forces(0.5)), simdev.NOTHING_NEWTON)
        self.arm.say("fault deaf 0")
        self.arm.resume()
        self.press()

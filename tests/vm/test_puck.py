"""A puck on the kernel's HID stack, whose reports are numbered, of both layouts: claimed through hidraw, it moves a point, walls hold the point back, and nothing
is sent to it.
"""

import json

import arms
import guest
import simdev


class Puck(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED
    model = "spacemouse"
    reports = {(1, 13)}  # number, and length with it: all six axes

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.puck = arms.Puck(cls.guest, cls.model)

    def arm(self):
        return json.loads(self.guest.run("thimble status --json"))["arms"][0]

    def test_1_it_is_the_daemons_and_becomes_active_by_itself(self):
        simdev.wait_for_state(self.guest, "active")
        self.guest.run(f"ls -l /proc/$(systemctl show thimbled -p MainPID --value)/fd | grep -q {self.puck.node}")

    def test_2_pushed_it_moves_the_point_until_a_wall_holds_it_back(self):
        self.assertFalse(self.arm()["is_in_contact"])
        self.puck.say("push 20 0 0")
        self.guest.sleep(1.5)
        arm = self.arm()
        self.assertTrue(arm["is_in_contact"])
        self.assertGreater(arm["position_m"][0], 0.01)
        said = [bytes.fromhex(entry["in"]) for entry in self.puck.log(0.5) if "in" in entry]
        self.assertEqual({(report[0], len(report)) for report in said}, self.reports)

    def test_3_let_go_the_point_rests_and_silence_is_no_fault(self):
        self.puck.say("push 0 0 0")
        self.guest.sleep(0.5)
        before = self.arm()
        self.guest.sleep(2)
        self.assertEqual(self.arm()["position_m"], before["position_m"])
        self.assertEqual((before["state"], before["faults"]), ("active", []))

    def test_4_nothing_was_ever_sent_to_it(self):
        counters = self.puck.status()["counters"]
        self.assertGreater(counters["to_host"], 10)
        self.assertEqual(counters["from_host"], 0)


class SeparateLayout(Puck):
    model = "spacenavigator"
    reports = {(1, 7), (2, 7)}  # translation, rotation

"""Two HID arms that press on a wall, while other devices hang and strangers wait for hidraw's one lock: what leaves for an arm goes over its hiddev.

One that hangs takes no other one down, be it ours or a stranger's, and a guard can let its arm go meanwhile. Before, an arm beside one that hung heard
nothing until the kernel gave that one's write up (decisions 0358 and 0488).
"""

import json

import misbehaviour
import simdev
import two_arms

HUNG = "VM-HUNG"
HELD_S = 2  # the kernel gives a write to hidraw up after 5
LOOK_S = 1.5
LET_GO_S = 0.05
RIGHT, LEFT = 0, 1


class HeldHidraw(two_arms.TwoArms):
    """Numbered: each test goes on where the one before it ended."""

    way = "usb"

    @classmethod
    def plug_in_others(cls):
        cls.guest.run(misbehaviour.GIVES_WAY)
        cls.hung = simdev.Simdev(cls.guest, "hung", "--vhci", "--serial", HUNG, "phantom-vintage")
        cls.hung.attach()
        cls.guest.wait_for(f"thimble devices | grep -q {HUNG}")

    def node_of(self, serial):
        return self.guest.run(f"for node in /sys/class/hidraw/*; do grep -lqx HID_UNIQ={serial} $node/device/uevent && basename $node; done; true").strip()

    def status(self, arm):
        status = json.loads(self.guest.run("thimble status --json"))
        return {**{key: status["arms"][arm][key] for key in ("state", "is_in_contact", "contacts", "faults")},
                **{key: status["servos"][arm][key] for key in ("missed_exchanges", "malformed_reports")}}

    def while_held(self, serial):
        """Of SERIAL's device, which takes nothing meanwhile: what the left and the right arm felt while a stranger's write to it had the lock."""
        node = self.node_of(serial)
        at_s, *logs = self.log_around(f"(python3 -B /run/tests/hold_hidraw.py /dev/{node} > /run/held 2>&1 &)", LOOK_S)
        held_s, free_s = (float(line) for line in self.guest.wait_for("test $(wc -l < /run/held) = 2 && cat /run/held").split())
        self.assertGreater(free_s - max(held_s, at_s), HELD_S, "hidraw was never held up: nothing was tried")
        return logs

    def assert_undisturbed(self, arm, before):
        self.assertEqual((before["state"], before["is_in_contact"]), ("active", True), before)
        self.assertEqual(self.status(arm), before)

    def test_1_daemon_and_guards_have_the_arms_hiddev_open_and_nobody_else_may(self):
        self.press_both()
        links = self.guest.run("for pid in $(pgrep -x thimbled) $(pgrep -x thimble-guard); do ls -l /proc/$pid/fd | grep -oE '/dev/(usb/hiddev|hidraw)[0-9]+' "
                               "| sort -u | tr '\\n' ' '; echo; done").splitlines()
        self.assertEqual(len(links), 3, links)
        self.assertEqual(links[0].count("hiddev"), 2, links)
        for of_guard in links[1:]:
            self.assertRegex(of_guard, r"^/dev/usb/hiddev\d+ $", "a guard writes to hidraw")
        self.assertNotEqual(links[1], links[2])
        self.assertEqual(set(self.guest.run("stat -c '%U:%G %a' /dev/usb/hiddev*").split("\n")), {"root:thimble 660", ""})

    def test_2_a_strangers_device_that_hangs_and_is_opened_holds_up_neither_arm(self):
        before = [self.status(arm) for arm in (RIGHT, LEFT)]
        self.hung.say("nak 30")
        left, right = self.while_held(HUNG)
        self.assert_pressed_without_a_gap(left)
        self.assert_pressed_without_a_gap(right)
        for arm in (RIGHT, LEFT):
            self.assert_undisturbed(arm, before[arm])

    def test_3_nor_does_an_arm_of_ours_that_hangs_and_that_strangers_open(self):
        before = self.status(RIGHT)
        self.left.say("nak 6")
        _, right = self.while_held(two_arms.BESIDE)
        self.assert_pressed_without_a_gap(right)
        self.assert_undisturbed(RIGHT, before)
        stopped = json.loads(simdev.wait_for_state(self.guest, "fault", arm=LEFT))
        self.assertEqual(stopped["force_newton"], [0, 0, 0])

    def test_4_it_works_again_when_a_person_has_seen_to_it(self):
        before = self.status(RIGHT)
        self.guest.run("sleep 6")
        self.assertLess(max(self.left.forces(1)), simdev.NOTHING_NEWTON, "what waited in the kernel came late")
        self.guest.run("thimble clear-fault left")
        # It fell silent, and may have been turned off meanwhile.
        simdev.wait_for_state(self.guest, "calibrating", arm=LEFT)
        self.left.calibrate()
        simdev.wait_for_state(self.guest, "active", arm=LEFT)
        self.press(self.left)
        self.assert_undisturbed(RIGHT, before)

    def test_5_a_guard_lets_its_arm_go_while_hidraw_is_held_up(self):
        self.hung.say("nak 30")
        node = self.node_of(HUNG)
        stop = f"python3 -B /run/tests/hold_hidraw.py /dev/{node} > /run/held 2>&1 & sleep 0.5; kill -STOP $(pgrep -x thimbled)"
        at_s, *logs = self.log_around(f"({stop}) > /dev/null", LOOK_S)
        held_s, free_s = (float(line) for line in self.guest.wait_for("test $(wc -l < /run/held) = 2 && cat /run/held").split())
        self.assertGreater(free_s, at_s + LOOK_S + 0.5, "hidraw was free too soon: nothing was tried")
        self.assertLess(held_s, at_s + 0.4)
        for log in logs:
            forces = two_arms.forces(log)
            self.assertGreater(min(force for at, force in forces if at < at_s + 0.4), two_arms.WALL_NEWTON)
            self.assertLess(max(at for at, force in forces if force > simdev.NOTHING_NEWTON), at_s + 0.6 + LET_GO_S)

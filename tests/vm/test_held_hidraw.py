"""Two HID arms that press on a wall, while other devices hang and strangers wait for hidraw's one lock: what leaves for an arm goes over its hiddev.

One that hangs takes no other one down, be it ours or a stranger's, and a guard can let its arm go meanwhile. Before, an arm beside one that hung heard
nothing until the kernel gave that one's write up (decisions 0358 and 0488).
"""

import json

import arms
import guest
import simdev
import two_arms

HUNG = "VM-HUNG"
HELD_S = 2  # the kernel gives a write to hidraw up after 5
LOOK_S = 1.5
LET_GO_S = 0.05
RIGHT, LEFT = 0, 1
HANGS_S = 3
# Samples of a millisecond: what was on its way when an arm began to hang, and a frame beside.
MOST_LATE = 3


class HeldHidraw(two_arms.TwoArms):
    """Numbered: each test goes on where the one before it ended."""

    way = "usb"
    gap_s = {"in": 0.003, "out": 0.003}

    @classmethod
    def plug_in_others(cls):
        cls.hung = simdev.Simdev(cls.guest, "hung", "--vhci", "--serial", HUNG, "phantom-vintage")
        cls.hung.attach()
        cls.guest.wait_for(f"thimble devices | grep -q {HUNG}")

    def node_of(self, serial):
        return self.guest.run(f"for node in /sys/class/hidraw/*; do grep -lqx HID_UNIQ={serial} $node/device/uevent && basename $node; done; true").strip()

    def hold(self, serial):
        """A step: a stranger's write to that device, which takes nothing, has hidraw's lock from then on."""
        return "run", f"(python3 -B /run/tests/hold_hidraw.py /dev/{self.node_of(serial)} > /run/held 2>&1 &)"

    def was_held(self):
        """From when until when."""
        return (float(line) for line in self.guest.wait_for("test $(wc -l < /run/held) = 2 && cat /run/held").split())

    def status(self, arm):
        status = json.loads(self.guest.run("thimble status --json"))
        return {**{key: status["arms"][arm][key] for key in ("state", "is_in_contact", "contacts", "faults")},
                **{key: status["servos"][arm][key] for key in ("missed_exchanges", "malformed_reports")}}

    def servo(self, arm):
        return json.loads(self.guest.run("thimble status --json"))["servos"][arm]

    def pressed_until(self, log, fell_s):
        """How long after that there was a force, which there was until then."""
        forces = two_arms.forces(log)
        self.assertGreater(min(force for at, force in forces if fell_s - 0.1 < at < fell_s), two_arms.WALL_NEWTON)
        return max(at for at, force in forces if force > simdev.NOTHING_NEWTON) - fell_s

    def while_held(self, serial):
        """Of SERIAL's device, which takes nothing meanwhile: what the left and the right arm felt while a stranger's write to it had the lock."""
        at_s, *logs = self.log_around(self.hold(serial), seconds=LOOK_S)
        held_s, free_s = self.was_held()
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
        before, hangs_before = self.status(RIGHT), self.servo(LEFT)
        self.left.say("nak 6")
        _, right = self.while_held(two_arms.BESIDE)
        self.assert_pressed_without_a_gap(right)
        self.assert_undisturbed(RIGHT, before)
        stopped = json.loads(simdev.wait_for_state(self.guest, "fault", arm=LEFT))
        self.assertEqual(stopped["force_newton"], [0, 0, 0])
        hangs = self.servo(LEFT)
        # Each millisecond anew, until after 20 of them the arm is stopped.
        self.assertGreater(hangs["missed_exchanges"], hangs_before["missed_exchanges"] + 15)
        self.assertEqual(hangs["overruns"], hangs_before["overruns"], "the servo waited for the kernel")

    def test_4_it_works_again_when_a_person_has_seen_to_it(self):
        before = self.status(RIGHT)
        self.guest.sleep(6)
        self.assertLess(max(self.left.forces(1)), simdev.NOTHING_NEWTON, "what waited in the kernel came late")
        self.guest.run("thimble clear-fault left")
        # It fell silent, and may have been turned off meanwhile.
        simdev.wait_for_state(self.guest, "calibrating", arm=LEFT)
        self.left.calibrate()
        simdev.wait_for_state(self.guest, "active", arm=LEFT)
        self.press(self.left)
        self.assert_undisturbed(RIGHT, before)

    def test_5_of_an_arm_that_hangs_when_the_daemon_is_killed_nothing_comes_back(self):
        # The daemon is ended before it could have noticed.
        steps = (self.left.step(f"nak {HANGS_S}"), ("signal", "SIGKILL"), ("sleep", HANGS_S + 1), *(arm.step(f"log {HANGS_S + 3}") for arm in (self.left, self.right)))
        (_, fell_s), (left, right) = simdev.words_and_logs(self.guest.steps(*steps, timeout_s=two_arms.LOGS_S))
        fell_s = float(fell_s)
        self.assertLess(self.pressed_until(right, fell_s), LET_GO_S)
        # Its own watchdog takes the force away; what the kernel has for it comes when it takes something again, and then zeros.
        late = [force for at_s, force in two_arms.forces(left) if at_s > fell_s + HANGS_S - 0.1]
        self.assertGreater(len(late), 500)
        self.assertLessEqual(sum(force > simdev.NOTHING_NEWTON for force in late), MOST_LATE)

    def test_6_a_guard_lets_its_arm_go_while_hidraw_is_held_up(self):
        # After one that was killed a person asks for the arms; after that of systemd, which ends in order, nobody has to.
        self.guest.wait_for("systemctl show thimbled -p NRestarts | grep -qx NRestarts=1 && systemctl is-active thimbled")
        self.guest.run("systemctl reset-failed thimbled; systemctl restart thimbled")
        self.press_both()
        self.hung.say("nak 30")
        steps = (self.hold(HUNG), ("sleep", 0.5), ("signal", "SIGSTOP"), ("sleep", 1), *(arm.step("log 3") for arm in (self.right, self.left)))
        (fell_s,), logs = simdev.words_and_logs(self.guest.steps(*steps, timeout_s=two_arms.LOGS_S))
        fell_s = float(fell_s)
        held_s, free_s = self.was_held()
        self.assertTrue(held_s + 0.1 < fell_s < free_s - 1, "hidraw was free: nothing was tried")
        for log in logs:
            self.assertLess(self.pressed_until(log, fell_s), LET_GO_S)

"""A HID device that hangs keeps hidraw's one lock from every other one: no report leaves for the arm beside it, on which a hand presses.
Its guard lets it go over hiddev.

By the guest's clock, which counts instructions. The arm's own watchdog takes 500 ms: what lets go earlier is the guard.
"""

import json

import arms
import guest
import simdev

HUNG = "VM-HUNG"
# 20 ms in which no report leaves, 20 ms in which the servo does not beat for that, and as much for a busy guest.
LET_GO_S = 0.08
HELD_S = 2  # the kernel gives a write up after 5


class SecondWay(guest.GuestTest):
    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest, "usb", is_named=False)
        cls.hung = simdev.Simdev(cls.guest, "hung", "--vhci", "--serial", HUNG, "phantom-vintage")
        cls.hung.attach()
        cls.guest.wait_for(f"thimble devices | grep -q {HUNG}")
        # Not before: its coming takes the only processor for longer than a servo waits.
        cls.arm.configure()
        cls.node = cls.guest.run("for node in /sys/class/hidraw/*; do grep -lqx HID_UNIQ=" + HUNG +
                                 " $node/device/uevent && basename $node; done; true").strip()

    def servo(self):
        return json.loads(self.guest.run("thimble status --json"))["servos"][0]

    def test_1_the_guard_has_the_arms_hiddev_open_and_nobody_else_may(self):
        self.arm.activate()
        self.guest.run("ls -l /proc/$(pgrep -x thimble-guard)/fd | grep -q /dev/usb/hiddev")
        self.assertEqual(self.guest.run("stat -c '%U:%G %a' /dev/usb/hiddev*").split("\n")[0], "root:thimble 660")

    def test_2_while_hidraw_is_held_up_it_takes_the_force_away(self):
        self.arm.say("move 0 0 0 0.3")
        self.guest.run("sleep 0.5")
        self.arm.say("move 0.018 0 0 0.3")
        self.guest.run("sleep 1")
        before_hold = self.servo()
        self.hung.say("nak 30")
        self.guest.run(f"python3 -B /run/tests/hold_hidraw.py /dev/{self.node} > /run/held 2>&1 & sleep 1")
        entries = self.arm.log(2)
        held_s, free_s = (float(line) for line in self.guest.wait_for("test $(wc -l < /run/held) = 2 && cat /run/held").split())
        self.assertGreater(free_s - held_s, HELD_S, "hidraw was never held up: nothing was tried")
        samples = [(entry["machine_s"], simdev.norm(entry["force_newton"])) for entry in entries if "tip_m" in entry]
        before = [force for at_s, force in samples if held_s - 0.05 < at_s < held_s]
        self.assertTrue(before and min(before) > 0.3, before)
        self.assertGreater(samples[-1][0], held_s + 0.3)
        after = self.servo()
        self.assertGreater(after["ticks"], before_hold["ticks"])
        self.assertEqual(after["overruns"], before_hold["overruns"], "the servo waited for hidraw")
        # Each millisecond anew, until after 20 of them the arm is stopped: an arm that hears nothing says nothing.
        self.assertGreater(after["missed_exchanges"] - before_hold["missed_exchanges"], 15)
        self.assertLess(max(at_s for at_s, force in samples if force > simdev.NOTHING_NEWTON) - held_s, LET_GO_S)

    def test_3_when_hidraw_is_free_nothing_comes_back(self):
        arm = json.loads(simdev.wait_for_state(self.guest, "fault"))
        # Its board answers what it hears, and so falls silent with the commands: which of the two is missed first is the kernel's affair.
        self.assertTrue({"command-timeout", "stale-sample"} & {fault["code"] for fault in arm["faults"]}, arm["faults"])
        self.guest.run("sleep 1")
        self.assertLess(max(self.arm.forces()), simdev.NOTHING_NEWTON)

"""Devices that do what no device may: they stall, say nothing, send bits turned over, too little, too much, or lie about what they are.

A Falcon on usbfs and a HID arm on hidraw, both over USB/IP, each pressing on a wall; and an arm on a serial port beside one on hidraw. Whatever one of them does, its own force stays within its
limit, the other one notices nothing, the daemon goes on, and when a person has seen to it the arm works again.
"""

import json

import arms
import guest
import simdev
import two_arms

LIMIT_NEWTON = 3.0
# A Falcon pressed on the wall feels 0.29 N, and nothing when it lets go.
PRESSED_NEWTON = 0.2
# The driver turns a force into currents for the pose that it was told: where that was a lie, the motors push elsewhere.
SLACK = 1.5
# What the device is told, and what of it it counts.
TROUBLES = {"nak 0.3": "unanswered", "stall 0.3": "refused", "corrupt 50": "corrupted", "short 50": "shortened", "babble 50": "babbled"}
LIMIT = f"limits.force_newton = {LIMIT_NEWTON}\n"
NAMES = ("right", "left")
RIGHT, HID = 0, 1
FALCON_IDS = "0403 cb48"
# As guest/lying_usb.py has them; "none" is last: a Falcon in all that it says, which does nothing.
LIES = "longer shorter no-endpoints more-endpoints long-length large-packets both-in interrupts no-serial strange-serial none"


def arm_beside(one, *way):
    return simdev.Simdev(one, "left", *way, *arms.frames_at_once(one, arms.QUIET_HZ), "--serial", two_arms.BESIDE, "phantom-vintage")


class Misbehaviour:
    """Numbered: each test goes on where the one before it ended. `plug_in()`: makes the right arm, and the HID arm beside it; `seen`: of an
    arm, that nothing of the other one may change."""

    pace = guest.COUNTED
    seen = ("state", "is_in_contact", "contacts", "faults")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arms = right, _ = cls.plug_in()
        cls.guest.wait_for(f"thimble devices | grep -q {two_arms.BESIDE}")
        right.words = f"{right.words}\nworld = \"box\"\n{LIMIT}{two_arms.LEFT}{LIMIT}"
        right.configure()
        cls.pid = cls.properties("MainPID")

    def status(self, arm):
        """Of the arm; why late periods are not counted: two_arms.py."""
        status = json.loads(self.guest.run("thimble status --json"))
        return {**{key: status["arms"][arm][key] for key in self.seen},
                "malformed_reports": status["servos"][arm]["malformed_reports"]}

    def recover(self, arm):
        """As a person does, until it is active and presses on the wall."""
        for _ in range(8):
            state = json.loads(simdev.wait_for_state(self.guest, "fault", "calibrating", "active", arm=arm))["state"]
            if state == "active":
                break
            if state == "fault":
                self.guest.ask(f"thimble clear-fault {NAMES[arm]}")
                self.guest.run("sleep 0.2")
            else:
                self.arms[arm].calibrate()
        self.arms[arm].say("move 0 0 0 0.1", "move 0.018 0 0 0.15")
        self.guest.run("sleep 0.3")
        status = self.status(arm)
        self.assertEqual((status["state"], status["is_in_contact"]), ("active", True), status)
        self.assertGreater(simdev.norm(self.arms[arm].felt(0.1)), PRESSED_NEWTON)

    def assert_bounded(self, arm, verb):
        before = self.status(1 - arm)
        self.assertEqual((before["state"], before["is_in_contact"]), ("active", True))
        device = self.arms[arm]
        done = device.status()["trouble"][TROUBLES[verb]]
        device.say(verb)
        self.guest.run("sleep 0.4")
        felt, beside = ([force for _, force in two_arms.forces(one.log(0.5))] for one in (device, self.arms[1 - arm]))
        self.assertGreater(device.status()["trouble"][TROUBLES[verb]], done)
        self.assertLess(max(felt), SLACK * LIMIT_NEWTON)
        self.assertGreater(min(beside), PRESSED_NEWTON)
        self.recover(arm)
        self.assertEqual(self.status(1 - arm), before)

    def test_1_both_press_on_a_wall(self):
        for arm in (RIGHT, HID):
            self.recover(arm)

    def test_2_the_right_arm_misbehaves(self):
        for verb in TROUBLES:
            with self.subTest(verb):
                self.assert_bounded(RIGHT, verb)

    def test_5_the_daemon_is_the_one_that_it_was(self):
        self.assertEqual(self.properties("MainPID"), self.pid)
        self.assertEqual(self.properties("NRestarts"), {"NRestarts": "0"})


class Falcon(Misbehaviour, guest.GuestTest):
    @classmethod
    def plug_in(cls):
        falcon = arms.Falcon(cls.guest, is_named=False)
        beside = arm_beside(cls.guest, "--usbip", simdev.SECOND_PORT)
        beside.attach(simdev.SECOND_PORT)
        return falcon, beside

    def test_3_the_hid_arm_misbehaves(self):
        for verb in TROUBLES:
            with self.subTest(verb):
                self.assert_bounded(HID, verb)

    def test_4_devices_that_lie_in_place_of_the_falcon(self):
        # Not its contacts: devices that come keep the guest's only processor at work, where the thread of the worlds waits for its
        # turn as every ordinary process does; answers that come late let the wall go for a moment.
        before = {**self.status(HID), "contacts": None}
        serial = self.arms[RIGHT].status()["serial_number"]
        self.arms[RIGHT].say("unplug")
        simdev.wait_for_state(self.guest, "lost")
        asked = dict(line.split() for line in self.guest.call("lying_usb", *FALCON_IDS.split(), serial, *LIES.split(), timeout_s=600).splitlines())
        self.assertEqual(list(asked), LIES.split())
        self.assertGreater(min(int(requests) for requests in asked.values()), 0, asked)
        json.loads(self.guest.run("thimble devices --json"))
        simdev.wait_for_state(self.guest, "lost")
        self.arms[RIGHT].say("plug")
        self.arms[RIGHT].attach()
        self.recover(RIGHT)
        self.assertEqual({**self.status(HID), "contacts": None}, before)


class TextArmThatIsSwitchedOff(arms.TextArm):
    """Its board sees the button once: to be calibrated again it is switched off and on, as the instruction says."""

    was_calibrated = False

    def calibrate(self):
        if self.was_calibrated:
            self.say("unplug", "plug")
            self.plug()
            simdev.wait_for_state(self.guest, "calibrating")
        self.was_calibrated = True
        super().calibrate()


class TextArm(Misbehaviour, guest.GuestTest):
    """On the kernel's cdc_acm; beside an arm on uhid, which is the cheapest to emulate."""

    seen = ("state", "is_in_contact", "faults")  # a device comes after each fault: as with those that lie

    @classmethod
    def plug_in(cls):
        return TextArmThatIsSwitchedOff(cls.guest, is_named=False), arm_beside(cls.guest, "--uhid")

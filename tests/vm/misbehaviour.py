"""Devices that do what no device may, beside one that must not notice: they stall, say nothing, send bits turned over, too little, too much, or lie about what they are.

Each presses on a wall so hard that its limit binds. Whatever one of them does, what it is commanded stays within its limit in the pose that it told, the other one notices
nothing, the daemon goes on, and when a person has seen to it the arm works again.
"""

import json
import sys

import arms
import commanded
import guest
import kept
import simdev
import two_arms

# Half of what the wall would push back with, 7 mm behind its face.
LIMIT_NEWTON = 0.5
DEEP = "move 0.022 0 0 0.1"
# The ramp after an activation may not be over yet.
BOUND_NEWTON = 0.8 * LIMIT_NEWTON
PRESSED_NEWTON = 0.2
LET_GO_S = 0.1
# Half a count of each of a Falcon's motors; those of the others are finer.
ROUNDING_NEWTON = 0.003
# Of what is felt, where nothing told a lie: the arm moves on while a command is under way. Where a pose was a lie the motors push elsewhere, and may push harder.
SLACK = 1.02
# One is too soon where a device is not there yet.
MOST_CLEARS = 3
LIES_OF_ITS_POSE = "corrupt 50"
HALTS = "halt 3"
SILENCES = "nak 0.3", "stall 0.3"
NO_MORE = "corrupt 0", "short 0", "babble 0", "halt 0"
# What the device is told, and what of it it counts.
TROUBLES = {"nak 0.3": "unanswered", "stall 0.3": "refused", "corrupt 50": "corrupted", "short 50": "shortened", "babble 50": "babbled",
            HALTS: "halted"}
LIMIT = f"limits.force_newton = {LIMIT_NEWTON}\n"
MUTE = "it does not report its position; check its power and cable"
NAMES = ("right", "left")
RIGHT, LEFT = 0, 1
FALCON_IDS, HID_IDS = "0403 cb48", "1234 0006"


def arm_beside(one, *way, policy=None):
    return simdev.Simdev(one, "left", *way, "--serial", two_arms.BESIDE, "phantom-vintage", policy=policy)


class Misbehaviour:
    """Numbered: each test goes on where the one before it ended. `plug_in()`: makes the right arm, and the HID arm beside it; `judge`: of the right one, of
    commanded.py; `seen`: of an arm, that nothing of the other one may change; `gives_way`: the kernel, to a real-time thread, also where it computes for another
    one; else it gives way as Debian has it (decision 0524)."""

    pace = guest.COUNTED
    gives_way = False
    may_fall_mute = False
    # Whose halted endpoints our own driver clears. The kernel's usbhid leaves one that goes out as it is, and cdc_acm forgets one (decision 0502).
    clears_halts = ()
    replugs = 0
    more_words = ""  # of the configuration
    seen = ("state", "is_in_contact", "contacts", "faults")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.guest.run(guest.GIVES_WAY if cls.gives_way else guest.GIVES_WAY_AS_DEBIAN_HAS_IT)
        cls.arms = right, _ = cls.plug_in()
        cls.guest.wait_for(f"thimble devices | grep -q {two_arms.BESIDE}")
        right.words = f"{right.words}\nworld = \"box\"\n{LIMIT}{two_arms.LEFT}{LIMIT}{cls.more_words}"
        # At half of that a report that misses its frame is 3 ms old before the next one is read, which is stale: the wall is let go for a moment.
        right.configure(arms.FULL_HZ)
        cls.judges = cls.judge, commanded.Phantom("phantom-vintage")
        cls.pid = cls.properties("MainPID")

    def status(self, arm):
        """Of the arm; why late periods are not counted: two_arms.py."""
        status = json.loads(self.guest.run("thimble status --json"))
        return {**{key: status["arms"][arm][key] for key in self.seen},
                "malformed_reports": status["servos"][arm]["malformed_reports"]}

    def recover(self, arm, may_be_mute=False):
        """As a person does, until it is active and presses on the wall with all that its limit allows."""
        may_be_mute = may_be_mute or self.may_fall_mute
        device = self.arms[arm]
        clears = 0
        for look in range(40):
            seen = json.loads(simdev.wait_for_state(self.guest, "fault", "calibrating", "configured", "active", arm=arm))
            if seen["state"] == "active":
                break
            if seen["state"] == "fault":
                clears += 1
                self.guest.ask(f"thimble clear-fault {NAMES[arm]}")
                self.guest.sleep(0.2)
            elif seen["state"] == "calibrating":
                device.calibrate()
            elif seen["instruction"] == MUTE and may_be_mute:
                # What the kernel makes of a device that stalls for a while, or of one endpoint that does.
                self.replugs += 1
                device.say("unplug", "plug")
                device.attach()
                simdev.wait_for_state(self.guest, "calibrating", arm=arm)
            else:
                self.guest.sleep(0.2)
        self.assertLessEqual(clears, MOST_CLEARS)
        if look > 0 or not self.is_pressed(arm):
            # From outside: a wall that an arm is in when it becomes active does not push it out.
            self.guest.steps(device.step("move 0 0 0 0.1"), ("sleep", 0.12), device.step(DEEP), ("sleep", 0.5))
        else:
            self.guest.sleep(0.3)  # a fault that comes late shows by then
        status = self.status(arm)
        self.assertEqual((status["state"], status["is_in_contact"]), ("active", True), status)
        log = device.log(0.1)
        felt = [force for _, force in two_arms.forces(log)]
        self.assertGreater(min(felt), BOUND_NEWTON)
        # Who judges commands agrees with what the motors did.
        self.assertAlmostEqual(max(commanded.forces(self.judges[arm], log)), max(felt), delta=(SLACK - 1) * LIMIT_NEWTON)

    def is_pressed(self, arm):
        return min(force for _, force in two_arms.forces(self.arms[arm].log(0.1))) > BOUND_NEWTON

    def assert_presses(self, arm, log):
        """All the while, within its limit."""
        felt = [force for _, force in two_arms.forces(log)]
        self.assertGreater(min(felt), PRESSED_NEWTON, (two_arms.longest_gaps(log), self.status(arm)))
        self.assertLess(max(felt), SLACK * LIMIT_NEWTON)

    def strike(self, device, verb, *logged):
        """The device does it for 0.35 s and no longer: how often, of each kind, and logs that hold all of that. Not always as often as it was told: an arm that was
        stopped is not asked any more, and one in lock-step then says nothing."""
        # In one go: between two commands an idle guest's clock runs ahead.
        said = [json.loads(line) for line in self.guest.steps(device.step("status", verb), ("sleep", 0.35), device.step(*NO_MORE, "status"),
                                                              *(one.step("log 0.7") for one in logged))]
        before, after = (entry for entry in said if "trouble" in entry)
        ends = [at for at, entry in enumerate(said) if "entries" in entry]
        starts = [said.index(after) + 1, *(end + 1 for end in ends)]
        found = [said[start:end] for start, end in zip(starts, ends)]
        for log in found:
            self.assertLess(log[0]["machine_s"], before["machine_s"], "it begins before the trouble")
        struck = {kind: count - before["trouble"][kind] for kind, count in after["trouble"].items()}
        self.assertGreater(struck[TROUBLES[verb]], 0)
        return struck, found

    def assert_bounded(self, arm, verb):
        before = self.status(1 - arm)
        self.assertEqual((before["state"], before["is_in_contact"]), ("active", True))
        device = self.arms[arm]
        struck, (log, log_beside) = self.strike(device, verb, device, self.arms[1 - arm])
        felt = [force for _, force in two_arms.forces(log)]
        if verb == HALTS and arm in self.clears_halts:
            self.assertGreater(struck["halted_out"], 0)
            self.assertGreater(struck["halted"], struck["halted_out"])
        if verb in SILENCES:
            self.assertNotEqual(self.status(arm)["faults"], [], "it was driven on")
        self.assertLess(max(commanded.forces(self.judges[arm], log), default=0), LIMIT_NEWTON + ROUNDING_NEWTON)
        if verb == LIES_OF_ITS_POSE:
            loads = commanded.loads(self.judges[arm], log, LIMIT_NEWTON)
            self.assertGreater(max(loads), 0)
            self.assertLessEqual(max(loads), 1)
            print(f"{self._testMethodName}: {verb}: the arm felt {max(felt):.2f} N where it told another pose", file=sys.stderr)
        else:
            self.assertLess(max(felt), SLACK * LIMIT_NEWTON)
        self.assert_presses(1 - arm, log_beside)
        self.replugs = 0
        self.recover(arm, may_be_mute=verb == HALTS and arm not in self.clears_halts)
        if verb == HALTS and not self.may_fall_mute:
            self.assertEqual(self.replugs, 0 if arm in self.clears_halts else 1, "as decision 0502 has it")
        self.assert_unmoved(1 - arm, before, self.replugs)

    def assert_unmoved(self, arm, before, comings):
        """Devices that come keep the guest's only processor at work, where the thread of the worlds waits for its turn as every ordinary process does;
        answers that come late let the wall go for a moment: no more than once each. How often it did."""
        after = self.status(arm)
        let_go = after.pop("contacts", 0) - before.pop("contacts", 0)
        self.assertGreaterEqual(let_go, 0)
        self.assertLessEqual(let_go, comings)
        self.assertEqual(after, before)
        return let_go

    def test_1_both_press_on_a_wall(self):
        for arm in (RIGHT, LEFT):
            self.recover(arm)

    def assert_bounded_by_each(self, arm):
        for verb in TROUBLES:
            with self.subTest(verb):
                self.assert_bounded(arm, verb)

    def kept(self):
        """By the daemon. One thread more is none of each: who reads of a device that comes has one from the first on."""
        return json.loads(self.guest.run(f"udevadm settle; pid={arms.PID}; echo \"{{{kept.COUNTS}}}\""))

    def lie_in_place_of(self, arm, ids, lies):
        """Each lie in turn; after them the arm is lost as before, and works when it is back."""
        before = self.status(1 - arm)
        kept_before = self.kept()
        serial = self.arms[arm].status()["serial_number"]
        self.arms[arm].say("unplug")
        simdev.wait_for_state(self.guest, "lost", arm=arm)
        begin_s = self.arms[1 - arm].status()["t_s"]
        told = self.guest.call("lying_usb", *ids.split(), serial, *lies.split(), timeout_s=600).split()
        self.assertEqual(told[::3], lies.split())
        self.assertGreater(min(int(requests) for requests in told[1::3]), 0, told)
        # The last one tells no lie: it is opened, so the others were looked at.
        self.assertGreater(int(told[-1]), 0, told)
        # Of all of them: the log's length is looked at, for it forgets what is old.
        passed_s = self.arms[1 - arm].status()["t_s"] - begin_s
        beside = self.arms[1 - arm].say(f"felt {passed_s + 1} {PRESSED_NEWTON}")[0]
        self.assertLessEqual(beside["from_s"], begin_s)
        self.assertLess(beside["longest_below_s"], LET_GO_S)
        self.assertLess(beside["most_newton"], SLACK * LIMIT_NEWTON)
        json.loads(self.guest.run("thimble devices --json"))
        simdev.wait_for_state(self.guest, "lost", arm=arm)
        self.arms[arm].say("plug")
        self.arms[arm].attach()
        self.recover(arm)
        kept_after = self.kept()
        for name, most in (("descriptors", 0), ("threads", 1), ("guards", 0)):
            self.assertLessEqual(kept_after[name], kept_before[name] + most, name)
        let_go = self.assert_unmoved(1 - arm, before, len(lies.split()) + 1)
        print(f"{self._testMethodName}: let go {let_go} times", file=sys.stderr)

    def test_9_the_daemon_is_the_one_that_it_was(self):
        self.assertEqual(self.properties("MainPID"), self.pid)
        self.assertEqual(self.properties("NRestarts"), {"NRestarts": "0"})


class FalconBesideHid(Misbehaviour):
    """Both on USB: on usbfs and on the kernel's HID stack."""

    judge = commanded.Falcon(arms.NEWTON_PER_COUNT)
    clears_halts = (RIGHT,)

    @classmethod
    def plug_in(cls):
        falcon = arms.Falcon(cls.guest, is_named=False)
        beside = arm_beside(cls.guest, "--vhci")
        beside.attach()
        return falcon, beside

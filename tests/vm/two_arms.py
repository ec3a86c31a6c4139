"""Two arms that press on a wall of the box, of which one has trouble, and the other must not notice. Judged by both arms' own logs."""

import json

import arms
import guest
import one_arm
import simdev

BESIDE = "VM-ARM-2"
LEFT = f"""
[[arm]]
name = "left"
device = "hid:{BESIDE}"
model = "phantom-vintage"
amplifier_max_a = 3.0
"""
# A sample older than that is stale, and its arm begins to let go (DESIGN): the arm beside never comes near. A command waits longer where
# another device comes and goes, on uhid behind the kernel's one lock of hidraw (decision 0358); at 20 ms the servo would stop the arm.
GAP_S = {"in": 0.003, "out": 0.005}
WALL_NEWTON = 0.3
LOGS_S = 300  # the host's, for steps that tell two logs; bounds them only


def forces(log):
    """Their norms, of what motors did, with the time of each."""
    return [(entry["machine_s"], simdev.norm(entry["force_newton"])) for entry in log if "tip_m" in entry]


def longest_gaps(log):
    """For the message of a failure: each way, the three longest times between two exchanges, s, and when each began."""
    gaps = {}
    for way in GAP_S:
        at_s = [entry["machine_s"] for entry in log if way in entry]
        gaps[way] = [(round(gap_s, 4), round(since_s, 4)) for gap_s, since_s in sorted(simdev.gaps(at_s), reverse=True)[:3]]
    return gaps


class TwoArms(guest.GuestTest):
    """Both by `way`, uhid or usb of arms.WAYS. Each test goes on where the one before it ended. `gap_s`: as GAP_S.
    The kernel gives way as Debian has it (decision 0524)."""

    way = "uhid"
    gap_s = GAP_S

    # Two devices take a third of the processor here; at twice the time an instruction the world's thread would wait for them.
    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.right = arms.HidArm(cls.guest, cls.way, arms.FULL_HZ, is_named=False)
        cls.left = simdev.Simdev(cls.guest, "left", *arms.WAYS[cls.way], "--serial", BESIDE, "phantom-vintage")
        if cls.way == "usb":
            cls.left.attach()
        cls.guest.wait_for(f"thimble devices | grep -q {BESIDE}")
        cls.guest.run(guest.GIVES_WAY_AS_DEBIAN_HAS_IT)
        # Before the arms are looked at: its coming takes the only processor for longer than a servo waits.
        cls.plug_in_others()
        cls.right.words = f"{cls.right.words}\nworld = \"box\"\n{LEFT}"
        cls.right.configure()

    @classmethod
    def plug_in_others(cls):
        """Devices that are nobody's arm."""

    def press(self, arm):
        one_arm.press_from_the_middle(self, arm, WALL_NEWTON)

    def press_both(self):
        self.right.activate()
        simdev.wait_for_state(self.guest, "calibrating", arm=1)
        self.left.calibrate()
        simdev.wait_for_state(self.guest, "active", arm=1)
        for arm in (self.right, self.left):
            self.press(arm)

    def of_the_arm_beside(self):
        """What would tell that something had happened to it. A period now and then is late: the devices have the guest's only processor before
        the servo, and who comes or goes has the kernel's one lock of all hidraw nodes (decision 0245). assert_pressed_without_a_gap() bounds that."""
        status = json.loads(self.guest.run("thimble status --json"))
        arm = status["arms"][1]
        return {**{key: arm[key] for key in ("state", "is_in_contact", "contacts", "faults", "constraint_state")},
                "malformed_reports": status["servos"][1]["malformed_reports"]}

    def assert_nothing_happened_beside(self, before):
        self.assertEqual(before["state"], "active")
        self.assertTrue(before["is_in_contact"])
        self.assertEqual(self.of_the_arm_beside(), before)

    def log_around(self, *blow, seconds=0.5):
        """Steps of the guest: when they began, on the guest's clock, and what the left and the right arm felt from 0.3 s before
        until SECONDS after them."""
        steps = (("sleep", 0.3), ("now",), *blow, ("sleep", seconds), *(arm.step(f"log {seconds + 2}") for arm in (self.left, self.right)))
        (at_s, *_), logs = simdev.words_and_logs(self.guest.steps(*steps, timeout_s=LOGS_S))
        at_s = float(at_s)
        return at_s, *([entry for entry in log if at_s - 0.3 < entry["machine_s"] < at_s + seconds] for log in logs)

    def assert_pressed_without_a_gap(self, log):
        felt = [force for _, force in forces(log)]
        self.assertGreater(len(felt), 500)
        self.assertGreater(min(felt), WALL_NEWTON)
        for way, gap_s in self.gap_s.items():
            at_s = [entry["machine_s"] for entry in log if way in entry]
            self.assertGreater(len(at_s), 500, way)
            self.assertLess(max(simdev.gaps(at_s))[0], gap_s, way)

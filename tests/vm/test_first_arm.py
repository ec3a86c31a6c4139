"""docs/first-arm.md, as a person goes by it: the packages as they come, an arm plugged in, what `thimble devices --toml` prints put behind the configuration, the one line that it leaves
open filled in, the service restarted; calibrated, activated for as long as the command lasts, a wall felt. The simulated arm that was there stays."""

import json

import arms
import guest
import simdev

FILE = "/etc/thimble/thimble.toml"
NAME = "left"  # the simulated one is called right
WALL_NEWTON = 0.25
MOST_NEWTON = 1.02  # what the page bounds the force by, and what an arm moves while a command is under way


class FirstArm(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest, "usb", is_named=False)

    def test_1_what_is_printed_lacks_only_which_arm_it_is_and_check_says_so(self):
        self.guest.run("thimble devices | grep -q 'its arm.model:.*phantom-vintage'")
        self.guest.run(f"thimble devices --toml >> {FILE}")
        status, words = self.guest.ask(f"thimbled --config {FILE} --check")
        self.assertEqual(status, 2, words)
        self.assertIn("the controller does not tell which arm it drives", words)
        self.guest.run(f"sed -i 's/^# model = \"phantom-vintage\"/model = \"phantom-vintage\"/' {FILE}; thimbled --config {FILE} --check")

    def test_2_restarted_the_service_has_both_arms(self):
        self.guest.run("systemctl restart thimbled")
        arm = json.loads(simdev.wait_for_state(self.guest, "calibrating", arm=1))
        self.assertEqual((arm["name"], arm["device"], arm["model"]), (NAME, f"hid:{arms.SERIAL}", "phantom-vintage"))
        simdev.wait_for_state(self.guest, "active", arm=0)
        self.assertLess(max(self.arm.forces(1)), simdev.NOTHING_NEWTON)

    def test_3_calibrated_it_waits_to_be_asked_for(self):
        self.arm.calibrate()
        simdev.wait_for_state(self.guest, "inactive", arm=1)
        self.arm.say("move 0.018 0 0 0.2")
        self.guest.sleep(0.5)
        self.assertLess(max(self.arm.forces(0.3)), simdev.NOTHING_NEWTON)

    def test_4_active_it_feels_the_box_gently(self):
        self.arm.say("move 0 0 0 0.2")
        self.guest.sleep(0.3)
        # In a terminal of its own: it lasts.
        self.guest.run(f"systemd-run --quiet --unit person thimble activate {NAME}")
        simdev.wait_for_state(self.guest, "active", arm=1)
        self.guest.sleep(0.6)
        self.arm.say("move 0.022 0 0 0.3")
        self.guest.sleep(0.6)
        self.assertLess(self.arm.felt(0.1)[0], -WALL_NEWTON)
        self.assertLess(max(self.arm.forces(1)), MOST_NEWTON)

    def test_5_interrupted_the_command_takes_the_force_off(self):
        self.guest.run("systemctl kill --signal INT person")
        simdev.wait_for_state(self.guest, "inactive", arm=1)
        self.guest.sleep(0.4)
        self.assertLess(max(self.arm.forces(0.2)), simdev.NOTHING_NEWTON)

    def test_6_nothing_is_printed_of_an_arm_that_somebody_uses(self):
        self.assertIn("# No arm is plugged in that nobody uses.", self.guest.run("thimble devices --toml"))

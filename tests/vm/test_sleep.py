"""The machine goes to sleep while an arm presses on a wall: it is let go before, and comes back as after a boot.

Not asleep in truth: what systemd does before and after is what it does here; that time goes on meanwhile is tested by `rt_linux`.
"""

import arms
import guest
import simdev

# As systemd-suspend.service does: while it is there, the machine is on its way to sleep, asleep, or on its way back.
NIGHT = "systemd-run --quiet --unit=night -p Wants=sleep.target -p After=sleep.target sleep 1000"


class Sleep(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest)

    def test_1_an_arm_is_let_go_before_the_machine_sleeps(self):
        self.arm.activate()
        self.arm.say("move 0 0 0 0.1", "move 0.018 0 0 0.2")
        self.guest.sleep(0.6)
        self.assertLess(self.arm.felt(0.1)[0], -0.3)
        self.guest.run(NIGHT)
        self.guest.wait_for("test $(systemctl is-active sleep.target) = active")
        self.assertEqual(self.guest.ask("systemctl is-active thimbled")[1].strip(), "inactive")
        self.guest.sleep(0.3)
        self.assertLess(max(self.arm.forces(0.2)), simdev.NOTHING_NEWTON)

    def test_2_afterwards_the_daemon_is_there_and_the_arm_wants_a_person(self):
        self.guest.run("systemctl stop night")
        self.guest.wait_for("systemctl is-active --quiet thimbled")
        simdev.wait_for_state(self.guest, "inactive", "calibrating")
        self.guest.sleep(0.5)
        self.assertLess(max(self.arm.forces(0.5)), simdev.NOTHING_NEWTON)
        self.arm.activate()

    def test_3_a_daemon_that_did_not_run_is_not_started(self):
        self.guest.run(f"systemctl stop thimbled; {NIGHT}")
        self.guest.wait_for("test $(systemctl is-active sleep.target) = active")
        self.guest.run("systemctl stop night")
        self.guest.wait_for("test $(systemctl is-active sleep.target) = inactive")
        self.guest.sleep(1)
        self.assertEqual(self.guest.ask("systemctl is-active thimbled")[1].strip(), "inactive")

"""A HID arm on USB, whose own watchdog takes 500 ms, and a Falcon, which has none, while the daemon is killed, stopped or hangs: lets_go.py. Arms of the other buses: test_guard_kinds.py."""

import arms
import guest
import lets_go


class HidArm(lets_go.LetsGo, guest.GuestTest):
    """On USB: its guard has hiddev."""

    @classmethod
    def plug_in(cls):
        return arms.HidArm(cls.guest, "usb")

    def test_a_servo_that_hangs_for_good_costs_the_daemon_its_life(self):
        """All else in it runs on, so that nobody but the servo could have petted the watchdog."""
        self.guest.run(f"python3 -B /run/tests/hang_thread.py {arms.SERVO} 10 > /dev/null 2>&1 &")
        self.assert_started_anew_without_force(self.WATCHDOG_S)
        self.assertIn("Watchdog timeout", self.guest.run("journalctl -u thimbled -n 30"))


class Falcon(lets_go.LetsGo, guest.GuestTest):
    """Its firmware goes on while the daemon is away, and knows where the arm is."""

    STARTED_ANEW = "inactive"

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest)

"""As test_guard.py, of a HID arm that has no USB, whose own watchdog takes 500 ms, and of one on a serial port, whose takes 100: lets_go.py."""

import arms
import guest
import lets_go
import simdev


class HidArmWithoutUsb(lets_go.LetsGo, guest.GuestTest):
    """Its guard has hidraw. The form of the family whose reports, and so whose zero, have 64 bytes."""

    FREE, IN_A_WALL = "move 0 -0.034 0.0495 0.1", "move 0 -0.034 0.064 0.15"

    @classmethod
    def plug_in(cls):
        return arms.TeensyArm(cls.guest)


class TextArm(lets_go.LetsGo, guest.GuestTest):
    """Where it was calibrated before, a new daemon does not see the button pressed: it is switched off and on, as the instruction says."""

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest)

    def start_anew(self):
        self.guest.run("systemctl stop thimbled")
        self.arm.say("unplug", "plug")
        self.arm.plug()
        super().start_anew()

    def bring_home(self):
        self.arm.say("unplug")
        simdev.wait_for_state(self.guest, "lost")
        self.arm.say("plug")
        self.arm.plug()
        simdev.wait_for_state(self.guest, "calibrating")
        super().bring_home()

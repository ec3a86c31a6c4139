"""An arm on a serial port that misbehaves beside a HID arm, and serial ports that lie in place of it: misbehaviour.py."""

import arms
import commanded
import guest
import misbehaviour
import simdev

TEXT_IDS = "16c0 0483"
# As guest/lying_usb.py has them; the last one is what it says, and answers no transfer.
LIES = ("serial-no-union serial-union-with-none serial-union-with-itself serial-short-union serial-endless-union serial-no-data serial-no-pair "
        "serial-half-a-pair serial-no-notices serial")


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


class SerialArm(misbehaviour.Misbehaviour, guest.GuestTest):
    """On the kernel's cdc_acm; beside an arm on uhid, which is the cheapest to emulate."""

    may_fall_mute = True
    judge = commanded.Text("phantom-vintage")
    seen = ("state", "is_in_contact", "faults")  # a device comes after each fault: as with those that lie

    @classmethod
    def plug_in(cls):
        return TextArmThatIsSwitchedOff(cls.guest, is_named=False), misbehaviour.arm_beside(cls.guest, "--uhid", policy=simdev.Simdev.first)

    def test_2_it_misbehaves(self):
        self.assert_bounded_by_each(misbehaviour.RIGHT)

    def test_3_serial_ports_that_lie_in_place_of_it(self):
        self.lie_in_place_of(misbehaviour.RIGHT, TEXT_IDS, LIES)


class SerialArmThatFallsMute(SerialArm):
    """Where the kernel gives way, its cdc_acm forgets a halt and reads nothing any more (decision 0487): the status says so, and plugged in anew the arm works."""

    gives_way = True
    test_3_serial_ports_that_lie_in_place_of_it = None

    def test_2_it_misbehaves(self):
        self.assert_bounded(misbehaviour.RIGHT, misbehaviour.HALTS)
        self.assertEqual(self.replugs, 1)

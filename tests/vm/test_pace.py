"""10,000 ticks through a stock kernel's USB stack, at 1 kHz and at 4 kHz, with an arm on its HID stack: paced.py."""

import arms
import guest
import paced
import simdev


class HidArm(paced.Paced):
    """On a processor of 4 ns an instruction, of which the device, its bus and the servo at 4 kHz take half: who waits for another one is late. The device,
    which has no processor of its own, computes in what the servo leaves it (decision 0490). The kernel is as Debian has it, without `preempt=full` (0495)."""

    pace = guest.COUNTED_SLOWLY
    below_the_servo = f"chrt -a -f -p 75 $(systemctl show simdev-arm -p MainPID --value); {simdev.carriers_at(76)}"

    @classmethod
    def plug_in(cls):
        arm = arms.HidArm(cls.guest, "usb", arms.FULL_HZ, is_named=False)
        cls.guest.run(guest.GIVES_WAY_AS_DEBIAN_HAS_IT)
        cls.guest.run(cls.below_the_servo)
        return arm

    def test_1_kHz(self):
        self.assert_in_time(1000, exchanges_hz=1000)

    def test_4_kHz(self):
        self.assert_in_time(4000, exchanges_hz=1000)

"""The same as in test_pace.py with an arm on usbfs, and a fifth of it with one on a serial port: paced.py."""

import json

import arms
import paced

# Of samples that come a tick late where the terminal's worker waits for its turn; 2 and 3 in a thousand were seen (decision 0409).
SELDOM = 0.01


class Falcon(paced.Paced):
    least_bytes = 3  # two of each are the modem's
    own_hz = 4000

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, rate_hz=arms.FULL_HZ, is_named=False)

    def test_1_kHz(self):
        self.assert_in_time(1000, exchanges_hz=500)

    def test_4_kHz(self):
        self.assert_in_time(4000, exchanges_hz=1000)


class TextArm(paced.Paced):
    """One message, one report, about 1,000 a second (arms.md 3.1): here the servo sets the pace. A fifth of the ticks, for the plan asks
    for the others. A terminal's bytes come through a worker of the kernel, which on every machine waits for its turn as ordinary processes do
    (decision 0409): here those workers, too, are a part of the hardware, but for one test."""

    ticks = paced.TICKS // 5
    beforehand = "pgrep ^kworker/u | xargs -n 1 chrt -f -p 1 > /dev/null 2>&1"

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest, arms.FULL_HZ)

    def assert_presses(self):
        arm = json.loads(self.guest.run("thimble status --json"))["arms"][0]
        self.assertEqual((arm["state"], arm["is_in_contact"], arm["faults"]), ("active", True, []))

    def test_0_as_a_kernel_boots_hardly_a_sample_is_stale(self):
        self.beforehand = "true"
        servo, *_ = self.count(1000)
        self.assertEqual([servo[key] for key in ("overruns", "malformed_reports")], [0, 0])
        self.assertLessEqual(servo["missed_exchanges"], SELDOM * servo["ticks"])
        self.assert_presses()

    def test_1_kHz_is_its_full_rate(self):
        # A daemon that begins anew sees no button that was pressed before.
        self.guest.run("systemctl stop thimbled")
        self.arm.say("unplug", "plug")
        self.arm.plug()
        servo, _, _, log = self.count(1000)
        self.assert_no_gap(log, exchanges_hz=1000)
        self.assertEqual([servo[key] for key in ("overruns", "missed_exchanges", "malformed_reports")], [0, 0, 0])
        self.assert_presses()

"""The same as in test_pace.py with an arm on usbfs, and a fifth of it with one on a serial port: paced.py."""

import json

import arms
import paced


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
    (decision 0409): here those workers, too, are a part of the hardware."""

    ticks = paced.TICKS // 5
    beforehand = "pgrep ^kworker/u | xargs -n 1 chrt -f -p 1 > /dev/null 2>&1"

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest, arms.FULL_HZ)

    def test_1_kHz_is_its_full_rate(self):
        servo, _, _, log = self.count(1000)
        self.assert_no_gap(log, exchanges_hz=1000)
        self.assertEqual([servo[key] for key in ("overruns", "missed_exchanges", "malformed_reports")], [0, 0, 0])
        arm = json.loads(self.guest.run("thimble status --json"))["arms"][0]
        self.assertEqual((arm["state"], arm["is_in_contact"], arm["faults"]), ("active", True, []))

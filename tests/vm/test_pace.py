"""10,000 ticks of the packaged daemon through a stock kernel's USB stack, at 1 kHz and at 4 kHz, counted.

The guest's clock counts instructions, so the figures are the same whatever the host does, and may be asserted. What a tick, an exchange
and a stale sample are here: docs/decisions/0345.
"""

import json
import sys

import arms
import guest
import simdev

TICKS = 10_000
# A Falcon on the wall feels 0.29 N, the HID arm more, and neither anything in the open.
PRESSED_NEWTON = 0.2
# Two statuses around the sleep, each with the counters of the kernel, in one script, since an idle guest's clock runs ahead between two.
SCRIPT = """
{beforehand}
look() {{
  thimble status --json | tr -d '\\n'; echo
  for task in /proc/$pid/task/*; do echo "$(cat $task/comm) $(awk '/ctxt_switches/ {{print $2}}' $task/status | xargs)"; done
}}
pid=$(systemctl show thimbled -p MainPID --value)
look > /run/before; sleep {seconds}; look > /run/after
cat /run/before; echo; cat /run/after
"""


def parse(text):
    status, *threads = text.strip().splitlines()
    switches = {}
    for line in threads:
        name, voluntary, involuntary = line.rsplit(" ", 2)
        before = switches.get(name, (0, 0))
        switches[name] = (before[0] + int(voluntary), before[1] + int(involuntary))
    return json.loads(status)["servos"][0], switches


class Paced(guest.GuestTest):
    pace = guest.COUNTED
    ticks = TICKS
    beforehand = ""  # of the counting

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = cls.plug_in()

    def count(self, rate_hz):
        """What servo, device and kernel counted in so many ticks and a few: of the device, and the switches of each name of a thread, by tick."""
        self.arm.configure(rate_hz)
        self.arm.activate()
        self.arm.say("move 0.018 0 0 0.3")
        self.guest.run("sleep 1")
        # The device, which no thread of the guest interrupts, is asked before and after, not within.
        idle = self.arm.status()["counters"]
        printed = self.guest.run(SCRIPT.format(beforehand=self.beforehand, seconds=1.01 * self.ticks / rate_hz), timeout_s=600)
        counters = self.arm.status()["counters"]
        before, after = (parse(text) for text in printed.split("\n\n"))
        servo = {key: after[0][key] - before[0][key] for key in ("ticks", "overruns", "missed_exchanges", "malformed_reports")}
        device = {key: counters[key] - idle[key] for key in idle}
        switches = {name: [round((now - then) / servo["ticks"], 3) for now, then in zip(after[1][name], before[1][name])]
                    for name in after[1]}
        print(f"{type(self).__name__}, {rate_hz} Hz: {servo}; {device}; switches a tick, voluntary and not: {switches}", file=sys.stderr)
        return servo, device, switches["servo-right"]

    def assert_in_time(self, rate_hz, exchanges_hz):
        servo, device, (voluntary, _) = self.count(rate_hz)
        # It pressed on the wall all the while.
        arm = json.loads(self.guest.run("thimble status --json"))["arms"][0]
        self.assertEqual((arm["state"], arm["is_in_contact"], arm["faults"]), ("active", True, []))
        self.assertGreater(simdev.norm(self.arm.felt(0.1)), PRESSED_NEWTON)
        self.assertGreaterEqual(servo.pop("ticks"), self.ticks)
        self.assertEqual(servo, {"overruns": 0, "missed_exchanges": 0, "malformed_reports": 0})
        self.assertEqual([device[key] for key in ("superseded", "lost", "malformed")], [0, 0, 0])
        seconds = self.ticks / rate_hz
        self.assertGreaterEqual(device["from_host"], 0.99 * exchanges_hz * seconds)
        # The sleep, and nothing else, lets others run. That the device, which has no processor of its own here, takes it away is counted, too;
        # how often depends on which of them was switched on first.
        self.assertAlmostEqual(voluntary, 1, delta=0.01)


class HidArm(Paced):
    @classmethod
    def plug_in(cls):
        return arms.HidArm(cls.guest, "usb", arms.FULL_HZ, is_named=False)

    def test_1_kHz(self):
        self.assert_in_time(1000, exchanges_hz=1000)

    def test_4_kHz(self):
        self.assert_in_time(4000, exchanges_hz=1000)


class Falcon(Paced):
    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, rate_hz=arms.FULL_HZ, is_named=False)

    def test_1_kHz(self):
        self.assert_in_time(1000, exchanges_hz=500)

    def test_4_kHz(self):
        self.assert_in_time(4000, exchanges_hz=1000)


class TextArm(Paced):
    """One message, one report, about 1,000 a second (arms.md 3.1): here the servo sets the pace. A fifth of the ticks, for the plan asks
    for the others. A terminal's bytes come through a worker of the kernel, which on every machine waits for its turn as ordinary processes do
    (decision 0409): here those workers, too, are a part of the hardware."""

    ticks = TICKS // 5
    beforehand = "pgrep ^kworker/u | xargs -n 1 chrt -f -p 1 > /dev/null 2>&1"

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest, arms.FULL_HZ)

    def test_1_kHz_is_its_full_rate(self):
        servo, device, _ = self.count(1000)
        self.assertGreaterEqual(device["from_host"], 0.99 * self.ticks)
        self.assertGreaterEqual(device["to_host"], 0.99 * self.ticks)
        self.assertEqual([servo[key] for key in ("overruns", "missed_exchanges", "malformed_reports")], [0, 0, 0])
        arm = json.loads(self.guest.run("thimble status --json"))["arms"][0]
        self.assertEqual((arm["state"], arm["is_in_contact"], arm["faults"]), ("active", True, []))

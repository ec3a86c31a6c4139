"""10,000 ticks of the packaged daemon through a stock kernel's USB stack, at 1 kHz and at 4 kHz, counted.

The guest's clock counts instructions, so the figures are the same whatever the host does, and may be asserted. What a tick, an exchange
and a stale sample are here: docs/decisions/0345.
"""

import json
import sys

import arms
import guest

TICKS = 10_000
# Two statuses around the sleep, each with the counters of kernel and device; everything in one script, since an idle guest's clock
# runs ahead between two.
SCRIPT = """
look() {{
  thimble status --json | tr -d '\\n'; echo
  {status}
  for task in /proc/$pid/task/*; do echo "$(cat $task/comm) $(awk '/ctxt_switches/ {{print $2}}' $task/status | xargs)"; done
}}
pid=$(systemctl show thimbled -p MainPID --value)
{move} > /dev/null; sleep 1
look > /run/before; sleep {seconds}; look > /run/after
cat /run/before; echo; cat /run/after
"""


def parse(text):
    status, device, *threads = text.strip().splitlines()
    switches = {}
    for line in threads:
        name, voluntary, involuntary = line.rsplit(" ", 2)
        before = switches.get(name, (0, 0))
        switches[name] = (before[0] + int(voluntary), before[1] + int(involuntary))
    return json.loads(status)["servos"][0], json.loads(device)["counters"], switches


class Paced(guest.GuestTest):
    # At two nanoseconds an instruction the arm's mechanics have the only processor for 0.3 ms of each: too long at 4 kHz.
    pace = guest.counted(0)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = cls.plug_in()

    def count(self, rate_hz):
        """What servo, device and kernel counted in TICKS and a few: of the device, and the switches of each name of a thread, by tick."""
        self.arm.configure(rate_hz)
        self.arm.activate()
        script = SCRIPT.format(status=self.arm.command("status"), move=self.arm.command("move 0.018 0 0 0.3"),
                               seconds=1.01 * TICKS / rate_hz)
        before, after = (parse(text) for text in self.guest.run(script, timeout_s=600).split("\n\n"))
        servo = {key: after[0][key] - before[0][key] for key in ("ticks", "overruns", "missed_exchanges", "malformed_reports")}
        device = {key: after[1][key] - before[1][key] for key in before[1]}
        switches = {name: [round((now - then) / servo["ticks"], 3) for now, then in zip(after[2][name], before[2][name])]
                    for name in after[2]}
        print(f"{type(self).__name__}, {rate_hz} Hz: {servo}; {device}; switches a tick, voluntary and not: {switches}", file=sys.stderr)
        return servo, device, switches["servo-right"]

    def assert_in_time(self, rate_hz, exchanges_hz):
        servo, device, (voluntary, involuntary) = self.count(rate_hz)
        self.assertGreaterEqual(servo.pop("ticks"), TICKS)
        self.assertEqual(servo, {"overruns": 0, "missed_exchanges": 0, "malformed_reports": 0})
        self.assertEqual([device[key] for key in ("superseded", "lost", "malformed")], [0, 0, 0])
        seconds = TICKS / rate_hz
        self.assertGreaterEqual(device["from_host"], 0.99 * exchanges_hz * seconds)
        # The sleep, and nothing else, lets others run.
        self.assertAlmostEqual(voluntary, 1, delta=0.01)
        self.assertLess(involuntary, 0.05)


class HidArm(Paced):
    @classmethod
    def plug_in(cls):
        return arms.HidArm(cls.guest, "usbip")

    def test_1_kHz(self):
        self.assert_in_time(1000, exchanges_hz=1000)

    def test_4_kHz(self):
        self.assert_in_time(4000, exchanges_hz=1000)


class Falcon(Paced):
    """At 4 kHz one period of 11,075 passed without a tick: docs/benchmarks.md."""

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest)

    def test_1_kHz(self):
        self.assert_in_time(1000, exchanges_hz=500)

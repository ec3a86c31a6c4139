"""Ticks of the packaged daemon through a stock kernel's USB stack, counted.

The guest's clock counts instructions, so the figures are the same whatever the host does, and may be asserted. What a tick, an exchange
and a stale sample are here: docs/decisions/0345.
"""

import json
import re
import sys

import arms
import guest
import simdev

TICKS = 10_000
# A Falcon on the wall feels 0.29 N, the HID arm more, and neither anything in the open.
PRESSED_NEWTON = 0.2
# A device is asked once a frame, and answers in it: who misses one waits a whole frame longer.
HALF_A_FRAME_S = 0.0005
AT_BOTH_ENDS = 2  # exchanges of which only a part lies in the time
LOOK_S = 5  # before and after the sleep, at most
PACKET = re.compile(r'.*"machine_s":(?P<at_s>[0-9.]*),"(?P<way>in|out)":"(?P<hex>[0-9a-f]*)"')


def parse(text):
    """What count_ticks counted, and the packets within the sleep: (time, bytes) of each way."""
    counted, *lines = text.splitlines()
    counted = json.loads(counted)
    packets = {"in": [], "out": []}
    for packet in map(PACKET.match, lines):
        if counted["begin_s"] <= float(packet["at_s"]) < counted["end_s"]:
            packets[packet["way"]].append((float(packet["at_s"]), len(packet["hex"]) // 2))
    return counted, packets


class Paced(guest.GuestTest):
    pace = guest.COUNTED
    ticks = TICKS
    beforehand = ""  # of the counting
    least_bytes = 1  # of a packet that has a report
    own_hz = 1000  # its driver's: what it has where nobody says one

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # As it boots, an ordinary process: what is offered over TCP alone needs it otherwise (decision 0409), and nothing here is.
        cls.guest.run("pgrep ^ksoftirqd/ | xargs -n 1 chrt --other -p 0")
        cls.arm = cls.plug_in()

    def count(self, rate_hz):
        """What servo, device and kernel counted in so many ticks and a few: of the device, and the switches of each name of a thread, by tick; and the device's log
        of the sleep."""
        self.arm.configure(arms.OWN_RATES if rate_hz == self.own_hz else rate_hz)
        self.arm.activate()
        self.arm.say("move 0.018 0 0 0.3")
        self.guest.run(f"sleep 1; {self.beforehand}")
        # The device, which no thread of the guest interrupts, is asked before and after, not within.
        idle = self.arm.status()["counters"]
        seconds = 1.01 * self.ticks / rate_hz
        log = parse(self.guest.call("count_ticks", str(seconds), str(seconds + LOOK_S), self.arm.socket, timeout_s=600))
        counters = self.arm.status()["counters"]
        before, after = log[0]["before"], log[0]["after"]
        servo = {key: after["servo"][key] - before["servo"][key] for key in ("ticks", "overruns", "missed_exchanges", "malformed_reports")}
        device = {key: counters[key] - idle[key] for key in idle}
        switches = {name: [round((now - then) / servo["ticks"], 3) for now, then in zip(both, before["switches"].get(name, (0, 0)))]
                    for name, both in after["switches"].items()}
        print(f"{type(self).__name__}, {rate_hz} Hz: {servo}; {device}; switches a tick, voluntary and not: {switches}", file=sys.stderr)
        return servo, device, switches["servo-right"], log

    def assert_no_gap(self, log, exchanges_hz):
        """No command and no report was left out, by the device's own log."""
        counted, packets = log
        slept_s = counted["end_s"] - counted["begin_s"]
        for way, those in packets.items():
            at_s = [at_s for at_s, size in those if size >= self.least_bytes]
            longest_s, _ = max(simdev.gaps(at_s))
            print(f"{type(self).__name__}, {way}: {len(at_s)} in {slept_s:.2f} s, {1000 * longest_s:.4f} ms between two at most", file=sys.stderr)
            self.assertGreaterEqual(len(at_s), exchanges_hz * slept_s - AT_BOTH_ENDS)
            self.assertLess(longest_s, 1 / exchanges_hz + HALF_A_FRAME_S, way)

    def assert_in_time(self, rate_hz, exchanges_hz):
        servo, device, (voluntary, _), log = self.count(rate_hz)
        # It pressed on the wall all the while.
        arm = json.loads(self.guest.run("thimble status --json"))["arms"][0]
        self.assertEqual((arm["state"], arm["is_in_contact"], arm["faults"]), ("active", True, []))
        self.assertGreater(simdev.norm(self.arm.felt(0.1)), PRESSED_NEWTON)
        self.assertGreaterEqual(servo.pop("ticks"), self.ticks)
        self.assertEqual(servo, {"overruns": 0, "missed_exchanges": 0, "malformed_reports": 0})
        self.assertEqual([device[key] for key in ("superseded", "lost", "malformed")], [0, 0, 0])
        self.assert_no_gap(log, exchanges_hz)
        # The sleep, and nothing else, lets others run. That a device above it takes it away is counted, too; how often depends on which of them was
        # switched on first.
        self.assertAlmostEqual(voluntary, 1, delta=0.01)

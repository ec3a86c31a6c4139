"""What an exchange takes in the guest beside a bare one through the same library, and what four arms take of its processor.

The guest's clock counts instructions; the figures are printed, for docs/benchmarks.md, and what was done to get them is asserted. What
they are: docs/decisions/0359 of the time of a trip, 0496 of the processor time that an exchange takes.
"""

import contextlib
import json
import sys

import arms
import guest
import simdev

PROGRAM = "/run/bin/vm_round_trip"
ECHO = "VM-ECHO-1"
MOST_OF_BARE = 1.15
# Of processor time, where the goal of 1.15 is not reached (docs/benchmarks.md): a sixth above what was measured. What this clock counts
# is the same in every run but for some per cent, so it is new work that breaks these.
MOST_WORK_OF_BARE = {"hidraw, uhid": 1.87, "HID, USB": 2.18, "HID, USB, bare over hiddev": 1.48, "usbfs, USB": 1.66, "cdc_acm, USB": 2.3}


def tell(text):
    print(text, file=sys.stderr)


class RoundTrips(guest.GuestTest):
    pace = guest.COUNTED
    runs_daemon = False

    @contextlib.contextmanager
    def offered(self, kind, way):
        """A device that sends back what it is sent, above all others, as hardware is."""
        self.guest.run("systemd-run --quiet --collect --unit echo "
                       f"-p CPUSchedulingPolicy=fifo -p CPUSchedulingPriority=85 {PROGRAM} offer {kind} {way}")
        try:
            yield
        finally:
            self.guest.run("systemctl stop echo; udevadm settle")

    def measure(self, name, kind, address, *nodes):
        printed = self.guest.run(f"{simdev.RAISE_CARRIERS}; udevadm settle; {PROGRAM} measure '{name}' {kind} {address} {' '.join(nodes)}", timeout_s=900)
        tell(printed.strip())
        trip, processor = (json.loads(line) for line in printed.strip().splitlines())
        # The clock counts instructions: what is late here is more work, not a busy host.
        self.assert_at_most(MOST_OF_BARE, trip)
        self.assert_at_most(MOST_WORK_OF_BARE[name], processor)

    def assert_at_most(self, ratio, figure):
        self.assertGreater(figure["value"], 0)
        self.assertGreater(figure["reference"], 0)
        self.assertLessEqual(figure["ratio"], ratio, figure["name"])

    @contextlib.contextmanager
    def offered_hid(self, way):
        with self.offered("hid", way):
            found = self.guest.wait_for("ls -d /sys/bus/hid/devices/0003:1234:0006.*/hidraw/hidraw*").strip()
            yield f"/dev/{found.rsplit('/', 1)[1]}"

    def test_hidraw_through_uhid(self):
        with self.offered_hid("uhid") as node:
            self.measure("hidraw, uhid", "hid", f"hid:{ECHO}", node)

    def test_hid_on_usb(self):
        """Ours leave over hiddev; the bare ones over hidraw, then over hiddev as well."""
        with self.offered_hid("usb") as node:
            hiddev = self.guest.wait_for("ls /dev/usb/hiddev*").strip()
            self.measure("HID, USB", "hid", f"hid:{ECHO}", node)
            self.measure("HID, USB, bare over hiddev", "hid", f"hid:{ECHO}", node, hiddev)

    def test_usbfs(self):
        with self.offered("usb", "usb"):
            port = self.guest.wait_for("basename $(dirname $(grep -lx cb48 /sys/bus/usb/devices/*/idProduct))").strip()
            node = self.guest.run(f"udevadm info -q name /sys/bus/usb/devices/{port}").strip()
            self.measure("usbfs, USB", "usb", f"usb:{ECHO}", f"/dev/{node}")

    def test_serial(self):
        with self.offered("serial", "usb"):
            node = self.guest.wait_for("ls /dev/ttyACM*").strip()
            self.measure("cdc_acm, USB", "serial", f"serial:{ECHO}", node)


# Processor time of each thread of the daemon, by its name, and of its arms' guards, and ticks of the servos, around two seconds in one script: between two
# commands an idle guest's clock runs ahead.
SHARES = """
look() {
  thimble status --json | tr -d '\\n'; echo
  awk '{print $1}' /proc/uptime
  for task in /proc/$pid/task/*; do echo "$(cat $task/comm) $(awk '{print $1}' $task/schedstat)"; done
  for guard in $(pgrep -x thimble-guard); do echo "guards $(cat /proc/$guard/task/*/schedstat | awk '{sum += $1} END {print sum}')"; done
}
pid=$(systemctl show thimbled -p MainPID --value)
look > /run/before; sleep 2; look > /run/after
cat /run/before; echo; cat /run/after
"""


def parse(text):
    status, uptime_s, *threads = text.strip().splitlines()
    busy_s = {}
    for line in threads:
        name, busy_ns = line.rsplit(" ", 1)
        kind = name.split("-")[0]
        busy_s[kind] = busy_s.get(kind, 0) + 1e-9 * float(busy_ns)
    return json.loads(status)["servos"], float(uptime_s), busy_s


class FourArms(guest.GuestTest):
    """At 1 kHz, each pressed against a wall of the box."""

    pace = guest.COUNTED
    names = ("right", "left", "third", "fourth")
    way = "uhid"  # of arms.WAYS
    rate_hz = arms.FULL_HZ
    ticks_hz = 4 * (arms.FULL_HZ,)
    most = 0.21  # of this emulated processor, with the guards; 0.15 to 0.17 were measured
    right_newton = 0.3

    @classmethod
    def plug_in_right(cls):
        return arms.HidArm(cls.guest, rate_hz=arms.FULL_HZ, is_named=False)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        right = cls.plug_in_right()
        cls.arms = [right]
        words = [right.words]
        for name in cls.names[1:]:
            serial = f"VM-{name}"
            cls.arms.append(simdev.Simdev(cls.guest, name, *arms.WAYS[cls.way], "--serial", serial, "phantom-vintage"))
            if cls.way == "usb":
                cls.arms[-1].attach()
            cls.guest.wait_for(f"thimble devices | grep -q {serial}")
            words.append(f'[[arm]]\nname = "{name}"\ndevice = "hid:{serial}"\nmodel = "phantom-vintage"\namplifier_max_a = 3.0')
        right.words = '\nworld = "box"\n\n'.join(words)
        right.configure(cls.rate_hz)

    def test_share_of_a_processor(self):
        for number, arm in enumerate(self.arms):
            simdev.wait_for_state(self.guest, "calibrating", arm=number)
            arm.calibrate()
            simdev.wait_for_state(self.guest, "active", arm=number)
            arm.say("move 0.018 0 0 0.3")
        before, after = (parse(part) for part in self.guest.run(SHARES, timeout_s=900).split("\n\n"))
        seconds = after[1] - before[1]
        shares = {name: round((after[2][name] - before[2].get(name, 0)) / seconds, 4) for name in sorted(after[2])}
        ticks = [servo["ticks"] - earlier["ticks"] for servo, earlier in zip(after[0], before[0])]
        tell(f"{type(self).__name__}: {sum(shares.values()):.3f} of a processor in {seconds:.1f} s; of it {shares}; ticks {ticks}")
        self.assertEqual(len(ticks), len(self.names))
        self.assertLess(sum(shares.values()), self.most)
        self.assertGreater(shares["guards"], 0)
        for count, rate_hz in zip(ticks, self.ticks_hz):
            self.assertAlmostEqual(count / seconds, rate_hz, delta=0.05 * rate_hz)
        for arm, newton in zip(self.arms, (self.right_newton, 0.3, 0.3, 0.3)):
            self.assertLess(arm.felt(0.2)[0], -newton)


class FourArmsOnUsb(FourArms):
    """A Falcon, which is asked each second tick then, and three HID arms."""

    way = "usb"
    most = 0.27  # 0.20 to 0.23 were measured
    right_newton = 0.2  # a Falcon feels 0.29 N there

    @classmethod
    def plug_in_right(cls):
        return arms.Falcon(cls.guest, is_named=False)


class FourArmsAtTheirOwnRates(FourArmsOnUsb):
    """The same as they come: nobody says a rate, so the Falcon has 4 kHz (decision 0491)."""

    rate_hz = arms.OWN_RATES
    ticks_hz = (4000, 1000, 1000, 1000)
    most = 0.27  # 0.22 were measured

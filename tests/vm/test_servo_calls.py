"""What the servo thread of the packaged daemon asks of a stock kernel and of the C library while it drives a real bus: HID on USB, usbfs. Other buses: test_servo_calls_kinds.py.

strace tells the system calls, probes of the kernel in the C library the allocations. Both see the threads of the bus, too, whose calls
may block and allocate: that is how the tests know that they see. Beside the HID arm the daemon has safety lines on a CP2112, whose every read blocks.
"""

import json
import pathlib
import sys

import arms
import guest
import lines

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import servo_calls  # noqa: E402

SERVO = "servo-right"
BUS = "bus"
LINES = "gpio"
LIBRARIES = ("libusb-1.0.so.", "libhidapi-hidraw.so.")  # theirs is no memory of ours
CALLS = 500  # of each kind, at least; strace slows the servo down
READS = 20  # of three lines, every 20 ms


class ArmWithLines(arms.HidArm):
    """`adapter`: that of its lines."""

    daemon_words = lines.SAFETY

    def activate(self):
        self.guest.wait_for_module("status_until", "safety.state", "waiting")
        lines.take_hold(self.guest, self.adapter)
        self.guest.run("thimble clear-fault right")
        super().activate()


class Hid(guest.GuestTest):
    """The arm hangs on USB, so that what leaves for it, over its hiddev, takes a frame of the bus."""

    pace = guest.COUNTED
    blocking_call = "ioctl(", "</dev/usb/hiddev", "HIDIOCSREPORT"
    libraries = LIBRARIES

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = cls.plug_in()
        cls.arm.activate()

    @classmethod
    def plug_in(cls):
        cls.adapter = lines.plug_in(cls.guest)
        arm = ArmWithLines(cls.guest, "usb", arms.FULL_HZ)
        arm.adapter = cls.adapter
        return arm

    def lean(self):
        """A hand leans on a wall, and feels it."""
        self.arm.say("move 0.018 0 0 0.15")
        self.guest.sleep(0.3)
        self.assertLess(self.arm.felt(0.1)[0], -0.3)

    def run_for_daemon(self, script):
        return self.guest.run(f"pid=$(systemctl show thimbled -p MainPID --value)\n{script}")

    def trace(self, thread):
        """System calls of the threads of that name within a second, one a line."""
        self.lean()
        threads = f"$(grep -lx '{thread}' /proc/$pid/task/*/comm | cut -d / -f 5 | sed 's/^/-p /')"
        self.run_for_daemon(f"timeout 1 strace -y -o /run/strace {threads}; test -s /run/strace")
        return self.guest.run("cat /run/strace").splitlines()

    def test_its_system_calls_are_the_sleep_and_the_wake_of_others(self):
        calls = self.trace(SERVO)
        self.assertEqual(servo_calls.forbidden(calls), [])
        for expected in (servo_calls.SLEEP, servo_calls.WAKE):
            self.assertGreater(sum(bool(expected.fullmatch(call)) for call in calls), CALLS)

    def test_what_may_block_is_asked_by_threads_of_the_bus(self):
        """The filter can fail."""
        seen = [call for call in servo_calls.forbidden(self.trace(BUS)) if all(word in call for word in self.blocking_call)]
        self.assertGreater(len(seen), CALLS)

    def test_its_safety_lines_are_read_by_a_thread_of_their_own(self):
        seen = [call for call in servo_calls.forbidden(self.trace(LINES)) if call.startswith("ioctl(") and "gpio" in call]
        self.assertGreater(len(seen), READS)

    def test_its_memory_comes_from_nowhere(self):
        self.lean()
        asked = "(sleep 0.5; thimble status > /dev/null)&"
        calls = json.loads(self.run_for_daemon(f"{asked} python3 -B /run/tests/allocations.py $pid 2 || exit 1; wait"))
        names = [name.split("/")[0] for name in calls]
        self.assertEqual(names.count(SERVO), 1, names)
        self.assertTrue(any(name.startswith(BUS) for name in names), names)
        for name, counts in calls.items():
            print(f"{type(self).__name__}: {name}: {counts}", file=sys.stderr)
            if name.startswith(SERVO):
                self.assertEqual(counts, {})
            if name.startswith(BUS):
                self.assertEqual([call for call in counts if not call.split(" by ")[1].startswith(self.libraries)], [])
        # It does see them: who answers for the status takes memory, by our program and by the C++ library.
        self.assertTrue(any(f"malloc by {taker}" in counts for counts in calls.values() for taker in ("thimbled", "libstdc++.so.6.0.30")))


class Usbfs(Hid):
    pace = guest.COUNTED
    blocking_call = "ioctl(", "USBDEVFS_SUBMITURB"
    test_its_safety_lines_are_read_by_a_thread_of_their_own = None  # it has none

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, rate_hz=arms.FULL_HZ)

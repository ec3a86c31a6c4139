"""What a test of the guest names: the base class, the guest itself, the paces that it can have."""

import re
import sys
import unittest

import guest_states
from machine import AS_IT_COMES, BIN, COUNTED, COUNTED_SLOWLY, DEBS, ON_TWO, Guest, GuestError

__all__ = ["AS_IT_COMES", "BIN", "COUNTED", "COUNTED_SLOWLY", "DEBS", "ON_TWO", "Guest", "GuestError", "GuestTest", "GIVES_WAY", "GIVES_WAY_AS_DEBIAN_HAS_IT"]

# For its kernel, which else computes for others to the end before it gives the guest's only processor to arm and servo (decision 0524).
GIVES_WAY = "echo full > /sys/kernel/debug/sched/preempt"
GIVES_WAY_AS_DEBIAN_HAS_IT = "grep -q '(voluntary)' /sys/kernel/debug/sched/preempt"

# In its log. Not what it says of time: a guest's clock leaps ahead while a busy host reads its disk, and a processor that the host takes away looks like one that is locked up.
TROUBLE = re.compile(r"^.*(?:BUG: (?!.*lockup)|Oops|general protection fault).*$", re.MULTILINE)


class GuestTest(unittest.TestCase):
    """A class of tests in one guest, in the order of their names. `runs_daemon`: it does so, or the devices of the test are not for it."""

    kernel = "amd64"
    pace = AS_IT_COMES
    runs_daemon = True
    is_told = False  # why a test failed

    @classmethod
    def setUpClass(cls):
        cls.guest = cls.start_guest()
        cls.addClassCleanup(cls.guest.close)
        cls.addClassCleanup(cls.assert_kernel_is_well)
        if not cls.runs_daemon:
            cls.guest.run("systemctl stop thimbled")

    @classmethod
    def start_guest(cls):
        return guest_states.start(cls.kernel, cls.pace)

    def run(self, result=None):
        """The first test of a class that fails says what the daemon says of itself: the rest fails for that."""
        result = result or self.defaultTestResult()
        failed = len(result.failures) + len(result.errors)
        super().run(result)
        if len(result.failures) + len(result.errors) > failed and not self.is_told:
            type(self).is_told = True
            print(self.words_of_the_daemon(), file=sys.stderr)
        return result

    def words_of_the_daemon(self):
        try:
            return self.guest.ask("thimble status; journalctl -u thimbled -u 'thimble-guard@*' -n 30 --no-pager")[1]
        except (GuestError, OSError) as error:
            return f"The guest says no more: {error}"

    @classmethod
    def assert_kernel_is_well(cls):
        """Nothing that the test did to it, or its devices, or the daemon, has left it in trouble, of which a process may notice nothing for long."""
        found = TROUBLE.findall(cls.guest.run("dmesg"))
        if found:
            raise AssertionError(f"the kernel says: {found}")

    @classmethod
    def properties(cls, *names, unit="thimbled.service"):
        text = cls.guest.run(f"systemctl show {unit} " + " ".join(f"-p {name}" for name in names))
        return dict(line.split("=", 1) for line in text.splitlines())

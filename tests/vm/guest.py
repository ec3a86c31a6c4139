"""What a test of the guest names: the base class, the guest itself, the paces that it can have."""

import unittest

import guest_states
from machine import AS_IT_COMES, COUNTED, DEBS, ON_TWO, Guest, GuestError

__all__ = ["AS_IT_COMES", "COUNTED", "DEBS", "ON_TWO", "Guest", "GuestError", "GuestTest"]


class GuestTest(unittest.TestCase):
    """A class of tests in one guest, in the order of their names. `runs_daemon`: it does so, or the devices of the test are not for it."""

    kernel = "amd64"
    pace = AS_IT_COMES
    runs_daemon = True

    @classmethod
    def setUpClass(cls):
        cls.guest = cls.start_guest()
        cls.addClassCleanup(cls.guest.close)
        if not cls.runs_daemon:
            cls.guest.run("systemctl stop thimbled")

    @classmethod
    def start_guest(cls):
        return guest_states.start(cls.kernel, cls.pace)

    @classmethod
    def properties(cls, *names, unit="thimbled.service"):
        text = cls.guest.run(f"systemctl show {unit} " + " ".join(f"-p {name}" for name in names))
        return dict(line.split("=", 1) for line in text.splitlines())

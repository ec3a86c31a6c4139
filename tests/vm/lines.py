"""Safety lines on a CP2112, wired as docs/safety-wiring.md says."""

import json
import pathlib
import re

import guest
import simdev

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "safety-wiring.md"
LET_GO_S = 0.1  # of the deadman: two readings and more
BEATS = 40  # of the enable line in a second, of 50: one in two may be late before the relay of that page falls off
SAFETY = re.search(r"```toml\n(\[safety\]\n.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]


def take_hold(one, adapter):
    """Of the deadman, anew: it counts once it was let go of since the newest stop."""
    one.steps(adapter.step("press 2"), ("sleep", LET_GO_S), adapter.step("release 2"))


def plug_in(one):
    """The adapter, once the kernel of that guest has a chip of it."""
    adapter = simdev.Simdev(one, "cp2112", "--uhid", "cp2112")
    one.wait_for("ls -d /sys/bus/gpio/devices/gpiochip*/")
    return adapter


class GuestWithLines(guest.GuestTest):
    """Its `arm_kind`, of arms.py, whose configuration has the lines, and the adapter. Each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.adapter = cls.plug_in_lines()
        cls.arm = cls.arm_kind(cls.guest)

    @classmethod
    def plug_in_lines(cls):
        return plug_in(cls.guest)

    def take_hold(self, adapter=None):
        take_hold(self.guest, adapter or self.adapter)

    def status(self):
        return json.loads(self.guest.run("thimble status --json"))

    def wait_until(self, path, value):
        """The daemon's status says so: the part of it where that stands."""
        try:
            return json.loads(self.guest.wait_for_module("status_until", path, value))
        except guest.GuestError as error:
            raise AssertionError(f"{error}\n{self.guest.ask('journalctl -u thimbled | tail -30')[1]}") from None

    def wait_until_enable_beats(self):
        self.wait_until("safety.state", "free")
        self.wait_until("safety.is_enable_beating", "true")

    def beats(self, adapter=None, during=()):
        """Changes of the enable line during those steps and in the second after them."""
        look = (adapter or self.adapter).step("status")
        looks = self.guest.steps(look, *during, ("sleep", 1), look)
        first, last = (json.loads(line)["readings"]["changes_3"] for line in (looks[0], looks[-1]))
        return last - first

"""Safety lines on a CP2112, wired as docs/safety-wiring.md says."""

import pathlib
import re

import simdev

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "safety-wiring.md"
SAFETY = re.search(r"```toml\n(\[safety\]\n.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]


def plug_in(guest):
    """The adapter, once the kernel has a chip of it."""
    adapter = simdev.Simdev(guest, "cp2112", "--uhid", "cp2112")
    guest.wait_for("ls -d /sys/bus/gpio/devices/gpiochip*/")
    return adapter

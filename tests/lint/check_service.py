#!/usr/bin/env python3
"""Units of systemd/: exposure as shipped, judged by systemd-analyze, and what real time, devices and restarts need.

Needs systemd-analyze (package systemd); whether the daemon works within the sandbox is tested in the guest (tests/vm).
"""

import pathlib
import re
import subprocess

import cpp_source

FOLDER = "systemd/"
MAX_EXPOSURE = 1.5
_EXPOSURE = re.compile(r"Overall exposure level for \S+: ([0-9.]+)")

# What a service with devices and real time must say, and why.
NEEDS = {
    "Type=notify": "systemd must wait for READY",
    "NotifyAccess=main": "nobody else may feed the watchdog",
    "User=thimble": "not root, and not a user that others share",
    "DevicePolicy=closed": "no device but those named",
    "DeviceAllow=char-hidraw rw": "arms on HID",
    "DeviceAllow=char-usb_device rw": "arms on bare USB",
    "DeviceAllow=char-gpiochip rw": "e-stop and deadman",
    "Wants=modprobe@hid.service modprobe@usbcore.service": "DeviceAllow= knows only classes that are there at the start",
    "After=modprobe@hid.service modprobe@usbcore.service": "DeviceAllow= knows only classes that are there at the start",
    "LimitMEMLOCK=infinity": "paged memory stops the servo",
    "IPAddressDeny=any": "as shipped it talks to this host only",
}
_NEEDS_A_VALUE = {
    "WatchdogSec": "a daemon that hangs must end",
    "LimitRTPRIO": "the servo threads ask for SCHED_FIFO",
    "LimitRTTIME": "a servo that spins must not take the machine along",
    "MemoryMax": "a volume that is too large must not take the machine along",
}
_REFUSED = {
    re.compile(r"^RestrictRealtime=(?:yes|true|1|on)$"): "it forbids SCHED_FIFO",
    re.compile(r"^PrivateDevices=(?:yes|true|1|on)$"): "it hides every arm",
    re.compile(r"^SystemCallFilter=~.*@resources"): "it takes sched_setscheduler away",
    re.compile(r"^CPUSchedulingPolicy="): "it would make every thread of the daemon a real-time one",
    re.compile(r"^IPAddressAllow=(?!localhost$)"): "other hosts are let in by thimbled-lan.conf only",
}


def exposure(path):
    """As systemd-analyze sees the file; raises OSError where it cannot be run."""
    result = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager", str(path)],
                            capture_output=True, text=True, timeout=60, check=False)
    found = _EXPOSURE.search(result.stdout)
    if not found:
        raise OSError(f"systemd-analyze judged nothing: {result.stderr.strip()[-200:]}")
    return float(found.group(1))


def check_text(path, text, breaches):
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith(("#", ";"))]
    for line, why in NEEDS.items():
        if line not in lines:
            breaches.append(f"{path}: needs {line}: {why}")
    for key, why in _NEEDS_A_VALUE.items():
        values = [line.partition("=")[2] for line in lines if line.startswith(f"{key}=")]
        if len(values) != 1 or values[0] in ("", "0", "infinity"):
            breaches.append(f"{path}: needs {key}= with a bound: {why}")
    for pattern, why in _REFUSED.items():
        for line in filter(pattern.match, lines):
            breaches.append(f"{path}: {line}: {why}")


def check(root):
    breaches = []
    path = f"{FOLDER}thimbled.service"
    if path not in cpp_source.tree_files(root):
        return [f"{path}: is missing"]
    check_text(path, cpp_source.read(root, path), breaches)
    found = exposure(pathlib.Path(root, path).resolve())
    if found > MAX_EXPOSURE:
        breaches.append(f"{path}: exposure {found} by systemd-analyze security, {MAX_EXPOSURE} is the most; run it on "
                        "the file to see which setting costs what")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

#!/usr/bin/env python3
"""Units of systemd/: exposure as shipped, judged by systemd-analyze, and what real time, devices and restarts need.

Needs systemd-analyze (package systemd); whether the daemon works within the sandbox is tested in the guest (tests/vm).
"""

import pathlib
import re
import subprocess
import typing

import cpp_source

FOLDER = "systemd/"
BUSES = "hal/linux/"
_EXPOSURE = re.compile(r"Overall exposure level for \S+: ([0-9.]+)")

# What hal/linux opens, by the words with which it looks for the node, and why. A class that the unit does not name is refused on
# a machine where the packages are installed, and nowhere else.
NODES = {
    "hidraw": ("DeviceAllow=char-hidraw rw", "arms on HID"),
    "usbmisc": ("DeviceAllow=char-usb r", "the way out to an arm on HID"),
    "usb": ("DeviceAllow=char-usb_device rw", "arms on bare USB"),
    "tty": ("DeviceAllow=char-ttyACM rw", "arms on USB serial"),
    "gpiochip": ("DeviceAllow=char-gpiochip rw", "e-stop and deadman"),
    "/dev/cpu_dma_latency": ("DeviceAllow=/dev/cpu_dma_latency rw", "a processor that sleeps deeply wakes late"),
}
# systemd.resource-control(5), DevicePolicy=closed: this one is let through as it is.
_ALWAYS_THERE = ("/dev/null",)
NODE_WORDS = re.compile(r"""
    (?:_match_subsystem(?:_devtype)?|\badd_places)\([^;"]*"(?P<subsystem>\w+)"
    | "(?P<node>/dev/\w+)"
    | starts_with\("(?P<name>gpio\w+)"\)""", re.VERBOSE)

# What a service with devices and real time must say, and why.
_DAEMON_NEEDS = dict(NODES.values()) | {
    "Type=notify": "systemd must wait for READY",
    "NotifyAccess=main": "nobody else may feed the watchdog",
    "User=thimble": "not root, and not a user that others share",
    "Restart=on-failure": "a daemon that ended by itself must come back",
    "RestartPreventExitStatus=2": "a configuration that is wrong would be wrong again",
    "DevicePolicy=closed": "no device but those named",
    "Wants=modprobe@hid.service modprobe@usbcore.service modprobe@cdc_acm.service": "DeviceAllow= knows only classes that are there at the start",
    "After=modprobe@hid.service modprobe@usbcore.service modprobe@cdc_acm.service": "DeviceAllow= knows only classes that are there at the start",
    "LimitMEMLOCK=infinity": "paged memory stops the servo",
    "IPAddressDeny=any": "as shipped it talks to this host only",
    "Wants=thimble-guard.socket": "an arm that needs a guard is refused without one",
    "After=thimble-guard.socket": "it is asked for when the first arm is opened",
    "Wants=thimble-board.socket": "the packages start nothing by themselves",
    "After=thimble-board.socket": "a board is asked for as soon as its world runs",
}
_DAEMON_BOUNDS = {
    "WatchdogSec": "a daemon that hangs must end",
    "LimitRTPRIO": "the servo threads ask for SCHED_FIFO",
    "LimitRTTIME": "a servo that spins must not take the machine along",
    "MemoryMax": "a volume that is too large must not take the machine along",
}
_NO_REAL_TIME = {
    re.compile(r"^RestrictRealtime=(?:yes|true|1|on)$"): "it forbids SCHED_FIFO",
    re.compile(r"^SystemCallFilter=~.*@resources"): "it takes sched_setscheduler away",
    re.compile(r"^CPUSchedulingPolicy="): "it would make every thread a real-time one",
}
_DAEMON_REFUSED = _NO_REAL_TIME | {
    re.compile(r"^PrivateDevices=(?:yes|true|1|on)$"): "it hides every arm",
    re.compile(r"^IPAddressAllow=(?!localhost$)"): "other hosts are let in by thimbled-lan.conf only",
}
_GUARD_NEEDS = {
    "StandardInput=socket": "it is told of its arm over the connection that started it",
    "PrivateDevices=yes": "the arm's node comes open, and it needs no other",
    "PrivateNetwork=yes": "it talks to nobody but the daemon",
    "Before=thimbled.service": "when the machine goes down the daemon ends first",
    "LimitMEMLOCK=infinity": "paged memory stops the guard",
}
_GUARD_BOUNDS = {
    "LimitRTPRIO": "it asks for SCHED_FIFO above the servos",
    "LimitRTTIME": "a guard that spins must not take the machine along",
}
_GUARD_REFUSED = _NO_REAL_TIME | {
    re.compile(r"^(?:PartOf|BindsTo|Requires|StopWhenUnneeded)="): "it must outlive the daemon",
    re.compile(r"^DeviceAllow="): "it opens nothing",
}

_BOARD_NEEDS = {
    "StandardInput=socket": "it answers the connection that started it",
    "CapabilityBoundingSet=CAP_SYS_ADMIN": "to enable a device of PCI needs this, and nothing it does needs more",
    "PrivateDevices=yes": "what it opens is of sysfs",
    "PrivateNetwork=yes": "it talks to nobody but the daemon",
    "SystemCallFilter=~@privileged @resources": "the right that it has is that of mounting, too",
}
_BOARD_BOUNDS = {
    "RuntimeMaxSec": "one that hangs keeps a connection of the socket",
    "TimeoutStopSec": "one that does not end when told to, likewise",
    "MemoryMax": "it maps one board",
}
_BOARD_REFUSED = {
    re.compile(r"^DeviceAllow="): "it opens none",
    re.compile(r"^Type=oneshot$"): "RuntimeMaxSec= bounds none of those",
}


class Unit(typing.NamedTuple):
    needs: dict
    bounds: dict
    refused: dict
    max_exposure: float


LIMITS = "daemon/config/load.hpp"
_MOST_ARMS = re.compile(r"kMaxArms = ([0-9]+);")
# Of each arm: its servo, up to three of its bus, and one of a link's serial line; the rest is the daemon's own, lines of worlds among it (decision 0511).
_THREADS_OF_AN_ARM, _OTHER_THREADS = 5, 32
GUARD_SOCKET = FOLDER + "thimble-guard.socket"

UNITS = {
    "thimbled.service": Unit(_DAEMON_NEEDS, _DAEMON_BOUNDS, _DAEMON_REFUSED, 1.5),
    "thimble-guard@.service": Unit(_GUARD_NEEDS, _GUARD_BOUNDS, _GUARD_REFUSED, 0.5),
    "thimble-board@.service": Unit(_BOARD_NEEDS, _BOARD_BOUNDS, _BOARD_REFUSED, 1.5),
}


def exposure(path):
    """As systemd-analyze sees the file; raises OSError where it cannot be run."""
    result = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager", str(path)],
                            capture_output=True, text=True, timeout=60, check=False)
    found = _EXPOSURE.search(result.stdout)
    if not found:
        raise OSError(f"systemd-analyze judged nothing: {result.stderr.strip()[-200:]}")
    return float(found.group(1))


def check_text(path, text, unit, breaches):
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith(("#", ";"))]
    for line, why in unit.needs.items():
        if line not in lines:
            breaches.append(f"{path}: needs {line}: {why}")
    for key, why in unit.bounds.items():
        values = [line.partition("=")[2] for line in lines if line.startswith(f"{key}=")]
        if len(values) != 1 or values[0] in ("", "0", "infinity"):
            breaches.append(f"{path}: needs {key}= with a bound: {why}")
    for pattern, why in unit.refused.items():
        for line in filter(pattern.match, lines):
            breaches.append(f"{path}: {line}: {why}")


def check_devices(root, files, path, text, breaches):
    """A node that hal/linux looks for has a line in the unit, and a line there has a node."""
    lines = {line for line, _ in NODES.values()}
    for line in text.splitlines():
        if line.startswith("DeviceAllow=") and line.strip() not in lines:
            breaches.append(f"{path}: {line.strip()}: for nothing that {BUSES} opens; see NODES in check_service.py")
    for source in files:
        if not source.startswith(BUSES) or not source.endswith(cpp_source.CPP_SUFFIXES):
            continue
        code = cpp_source.without_comments(cpp_source.read(root, source), keep_strings=True)
        for found in NODE_WORDS.finditer(code):
            word = found[found.lastgroup]
            if word not in NODES and word not in _ALWAYS_THERE:
                breaches.append(f"{source}:{cpp_source.line_of(code, found.start())}: {word}: which DeviceAllow= of {path} lets "
                                "the daemon open it? Say so in NODES of check_service.py")


def check_unit(root, path, unit, breaches):
    check_text(path, cpp_source.read(root, path), unit, breaches)
    found = exposure(pathlib.Path(root, path).resolve())
    if found > unit.max_exposure:
        breaches.append(f"{path}: exposure {found} by systemd-analyze security, {unit.max_exposure} is the most; run it "
                        "on the file to see which setting costs what")


def check_room(root, files, breaches):
    """As many arms as a configuration may have find threads and guards."""
    service = FOLDER + "thimbled.service"
    if not {LIMITS, GUARD_SOCKET, service} <= set(files):
        return
    most = int(_MOST_ARMS.search(cpp_source.read(root, LIMITS))[1])
    for path, key, least in ((service, "TasksMax", most * _THREADS_OF_AN_ARM + _OTHER_THREADS), (GUARD_SOCKET, "MaxConnections", 2 * most)):
        found = re.search(rf"^{key}=([0-9]+)$", cpp_source.read(root, path), re.MULTILINE)
        if not found or int(found[1]) < least:
            breaches.append(f"{path}: needs {key}= of at least {least}: {LIMITS} lets a configuration have {most} arms")


def check(root):
    breaches = []
    files = cpp_source.tree_files(root)
    check_room(root, files, breaches)
    for name, unit in UNITS.items():
        path = FOLDER + name
        if path in files:
            check_unit(root, path, unit, breaches)
            if unit.needs is _DAEMON_NEEDS:
                check_devices(root, files, path, cpp_source.read(root, path), breaches)
        else:
            breaches.append(f"{path}: is missing")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

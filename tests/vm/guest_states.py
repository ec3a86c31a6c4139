"""Guests that begin where an earlier one was saved: with the packages installed, and switched off, or running and settled.

A boot and an installation cost minutes of an emulated processor, and end in the same for the same packages. They are done once,
by whoever needs them first, and kept beside the image (decision 0376).
"""

import contextlib
import subprocess
import sys

import guest_image
import machine
import qmp
import state_cache

RECIPE = 2  # to be counted up when install() or settle() does something else, or the machine has other devices
INSTALLED = ("thimbled", "thimble")
KEPT = 3  # sets of packages; with every pace one has 2 GB
SETTLE_S = 300


def key():
    """Of all that decides what is saved but kernel and pace, which name the parts."""
    version = subprocess.run(["qemu-system-x86_64", "--version"], stdout=subprocess.PIPE, check=True).stdout
    debs = [path for name in INSTALLED for path in machine.DEBS.glob(f"{name}_*.deb")]
    return state_cache.key((RECIPE, guest_image.key(), version, *(machine.words("", pace) for pace in machine.PACES)), debs)


def can_be_offered(one):
    """From now on devices can be."""
    one.run("modprobe -a uhid vhci-hcd cdc-acm")


def settle(one):
    """Until nothing of the start is under way any more, the arm of the configuration that comes with the package is simulated, and devices can be offered."""
    one.run("systemctl is-system-running --wait", SETTLE_S)
    one.wait_for("systemctl show thimbled -p StatusText | grep -qi 'right active'", SETTLE_S)
    can_be_offered(one)


def install(folder):
    with machine.Guest() as one:
        one.install(*INSTALLED)
        one.save_disk(folder / "disk.qcow2")


@contextlib.contextmanager
def installed():
    """The entry of these packages, whose part `installed` is there, and the disk in it."""
    with state_cache.entry(guest_image.image_folder() / "states", key(), KEPT) as entry:
        yield entry, state_cache.part(entry, "installed", install) / "disk.qcow2"


def boot(kernel, pace, devices=()):
    """A guest that has the packages and was just switched on. `devices`: more of them, in words for QEMU."""
    with installed() as (_, disk):
        return machine.Guest(kernel, pace=pace, disk=disk, devices=devices)


def saved(entry, disk, kernel, pace):
    """The part of a guest that was switched on and has settled."""
    def save(folder):
        with machine.Guest(kernel, pace=pace, disk=disk) as one:
            settle(one)
            one.save_state(folder / "disk.qcow2", folder / "memory")

    return state_cache.part(entry, f"{kernel}-{pace.name}", save)


def resume(kernel, pace):
    """A guest that has the packages and was switched on a while ago."""
    with installed() as (entry, disk):
        part = saved(entry, disk, kernel, pace)
        return machine.Guest(kernel, pace=pace, disk=part / "disk.qcow2", memory=part / "memory")


def start(kernel, pace):
    """A guest that has the packages: just switched on where its time passes as it comes; a while ago where it is counted, and devices can be
    offered to it."""
    if not pace.is_counted:
        return boot(kernel, pace)
    try:
        return resume(kernel, pace)
    except (OSError, machine.GuestError, qmp.QmpError) as error:
        print(f"No saved guest, this one boots: {error}", file=sys.stderr)
        one = boot(kernel, pace)
        can_be_offered(one)
        return one


def prepare(pace):
    """Makes what start() needs, where it is not there, and says what it costs."""
    with installed() as (entry, disk):
        part = saved(entry, disk, "amd64", pace) if pace.is_counted else disk.parent
    print(f"{part}: {sum(path.stat().st_blocks for path in part.iterdir()) // 2048} MiB")

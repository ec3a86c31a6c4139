"""Guests that begin where an earlier one was saved: without the packages, running; with them, running and settled, or switched off.

A boot and an installation cost a minute of an emulated processor, and end in the same for the same image and packages. They are done once,
by whoever needs them first, and kept beside the image (decisions 0376, 0396).
"""

import contextlib
import subprocess
import sys

import guest_image
import machine
import qmp
import state_cache

RECIPE = 3  # to be counted up when install() or settle() does something else, or the machine has other devices
INSTALLED = ("thimbled", "thimble")
KERNEL = "amd64"
KEPT_MACHINES = 2
KEPT = 3  # sets of packages; one has 0.2 GB
SETTLE_S = 300
BARE = "bare"


def machine_key():
    """Of all that decides what is saved but packages, kernel and pace."""
    version = subprocess.run(["qemu-system-x86_64", "--version"], stdout=subprocess.PIPE, check=True).stdout
    return state_cache.key((RECIPE, guest_image.key(), version, *(machine.words("", pace) for pace in machine.PACES)), [])


def packages_key():
    return state_cache.key((), [path for name in INSTALLED for path in machine.DEBS.glob(f"{name}_*.deb")])


def can_be_offered(one):
    """From now on devices can be. What USB/IP sends passes through the kernel's loopback, and now and then is left to its ksoftirqd: an ordinary
    process, behind which a frame of a bus must not wait (decision 0409)."""
    one.run("modprobe -a uhid vhci-hcd cdc-acm; pgrep ^ksoftirqd/ | xargs -n 1 chrt -f -p 1")


def install(one):
    """With the worst that may happen between the two steps, for vm.udev: udev reads the rules while the package is not configured yet."""
    debs = " ".join(f"/run/debs/{name}_*.deb" for name in INSTALLED)
    one.run(f"export DEBIAN_FRONTEND=noninteractive; dpkg --unpack {debs}\n"
            "sleep 4; udevadm trigger --settle /sys/class/mem/null\n"
            "dpkg --configure --pending", SETTLE_S)


def settle(one):
    """Until nothing of the start is under way any more, the arm of the configuration that comes with the package is simulated, and devices can be offered."""
    one.run("systemctl is-system-running --wait", SETTLE_S)
    one.wait_for("systemctl show thimbled -p StatusText | grep -qi 'right active'", SETTLE_S)
    can_be_offered(one)


@contextlib.contextmanager
def of_this_machine():
    """The entry of guests that are alike but for packages. All disks in it lie one on the other, so it goes as a whole."""
    with state_cache.entry(guest_image.image_folder() / "saved", machine_key(), KEPT_MACHINES) as entry:
        yield entry


@contextlib.contextmanager
def of_these_packages():
    """Its entry, and in it that of these packages."""
    with of_this_machine() as alike, state_cache.entry(alike / "packages", packages_key(), KEPT) as entry:
        yield alike, entry


def save(one, folder):
    one.save_state(folder / "disk.qcow2", folder / "memory")


def go_on(part, pace, **words):
    """Where save() wrote."""
    return machine.Guest(KERNEL, pace=pace, disk=part / "disk.qcow2", memory=part / "memory", **words)


def bare_part(alike):
    """Of a guest that has no packages and counts."""
    def make(folder):
        with machine.Guest(KERNEL, pace=machine.COUNTED) as one:
            one.run("systemctl is-system-running --wait", SETTLE_S)
            save(one, folder)

    return state_cache.part(alike, BARE, make)


def counted_part(alike, entry):
    """Of one that has been given them since."""
    def make(folder):
        with go_on(bare_part(alike), machine.COUNTED) as one:
            install(one)
            settle(one)
            save(one, folder)

    return state_cache.part(entry, machine.COUNTED.name, make)


def disk_part(alike, entry):
    """Of the same, switched off."""
    def make(folder):
        with go_on(counted_part(alike, entry), machine.COUNTED) as one:
            one.save_disk(folder / "disk.qcow2")

    return state_cache.part(entry, machine.AS_IT_COMES.name, make)


def part(alike, entry, pace):
    """What a guest of this pace begins with."""
    return counted_part(alike, entry) if pace.is_counted else disk_part(alike, entry)


def boot(kernel, pace):
    """A guest that has the packages and was just switched on."""
    with of_these_packages() as (alike, entry):
        return machine.Guest(kernel, pace=pace, disk=disk_part(alike, entry) / "disk.qcow2")


def resume(pace):
    """A guest that has the packages and was switched on a while ago."""
    with of_these_packages() as (alike, entry):
        return go_on(part(alike, entry, pace), pace)


def start_bare(share=machine.DEBS):
    """A guest that counts, has no packages and was switched on a while ago. `share`: in place of the folder of packages."""
    try:
        with of_this_machine() as alike:
            return go_on(bare_part(alike), machine.COUNTED, share=share)
    except (OSError, machine.GuestError, qmp.QmpError) as error:
        print(f"No saved guest, this one boots: {error}", file=sys.stderr)
        return machine.Guest(KERNEL, pace=machine.COUNTED, share=share)


def start(kernel, pace):
    """A guest that has the packages: just switched on where its time passes as it comes; a while ago where it is counted, and devices can be
    offered to it."""
    if not pace.is_counted:
        return boot(kernel, pace)
    try:
        return resume(pace)
    except (OSError, machine.GuestError, qmp.QmpError) as error:
        print(f"No saved guest, this one boots: {error}", file=sys.stderr)
        one = boot(kernel, pace)
        can_be_offered(one)
        return one


def prepare(name):
    """Makes what start() of that pace or start_bare() needs, where it is not there, and says what it costs."""
    with of_these_packages() as (alike, entry):
        made = bare_part(alike) if name == BARE else part(alike, entry, {pace.name: pace for pace in machine.PACES}[name])
    print(f"{made}: {sum(path.stat().st_blocks for path in made.iterdir()) // 2048} MiB")

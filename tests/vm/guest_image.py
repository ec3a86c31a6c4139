#!/usr/bin/env python3
"""Makes the root of the test guest: a stock Debian 12 with its stock kernels, kept in a cache outside the build folder.

usage: guest_image.py    (prints the folder that has it: disk.img, a kernel and an initrd of each flavour, and libgpiod2, decision 0518)

The cache is $XDG_CACHE_HOME/thimble/vm or ~/.cache/thimble/vm; its key is all that decides what the root is: the packages, what is left out of
them, and the files of tests/vm/guest that go into it. It works as root; for others mmdebstrap takes a user namespace or fakechroot.
"""

import fcntl
import hashlib
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
RECIPE = 1  # to be counted up when make_beside(), make_tree() or make_disk() does something else
SUITE = "bookworm"
KERNELS = {"amd64": "linux-image-amd64", "rt-amd64": "linux-image-rt-amd64"}
PACKAGES = sorted({
    "systemd", "systemd-sysv", "udev", "dbus", "kmod", "procps", "iproute2", "python3", "acl", "adduser", "usbip", "strace",
    # What the packages under test depend on: the guest has no network.
    "libboost-json1.81.0", "libspdlog1.10-fmt9", "libusb-1.0-0", "libhidapi-hidraw0", "libgpiod2", "libsodium23",
    "libudev1", "zlib1g",
    *KERNELS.values()})
# What a module of the guest's kernel is compiled with, which is not in the guest (decision 0517).
BESIDE_PACKAGES = ("linux-headers-amd64", "linux-source-6.1", "make", "xz-utils")
# Modules for hardware that the guest never has, and what nobody reads in it: three quarters of the size.
LEFT_OUT = [f"/lib/modules/*/kernel/{folder}/*" for folder in (
    "sound", "drivers/gpu", "drivers/media", "drivers/net", "drivers/infiniband", "drivers/staging", "drivers/scsi",
    "drivers/iio")] + ["/usr/share/locale/*", "/usr/share/man/*"] + [
    # The names of all hardware there is, which each installation of a package with a list of its own compiles anew.
    "/lib/udev/hwdb.d/20-*.hwdb"]
BAKED_IN = ("agent.py", "vm-agent.service", "initramfs.hook", "gpio_sim.sh", "libgpiod2.sh")
DISK = "3G"  # sparse
LIBGPIOD2 = "libgpiod2"
PROGRAMS = ("mmdebstrap", "mke2fs", "qemu-system-x86_64")


def key():
    digest = hashlib.sha256(repr((RECIPE, SUITE, PACKAGES, BESIDE_PACKAGES, LEFT_OUT, DISK)).encode())
    for name in BAKED_IN:
        digest.update((HERE / "guest" / name).read_bytes())
    return digest.hexdigest()[:16]


def cache_folder():
    home = pathlib.Path(os.environ.get("HOME") or "/tmp")
    return pathlib.Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "thimble" / "vm"


def image_folder():
    """Where the image is, or will be."""
    return cache_folder() / key()


def missing():
    """Programs without which there is no guest."""
    path = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
    return [program for program in PROGRAMS if not shutil.which(program, path=path)]


def bootstrap(target, packages, options, hooks):
    subprocess.run(["mmdebstrap", "--quiet", "--variant=minbase", "--mode=root" if os.geteuid() == 0 else "--mode=auto",
                    f"--include={','.join(packages)}", *options, *(f"--customize-hook={hook}" for hook in hooks), SUITE, target],
                   check=True, stdout=sys.stderr)


def make_beside(folder):
    """What is made in a Debian that is thrown away: gpio_sim.ko, and libgpiod2, which may be missing: one test is then without it."""
    hooks = [hook for name in ("gpio_sim.sh", "libgpiod2.sh") for hook in (
        f"upload {shlex.quote(str(HERE / 'guest' / name))} /{name}", f'chroot "$1" sh /{name}')]
    hooks[-1] += " || echo 'guest_image.py: there is no libgpiod 2 for the test that takes it'; mkdir -p \"$1/libgpiod2\""
    bootstrap("/dev/null", BESIDE_PACKAGES, (), (
        *hooks, f"copy-out /gpio_sim.ko /libgpiod2 {shlex.quote(str(folder))}"))


def make_tree(tarball, boot, module):
    guest = HERE / "guest"
    options = [f"--essential-hook=sh {shlex.quote(str(guest / 'initramfs.hook'))} \"$1\"",
               *(f"--dpkgopt=path-exclude={pattern}" for pattern in LEFT_OUT)]
    bootstrap(tarball, PACKAGES, options, (
        'mkdir "$1/usr/lib/thimble-vm"',
        f"upload {shlex.quote(str(guest / 'agent.py'))} /usr/lib/thimble-vm/agent.py",
        f"upload {shlex.quote(str(module))} /usr/lib/thimble-vm/gpio_sim.ko",
        f"upload {shlex.quote(str(guest / 'vm-agent.service'))} /etc/systemd/system/vm-agent.service",
        'chroot "$1" systemctl enable vm-agent.service',
        'echo "LABEL=root / ext4 defaults,noatime 0 0" > "$1/etc/fstab"',
        'echo guest > "$1/etc/hostname"',
        f"copy-out /boot {shlex.quote(str(boot))}"))


def make_disk(tarball, disk, work):
    """The tarball as a file system, without mounting anything. The guest's kernel fills /dev."""
    script = ('set -e; mkdir "$3/root"; tar -x -C "$3/root" --exclude=./dev -f "$1"; mkdir "$3/root/dev"; '
              f'PATH="$PATH:/usr/sbin:/sbin" mke2fs -q -t ext4 -d "$3/root" -L root "$2" {DISK}; rm -rf "$3/root"')
    owner = [] if os.geteuid() == 0 else ["fakeroot"]
    subprocess.run([*owner, "bash", "-c", script, "-", tarball, disk, work], check=True, stdout=sys.stderr)


def take_kernels(boot, folder):
    for flavour in KERNELS:
        for kind, name in (("vmlinuz", "vmlinuz"), ("initrd.img", "initrd")):
            found = [path for path in sorted(boot.glob(f"boot/{kind}-*-{flavour}"))
                     if flavour != "amd64" or not path.name.endswith("-rt-amd64")]
            shutil.copyfile(found[-1], folder / f"{name}-{flavour}")


def make():
    """The folder of the image, made when it is not there; earlier ones go."""
    folder = image_folder()
    cache = cache_folder()
    cache.mkdir(parents=True, exist_ok=True)
    with open(cache / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if folder.exists():
            return folder
        for earlier in cache.iterdir():
            if earlier.is_dir():
                shutil.rmtree(earlier)
        with tempfile.TemporaryDirectory(dir=cache) as work:
            work = pathlib.Path(work)
            work.chmod(0o755)
            for name in ("boot", "image", "beside"):
                (work / name).mkdir()
            make_beside(work / "beside")
            make_tree(work / "root.tar", work / "boot", work / "beside" / "gpio_sim.ko")
            make_disk(work / "root.tar", work / "image" / "disk.img", work)
            take_kernels(work / "boot", work / "image")
            (work / "beside" / "libgpiod2").rename(work / "image" / LIBGPIOD2)
            (work / "image").rename(folder)
    return folder


if __name__ == "__main__":
    if missing():
        sys.exit(f"guest_image.py: not installed: {', '.join(missing())}")
    print(make())

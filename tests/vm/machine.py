"""A guest under QEMU, started from the cached image, which it does not change; and the base of the tests in it."""

import base64
import contextlib
import gzip
import os
import pathlib
import select
import shutil
import socket
import subprocess
import tempfile
import time
import unittest

import guest_image

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parents[1] / "build"
DEBS = pathlib.Path(os.environ.get("THIMBLE_DEBS", BUILD / "deb"))
BIN = pathlib.Path(os.environ.get("THIMBLE_BIN", BUILD / "release" / "bin"))
# Waits are bounded, never asserted: an emulated machine beside other work boots in 10 s, or in 60.
BOOT_S = 400
COMMAND_S = 120


class GuestError(Exception):
    """The guest did not do what it was told; the message has its words."""


# With several processors that run as the host lets them. On a busy one an emulated timer is late: the kernel must neither take
# it for broken nor learn from it how fast the TSC is, or the guest's clock runs several times too fast.
AS_IT_COMES = ("-smp", "2", "-accel", "tcg,thread=multi"), "clocksource=acpi_pm tsc=unstable no_timer_check"


def counted(shift):
    """The guest's clock counts instructions, 2^shift ns each, and leaps over idle time: however busy the host is, nobody in the
    guest is late for it. For tests with a device that must be served in time; it runs in the guest, too."""
    return ("-smp", "1", "-accel", "tcg,thread=single", "-icount", f"shift={shift},sleep=off"), "clocksource=tsc tsc=reliable"


COUNTED = counted(2)  # fast enough for what has 1,000 frames a second


class Guest:
    """One virtual machine. Use as a context manager, or call close()."""

    def __init__(self, kernel="amd64", share=DEBS, pace=AS_IT_COMES):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thimble-vm-"))
        self.console = self.folder / "console"
        image = guest_image.image_folder()
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listener.bind(str(self.folder / "cmd"))
        listener.listen(1)
        command = [
            "setpriv", "--pdeathsig", "KILL",  # it ends with the test, whatever ends that
            "qemu-system-x86_64", "-nodefaults", "-display", "none", "-machine", "q35", "-m", "1024", *pace[0],
            # Never KVM: it is there on machines where it hangs. Under it all processors look alike.
            "-cpu", "qemu64,+ssse3,+sse4.1,+sse4.2,+popcnt",
            "-kernel", image / f"vmlinuz-{kernel}", "-initrd", image / f"initrd-{kernel}",
            "-append", f"root=LABEL=root rw console=ttyS0 quiet panic=-1 {pace[1]}",
            "-drive", f"file={image / 'disk.img'},format=raw,if=virtio,snapshot=on",
            "-serial", f"file:{self.console}",
            "-device", "virtio-serial-pci", "-chardev", f"socket,id=cmd,path={self.folder / 'cmd'}",
            "-device", "virtserialport,chardev=cmd,name=vm.cmd"]
        for tag, path in (("debs", share), ("tests", HERE / "guest"), ("bin", BIN)):
            command += ["-virtfs", f"local,path={path},mount_tag={tag},security_model=none,readonly=on"]
        with open(self.folder / "qemu.log", "wb") as log:
            self.process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=log)
        listener.settimeout(30)
        try:
            self.channel, _ = listener.accept()
        except OSError:
            words = self.words()
            self.close()
            raise GuestError(f"QEMU did not start: {words}") from None
        finally:
            listener.close()
        self.pending = b""
        with self.closed_on_failure():
            self.wait_until_up()

    @contextlib.contextmanager
    def closed_on_failure(self):
        try:
            yield
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.process.kill()
        self.process.wait()
        if hasattr(self, "channel"):
            self.channel.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def words(self):
        """The last of what console and emulator said."""
        texts = [path.read_bytes()[-2000:].decode(errors="replace")
                 for path in (self.console, self.folder / "qemu.log") if path.exists()]
        return "\n".join(texts)

    def wait_until_up(self):
        """Until the agent answers; then the folders of the host are mounted: packages, scripts of the guest, programs of the tests."""
        self.read_answer(BOOT_S)
        self.run("for tag in debs tests bin; do mkdir -p /run/$tag; mountpoint -q /run/$tag || "
                 "mount -t 9p -o trans=virtio,version=9p2000.L,ro $tag /run/$tag; done")

    def read_answer(self, timeout_s):
        end = time.monotonic() + timeout_s
        while b"\n" not in self.pending:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.channel], [], [], left)[0]:
                raise GuestError(f"no answer within {timeout_s} s; it said:\n{self.words()}")
            data = self.channel.recv(65536)
            if not data:
                raise GuestError(f"the guest is gone; it said:\n{self.words()}")
            self.pending += data
        line, self.pending = self.pending.split(b"\n", 1)
        status, _, printed = line.partition(b" ")
        return int(status), base64.b64decode(printed).decode(errors="replace")

    def ask(self, script, timeout_s=COMMAND_S):
        """Exit status of a bash script in the guest, as root, and what it printed."""
        self.channel.sendall(base64.b64encode(script.encode()) + b"\n")
        return self.read_answer(timeout_s)

    def run(self, script, timeout_s=COMMAND_S):
        """What it printed; it must succeed."""
        status, printed = self.ask(script, timeout_s)
        if status != 0:
            raise GuestError(f"status {status} of: {script}\n{printed}")
        return printed

    def fetch(self, path):
        """A file of the guest, in pieces: the port to it takes 32 KiB at once."""
        self.run(f"gzip -c {path} > /run/fetched")
        packed = b""
        while True:
            piece = base64.b64decode(self.run(f"tail -c +{len(packed) + 1} /run/fetched | head -c 15000 | base64"))
            packed += piece
            if not piece:
                return gzip.decompress(packed)

    def reboot(self):
        """The systemd way, so that services are stopped and started as ever."""
        self.ask("systemctl --no-block reboot")
        self.wait_until_up()

    def wait_for(self, script, timeout_s=COMMAND_S):
        """Until the script succeeds: its output. Polls, with a bound."""
        end = time.monotonic() + timeout_s
        while True:
            status, printed = self.ask(script)
            if status == 0:
                return printed
            if time.monotonic() > end:
                raise GuestError(f"never: {script}\n{printed}")
            time.sleep(0.3)

    def install(self, *names):
        """Packages of the share, as dpkg does it: their dependencies must be there."""
        return self.run("export DEBIAN_FRONTEND=noninteractive; dpkg -i " +
                        " ".join(f"/run/debs/{name}_*.deb" for name in names), timeout_s=300)


class GuestTest(unittest.TestCase):
    """A class of tests in one guest, in the order of their names."""

    kernel = "amd64"
    pace = AS_IT_COMES
    installs = ("thimbled", "thimble")

    @classmethod
    def setUpClass(cls):
        cls.guest = Guest(cls.kernel, pace=cls.pace)
        cls.addClassCleanup(cls.guest.close)
        if cls.installs:
            cls.guest.install(*cls.installs)

    @classmethod
    def properties(cls, *names, unit="thimbled.service"):
        text = cls.guest.run(f"systemctl show {unit} " + " ".join(f"-p {name}" for name in names))
        return dict(line.split("=", 1) for line in text.splitlines())

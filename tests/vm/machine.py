"""A guest under QEMU, started from the cached image, which it does not change."""

import base64
import contextlib
import json
import os
import pathlib
import select
import shlex
import shutil
import socket
import subprocess
import tempfile
import time
import typing
import zlib

import costs
import guest_image
import processors
import qmp

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parents[1] / "build"
DEBS = pathlib.Path(os.environ.get("THIMBLE_DEBS", BUILD / "deb"))
BIN = pathlib.Path(os.environ.get("THIMBLE_BIN", BUILD / "release" / "bin"))
# Waits are bounded, never asserted: an emulated machine beside other work boots in 10 s, or in 60.
BOOT_S = 400
START_S = 30
SAVE_S = 120
COMMAND_S = 120
SLOT_BYTES = 1 << 22  # of memory behind a BAR, at most


class GuestError(Exception):
    """The guest did not do what it was told; the message has its words."""


class Pace(typing.NamedTuple):
    """How the guest's time passes: a name for files, words for QEMU and words for the guest's kernel."""

    name: str
    machine: tuple
    kernel: str
    is_counted: bool = False


# Processors that run as the host lets them. On a busy one an emulated timer is late: the kernel must neither take it for broken nor
# learn from it how fast the TSC is, or the guest's clock runs several times too fast.
AS_HOST_LETS = "clocksource=acpi_pm tsc=unstable no_timer_check"
ONE_PROCESSOR = ("-smp", "1")
AS_IT_COMES = Pace("as-it-comes", (*ONE_PROCESSOR, "-accel", "tcg,thread=single"), AS_HOST_LETS)
ON_TWO = Pace("on-two", ("-smp", "2", "-accel", "tcg,thread=multi"), AS_HOST_LETS)


# What a kernel does for real processors, at each wake-up or copy (decision 0396); clearcpuid: no copying by "rep movs", one translated block a word.
CHEAP_TO_EMULATE = "mitigations=off psi=0 cpuidle.off=1 clearcpuid=112"


# The guest's clock counts instructions, a nanosecond each, and leaps over idle time: however busy the host is, nobody in the guest is late
# for it. For tests with a device that must be served in time; it runs in the guest, too. A slower guest costs more, not less: while a
# program runs, the device has its frames (decision 0382). No memory is gathered into huge pages: that takes the only processor for 1.5 ms
# (decision 0383).
COUNTED = Pace("counted", (*ONE_PROCESSOR, "-accel", "tcg,thread=single", "-icount", "shift=0,sleep=off"),
               f"clocksource=tsc tsc=reliable transparent_hugepage=never {CHEAP_TO_EMULATE}", is_counted=True)
# The same a quarter as fast, on which nothing is left to spare: it goes on from where COUNTED was saved, and its clock, which is a count times four, leaps ahead then.
COUNTED_SLOWLY = COUNTED._replace(name="counted-slowly", machine=tuple(word.replace("shift=0", "shift=2") for word in COUNTED.machine))
PACES = (AS_IT_COMES, ON_TWO, COUNTED)


def words(kernel, pace):
    """The words for QEMU that make the machine what it is: a saved state fits only into the same."""
    return ("-nodefaults", "-no-shutdown", "-display", "none", "-machine", "q35", "-m", "1024", *pace.machine,
            # Never KVM: it is there on machines where it hangs. Under it all processors look alike.
            "-cpu", "qemu64,+ssse3,+sse4.1,+sse4.2,+popcnt",
            # Empty, for what put_into_slot() is given.
            "-device", f"pcie-root-port,id=free-slot,chassis=1,pref64-reserve={4 * SLOT_BYTES}",
            # norandmaps: what a program has translated lies where it lay before, and is not translated again (decision 0381).
            "-append", f"root=LABEL=root rw console=ttyS0 quiet panic=-1 norandmaps {pace.kernel}")


class Guest:
    """One virtual machine. Use as a context manager, or call close().

    It boots, from `disk`, a qcow2 file that save_disk() made, or from the image; or it goes on where save_state() wrote both.
    """

    def __init__(self, kernel="amd64", share=DEBS, pace=AS_IT_COMES, disk=None, memory=None):
        self.pace = pace
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thimble-vm-"))
        self.console = self.folder / "console"
        image = guest_image.image_folder()
        self.processor, words_before = processors.claim(image / "processors") if pace.machine[:2] == ONE_PROCESSOR else (None, ())
        command = [
            *words_before, "setpriv", "--pdeathsig", "KILL",  # it ends with the test, whatever ends that
            "qemu-system-x86_64", *words(kernel, pace),
            "-kernel", image / f"vmlinuz-{kernel}", "-initrd", image / f"initrd-{kernel}",
            "-drive", f"file={disk},format=qcow2,if=virtio,snapshot=on" if disk else
                      f"file={image / 'disk.img'},format=raw,if=virtio,snapshot=on",
            "-serial", f"file:{self.console}",
            "-chardev", f"socket,id=qmp,path={self.folder / 'qmp'}", "-mon", "chardev=qmp,mode=control",
            "-device", "virtio-serial-pci", "-chardev", f"socket,id=cmd,path={self.folder / 'cmd'}",
            "-device", "virtserialport,chardev=cmd,name=vm.cmd"]
        self.shares = (("debs", share), ("tests", HERE / "guest"), ("bin", BIN))
        for tag, path in self.shares:
            command += ["-virtfs", f"local,path={path},mount_tag={tag},security_model=none,readonly=on"]
        if memory:
            command += ["-incoming", f"exec:cat {shlex.quote(str(memory))}"]
        self.pending = b""
        with self.closed_on_failure():
            self.start(command)
            if memory:
                # It was saved while it was stopped.
                self.wait_until(lambda: self.monitor.execute("query-status")["status"] == "paused", "its state is not read")
                self.monitor.execute("cont")
            else:
                self.read_answer(BOOT_S)
            self.mount()

    def start(self, command):
        """QEMU, which connects to us."""
        with contextlib.ExitStack() as stack:
            listeners = []
            for name in ("qmp", "cmd"):
                listeners.append(stack.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)))
                listeners[-1].bind(str(self.folder / name))
                listeners[-1].listen(1)
                listeners[-1].settimeout(START_S)
            with open(self.folder / "qemu.log", "wb") as log:
                self.process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
            try:
                channels = [listener.accept()[0] for listener in listeners]
            except OSError:
                raise GuestError(f"QEMU did not start: {self.words()}") from None
        channels[0].settimeout(SAVE_S)
        self.monitor, self.channel = qmp.Monitor(channels[0]), channels[1]
        self.costs = costs.Costs(self.process)

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
        if hasattr(self, "process"):
            self.process.kill()
            self.process.wait()
        for end in ("monitor", "channel", "processor"):
            if getattr(self, end, None) is not None:
                getattr(self, end).close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def words(self):
        """The last of what console and emulator said."""
        texts = [path.read_bytes()[-2000:].decode(errors="replace")
                 for path in (self.console, self.folder / "qemu.log") if path.exists()]
        return "\n".join(texts)

    def mount(self):
        """The folders of the host: packages, scripts of the guest, programs of the tests."""
        self.send(b"mount", json.dumps([name for name, _ in self.shares]))
        status, printed = self.read_answer(COMMAND_S)
        if status != 0:
            raise GuestError(printed)

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
        self.costs.answered()
        line, self.pending = self.pending.split(b"\n", 1)
        status, _, printed = line.partition(b" ")
        return int(status), zlib.decompress(base64.b64decode(printed)).decode(errors="replace")

    def send(self, kind, request):
        self.costs.asked(request)
        self.channel.sendall(kind + b" " + base64.b64encode(request.encode()) + b"\n")

    def ask(self, script, timeout_s=COMMAND_S):
        """Exit status of a bash script in the guest, as root, and what it printed."""
        self.send(b"run", script)
        return self.read_answer(timeout_s)

    def run(self, script, timeout_s=COMMAND_S):
        """What it printed; it must succeed."""
        status, printed = self.ask(script, timeout_s)
        if status != 0:
            raise GuestError(f"status {status} of: {script}\n{printed}")
        return printed

    def ask_module(self, module, *words, timeout_s=COMMAND_S):
        """The same of the main() of a module of guest/."""
        self.send(b"call", json.dumps([module, *words]))
        return self.read_answer(timeout_s)

    def call(self, module, *words, timeout_s=COMMAND_S):
        """What it printed; it must succeed."""
        status, printed = self.ask_module(module, *words, timeout_s=timeout_s)
        if status != 0:
            raise GuestError(f"status {status} of {module} {' '.join(words)}\n{printed}")
        return printed

    def steps(self, *steps, timeout_s=COMMAND_S):
        """Those of guest/steps.py, in one go: the lines that they printed; each must succeed."""
        return self.call("steps", *map(json.dumps, steps), timeout_s=timeout_s).splitlines()

    def sleep(self, seconds):
        """By its clock."""
        self.steps(("sleep", seconds))

    def wait_for(self, script, timeout_s=COMMAND_S):
        """Until the script succeeds: its output. Polls, with a bound; mostly in the guest, where time that passes is cheaper than a question."""
        looks = f"for look in {{1..10}}; do said=$( {{ {script}\n}} 2>&1) && break; [ $look -lt 10 ] && sleep 0.1; done; status=$?; echo \"$said\"; exit $status"
        return self.poll(lambda: self.ask(looks), script, timeout_s)

    def wait_for_module(self, module, *words, timeout_s=COMMAND_S):
        """The same of the main() of a module of guest/."""
        return self.poll(lambda: self.ask_module(module, *words), " ".join((module, *words)), timeout_s)

    @staticmethod
    def poll(ask, name, timeout_s):
        end = time.monotonic() + timeout_s
        while True:
            status, printed = ask()
            if status == 0:
                return printed
            if time.monotonic() > end:
                raise GuestError(f"never: {name}\n{printed}")
            time.sleep(0.1)

    def put_into_slot(self, memory):
        """A device of PCI whose BAR 2 is this file of the host: its address."""
        self.monitor.execute("object-add", qom_type="memory-backend-file", id="board", size=memory.stat().st_size, share=True, mem_path=str(memory))
        self.monitor.execute("device_add", driver="ivshmem-plain", memdev="board", bus="free-slot")
        return self.wait_for("grep -lx 0x1110 /sys/bus/pci/devices/*/device").split("/")[-2]

    def install(self, *names, words=""):
        """Packages of the share, as dpkg does it: their dependencies must be there. `words`: for dpkg."""
        return self.run(f"export DEBIAN_FRONTEND=noninteractive; dpkg -i {words} " +
                        " ".join(f"/run/debs/{name}_*.deb" for name in names), timeout_s=300)

    def save_disk(self, path):
        """Switches it off, writes what its disk has that differs from the one below it, and ends."""
        self.ask("systemctl --no-block poweroff")
        self.wait_until(lambda: self.monitor.execute("query-status")["status"] == "shutdown", "it does not switch off")
        self.copy_disk(path)
        self.close()

    def save_state(self, disk, memory):
        """Writes its disk as it is, and all that is not on the disk, and ends."""
        # A folder that is mounted would keep the machine from being saved.
        self.run("sync; umount " + " ".join(f"/run/{name}" for name, _ in self.shares))
        self.monitor.execute("stop")
        self.copy_disk(disk)
        self.monitor.execute("migrate", uri=f"exec:cat > {shlex.quote(str(memory))}")
        self.wait_until(self.is_saved, "its state is not written")
        self.close()

    def copy_disk(self, path):
        try:
            self.monitor.copy_layer("virtio0", path)
        except (OSError, qmp.QmpError) as error:
            raise GuestError(f"its disk cannot be copied: {error}") from None

    def is_saved(self):
        progress = self.monitor.execute("query-migrate")
        if progress["status"] == "failed":
            raise GuestError(f"its state cannot be written: {progress.get('error-desc')}")
        return progress["status"] == "completed"

    def wait_until(self, condition, trouble):
        """Of QEMU; polls, with a bound."""
        end = time.monotonic() + SAVE_S
        try:
            while not condition():
                if time.monotonic() > end:
                    raise GuestError(f"{trouble} within {SAVE_S} s")
                time.sleep(0.05)
        except (OSError, qmp.QmpError) as error:
            raise GuestError(f"{trouble}: {error}; it said:\n{self.words()}") from None

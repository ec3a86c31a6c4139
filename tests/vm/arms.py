"""Simulated arms as the packaged daemon has them: plugged into the guest, named in its configuration, with a box to feel."""

import base64
import hashlib
import json
import random
import struct

import simdev

SERIAL = "VM-ARM-1"
FIRMWARE = "/etc/thimble/falcon.bin"
NEWTON_PER_COUNT = 0.00244  # nearly what the model has
PLUGIN = "/usr/local/lib/thimble/falcon_plugin.so"
BOX = """
world = "box"

[[world]]
name = "box"
source = "box:3"
workspace_m = 0.09
"""
# What the servo can do with least, and a quarter less to emulate than 1,000 (decision 0390): for tests that look at no time.
QUIET_HZ = 500
FULL_HZ = 1000
OWN_RATES = "own"
# In scripts of the guest: the daemon, and the thread that drives the arm.
PID = "$(systemctl show thimbled -p MainPID --value)"
SERVO = f"$(ps -L -o lwp=,comm= -p {PID} | awk '$2 == \"servo-right\" {{print $1}}')"


# How a HID arm comes to the kernel.
WAYS = {"uhid": ("--uhid",), "usb": ("--vhci",), "usbip": ("--usbip", simdev.PORT)}


class Arm(simdev.Simdev):
    """`words`: in the configuration, that say which one it is; `daemon_words`: what else stands there, first of all; `rate_hz`: of the servo."""

    words = ""
    daemon_words = ""
    box = BOX
    rate_hz = QUIET_HZ

    def configure(self, rate_hz=None):
        """The daemon starts anew with it alone. OWN_RATES: each arm has that of its driver, as where nobody says one."""
        rate = "" if rate_hz == OWN_RATES else f"rate_hz = {rate_hz or self.rate_hz}\n"
        text = (f'{self.daemon_words}\n[servo]\n{rate}realtime = "best-effort"\n\n'
                f'[[arm]]\nname = "right"\n{self.words}{self.box}')
        self.guest.run(f"cat > /etc/thimble/thimble.toml <<'E'\n{text}E\nudevadm settle; systemctl restart thimbled")

    def plug(self):
        """Into the kernel; also again, after the verb plug."""
        self.attach()

    def activate(self):
        simdev.wait_for_state(self.guest, "calibrating")
        self.calibrate()
        simdev.wait_for_state(self.guest, "active")

    def bring_back(self):
        """Plugged in again after it was driven: calibrated, it waits for a clear. What the status says of it then."""
        simdev.wait_for_state(self.guest, "calibrating")
        self.calibrate()
        return json.loads(simdev.wait_for_state(self.guest, "fault"))

    def clear(self):
        self.guest.run("thimble clear-fault right")
        simdev.wait_for_state(self.guest, "active")

    def resume(self):
        self.bring_back()
        self.clear()


class HidArm(Arm):
    """Of the PHANToM family; `way`: of WAYS. `is_named`: in the daemon's configuration, or its caller does that. `model`, and `ids`: what its controller says that it is."""

    model = "phantom-vintage"
    ids = "1234:0006"

    def __init__(self, guest, way="uhid", rate_hz=QUIET_HZ, *, is_named=True):
        super().__init__(guest, "arm", *WAYS[way], "--serial", SERIAL, self.model)
        self.words = f'device = "hid:{SERIAL}"\nmodel = "{self.model}"\namplifier_max_a = 3.0'
        self.way = way
        self.rate_hz = rate_hz
        self.plug()
        if is_named:
            self.configure()

    def plug(self):
        if self.way != "uhid":
            self.attach()
        # The node, and its rule, which may come a little later.
        self.guest.wait_for(f"stat -c %G /dev/$(basename /sys/bus/hid/devices/0003:{self.ids}.*/hidraw/hidraw*) | grep -qx thimble")


class TeensyArm(HidArm):
    """Of the same family, its controller a Teensy: reports of 64 bytes. Its home is 60 mm from its origin, so it has a box of +-60 mm about that."""

    model = "polhem-1"
    ids = "16C0:0486"
    box = BOX.replace("0.09", "0.36")


class TextArm(Arm):
    """The same arm at a Teensy with the text protocol: a serial port, made by the kernel's cdc_acm."""

    words = f'device = "serial:{SERIAL}"\nmodel = "phantom-vintage"\namplifier_max_a = 3.0'

    def __init__(self, guest, rate_hz=QUIET_HZ, *, is_named=True):
        super().__init__(guest, "text-arm", *WAYS["usb"], "--serial", SERIAL, "--amplifier-max-a", "3", "phantom-vintage-serial")
        self.rate_hz = rate_hz
        self.plug()
        if is_named:
            self.configure()

    def plug(self):
        super().plug()
        # The node, and its rule, which may come a little later.
        self.node = self.guest.wait_for(f"udevadm settle; grep -lx {SERIAL} /sys/class/tty/ttyACM*/device/../serial > /dev/null && "
                                   "ls -d /sys/class/tty/ttyACM*").strip().rsplit("/", 1)[1]
        self.guest.wait_for(f"stat -c %G /dev/{self.node} | grep -qx thimble")


class Puck(Arm):
    """One of 3Dconnexion; `node`: its hidraw node."""

    def __init__(self, guest, model="spacemouse"):
        super().__init__(guest, "puck", *WAYS["usb"], "--serial", SERIAL, model)
        self.plug()
        address = guest.wait_for("thimble devices | grep -o 'hid:[^ ]*'").split()[0]
        self.words = f'device = "{address}"'
        self.node = guest.wait_for("ls /sys/bus/hid/devices/0003:*/hidraw").split()[-1]
        self.configure()


def firmware(words=600):
    """A boot stream as the processor's maker defines it, with noise for code: key, eight reserved words and the entry point; one
    block; the end."""
    noise = random.Random(1)
    code = [noise.randrange(0x10000) for _ in range(words)]
    stream = [0x08AA] + 8 * [0] + [0x003F, 0x8000] + [words, 0x003F, 0x8000] + code + [0]
    return struct.pack(f"<{len(stream)}H", *stream)


def plugin(guest):
    """The Falcon's driver as a shared object, in the guest: no part of the packages (decision 0335), but of the build folder."""
    guest.run(f"install -D -m 644 /run/bin/falcon_plugin.so {PLUGIN}")
    return PLUGIN


class Falcon(Arm):
    """Nothing is in its memory yet; `address`: how the configuration names it. `plugin`: a driver from outside, a file of the guest. `is_named`: as above."""

    def __init__(self, guest, plugin=None, rate_hz=QUIET_HZ, *, way="usb", is_named=True):
        if plugin is not None:
            self.daemon_words = f'[daemon]\nplugins = ["{plugin}"]\n'
        super().__init__(guest, "falcon", *WAYS[way], "falcon")
        self.rate_hz = rate_hz
        self.plug()
        self.port = guest.wait_for("basename $(dirname $(grep -lx cb48 /sys/bus/usb/devices/*/idProduct))").strip()
        self.address = "usb:" + guest.run(f"cat /sys/bus/usb/devices/{self.port}/serial").strip()
        image = firmware()
        guest.run(f"base64 -d > {FIRMWARE} <<< {base64.b64encode(image).decode()}")
        self.words = (f'device = "{self.address}"\nfirmware = "{FIRMWARE}"\nfirmware_sha256 = "{hashlib.sha256(image).hexdigest()}"\n'
                      f"newton_per_count = {NEWTON_PER_COUNT}")
        if is_named:
            self.configure()

    def calibrate(self):
        self.say("home 0.3")
        self.guest.sleep(0.4)

    def activate(self):
        # A firmware that runs already knows where it is.
        simdev.wait_for_state(self.guest, "calibrating", "active")
        self.say("home 0.3")
        simdev.wait_for_state(self.guest, "active")

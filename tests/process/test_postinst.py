"""What installing the daemon's package does with arms that are plugged in already, in a planted /sys and /dev."""

import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class Preinst(unittest.TestCase):
    def test_makes_the_groups_that_the_package_makes(self):
        def entries(path):
            lines = (SOURCE / path).read_text().splitlines()
            return [line.split() for line in lines if line[:2] in ("u ", "g ")]

        self.assertEqual(entries("debian/thimbled.preinst"), entries("systemd/thimble.sysusers"))
        self.assertEqual(len(entries("systemd/thimble.sysusers")), 2)


class Postinst(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "run/udev").mkdir(parents=True)
        rules = self.root / "lib/udev/rules.d/0-thimble.rules"
        rules.parent.mkdir(parents=True)
        rules.write_text((SOURCE / "udev/0-thimble.rules").read_text())
        for program in ("setfacl", "udevadm", "systemd-sysusers"):
            path = self.root / "bin" / program
            path.parent.mkdir(exist_ok=True)
            # Each fails, as in a container: that must not stop the installation.
            status = 0 if program == "systemd-sysusers" else 1
            path.write_text(f'#!/bin/sh\necho "{program} $*" >> {self.root}/log\nexit {status}\n')
            path.chmod(0o755)
        self.script = self.root / "postinst"
        text = (SOURCE / "debian/thimbled.postinst").read_text()
        for top in ("/sys/", "/dev/", "/run/", "/lib/udev"):
            text = text.replace(f" {top}", f" {self.root}{top}").replace(f'"{top}', f'"{self.root}{top}')
            text = text.replace(f"={top}", f"={self.root}{top}")
        self.script.write_text(text)

    def plant(self, path, text=""):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def plug_in(self, port, vendor, product, *children):
        device = f"sys/devices/usb1/{port}"
        self.plant(f"{device}/idVendor", vendor + "\n")
        self.plant(f"{device}/idProduct", product + "\n")
        self.plant(f"{device}/uevent", f"MAJOR=189\nDEVNAME=bus/usb/001/{port}\nDEVTYPE=usb_device\n")
        for child in children:
            self.plant(f"{device}/{port}:1.0/{child}/uevent", f"MAJOR=1\nDEVNAME={child}\n")
        link = self.root / "sys/bus/usb/devices" / port
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(self.root / device)

    def calls(self, *arguments):
        (self.root / "log").write_text("")
        environment = {**os.environ, "PATH": f"{self.root}/bin:{os.environ['PATH']}"}
        subprocess.run(["sh", "-eu", self.script, *arguments], env=environment, check=True, timeout=60)
        return (self.root / "log").read_text().replace(str(self.root), "").splitlines()

    def test_the_seats_access_lists_go_from_every_node_of_a_force_device_and_from_no_other(self):
        self.plug_in("1-1", "1234", "0006", "hidraw0", "usb/hiddev0", "input/event7")
        self.plug_in("1-2", "16c0", "0483", "ttyACM0")
        self.plug_in("1-3", "046d", "c626", "hidraw1")  # a puck is for whoever sits there
        self.plug_in("1-4", "1234", "0007", "hidraw2")
        self.plant("sys/bus/hid/devices/0005:10C4:EA90.0003/hidraw/hidraw5/uevent", "DEVNAME=hidraw5\n")
        removed = [call.split()[-1] for call in self.calls("configure", "") if call.startswith("setfacl --remove-all ")]
        self.assertEqual(sorted(removed), ["/dev/bus/usb/001/1-1", "/dev/bus/usb/001/1-2", "/dev/hidraw0",
                                           "/dev/hidraw5", "/dev/input/event7", "/dev/ttyACM0", "/dev/usb/hiddev0"])

    def test_the_rules_come_after_and_are_waited_for_once_and_last(self):
        self.plug_in("1-1", "1234", "0006", "hidraw0")
        calls = self.calls("configure", "")
        last_list = max(i for i, call in enumerate(calls) if call.startswith("setfacl"))
        triggers = [i for i, call in enumerate(calls) if call.startswith("udevadm trigger")]
        self.assertLess(calls.index("udevadm control --reload"), min(triggers))
        self.assertLess(last_list, min(triggers))
        for subsystem in ("usb", "usbmisc", "hidraw", "input", "gpio", "tty"):
            self.assertTrue(any(f"--subsystem-match={subsystem}" in calls[i].split() for i in triggers), subsystem)
        self.assertEqual([call for call in calls if call == "udevadm settle"], ["udevadm settle"])
        self.assertEqual(calls[-1], "udevadm settle")

    def test_nothing_is_plugged_in_and_an_update_leaves_access_lists_alone(self):
        self.assertFalse([call for call in self.calls("configure", "") if call.startswith("setfacl")])
        self.plug_in("1-1", "1234", "0006", "hidraw0")
        updated = self.calls("configure", "0.1.0")
        self.assertFalse([call for call in updated if call.startswith("setfacl")])
        self.assertEqual(updated[-1], "udevadm settle")

    def test_no_other_step_and_no_machine_without_udev_is_touched(self):
        self.assertEqual(self.calls("abort-upgrade", "0.1.0"), [])
        (self.root / "run/udev").rmdir()
        self.assertEqual(self.calls("configure", ""), [])


if __name__ == "__main__":
    unittest.main()

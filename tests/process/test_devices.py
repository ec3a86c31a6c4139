"""`thimble devices`, without a daemon and with one."""

import json
import shutil
import subprocess

from rig import BIN, HELLO, TIMEOUT_S, ProcessTest

# For umockdev-run: an arm with a serial number, and a mouse without.
MACHINE = """P: /devices/pci0000:00/0000:00:14.0/usb1/1-4
N: bus/usb/001/004
E: SUBSYSTEM=usb
E: DEVTYPE=usb_device
E: DEVNAME=/dev/bus/usb/001/004
A: idVendor=1234
A: idProduct=0006
A: bDeviceClass=00
A: bConfigurationValue=1
A: devnum=4
A: manufacturer=Maker
A: product=Arm
A: serial=ABC1

P: /devices/pci0000:00/0000:00:14.0/usb1/1-4/1-4:1.0
E: SUBSYSTEM=usb
E: DEVTYPE=usb_interface
A: bInterfaceNumber=00

P: /devices/pci0000:00/0000:00:14.0/usb1/1-4/1-4:1.0/0003:1234:0006.0001
E: SUBSYSTEM=hid
E: HID_ID=0003:00001234:00000006
E: HID_UNIQ=ABC1
H: report_descriptor=0600FF0901A101150026FF007508950E09018102950E09019102C0

P: /devices/pci0000:00/0000:00:14.0/usb1/1-4/1-4:1.0/0003:1234:0006.0001/hidraw0
N: hidraw0
E: SUBSYSTEM=hidraw
E: DEVNAME=/dev/hidraw0

P: /devices/pci0000:00/0000:00:14.0/usb1/1-5
N: bus/usb/001/005
E: SUBSYSTEM=usb
E: DEVTYPE=usb_device
E: DEVNAME=/dev/bus/usb/001/005
A: idVendor=046d
A: idProduct=c077
A: bDeviceClass=00
A: devnum=5
"""

# A Falcon, and a puck without a serial number.
TELLING = """P: /devices/pci0000:00/0000:00:14.0/usb1/1-6
N: bus/usb/001/006
E: SUBSYSTEM=usb
E: DEVTYPE=usb_device
E: DEVNAME=/dev/bus/usb/001/006
A: idVendor=0403
A: idProduct=cb48
A: bDeviceClass=00
A: bConfigurationValue=1
A: devnum=6
A: busnum=1
A: speed=12
A: manufacturer=Novint
A: product=FALCON HAPTIC
A: serial=FALCON1
H: descriptors=1201000200000008030448CB00040102030109022000010100802D0904000002FFFFFF020705810240000007050202400000

P: /devices/pci0000:00/0000:00:14.0/usb1/1-6/1-6:1.0
E: SUBSYSTEM=usb
E: DEVTYPE=usb_interface
A: bInterfaceNumber=00
A: bInterfaceClass=ff

P: /devices/pci0000:00/0000:00:14.0/usb1/1-7
N: bus/usb/001/007
E: SUBSYSTEM=usb
E: DEVTYPE=usb_device
E: DEVNAME=/dev/bus/usb/001/007
A: idVendor=046d
A: idProduct=c626
A: bDeviceClass=00
A: devnum=7
A: manufacturer=3Dconnexion
A: product=SpaceNavigator

P: /devices/pci0000:00/0000:00:14.0/usb1/1-7/1-7:1.0
E: SUBSYSTEM=usb
E: DEVTYPE=usb_interface
A: bInterfaceNumber=00

P: /devices/pci0000:00/0000:00:14.0/usb1/1-7/1-7:1.0/0003:046D:C626.0002
E: SUBSYSTEM=hid
E: HID_ID=0003:0000046D:0000C626
H: report_descriptor=05010908A101A1008501160CFE26F40136000046000009300931093275109503810AC0A1008502160CFE26F401360000460000093309340935751095038102C0A1028503050919012902150025013500450175019502950E8103C0C0

P: /devices/pci0000:00/0000:00:14.0/usb1/1-7/1-7:1.0/0003:046D:C626.0002/hidraw1
N: hidraw1
E: SUBSYSTEM=hidraw
E: DEVNAME=/dev/hidraw1
"""
WORLD = '[[world]]\nname = "box"\nsource = "box:3"\nworkspace_m = 0.09\n'


class Devices(ProcessTest):
    def test_needs_no_daemon(self):
        result = self.run_program("thimble", "devices", "--socket", self.folder / "none")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("sim:phantom-vintage", result.stdout)
        self.assertIn("no daemon is running", result.stdout)
        self.assertNotIn("in use by", result.stdout)

    def test_says_what_the_daemon_uses(self):
        daemon = self.start(config=HELLO)
        self.assertIn("in use by right", self.thimble(daemon, "devices").stdout)
        document = json.loads(self.thimble(daemon, "devices", "--json").stdout)
        used = [entry["address"] for entry in document["devices"] if entry["users"]]
        self.assertEqual(used, ["sim:phantom-vintage"])


class RealDevices(ProcessTest):
    """On a machine that umockdev invents: the real libudev looks at it."""

    def devices(self, *more, machine=MACHINE):
        file = self.write("machine.umockdev", machine)
        command = ["umockdev-run", "--device", file, "--", BIN / "thimble", "devices",
                   "--socket", self.folder / "none", *more]
        return subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S)

    def setUp(self):
        super().setUp()
        if shutil.which("umockdev-run") is None:
            self.skipTest("umockdev-run is not installed (package umockdev)")

    def test_are_listed_beside_the_simulated_ones_with_what_is_in_the_way(self):
        result = self.devices("--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        entries = {e["address"]: e for e in json.loads(result.stdout)["devices"]}
        self.assertIn("sim:phantom-vintage", entries)
        self.assertLess(list(entries).index("hid:ABC1"), list(entries).index("sim:phantom-vintage"))
        arm = entries["hid:ABC1"]
        self.assertIn("Maker Arm, 1234:0006 at /dev/hidraw0", arm["description"])
        self.assertIn("before a person says that it is an arm", arm["needs"])
        self.assertIn("amplifier_max_a is missing", arm["needs"])
        self.assertIn("woody-2015", arm["models"])
        self.assertRegex(self.devices().stdout, r"(?s)^hid:ABC1.*its arm.model: .*woody-2015.*sim:")
        for stranger in ("usb:ABC1", "usb:pci-0000:00:14.0-usb-0:5"):
            self.assertEqual(entries[stranger]["obstacle"], "no driver knows it")


    def test_become_tables_that_lack_only_what_a_person_knows(self):
        result = self.devices("--toml")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn('device = "hid:ABC1"', result.stdout)
        self.assertNotIn("sim:", result.stdout)
        bare = self.thimbled("--config", self.write("bare.toml", WORLD + result.stdout), "--check")
        self.assertEqual(bare.returncode, 2)
        self.assertIn("the controller does not tell which arm it drives", bare.stderr)
        chosen = result.stdout.replace('# model = "woody-2015"', 'model = "woody-2015"')
        checked = self.thimbled("--config", self.write("chosen.toml", WORLD + chosen), "--check")
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_whose_ids_say_what_they_are_lack_nothing_but_their_firmware(self):
        result = self.devices("--toml", machine=TELLING)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        file = self.write("both.toml", WORLD + result.stdout)
        bare = self.thimbled("--config", file, "--check")
        self.assertEqual(bare.returncode, 2)
        self.assertEqual(len(bare.stderr.splitlines()), 1, bare.stderr)
        self.assertIn("there is no firmware at", bare.stderr)
        self.write("nvent_firmware.bin", "\0" * 1000)
        given = self.thimbled("--config", file, "--check")
        self.assertEqual(given.returncode, 2)
        self.assertIn("does not begin as a firmware of the Falcon does", given.stderr)
        puck = self.write("puck.toml", WORLD + result.stdout[:result.stdout.index("# Novint")])
        checked = self.thimbled("--config", puck, "--check")
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_become_tables_or_a_document_but_not_both(self):
        self.assertEqual(self.devices("--toml", "--json").returncode, 2)
        self.assertEqual(self.devices("--toml", "--root", "/").returncode, 2)


class AbsentArm(ProcessTest):
    """Of two arms one is not there: no start fails for it, and the other is driven."""

    BOTH = HELLO + """
[[arm]]
name = "absent"
device = "hid:NOBODY"
model = "phantom-vintage"
amplifier_max_a = 3.0
world = "box"
"""

    def test_is_lost_and_told_while_the_other_is_driven(self):
        file = self.write("both.toml", self.BOTH)
        self.assertEqual(self.thimbled("--config", file, "--check").returncode, 0)
        daemon = self.start(config=self.BOTH)
        status = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        absent = status["arms"][1]
        self.assertEqual((absent["state"], absent["faults"]), ("lost", []))
        self.assertIn("no device at hid:NOBODY", absent["instruction"])
        self.assertEqual([servo.get("rate_hz") for servo in status["servos"]], [1000, None], "it is its driver's own")
        self.assertTrue(any("arm 'absent': no device at hid:NOBODY" in line for line in status["degraded"]))
        refused = self.thimble(daemon, "activate", "absent")
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("no device at hid:NOBODY", refused.stderr)
        self.assertIn("has no latched fault", self.thimble(daemon, "clear-fault", "absent").stderr)
        self.assertEqual(daemon.stop(), 0)
        self.assertIn("arm 'absent': no device at hid:NOBODY", daemon.log())
        self.assertFalse(list(daemon.folder.glob("flight-*")), "that it is not there is no stop")

    def test_a_simulated_arm_in_the_place_of_an_absent_one_is_told_in_the_log(self):
        daemon = self.start(config=HELLO.replace(
            'device = "sim:phantom-vintage"', 'device = "hid:NOBODY"\nmodel = "phantom-vintage"\n'
            'fallback = "simulated"'))
        sentence = daemon.status()["degraded"][-1]
        self.assertIn("hid:NOBODY is not there; a simulated arm stands in for it", sentence)
        self.assertEqual(daemon.stop(), 0)
        self.assertEqual(daemon.log().count(sentence), 1)


def usb_device(port, number, ids, *attributes):
    vendor, product = ids.split(":")
    return f"""P: /devices/pci0000:00/0000:00:14.0/usb1/{port}
N: bus/usb/001/{number:03}
E: SUBSYSTEM=usb
E: DEVTYPE=usb_device
E: DEVNAME=/dev/bus/usb/001/{number:03}
A: idVendor={vendor}
A: idProduct={product}
A: bDeviceClass=00
A: bConfigurationValue=1
A: devnum={number}
{"".join(line + chr(10) for line in attributes)}
"""


def puck(port, number, serial, input_bytes):
    """SpaceMouse Pro whose report has an identifier and so many bytes."""
    folder = f"/devices/pci0000:00/0000:00:14.0/usb1/{port}/{port}:1.0"
    return usb_device(port, number, "046d:c62b", f"A: serial={serial}") + f"""P: {folder}
E: SUBSYSTEM=usb
E: DEVTYPE=usb_interface
A: bInterfaceNumber=00

P: {folder}/0003:046D:C62B.{number:04}
E: SUBSYSTEM=hid
E: HID_ID=0003:0000046D:0000C62B
E: HID_UNIQ={serial}
H: report_descriptor=05010908A1018501150026FF00750895{input_bytes:02X}09018102C0

P: {folder}/0003:046D:C62B.{number:04}/hidraw{number}
N: hidraw{number}
E: SUBSYSTEM=hidraw
E: DEVNAME=/dev/hidraw{number}

"""


class LyingArms(ProcessTest):
    """What devices say of themselves ends no start, and so no other arm."""

    # One interface whose endpoint 0x81 is told twice, first as isochronous.
    FALCON = usb_device("1-6", 6, "0403:cb48", "A: serial=FALCON",
                        "H: descriptors=1201000200000040030448CB00040102030109022700010100A02D"
                        "0904000003FFFFFF02070581014000010705810240000007050202400000")
    MACHINE = puck("1-4", 4, "LONG", 100) + puck("1-5", 5, "OTHER", 12) + FALCON

    def arm(self, name, device, *more):
        return "\n".join(["[[arm]]", f'name = "{name}"', f'device = "{device}"',
                          'world = "box"', *more, ""])

    def test_are_lost_and_told_while_another_is_driven(self):
        if shutil.which("umockdev-run") is None:
            self.skipTest("umockdev-run is not installed (package umockdev)")
        file = self.write("lying.toml", HELLO + self.arm("long", "hid:LONG")
                          + self.arm("other", "hid:OTHER", 'model = "spacenavigator"')
                          + self.arm("twice", "usb:FALCON") + self.arm("older", "usb:1-6"))
        summary = self.folder / "summary.json"
        ended = subprocess.run(
            ["umockdev-run", "--device", self.write("machine.umockdev", self.MACHINE), "--",
             BIN / "thimbled", "--config", file, "--for", "0.5", "--summary", summary,
             "--set", f"daemon.socket={self.folder / 'socket'}",
             "--set", f"daemon.flight_directory={self.folder}"],
            capture_output=True, text=True, timeout=TIMEOUT_S)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        arms = {arm["name"]: arm["state"] for arm in json.loads(summary.read_text())["arms"]}
        self.assertEqual([arms.pop(name) for name in ("long", "other", "twice", "older")], ["lost"] * 4)
        self.assertNotIn("lost", arms.values())
        self.assertRegex(ended.stderr, "arm 'long'.*reports of more than 64 bytes")
        self.assertRegex(ended.stderr, "arm 'other'.*'spacenavigator'")
        self.assertRegex(ended.stderr, "arm 'twice'.*two bulk pipes of 64 bytes")
        self.assertRegex(ended.stderr, "arm 'older': no device at usb:1-6; what the kernel calls so today is: usb:FALCON,")


class EveryArm(ProcessTest):
    def test_is_driven_and_shows_its_gimbal_where_it_has_one(self):
        for model in ("premium-1.5", "aluhaptics-2", "polhem-1"):
            with self.subTest(model=model):
                daemon = self.start("--set", f"arm.0.device=sim:{model}", config=HELLO, name=model)
                status = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
                arm = status["arms"][0]
                self.assertEqual(arm["model"], model)
                has_gimbal = model == "polhem-1"
                self.assertEqual(len(arm["gimbal_rad"]), 3 if has_gimbal else 0)
                self.assertEqual(has_gimbal, "gimbal" in self.thimble(daemon, "status").stdout)
                self.assertEqual(daemon.stop(), 0)

    def test_is_driven_on_bare_usb_too(self):
        daemon = self.start("--set", "arm.0.device=sim:falcon-loaded", config=HELLO)
        status = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        self.assertEqual(status["arms"][0]["model"], "falcon")
        self.assertEqual(daemon.stop(), 0)

    def test_has_the_rate_that_it_needs_where_nobody_says_one(self):
        first = HELLO[HELLO.index("[[arm]]"):HELLO.index("[[world]]")]
        both = HELLO.replace(first, first + first.replace('"right"', '"left"').replace("sim:phantom-vintage", "sim:falcon-loaded"))
        self.assertNotIn("rate_hz", both)
        for words, rates_hz in (([], [1000, 4000]), (["--set", "servo.rate_hz=2000"], [2000, 2000])):
            daemon = self.start(*words, config=both, name=f"rates-{rates_hz[1]}")
            servos = daemon.status_when(lambda s: all(servo["ticks"] > 0 for servo in s["servos"]))["servos"]
            self.assertEqual([servo["rate_hz"] for servo in servos], rates_hz)
            self.assertEqual(daemon.stop(), 0)

"""The rules of udev/, met by real events: HID devices that the guest's kernel makes through uhid, and some on its USB stack."""

import contextlib
import re

import guest
import nodes
import simdev

# Model and product id: one of each form that a rule has.
ON_USB = (("falcon", "cb48"), ("cam-8", "0001"), ("spacemouse", "c635"), ("spacenavigator", "c626"))
DELAY_MS = 4321  # nobody's default: where it is found the rule was met
# Those that make a force, and what is as near to one: model, product id, and the kinds of nodes that the kernel makes of each, its own on the bus aside.
CLOSED = (("phantom-vintage", "0006", {"hidraw", "hiddev"}), ("phantom-vintage-serial", "0483", {"ttyACM"}), ("falcon", "cb48", set()),
          ("cam-8", "0001", set()), ("cp2112", "ea90", {"hidraw", "gpiochip"}))
OPENER = ('SUBSYSTEM=="usb|usbmisc|hidraw|tty|gpio", MODE="0666", GROUP="users", TAG+="uaccess"')
# As it is given to all who want to save power, in a file that comes late; for each event, as ours: one for "add" alone is undone by a driver's "bind".
SAVER = ('SUBSYSTEM=="usb", TEST=="power/control", ATTR{power/control}="auto", '
         f'ATTR{{power/autosuspend_delay_ms}}="{DELAY_MS}"')


class Udev(guest.GuestTest):
    pace = guest.COUNTED
    runs_daemon = False  # whose arm would have a third of the processor

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.guest.run("useradd --create-home --groups thimble-users member")

    def plug(self, vendor, product):
        """A HID device until unplug(): its node."""
        unit = f"uhid-{vendor}-{product}"
        self.guest.run(f"systemd-run --quiet --collect --unit {unit} python3 -B /run/tests/uhid_device.py {vendor} {product} SN1")
        self.addCleanup(self.guest.ask, f"systemctl stop {unit}")
        name = f"0003:{vendor}:{product}.*".upper()
        node = self.guest.wait_for(f"ls -d /sys/bus/hid/devices/{name}/hidraw/hidraw*").strip().rsplit("/", 1)[1]
        self.guest.run("udevadm settle")
        return f"/dev/{node}"

    def add_rule(self, name, rule):
        """Of somebody else, until the test has ended."""
        file = f"/etc/udev/rules.d/{name}.rules"
        self.guest.run(f"echo '{rule}' > {file}; udevadm control --reload")
        self.addCleanup(self.guest.run, f"rm -f {file}; udevadm control --reload")

    @contextlib.contextmanager
    def on_usb(self, model, product):
        """A device of ours on the USB stack while it lasts: its folder of sysfs."""
        device = simdev.Simdev(self.guest, model, "--vhci", model)
        try:
            device.attach()
            folder = self.guest.wait_for(f"dirname $(grep -lx {product} /sys/bus/usb/devices/*/idProduct)").strip()
            self.guest.run("udevadm settle")
            yield self.guest.run(f"readlink -f {folder}").strip()
        finally:
            device.stop()

    def test_the_rules_found_their_groups_when_they_were_read_first(self):
        """That was between unpacking and configuring: guest_states.install()."""
        self.assertEqual(self.guest.ask("journalctl --no-pager -u systemd-udevd | grep \"Unknown group 'thimble\"")[1], "")

    def test_an_arm_belongs_to_the_daemon_and_to_nobody_else(self):
        for vendor, product in (("1234", "0006"), ("16c0", "0486")):
            with self.subTest(f"{vendor}:{product}"):
                node = self.plug(vendor, product)
                nodes.assert_closed(self, self.guest, node)
                self.assertNotEqual(self.guest.ask(f"runuser -u member -- cat {node} </dev/null")[0], 0)

    def test_no_list_of_ids_lets_a_device_sleep(self):
        """Compiled by the trigger of udev's own package; other lists come first."""
        for name in ("v1234p0006", "v16C0p0486", "v16C0p0483", "v0403pCB48", "v10C4pEA90", "v1209p0001", "v256FpC635", "v046DpC62B"):
            with self.subTest(name):
                self.assertIn("ID_AUTOSUSPEND=0", self.guest.run(f"systemd-hwdb query usb:{name}d0100dc00dsc00dp00").splitlines())

    def test_no_rule_of_others_lets_a_device_sleep(self):
        self.add_rule("99-usb-power", SAVER)
        for model, product in ON_USB:
            with self.subTest(model), self.on_usb(model, product) as folder:
                said = self.guest.run(f"cd {folder}/power; cat autosuspend_delay_ms control").split()
                self.assertEqual(said, [str(DELAY_MS), "on"])

    def test_no_rule_of_others_opens_a_node_of_what_is_on_usb(self):
        self.add_rule("60-open", OPENER)
        self.assertEqual(nodes.rights(self.guest, self.plug("1234", "0007")), "root:users 666", "a device that no rule of ours closes")
        for model, product, kinds in CLOSED:
            with self.subTest(model), self.on_usb(model, product) as folder:
                found = nodes.under(self.guest, folder)
                self.assertEqual({re.sub(r"\d+$", "", node.rsplit("/", 1)[1]) for node in found if not node.startswith("/dev/bus/usb/")}, kinds)
                self.assertEqual(len(found), len(kinds) + 1, found)
                for node in found:
                    nodes.assert_closed(self, self.guest, node)

    def test_the_daemons_user_may_open_it(self):
        node = self.plug("1234", "0006")
        self.guest.run(f"runuser -u thimble -- bash -c 'exec 3<>{node}'")

    def test_another_device_stays_closed(self):
        self.assertEqual(nodes.rights(self.guest, self.plug("1234", "0007")), "root:root 600")

    def test_a_puck_is_for_whoever_sits_there_and_for_the_daemon(self):
        for vendor, product in (("256f", "c635"), ("046d", "c62b")):
            with self.subTest(f"{vendor}:{product}"):
                node = self.plug(vendor, product)
                self.assertEqual(nodes.rights(self.guest, node), "root:thimble 660")
                self.assertTrue(nodes.is_given_to_the_seat(self.guest, node))
                self.assertLessEqual({"uaccess", "systemd"}, nodes.tags(self.guest, node))

    def test_rules_of_others_do_not_open_an_arm(self):
        # As they come with Teensy boards, among others.
        for name, how in (("00-teensy", 'MODE:="0666"'), ("49-open", 'MODE:="0666", GROUP:="users"'),
                          ("70-seat", 'TAG+="uaccess"'), ("99-open", 'MODE="0666", GROUP="users"')):
            with self.subTest(name):
                self.add_rule(name, f'KERNEL=="hidraw*", {how}')
                node = self.plug("1234", "0006")
                nodes.assert_closed(self, self.guest, node)
                self.doCleanups()
                self.guest.wait_for("! ls -d /sys/bus/hid/devices/0003:1234:0006.* 2>/dev/null")

    def test_unplugged_it_is_gone_and_plugged_in_again_it_is_the_daemons(self):
        for _ in range(3):
            self.assertEqual(nodes.rights(self.guest, self.plug("1234", "0006")), "root:thimble 660")
            self.doCleanups()
            self.guest.wait_for("! ls /sys/bus/hid/devices/0003:1234:0006.* 2>/dev/null")

    def test_the_daemon_may_keep_the_processors_awake(self):
        self.assertEqual(nodes.rights(self.guest, "/dev/cpu_dma_latency"), "root:thimble 660")

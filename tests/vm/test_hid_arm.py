"""A HID arm on the kernel's own HID stack, claimed through hidapi: one_arm.py through uhid and over USB/IP; a simulated one until it comes."""

import json

import arms
import guest
import one_arm
import simdev


class Uhid(one_arm.OneArm):
    way = "uhid"
    walls = [(axis, sign) for axis in range(3) for sign in (1, -1)]

    @classmethod
    def plug_in(cls):
        return arms.HidArm(cls.guest, cls.way)

    def test_1_its_node_is_the_daemons_and_the_daemon_has_it_open(self):
        node = self.guest.run(f"ls -d /sys/bus/hid/devices/0003:{self.arm.ids}.*/hidraw/hidraw*").strip().rsplit("/", 1)[1]
        self.assert_node(f"/dev/{node}")
        self.assertTrue(self.arm.status()["open"])
        # Of those on USB: it never sleeps.
        self.assertEqual(self.guest.run(f"path=$(readlink -f /sys/class/hidraw/{node}/device/../../power/control); "
                                        "case $path in */usb*) cat $path;; *) echo on;; esac").strip(), "on")

    def assert_guard_has_hiddev(self):
        self.guest.run("ls -l /proc/$(pgrep -x thimble-guard)/fd | grep -q /dev/usb/hiddev")

    def test_5b_upgraded_while_the_hand_pushes_it_is_let_go_and_comes_back(self):
        """By the same package, which is what an upgrade does to a service; its guard has the arm meanwhile."""
        self.assertGreater(simdev.norm(self.press()), one_arm.WALL_NEWTON)
        before = self.properties("MainPID")
        self.guest.install("thimbled", words="--no-triggers")
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertNotEqual(self.properties("MainPID"), before)
        self.assertEqual(self.properties("ActiveState", "NRestarts"), {"ActiveState": "active", "NRestarts": "0"})
        self.assertLess(max(self.arm.forces(0.2)), simdev.NOTHING_NEWTON)
        self.arm.activate()

    def test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        super().test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force()
        self.guest.wait_for("! ls -l /proc/*/fd 2>/dev/null | grep -q /dev/hidraw")


class Teensy(Uhid):
    """The form of the family that reports 64 bytes, on USB: they leave over its hiddev, too."""

    way = "usb"
    walls = ((2, 1),)
    rest_m = (0.0, -0.034, 0.0495)  # its home
    to_wall_m = 0.0145
    test_5b_upgraded_while_the_hand_pushes_it_is_let_go_and_comes_back = None  # of the daemon, whatever the arm
    test_7_gone_with_its_daemon_it_keeps_no_guard_at_work = None  # over its hiddev as any arm on USB

    @classmethod
    def plug_in(cls):
        return arms.TeensyArm(cls.guest, cls.way)

    def test_2b_its_reports_are_those_of_that_form(self):
        log = self.arm.log(0.1)
        for way in ("in", "out"):
            self.assertEqual({len(entry[way]) // 2 for entry in log if way in entry}, {64}, way)
        self.assert_guard_has_hiddev()


class Usbip(Uhid):
    way = "usbip"
    walls = one_arm.OneArm.walls
    test_5b_upgraded_while_the_hand_pushes_it_is_let_go_and_comes_back = None  # dear, and once is enough

    def test_2b_its_guard_has_the_way_out_which_is_nobody_elses(self):
        """The kernel makes a hiddev of the arm, and the guard holds it (decision 0488)."""
        self.assert_guard_has_hiddev()
        self.assertEqual(self.guest.run("stat -c '%U:%G %a' /dev/usb/hiddev0").strip(), "root:thimble 660")


class FallBack(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = arms.HidArm(cls.guest, is_named=False)
        cls.arm.say("unplug")
        cls.arm.words += '\nfallback = "simulated"'
        cls.arm.configure()

    def status(self):
        """Of the daemon, and of its arm."""
        whole = json.loads(self.guest.run("thimble status --json"))
        return whole, whole["arms"][0]

    def assert_stands_in(self):
        whole, arm = self.status()
        self.assertEqual((arm["device"], arm["stands_in_for"], arm["state"]), ("sim:phantom-vintage", f"hid:{arms.SERIAL}", "active"))
        return whole["degraded"]

    def test_1_a_simulated_one_stands_in_and_the_status_says_so(self):
        simdev.wait_for_state(self.guest, "active")
        self.assertIn(f"arm 'right': hid:{arms.SERIAL} is not there; a simulated arm stands in for it (sim:phantom-vintage)", self.assert_stands_in())

    def test_2_plugged_in_while_that_is_active_the_arm_waits_untouched(self):
        self.arm.say("plug")
        self.arm.plug()
        self.guest.wait_for("thimble status --json | grep -q 'it takes over as soon as the simulated arm is inactive: thimble deactivate right'")
        self.guest.sleep(2)  # it is looked for again meanwhile
        self.assert_stands_in()
        arm = self.arm.status()
        self.assertEqual((arm["open"], arm["counters"]["from_host"]), (False, 0))

    def test_3_it_takes_over_when_that_rests_and_is_not_active_unasked(self):
        self.guest.run("thimble deactivate right")
        taken = json.loads(simdev.wait_for_state(self.guest, "calibrating"))
        self.assertEqual((taken["device"], taken["stands_in_for"]), (f"hid:{arms.SERIAL}", ""))
        self.arm.calibrate()
        simdev.wait_for_state(self.guest, "inactive")
        self.arm.say("move 0.018 0 0 0.2")
        self.guest.sleep(1)
        self.assertEqual(self.status()[1]["state"], "inactive")
        self.assertLess(max(self.arm.forces(1)), simdev.NOTHING_NEWTON)

    def test_4_asked_for_it_is_active_and_its_walls_are_felt(self):
        self.arm.say("move 0 0 0 0.2")
        self.guest.run("thimble activate right")
        simdev.wait_for_state(self.guest, "active")
        self.arm.say("move 0.018 0 0 0.2")
        self.guest.sleep(0.8)
        self.assertLess(self.arm.felt(0.1)[0], -one_arm.WALL_NEWTON)

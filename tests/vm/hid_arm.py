"""One HID arm from its coming to its end, on the kernel's own HID stack, claimed through hidapi: one_arm.py."""

import arms
import one_arm


class HidArm(one_arm.OneArm):
    """`way`: of arms.WAYS."""

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

    def test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        super().test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force()
        self.guest.wait_for("! ls -l /proc/*/fd 2>/dev/null | grep -q /dev/hidraw")

"""The same reports, one a tick, over every bus: the forces that a session answers are the same to the bit.

A tape of a simulated arm in the hand of a simulated person is played to the same session, with the drivers that the daemon has: over the
simulated bus, and over the kernel's own. The device plays it from the far end of uhid or vhci-hcd, libusb and hidapi are the real ones.
docs/decisions/0346 says what is left out of the comparison.
"""

import guest
import tape

# The bits of three zeros.
NO_FORCE = 48 * "0"


class Replay(guest.GuestTest):
    pace = guest.COUNTED
    runs_daemon = False

    def play(self, arm, where, name):
        """A line for each tick: number, state, force and the bytes that were sent."""
        self.guest.run(f"{tape.PROGRAM} play {arm} {where} > /run/{arm}.{name}", timeout_s=600)

    def assert_same(self, arm, name):
        both = f"/run/{arm}.simulated /run/{arm}.{name}"
        status, differences = self.guest.ask(f"cmp {both} && exit 0; diff {both} | head -20; exit 1")
        self.assertEqual(status, 0, differences)

    def assert_felt(self, arm, ticks):
        """It was a session: calibrated and driven, with as many different forces as a hand that explores a box would meet."""
        lines = [line.split() for line in self.guest.run(f"cat /run/{arm}.simulated").splitlines()]
        self.assertEqual([int(line[0]) for line in lines], list(range(1, ticks + 1)))
        self.assertEqual([line[1] for line in lines[-ticks // 2:]], ticks // 2 * ["active"])
        self.assertGreater(len({line[2] for line in lines} - {NO_FORCE}), ticks // 3)

    def test_hid_arm_over_hidraw(self):
        self.play("phantom", "sim", "simulated")
        self.assert_felt("phantom", 4_000)
        for way in ("uhid", "usb"):
            with self.subTest(way), tape.Tape(self.guest, "phantom", way) as device:
                self.play("phantom", device.address, way)
                self.assert_same("phantom", way)

    def test_falcon_over_usbfs(self):
        self.play("falcon", "sim", "simulated")
        self.assert_felt("falcon", 2_500)
        with tape.Tape(self.guest, "falcon", "usb") as device:
            self.play("falcon", device.address, "usb")
            self.assert_same("falcon", "usb")

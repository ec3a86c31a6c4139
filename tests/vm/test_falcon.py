"""A Falcon on the kernel's own USB stack: the packaged daemon uploads a firmware to its boot-loader through libusb.

The firmware is made up (arms.firmware); the simulated arm takes it for one.
"""

import json

import arms
import one_arm
import simdev


class Falcon(one_arm.OneArm):
    way = "usbip"

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, way=cls.way)

    def pull(self):
        """Its supply, too: nothing is in its memory then, and it is sent its firmware again."""
        self.arm.say("unplug")

    def test_1_its_node_is_the_daemons_and_the_daemon_has_claimed_it(self):
        port = f"/sys/bus/usb/devices/{self.arm.port}"
        self.assert_node("/dev/" + self.guest.run(f"udevadm info --query=name {port}").strip())
        self.assertEqual(self.guest.run(f"cat {port}/power/control").strip(), "on")

    def test_1b_its_boot_loader_was_given_the_whole_firmware_once(self):
        simdev.wait_for_state(self.guest, "calibrating")
        # What it was sent since it came.
        sent = b"".join(bytes.fromhex(entry["out"]) for entry in self.arm.log(60) if "out" in entry)
        self.assertEqual(sent.count(arms.firmware()), 1)

    def assert_ended_by_the_first_packets(self, log):
        """Those with which the daemon asks whether its firmware runs; on the arm's own clock."""
        heard_s = [entry["t_s"] for entry in log if "out" in entry]
        _, silent_s = max(simdev.gaps(heard_s))
        back_s = min(when_s for when_s in heard_s if when_s > silent_s)
        forces = [(entry["t_s"] - back_s, simdev.norm(entry["force_newton"])) for entry in log if "tip_m" in entry]
        self.assertGreater(min(newton for when_s, newton in forces if silent_s - back_s < when_s < 0), one_arm.WALL_NEWTON)
        self.assertLess(max(newton for when_s, newton in forces if when_s > 0.02), simdev.NOTHING_NEWTON)

    def test_5b_of_its_cable_alone_pulled_the_last_force_stays_and_ends_when_it_is_back(self):
        """Its firmware goes on, and no source knows of a watchdog: docs/first-arm.md says so to whoever has one. It knows where it is, and yet waits for a clear."""
        pressed = simdev.norm(self.press())
        self.assertGreater(pressed, one_arm.WALL_NEWTON)
        self.guest.steps(self.arm.step("pull-cable"), ("sleep", 1))
        self.assertAlmostEqual(simdev.norm(self.arm.felt(0.3)), pressed, delta=0.1 * pressed)
        lost = json.loads(simdev.wait_for_state(self.guest, "lost"))
        self.assertEqual([fault["code"] for fault in lost["faults"]], ["disconnected"])
        uploads = self.arm.status()["readings"]["uploads"]
        self.arm.say("plug")
        # As a person looks before attaching it.
        if self.way == "usbip":
            self.assertIn("(0403:cb48)", self.guest.run(f"usbip --tcp-port {simdev.PORT} list -r 127.0.0.1"))
        self.arm.plug()
        back = json.loads(simdev.wait_for_state(self.guest, "fault"))
        self.assertEqual((back["calibration"], back["faults"][0]["number"]), ("ok", lost["faults"][0]["number"]))
        self.guest.sleep(0.5)
        self.assert_ended_by_the_first_packets(self.arm.log(5))
        self.assertEqual(self.arm.status()["readings"]["uploads"], uploads)
        self.arm.clear()
        self.move(self.rest_m, 0.1)
        self.guest.sleep(0.2)

"""Two daemons in two network namespaces: one block that both arms push (thesis 5.3.4), and two arms coupled to each other (5.3.5)."""

import math
import os
import signal
import subprocess
import unittest

import rig


def reason_to_skip():
    """Why no network namespace can be made here; empty when one can."""
    if os.getuid() != 0:
        return "network namespaces need root"
    name = f"thimble-test-{os.getpid()}"
    try:
        made = subprocess.run(["ip", "netns", "add", name], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return "ip is not installed (package iproute2)"
    if made.returncode != 0:
        return "ip netns is not permitted here: " + made.stderr.strip()
    subprocess.run(["ip", "netns", "del", name], check=False)
    return ""


class Seen:
    """What one of the daemons says, once it answers."""

    def __init__(self, test, socket):
        self._test = test
        self._socket = socket

    def status(self):
        if not os.path.exists(self._socket):
            return None
        try:
            code, _, body = rig.http_over(self._socket, "GET", "/v1/status")
        except (ConnectionError, FileNotFoundError):
            return None
        return rig.json.loads(body) if code == 200 else None

    def when(self, condition):
        found = []

        def holds():
            status = self.status()
            if status is None or not condition(status):
                return False
            found.append(status)
            return True

        self._test.assert_soon(holds)
        return found[0]


class TwoHosts:
    """examples/two_hosts.sh with `arguments`, until the end of a test."""

    arguments = ()

    def setUp(self):
        super().setUp()
        reason = reason_to_skip()
        if reason:
            self.skipTest(reason)
        with open(self.folder / "log", "wb") as log:
            self.program = subprocess.Popen(
                [str(rig.EXAMPLES / "two_hosts.sh"), *self.arguments], stdin=subprocess.DEVNULL, stdout=log,
                stderr=log, preexec_fn=rig.die_with_parent,
                env={**rig.clean_environment(), "THIMBLED": str(rig.BIN / "thimbled"),
                     "ROOM": str(self.folder)})
        self.addCleanup(self.stop)
        self.host = Seen(self, str(self.folder / "host.sock"))
        self.guest = Seen(self, str(self.folder / "guest.sock"))

    def stop(self):
        if self.program.poll() is None:
            self.program.send_signal(signal.SIGTERM)
        self.program.wait(rig.TIMEOUT_S)

    def assert_it_leaves_no_namespace_behind(self):
        ours = f"-{self.program.pid}"
        namespaces = subprocess.run(["ip", "netns"], capture_output=True, text=True, check=True)
        self.assertIn(ours, namespaces.stdout)
        self.stop()
        left = subprocess.run(["ip", "netns"], capture_output=True, text=True, check=True)
        self.assertNotIn(ours, left.stdout)


class Block(TwoHosts, rig.ProcessTest):
    arguments = ("block",)

    def see_it_pushed(self, way):
        """The block has gone 2 mm `way`, 1 or -1, along x, from the furthest that it was seen the other way."""
        seen = []

        def has_gone(status):
            seen.append(way * status["worlds"][0]["block"]["center_m"][0])
            return seen[-1] > min(seen) + 0.002
        self.host.when(has_gone)

    def test_each_pushes_the_block_and_the_other_feels_it(self):
        self.host.when(lambda s: s["arms"][0]["state"] == "active")
        self.guest.when(lambda s: s["arms"][0]["state"] == "active" and s["links"][0]["is_up"])
        with self.subTest("the way between them is as long as it was said"):
            link = self.guest.when(lambda s: s["links"][0]["round_trip_s"] > 0)["links"][0]
            self.assertGreaterEqual(link["round_trip_s"], 0.05)
            self.assertEqual((link["peer"], link["scheme"]), ("udp://10.68.0.1:5001", "ghost-point"))
        with self.subTest("with a key of their own"):
            self.assertEqual(os.stat(self.folder / "link.key").st_mode & 0o777, 0o600)
        # Each stands on one side of it, and can push it only away from itself.
        with self.subTest("the host's arm, at the left, pushes it to the right"):
            self.see_it_pushed(1)
        with self.subTest("and with it the guest's, which feels its right face"):
            pushed = self.guest.when(lambda s: s["arms"][0]["is_in_contact"] and s["arms"][0]["force_newton"][0] > 0.05)
            felt = pushed["arms"][0]["felt"]
            self.assertEqual(felt["planes"][0]["normal"], [-1, 0, 0])
            self.assertTrue(math.isfinite(felt["position_m"][0]))
        with self.subTest("the guest's arm, at the right, pushes it to the left"):
            self.see_it_pushed(-1)
        with self.subTest("and with it the host's, whose frame gives way: no wall is late to it that another did not move"):
            self.host.when(lambda s: s["arms"][0]["offset_m"][0] < -0.001)
        with self.subTest("nothing came to grief"):
            for side in (self.host, self.guest):
                self.assertEqual(side.status()["arms"][0]["faults"], [])
        self.assert_it_leaves_no_namespace_behind()


class Teleoperation(TwoHosts, rig.ProcessTest):
    arguments = ("teleoperation",)
    scheme = "wave"  # of the arm that moves

    def test_what_one_does_the_other_is_drawn_along_by(self):
        self.guest.when(lambda s: s["arms"][0]["state"] == "active" and s["links"][0]["is_up"])
        first = self.host.when(lambda s: s["arms"][0]["state"] == "active")["arms"][0]
        with self.subTest("its far end is the arm of the other host, as far away as was said, with a key of their own"):
            link = self.guest.when(lambda s: s["links"][0]["round_trip_s"] > 0)["links"][0]
            self.assertEqual((link["peer"], link["peer_arm"], link["scheme"]), ("udp://10.68.0.1:5001", "here", self.scheme))
            self.assertGreaterEqual(link["round_trip_s"], 0.04)
            self.assertEqual(os.stat(self.folder / "link.key").st_mode & 0o777, 0o600)
        with self.subTest("the hand that holds still is moved by 3 mm, and its arm pulls at it"):
            def is_drawn(status):
                arm = status["arms"][0]
                return math.dist(arm["position_m"], first["position_m"]) > 0.003 and math.hypot(*arm["force_newton"]) > 0.1
            self.host.when(is_drawn)
        with self.subTest("and the hand that moves feels it"):
            self.guest.when(lambda s: math.hypot(*s["arms"][0]["force_newton"]) > 0.1)
        with self.subTest("nothing came to grief"):
            for side in (self.host, self.guest):
                self.assertEqual(side.status()["arms"][0]["faults"], [])
        self.assert_it_leaves_no_namespace_behind()


class BySpringDamper(Teleoperation):
    arguments = ("teleoperation", "spring-damper")
    scheme = "spring-damper"


class ByGhostPoint(Teleoperation):
    """The arm that is drawn along is a spring-damper's."""

    arguments = ("teleoperation", "ghost-point")
    scheme = "ghost-point"


if __name__ == "__main__":
    unittest.main()

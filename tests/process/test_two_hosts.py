"""Arms of other hosts touch a world by our own datagrams: as many daemons as hosts, on loopback."""

import os
import signal

from rig import ProcessTest, free_udp_port

KEY = "0f" * 32

WORLD = """
[[world]]
name = "box"
source = "box:3"
listen = "udp://127.0.0.1:{port}"
key_file = "{key}"
"""

ARM = """
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
link = "udp://127.0.0.1:{port}"
protocol = "thimble"
key_file = "{key}"
coupling.scheme = "{scheme}"
[arm.hand]
motion = "poke"
seed = {seed}
"""


def link(status):
    return status["links"][0]


class TwoHosts(ProcessTest):
    def setUp(self):
        super().setUp()
        self.port = free_udp_port()
        self.key = self.key_file("link.key", KEY + "\n")
        self.world = self.start(name="world", config=WORLD.format(port=self.port, key=self.key))

    def key_file(self, name, text, mode=0o600):
        path = self.write(name, text)
        os.chmod(path, mode)
        return path

    def arm(self, name, scheme="ghost-point", key=None, seed=1):
        return self.start(name=name, config=ARM.format(port=self.port, key=key or self.key, scheme=scheme, seed=seed))

    def sessions(self):
        return [one for one in self.world.status()["links"] if one["kind"] == "thimble"]

    def test_every_scheme_is_felt(self):
        for scheme in ("ghost-point", "remote-force", "spring-damper", "wave"):
            with self.subTest(scheme):
                arm = self.arm(scheme, scheme)
                status = arm.status_when(lambda s: link(s)["is_up"] and s["arms"][0]["contacts"] > 0
                                         and "clocks" in link(s))
                self.assertEqual(link(status)["kind"], "thimble")
                self.assertEqual(link(status)["peer_world"], "box")
                # One clock on one machine: whatever the ways, it is off by no more than is told.
                clocks = link(status)["clocks"]
                self.assertLessEqual(abs(clocks["offset_s"]), clocks["offset_error_s"])
                self.assertGreater(status["arms"][0]["peak_force_newton"], 0.1)
                arm.stop()

    def test_a_wrong_key_hears_nothing_and_is_counted(self):
        good = self.arm("good")
        wrong = self.arm("wrong", key=self.key_file("wrong.key", "0e" * 32))
        self.world.status_when(lambda s: s["links"][0]["events"]["bad_seal"] >= 3)
        self.assertFalse(link(wrong.status())["is_up"])
        self.assertEqual(link(wrong.status())["received"], 0)
        good.status_when(lambda s: link(s)["is_up"])
        self.assertEqual(len(self.sessions()), 1)

    def test_a_key_that_others_may_read_ends_the_start(self):
        open_key = self.key_file("open.key", KEY, 0o644)
        with self.assertRaisesRegex(AssertionError, "chmod 600"):
            self.arm("careless", key=open_key)

    def test_an_arm_that_is_stopped_stalls_no_other(self):
        stopped, other = self.arm("stopped"), self.arm("other", seed=2)
        for arm in (stopped, other):
            arm.status_when(lambda s: link(s)["is_up"])
        stopped.process.send_signal(signal.SIGSTOP)
        try:
            self.world.status_when(lambda s: s["links"][0]["events"]["sessions_released"] >= 1)
            before = link(other.status())
            other.status_when(lambda s: link(s)["events"]["accepted"] >= before["events"]["accepted"] + 500)
            self.assertEqual(link(other.status())["events"]["sessions_opened"], 1)
            self.assertEqual(len(self.sessions()), 1)
        finally:
            stopped.process.send_signal(signal.SIGCONT)
        stopped.status_when(lambda s: link(s)["is_up"] and link(s)["events"]["sessions_opened"] >= 2)
        self.assertEqual(len(self.sessions()), 2)

    def test_a_world_that_restarts_is_found_again(self):
        arm = self.arm("arm")
        arm.status_when(lambda s: link(s)["is_up"])
        self.world.stop(signal.SIGKILL)
        arm.status_when(lambda s: not link(s)["is_up"])
        self.start(name="again", config=WORLD.format(port=self.port, key=self.key))
        arm.status_when(lambda s: link(s)["is_up"])

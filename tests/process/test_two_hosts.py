"""Arms of other hosts touch a world by our own datagrams: as many daemons as hosts, on loopback."""

import itertools
import os
import random
import select
import signal
import socket
import threading

from rig import ProcessTest, free_udp_port, udp_socket

KEY = "0f" * 32
# Who says nothing for a second has lost its session, also where a busy machine kept it from that: then it is another round.
ROUNDS = 5

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


HOST_ARM = """
[[arm]]
name = "left"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
listen = "udp://127.0.0.1:{port}"
key_file = "{key}"
coupling.scheme = "wave"
[arm.hand]
stiffness_newton_per_m = 50
"""

PIECES = """
[[world]]
name = "desk"
source = "pieces"
listen = "{address}"
{key}
[world.pieces]
cells = 32
count = 1
"""


def link(status):
    return status["links"][0]


def is_up(status):
    return link(status)["is_up"]


def sessions_opened(status):
    return link(status)["events"]["sessions_opened"]


def sessions_released(status):
    return link(status)["events"]["sessions_released"]


def sessions_of_arms(status):
    """At a world."""
    return [one for one in status["links"] if one["kind"] == "thimble"]


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

    def assert_sessions(self, count):
        """Never more, and as many at last: one that a busy machine kept silent is taken again."""
        def are_all_there(status):
            there = len(sessions_of_arms(status))
            self.assertLessEqual(there, count)
            return there == count

        self.world.status_when(are_all_there)

    def assert_goes_on(self, arm, meanwhile=lambda: None):
        """Its servo ticks without a fault and its session, the one it had, is answered, while `meanwhile` is done again
        and again."""
        for _ in range(ROUNDS):
            before = arm.status_when(is_up)
            after = self.gone_on(arm, before, meanwhile)
            self.assertEqual(after["arms"][0]["faults"], [])
            if sessions_released(after) == sessions_released(before):
                break
        self.assertEqual(sessions_opened(after), sessions_opened(before))

    def gone_on(self, arm, before, meanwhile):
        """The status of an arm that is answered, some time after that one."""
        def has_gone_on(status):
            meanwhile()
            ticks, accepted = (status["servos"][0]["ticks"], link(status)["events"]["accepted"])
            return (is_up(status) and ticks >= before["servos"][0]["ticks"] + 500
                    and accepted >= link(before)["events"]["accepted"] + 500)

        return arm.status_when(has_gone_on)

    def test_every_scheme_is_felt(self):
        for scheme in ("ghost-point", "constraint-plane", "remote-force", "spring-damper", "wave", "buffer-zone",
                       "composite"):
            with self.subTest(scheme):
                arm = self.arm(scheme, scheme)
                status = arm.status_when(lambda s: link(s)["is_up"] and s["arms"][0]["contacts"] > 0
                                         and s["arms"][0]["peak_force_newton"] > 0.1 and "clocks" in link(s))
                self.assertEqual(link(status)["kind"], "thimble")
                self.assertEqual(link(status)["peer_world"], "box")
                # One clock on one machine: whatever the ways, it is off by no more than is told.
                clocks = link(status)["clocks"]
                self.assertLessEqual(abs(clocks["offset_s"]), clocks["offset_error_s"])
                arm.stop()

    def test_what_is_asked_of_an_arm_comes_about_in_the_world_of_the_other_host(self):
        port = free_udp_port()
        desk = self.start(name="desk", config=PIECES.format(address=f"udp://127.0.0.1:{port}", key=f'key_file = "{self.key}"'))
        arm = self.start(name="arm", config=ARM.format(port=port, key=self.key, scheme="ghost-point", seed=1))
        arm.status_when(lambda s: link(s)["is_up"])
        for verb, wish, is_free in (("free", "to switch free motion", True), ("free", "to switch free motion", False),
                                    ("free", "to switch free motion", True), ("reset", "for a reset", False)):
            self.ask_the_far_world(arm, verb, f"arm right: its world was asked {wish}\n", desk, is_free)
        arm.stop()
        with self.subTest("an arm that comes again asks for nothing of before"):
            again = self.start(name="again", config=ARM.format(port=port, key=self.key, scheme="wave", seed=1))
            before = link(again.status_when(lambda s: link(s)["is_up"]))["events"]["accepted"]
            again.status_when(lambda s: link(s)["events"]["accepted"] >= before + 300)
            self.assertFalse(desk.status()["worlds"][0]["pieces"]["is_free_motion"])
        with self.subTest("a world that does nothing of the kind, or is away, is said to the person"):
            box = self.arm("box")
            box.status_when(lambda s: link(s)["is_up"])
            told = self.thimble(box, "free", "right")
            self.assertEqual(told.returncode, 1)
            self.assert_one_sentence(told.stderr, "only a world of pieces")
            self.world.stop(signal.SIGKILL)
            box.status_when(lambda s: not link(s)["is_up"])
            self.assert_one_sentence(self.thimble(box, "reset").stderr, "does not answer")

    def test_a_wrong_key_hears_nothing_and_is_counted(self):
        good = self.arm("good")
        good.status_when(lambda s: link(s)["is_up"])
        wrong = self.arm("wrong", key=self.key_file("wrong.key", "0e" * 32))
        self.world.status_when(lambda s: s["links"][0]["events"]["bad_seal"] >= 3)
        self.assertFalse(link(wrong.status())["is_up"])
        self.assertEqual(link(wrong.status())["received"], 0)
        self.assert_servo_goes_on(wrong)
        self.assert_goes_on(good)
        self.assert_sessions(1)

    def test_a_key_that_others_may_read_ends_the_start(self):
        open_key = self.key_file("open.key", KEY, 0o644)
        with self.assertRaisesRegex(AssertionError, "chmod 600"):
            self.arm("careless", key=open_key)

    def test_an_arm_that_is_stopped_stalls_no_other(self):
        stopped, other = self.arm("stopped"), self.arm("other", seed=2)
        for _ in range(ROUNDS):
            before = other.status_when(is_up)
            of_stopped = stopped.status_when(is_up)
            stopped.process.send_signal(signal.SIGSTOP)
            try:
                self.world.status_when(lambda s: len(sessions_of_arms(s)) == 1)
                self.assert_goes_on(other)
                self.world.status_when(lambda s: len(sessions_of_arms(s)) == 1)
                after = other.status()
            finally:
                stopped.process.send_signal(signal.SIGCONT)
            stopped.status_when(lambda s, before=sessions_opened(of_stopped): is_up(s) and sessions_opened(s) > before)
            self.assert_sessions(2)
            if sessions_released(after) == sessions_released(before):
                break
        self.assertEqual(sessions_opened(after), sessions_opened(before))

    def test_a_world_that_restarts_is_found_again(self):
        arm = self.arm("arm", scheme="auto")
        arm.status_when(lambda s: link(s)["is_up"] and link(s)["scheme"] == "composite")
        self.world.stop(signal.SIGKILL)
        arm.status_when(lambda s: not link(s)["is_up"])
        self.assert_servo_goes_on(arm)
        simple = WORLD.format(port=self.port, key=self.key) + 'constraint_model = "simple"\n'
        self.start(name="again", config=simple)
        status = arm.status_when(lambda s: link(s)["is_up"] and link(s)["scheme"] == "ghost-point")
        self.assertEqual(link(status)["scheme_reason"], "the world does not go with composite")

    def test_two_arms_are_each_others_far_end(self):
        port = free_udp_port()
        left = self.start(name="left", config=HOST_ARM.format(port=port, key=self.key))
        guest = ARM.replace("poke", "sweep").format(port=port, key=self.key, scheme="{scheme}", seed=1)
        with self.subTest("one that does not go with it hears why, and so does the other"):
            wrong = self.start(name="wrong", config=guest.format(scheme="spring-damper"))
            wrong.status_when(lambda s: "an arm of the scheme wave, which does not go with spring-damper"
                              in link(s)["last_error"])
            left.status_when(lambda s: "spring-damper does not go with wave" in s["links"][1]["last_error"])
            wrong.stop()
        right = self.start(name="right", config=guest.format(scheme="wave"))
        with self.subTest("what one does the other feels"):
            status = right.status_when(lambda s: link(s)["is_up"] and s["arms"][0]["peak_force_newton"] > 0.1)
            self.assertEqual(link(status)["peer_arm"], "left")
            drawn = left.status_when(lambda s: s["arms"][0]["peak_force_newton"] > 0.1)
            self.assertEqual(drawn["arms"][0]["world"], drawn["links"][2]["peer"])
        with self.subTest("an arm whose peer is killed is let go"):
            left.stop(signal.SIGKILL)
            alone = right.status_when(lambda s: not link(s)["is_up"] and s["arms"][0]["force_newton"] == [0, 0, 0])
            right.status_when(lambda s: s["servos"][0]["ticks"] >= alone["servos"][0]["ticks"] + 500)
            self.assertEqual(right.status()["arms"][0]["faults"], [])
        with self.subTest("and taken up by the one that comes after"):
            self.start(name="again", config=HOST_ARM.format(port=port, key=self.key))
            right.status_when(lambda s: link(s)["is_up"])

    def test_a_world_that_is_stopped_stalls_no_servo_and_no_other_world(self):
        port = free_udp_port()
        self.start(name="beside", config=WORLD.format(port=port, key=self.key))
        # Both links of one daemon: they have one net plane.
        texts = [ARM.format(port=one, key=self.key, scheme="ghost-point", seed=1) for one in (port, self.port)]
        arms = self.start(name="arms", config=texts[0] + texts[1].replace('"right"', '"left"'))
        arms.status_when(lambda s: s["links"][0]["is_up"] and s["links"][1]["is_up"])
        self.world.process.send_signal(signal.SIGSTOP)
        try:
            arms.status_when(lambda s: not s["links"][1]["is_up"])
            self.assert_goes_on(arms)
            before = arms.status()["servos"]
            status = arms.status_when(lambda s: all(now["ticks"] >= then["ticks"] + 500
                                                    for now, then in zip(s["servos"], before)))
            self.assertEqual([(arm["state"], arm["faults"]) for arm in status["arms"]], [("active", [])] * 2)
        finally:
            self.world.process.send_signal(signal.SIGCONT)
        arms.status_when(lambda s: s["links"][1]["is_up"])

    def test_a_flood_is_counted_and_takes_no_session_away(self):
        arms = self.arm("arm"), self.arm("other", seed=2)
        for arm in arms:
            arm.status_when(lambda s: link(s)["is_up"])
        source = random.Random(4)
        sealed_hello = b"THMB\x01\x01\x00\x01" + bytes(8)
        with udp_socket() as flood:
            def pour():
                for _ in range(500):
                    noise = source.randbytes(source.randrange(0, 1400))
                    kind = source.randrange(3)
                    if kind == 1:
                        noise = sealed_hello + noise[:1100]
                    elif kind == 2:
                        noise = b"THMB" + noise[:1190]
                    flood.sendto(noise, ("127.0.0.1", self.port))

            for arm in arms:
                self.assert_goes_on(arm, meanwhile=pour)
        world = self.world.status()
        self.assertGreater(world["links"][0]["rejected"], 500)
        self.assertGreater(world["links"][0]["events"]["bad_seal"], 10)
        self.assert_sessions(2)

    def test_a_capture_that_is_played_again_moves_nothing(self):
        with Wiretap(self.port) as tap:
            arm = self.start(name="arm", config=ARM.format(port=tap.port, key=self.key, scheme="ghost-point", seed=1))
            arm.status_when(lambda s: link(s)["events"]["accepted"] >= 300)
            other_arm = self.arm("other", seed=2)
            other_arm.status_when(lambda s: link(s)["is_up"])
            captured = list(tap.captured)
            with udp_socket() as other:  # from elsewhere: no session of its own, and none taken
                self.play(captured, other, lambda s: s["links"][0]["events"]["wrong_peer"] >= 100)
            # from the arm's own address
            self.play(captured, tap.out, lambda s: s["links"][0]["stale"] >= 100)
            # Each round hears all of that several times: how the session began, and some samples.
            beginning = captured[:200]
            with udp_socket() as other:
                for one, out in itertools.product((arm, other_arm), (other, tap.out)):
                    self.assert_goes_on(one, meanwhile=self.sayer(beginning, out))
                    status = one.status()
                    self.assertLessEqual(sessions_opened(status) - sessions_released(status), 1)
            self.assert_sessions(2)

    def play(self, captured, out, counted):
        """Says `captured` again and again, a few at a time, since a kernel drops what comes to a
        busy world in one go, until the world has `counted`."""
        say_some = self.sayer(captured, out)

        def say_and_count(status):
            say_some()
            return counted(status)

        self.world.status_when(say_and_count)

    def sayer(self, captured, out):
        datagrams = itertools.cycle(captured)

        def say_some():
            for datagram in itertools.islice(datagrams, 32):
                out.sendto(datagram, ("127.0.0.1", self.port))

        return say_some


class Wiretap:
    """Stands between an arm and the world's port, and keeps what the arm says."""

    def __init__(self, port):
        self.world = ("127.0.0.1", port)
        self.inside = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.inside.bind(("127.0.0.1", 0))
        self.port = self.inside.getsockname()[1]
        self.out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.out.bind(("127.0.0.1", 0))
        self.captured = []
        self.is_over = threading.Event()
        self.thread = threading.Thread(target=self.carry, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.is_over.set()
        self.thread.join()
        self.inside.close()
        self.out.close()

    def carry(self):
        arm = None
        while not self.is_over.is_set():
            readable, _, _ = select.select([self.inside, self.out], [], [], 0.05)
            try:
                if self.inside in readable:
                    datagram, arm = self.inside.recvfrom(2048)
                    self.captured.append(datagram)
                    self.out.sendto(datagram, self.world)
                if self.out in readable:
                    datagram = self.out.recv(2048)
                    if arm:
                        self.inside.sendto(datagram, arm)
            except ConnectionError:  # nobody listens there any more
                pass

"""`thimbled` with the arm's half of the example pair in front of a server of 1999."""

import itertools
import math
import os
import random
import struct

from programs_of_1999 import GARBAGE, Server, reply_bytes
from rig import EXAMPLES, ProcessTest, free_udp_port, udp_socket


class Arm(ProcessTest):
    def start_arm(self, port, *arguments, name="arm"):
        return self.start("--config", EXAMPLES / "arm-host.toml",
                          "--set", f"arm.link=udp://127.0.0.1:{port}", *arguments, name=name)

    def feel(self, daemon, more_contacts=2):
        """Waits until the person has touched more walls, and finds the arm well."""
        before = daemon.status()["arms"][0]["contacts"]
        status = daemon.status_when(lambda s: s["arms"][0]["contacts"] >= before + more_contacts)
        arm = status["arms"][0]
        self.assertEqual((arm["state"], arm["faults"]), ("active", []))
        self.assertGreater(arm["peak_force_newton"], 0)
        for number in arm["force_newton"] + arm["offset_m"] + arm["position_m"]:
            self.assertTrue(math.isfinite(number), arm)
        return status

    def test_feels_the_box_of_a_server_of_1999(self):
        with Server() as server:
            daemon = self.start_arm(server.port)
            link = self.feel(daemon)["links"][0]
            self.assertEqual((link["rejected"], link["is_up"]), (0, True))
            self.assertEqual(daemon.stop(), 0)
        self.assertEqual(server.sizes, {12})
        self.assertGreater(len(server.positions), 100)
        for position in server.positions:
            self.assertTrue(all(math.isfinite(x) and abs(x) < 500 for x in position), position)

    def test_and_so_in_lock_step(self):
        with Server() as server:
            daemon = self.start_arm(server.port, "--set", "arm.coupling.mode=lock-step")
            self.feel(daemon)

    def test_never_touches_what_lies_in_the_buffer_of_unset_axes(self):
        source = random.Random(5)

        def answer(_, position):
            return [reply_bytes(position, unset=source.choices(GARBAGE, k=3))]

        with Server(answer=answer) as server:
            link = self.feel(self.start_arm(server.port), 4)["links"][0]
            self.assertEqual(link["rejected"], 0)
            for position in server.positions:
                self.assertTrue(all(map(math.isfinite, position)), position)

    def test_refuses_replies_that_no_server_of_1999_sends(self):
        good = struct.pack(">fff", 15, 15, 15)
        bad = [bytes(size) for size in range(65) if size != 13]
        bad += [good + bytes([directions]) for directions in (0x03, 0x0C, 0x30, 0x40, 0x80, 0xFF)]
        bad += [struct.pack(">fffB", number, 0, 0, 1) for number in (*GARBAGE[:4], -1e30)]
        endless = itertools.cycle(bad)

        with Server(answer=lambda _, position: [next(endless), reply_bytes(position)]) as server:
            status = self.feel(self.start_arm(server.port))
            self.assertGreater(status["links"][0]["rejected"], 0)

    def test_is_never_moved_by_such_replies_alone(self):
        source = random.Random(6)

        def answer(_, __):
            return [source.choice(GARBAGE).hex().encode(), source.randbytes(12),
                    struct.pack(">fffB", *source.choices(GARBAGE[:4], k=3), 0x15)]

        with Server(answer=answer) as server:
            daemon = self.start_arm(server.port)
            status = daemon.status_when(lambda s: s["links"][0]["rejected"] > 30)
            self.assertFalse(status["links"][0]["is_up"])
            self.assertEqual(status["arms"][0]["peak_force_newton"], 0)
            self.assertEqual(status["arms"][0]["faults"], [])
            self.assert_servo_goes_on(daemon)

    def test_lost_replies_stop_nothing_in_either_mode(self):
        for mode in ("streamed", "lock-step"):
            with self.subTest(mode), Server(
                    answer=lambda number, p: [] if number % 7 == 0 else [reply_bytes(p)]) as server:
                daemon = self.start_arm(server.port, "--set", f"arm.coupling.mode={mode}",
                                        name=mode)
                self.feel(daemon)
                daemon.status_when(lambda s: s["links"][0]["lost"] > 0)
                self.assertEqual(daemon.stop(), 0)

    def test_duplicated_replies_are_stale(self):
        with Server(answer=lambda _, p: [reply_bytes(p)] * 2) as server:
            daemon = self.start_arm(server.port)
            self.feel(daemon)
            daemon.status_when(lambda s: s["links"][0]["stale"] > 0)

    def test_finds_a_server_that_starts_later_and_one_that_restarts(self):
        port = free_udp_port()
        daemon = self.start_arm(port)
        status = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        self.assertFalse(status["links"][0]["is_up"])
        for _ in range(2):
            with Server(port):
                self.feel(daemon)
            status = daemon.status_when(lambda s: not s["links"][0]["is_up"])
            self.assertEqual(status["arms"][0]["faults"], [])
            daemon.status_when(lambda s: s["arms"][0]["force_newton"] == [0, 0, 0])

    def test_is_deaf_to_others_than_the_server(self):
        with Server() as server, udp_socket() as stranger:
            daemon = self.start_arm(server.port)
            self.feel(daemon, 1)
            (port,) = udp_ports_of(daemon.pid)
            for _ in range(200):
                stranger.sendto(struct.pack(">fffB", -40, 0, 0, 1), ("127.0.0.1", port))
            status = daemon.status_when(lambda s: s["links"][0]["rejected"] >= 200)
            self.assertEqual(status["arms"][0]["faults"], [])
            self.feel(daemon, 1)


class Pair(ProcessTest):
    def test_the_two_examples_meet(self):
        port = free_udp_port()
        world = self.start("--config", EXAMPLES / "world-host.toml",
                           "--set", f"world.listen=udp://127.0.0.1:{port}", name="world")
        arm = self.start("--config", EXAMPLES / "arm-host.toml",
                         "--set", f"arm.link=udp://127.0.0.1:{port}", name="arm")
        arm.status_when(lambda s: s["arms"][0]["contacts"] >= 2)
        self.assertEqual(world.status()["links"][0]["rejected"], 0)
        self.assertEqual((arm.stop(), world.stop()), (0, 0))


def udp_ports_of(pid):
    """Local ports of the process's UDP sockets over IPv4."""
    inodes = set()
    for name in os.listdir(f"/proc/{pid}/fd"):
        try:
            target = os.readlink(f"/proc/{pid}/fd/{name}")
        except FileNotFoundError:  # a connection that has just gone
            continue
        if target.startswith("socket:["):
            inodes.add(target[8:-1])
    ports = []
    with open(f"/proc/{pid}/net/udp", encoding="ascii") as table:
        for line in table.readlines()[1:]:
            words = line.split()
            if words[9] in inodes:
                ports.append(int(words[1].split(":")[1], 16))
    return ports

"""A client of 1999 in front of `thimbled` with the world's half of the example pair."""

import random
import struct

from programs_of_1999 import Client, reply_bytes, request_bytes
from rig import EXAMPLES, ProcessTest, free_udp_port, udp_socket

# Who says nothing for a second has lost its session, also where a busy machine kept it from that: then it is another round.
ROUNDS = 5


class ConstraintModel(ProcessTest):
    def test_decides_what_the_same_datagrams_say(self):
        for model, directions in (("ghost-point", 0x05), ("simple", 0x04)):
            with self.subTest(model):
                port = free_udp_port()
                self.start("--config", EXAMPLES / "world-host.toml", "--set",
                           f"world.listen=udp://127.0.0.1:{port}", "--set",
                           f"world.constraint_model={model}", name=model)
                with Client(port) as client:
                    for x, y, expected in ((0, 0, 0), (0, 16, 0x04), (20, 16, directions)):
                        self.assertEqual(client.ask(x, y, 0)[12], expected)


class World(ProcessTest):
    def setUp(self):
        super().setUp()
        self.port = free_udp_port()
        self.daemon = self.start("--config", EXAMPLES / "world-host.toml",
                                 "--set", f"world.listen=udp://127.0.0.1:{self.port}")

    def link(self):
        return self.daemon.status()["links"][0]

    def rejected_at_least(self, count):
        return self.daemon.status_when(lambda s: s["links"][0]["rejected"] >= count)["links"][0]

    @staticmethod
    def has_kept_its_session(before, after):
        """The link, from one moment to the other: who had one then has it still, and nobody else had any."""
        opened = before["events"]["sessions_opened"]
        return (after["events"]["sessions_opened"], after["events"]["sessions_released"]) == (opened, opened - 1)

    def test_answers_in_exactly_the_bytes_of_the_thesis(self):
        with Client(self.port) as client:
            for position, reply in (
                    ((0, 0, 0), "00000000 00000000 00000000 00"),
                    ((20, 0, 0), "41700000 00000000 00000000 01"),
                    ((-20, 0, 0), "C1700000 00000000 00000000 02"),
                    ((0, 20, 0), "00000000 41700000 00000000 04"),
                    ((0, -20, 0), "00000000 C1700000 00000000 08"),
                    ((0, 0, 20), "00000000 00000000 41700000 10"),
                    ((0, 0, -20), "00000000 00000000 C1700000 20"),
                    ((20, -20, 20), "41700000 C1700000 41700000 19"),
                    ((15, 0, 0), "41700000 00000000 00000000 01"),
                    ((-15, 0, 0), "00000000 00000000 00000000 00"),
                    ((14.99, 0, 0), "00000000 00000000 00000000 00")):
                self.assertEqual(client.ask(*position), bytes.fromhex(reply), position)

    def test_agrees_with_the_server_of_1999_along_a_random_walk(self):
        source = random.Random(1999)
        position = [0.0, 0.0, 0.0]
        with Client(self.port) as client:
            for _ in range(2000):
                for axis in range(3):
                    step = source.choice((source.gauss(0, 3), source.gauss(0, 30)))
                    moved = min(max(position[axis] + step, -60.0), 60.0)
                    (position[axis],) = struct.unpack(">f", struct.pack(">f", moved))
                self.assertEqual(client.ask(*position), reply_bytes(position), position)
        link = self.link()
        self.assertEqual((link["received"], link["sent"], link["rejected"]), (2000, 2000, 0))

    def test_a_duplicate_and_a_burst_are_answered_each(self):
        with Client(self.port) as client:
            for x in (20, 20, -20, 0):
                client.send(request_bytes(x, 0, 0))
            self.assertEqual([client.receive()[12] for _ in range(4)], [1, 1, 2, 0])

    def test_malformed_requests_of_every_size_get_no_answer_and_no_session(self):
        with Client(self.port) as stranger, Client(self.port) as client:
            sizes = [size for size in range(65) if size != 12]
            for size in sizes:
                stranger.send(b"\x41" * size)
            self.assertEqual(self.rejected_at_least(len(sizes))["sent"], 0)
            self.assertTrue(stranger.hears_nothing())
            # The stranger holds nothing: another is answered at once.
            self.assertEqual(client.ask(20, 0, 0)[12], 1)

    def test_malformed_requests_within_a_session_do_not_disturb_it(self):
        source = random.Random(7)
        with Client(self.port) as client:
            for size in [*range(65), 1400, 9000]:
                self.assertEqual(client.ask(20, 0, 0)[12], 1)
                if size != 12:
                    client.send(source.randbytes(size))
            for number in ("7FC00000", "7F800000", "FF800000", "7F7FFFFF"):
                client.send(bytes.fromhex("00000000" + number + "00000000"))
            self.assertEqual(client.ask(-20, 0, 0)[12], 2)
            self.assertEqual(self.link()["rejected"], 64 + 2 + 4)

    def test_a_second_client_waits_until_the_first_has_been_silent(self):
        for _ in range(ROUNDS):
            with Client(self.port) as second:
                with Client(self.port) as first:
                    if not self.waits_for_the_first(first, second):
                        continue
                # The first is gone without a word. The second of 1999 blocks, and is answered.
                self.assertEqual(second.receive()[12], 2)
                self.assertEqual(second.ask(0, 0, 20)[12], 0x10)
                return
        self.fail("the first never kept its session")

    def waits_for_the_first(self, first, second):
        """False: the first did not keep its session."""
        self.assertEqual(first.ask(20, 0, 0)[12], 1)
        before = self.link()
        second.send(request_bytes(-20, 0, 0))
        self.daemon.status_when(lambda s: s["links"][0]["rejected"] > before["rejected"]
                                or not self.has_kept_its_session(before, s["links"][0]))
        for _ in range(50):
            self.assertEqual(first.ask(20, 0, 0)[12], 1)
        hears_nothing = second.hears_nothing()
        if not self.has_kept_its_session(before, self.link()):
            return False
        self.assertTrue(hears_nothing)
        return True

    def test_a_client_that_restarts_is_served_again(self):
        for x, directions in ((20, 1), (-20, 2), (20, 1)):
            with Client(self.port) as client:
                self.assertEqual(client.ask(x, 0, 0)[12], directions)

    def test_a_daemon_that_restarts_serves_the_same_client_again(self):
        with Client(self.port) as client:
            self.assertEqual(client.ask(20, 0, 0)[12], 1)
            self.assertEqual(self.daemon.stop(), 0)
            self.daemon.close()
            self.start("--config", EXAMPLES / "world-host.toml",
                       "--set", f"world.listen=udp://127.0.0.1:{self.port}", name="again")
            self.assertEqual(client.ask(-20, 0, 0)[12], 2)

    def test_a_flood_of_others_does_not_disturb(self):
        source = random.Random(3)
        with Client(self.port) as client, udp_socket() as flood:
            flood.connect(("127.0.0.1", self.port))
            for _ in range(ROUNDS):
                self.assertEqual(client.ask(0, 0, 0)[12], 0)
                before = self.link()
                for _ in range(300):
                    # Fewer than a socket holds: what the kernel drops is not the daemon's doing.
                    for _ in range(100):
                        flood.send(source.choice((request_bytes(20, 20, 20), source.randbytes(13))))
                    self.assertEqual(client.ask(-20, 0, 0), reply_bytes((-20, 0, 0)))
                link = self.link()
                if self.has_kept_its_session(before, link):
                    break
        self.assertEqual((link["rejected"] - before["rejected"], link["sent"] - before["sent"]), (30000, 300))

    def test_a_second_world_on_the_port_is_refused(self):
        result = self.thimbled("--config", EXAMPLES / "world-host.toml",
                               "--set", f"world.listen=udp://127.0.0.1:{self.port}",
                               "--set", f"daemon.socket={self.folder}/other")
        self.assertEqual(result.returncode, 1)
        self.assert_one_sentence(result.stderr, "box", str(self.port))

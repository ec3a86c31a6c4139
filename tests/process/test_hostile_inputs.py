"""Files, volumes and connections that mean no good, against the whole program."""

import contextlib
import json
import random
import resource
import socket
import struct
import threading

from rig import (EXAMPLES, HELLO, ProcessTest, die_with_parent, http_answer, http_over,
                 http_request, is_sanitized, unix_connection)

MIB = 1 << 20
CONNECTIONS = 40


def npy(shape="(4, 4, 4)", descr="|u1", data=b"\0" * 64, order="False", version=b"\x01\x00"):
    header = f"{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}".encode()
    header += b" " * (-(len(header) + 11) % 64) + b"\n"
    length = struct.pack("<H" if version[0] == 1 else "<I", len(header))
    return b"\x93NUMPY" + version + length + header + data


class Configurations(ProcessTest):
    def refuse(self, name, content, *more):
        file = self.write(name, content)
        result = self.thimbled("--config", file, "--check", *more)
        self.assertEqual(result.returncode, 2, (name, result.stderr[:500]))
        self.assertIn(str(file), result.stderr)
        self.assertLess(len(result.stderr), 100_000, "a mistake is told, not the whole file")
        return result.stderr

    def test_random_bytes_are_mistakes(self):
        source = random.Random(11)
        for number in range(20):
            self.refuse(f"noise-{number}", source.randbytes(source.randrange(1, 4096)))
        self.refuse("zeros", bytes(4096))

    def test_a_good_file_with_flipped_bytes_never_ends_it_otherwise(self):
        good = (EXAMPLES / "hello-voxel.toml").read_bytes()
        source = random.Random(12)
        for number in range(30):
            bad = bytearray(good)
            for _ in range(source.randrange(1, 8)):
                bad[source.randrange(len(bad))] = source.randrange(256)
            file = self.write(f"flipped-{number}", bytes(bad))
            result = self.thimbled("--config", file, "--check")
            self.assertIn(result.returncode, (0, 2), (bytes(bad), result.stderr))

    def test_a_huge_or_endless_file_is_too_large(self):
        words = self.refuse("huge.toml", b"# padding\n" * (2 * MIB // 10))
        self.assert_one_sentence(words, "huge.toml")
        result = self.thimbled("--config", "/dev/zero", "--check")
        self.assertEqual(result.returncode, 2)
        self.assert_one_sentence(result.stderr, "/dev/zero")

    def test_deep_nesting_is_a_mistake(self):
        self.refuse("deep.toml", b"a = " + b"[" * 60_000)
        self.refuse("deep-keys.toml", b".".join([b"a"] * 10_000) + b" = 1")

    def test_thousands_of_mistakes_are_still_few_words(self):
        self.refuse("many.toml", "".join(f"key-{number} = 1\n" for number in range(4_000)))


class Volumes(ProcessTest):
    def refuse(self, content):
        file = self.write("volume.npy", content)
        config = self.write("volume.toml",
                            HELLO.replace('source = "box:3"', 'source = "volume.npy"'))
        for more in ((), ("--check",)):
            result = self.thimbled("--config", config, "--set", f"daemon.socket={self.folder}/s",
                                   *more, preexec=self.little_memory)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assert_one_sentence(result.stderr, f"{config}:11:", "world.0.source", str(file))

    @staticmethod
    def little_memory():
        # Whatever size a file claims to have: nothing large is allocated before it is found out.
        # A sanitizer takes terabytes of address space for itself.
        if not is_sanitized():
            resource.setrlimit(resource.RLIMIT_AS, (64 * MIB, 64 * MIB))
        die_with_parent()

    def test_lies_are_told_in_one_sentence_with_the_file(self):
        for content in (b"", b"\x93NUMPY", npy()[:40], npy(data=b"\0" * 63),
                        npy(shape="(99999999, 99999999, 99999999)"),
                        npy(shape="(18446744073709551615, 2, 2)"), npy(shape="(-4, 4, 4)"),
                        npy(shape="(4, 4)"), npy(shape="(0, 4, 4)"), npy(shape="(2000, 2, 2)"),
                        npy(shape="(1024, 1024, 1024)"), npy(descr="|O"), npy(descr="<c16"),
                        npy(descr="<f8"), npy(order="Perhaps"), npy(version=b"\x09\x00"),
                        npy(version=b"\x02\x00")[:8] + b"\xff\xff\xff\xff",
                        b"PK\x03\x04" + bytes(200), random.Random(2).randbytes(5000)):
            with self.subTest(content[:90]):
                self.refuse(content)

    def test_what_is_no_file_is_refused(self):
        for source in ("none.npy", "folder.npy"):
            (self.folder / "folder.npy").mkdir(exist_ok=True)
            config = self.write("volume.toml",
                                HELLO.replace('source = "box:3"', f'source = "{source}"'))
            result = self.thimbled("--config", config, "--set", f"daemon.socket={self.folder}/s")
            self.assertEqual(result.returncode, 2)
            self.assert_one_sentence(result.stderr, source)

    def test_a_number_that_is_none_is_found_when_it_is_read(self):
        data = struct.pack("<64f", *[float("nan")] * 64)
        self.write("volume.npy", npy(descr="<f4", data=data))
        config = self.write("volume.toml",
                            HELLO.replace('source = "box:3"', 'source = "volume.npy"'))
        self.assertEqual(self.thimbled("--config", config, "--check").returncode, 0)
        result = self.thimbled("--config", config, "--set", f"daemon.socket={self.folder}/s")
        self.assertEqual(result.returncode, 1)
        self.assert_one_sentence(result.stderr, "volume[0, 0, 0]")


class Connections(ProcessTest):
    def setUp(self):
        super().setUp()
        self.daemon = self.start(config=HELLO)

    def connect(self):
        connection = unix_connection(self.daemon.socket)
        self.addCleanup(connection.close)
        return connection

    def tearDown(self):
        # Whatever was done to it: it runs, answers and ends well.
        self.assert_servo_goes_on(self.daemon)
        self.assertEqual(self.daemon.stop(), 0, self.daemon.log())
        super().tearDown()

    def test_garbage_is_refused_and_closed(self):
        source = random.Random(21)
        rubbish = [source.randbytes(source.randrange(1, 3000)) for _ in range(30)]
        rubbish += [b"\r\n\r\n", b"GET", b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01" + bytes(300),
                    b"GET /" + b"a" * 20_000, b"X: y\r\n" * 5000,
                    b"POST /v1/arms/right/activate HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
                    b"POST /v1/arms/right/activate HTTP/1.1\r\nContent-Length: 99999999999999999999"
                    b"\r\n\r\n", b"GET /v1/status HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffff"
                    b"ffffffffffff\r\n"]
        for words in rubbish:
            with self.connect() as connection, contextlib.suppress(BrokenPipeError,
                                                                   ConnectionResetError):
                connection.sendall(words)
                connection.shutdown(socket.SHUT_WR)
                answer = b"".join(iter(lambda c=connection: c.recv(65536), b""))
                if answer:
                    self.assertRegex(answer, rb"^HTTP/1\.1 [45]\d\d ")

    def test_paths_that_lead_nowhere(self):
        for method, target, code in (("GET", "/", 404), ("GET", "/v1/status/../../etc", 404),
                                     ("POST", "/v1/arms/%00/activate", 404),
                                     ("POST", "/v1/arms//activate", 404),
                                     ("DELETE", "/v1/status", 405),
                                     ("POST", "/v1/arms/right/explode", 404)):
            answered, _, body = http_over(self.daemon.socket, method, target)
            self.assertEqual(answered, code, (method, target))
            self.assertIn("message", json.loads(body)["error"])

    def test_more_connections_than_it_takes_keep_nobody_from_stopping(self):
        self.daemon.stop()
        by_clients = HELLO.replace("amplifier_max_a", "activate = false\namplifier_max_a")
        self.daemon = self.start(name="held", config=by_clients)
        holder = self.connect()
        self.assertEqual(http_request(holder, "POST", "/v1/arms/right/activate")[0], 200)
        silent = [self.connect() for _ in range(CONNECTIONS)]
        # All that came are served, in the place of those that were silent longest, and the holder stays.
        for _ in range(3):
            self.assertEqual(http_over(self.daemon.socket, "GET", "/v1/status")[0], 200)
        self.assertEqual(http_request(silent[-1], "GET", "/v1/status")[0], 200)
        self.assertEqual(silent[0].recv(1), b"", "it made room")
        self.assertEqual(http_request(holder, "GET", "/v1/status")[0], 200)
        self.assertEqual(http_over(self.daemon.socket, "POST", "/v1/arms/right/deactivate")[0], 200)

    def test_slow_clients_that_never_read(self):
        for _ in range(10):
            connection = self.connect()
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
            connection.setblocking(False)
            with contextlib.suppress(BlockingIOError, BrokenPipeError, ConnectionResetError):
                for _ in range(10_000):
                    connection.send(b"GET /v1/status HTTP/1.1\r\nHost: thimble\r\n\r\n" * 20)

    def test_a_request_in_single_bytes(self):
        connection = self.connect()
        for byte in b"GET /v1/status HTTP/1.1\r\nHost: thimble\r\n\r\n":
            connection.send(bytes([byte]))
        self.assertEqual(http_answer(connection)[0], 200)

    def test_clients_that_come_and_go(self):
        for number in range(500):
            with self.connect() as connection:
                if number % 2:
                    connection.send(b"POST /v1/arms/right/activate HTTP/1.1\r\n\r\n")


class Answers(ProcessTest):
    """A daemon that is none: its status is good, what it answers to a command is not."""

    STATUS = json.dumps({"version": "0", "arms": [{"name": "right"}], "worlds": [{"name": "box", "cells": [3, 3, 3]}]})

    def answer(self, connection):
        with connection, contextlib.suppress(BrokenPipeError, ConnectionResetError):
            while request := connection.recv(65536):
                body = self.STATUS if request.startswith(b"GET") else "{}"
                connection.sendall(f"HTTP/1.1 200 OK\r\nContent-Length: {len(body)}\r\n\r\n{body}"
                                   .encode())

    def test_garbage_is_no_success(self):
        path = str(self.folder / "none.sock")
        state = self.write("state.nrrd", "of an earlier day")
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(path)
            listener.listen()
            for words in (["world", "fill", "box"], ["activate"], ["deactivate"], ["clear-fault", "right"],
                          ["world", "save", "box", "--file", state], ["world", "load", "box", "--file", state]):
                daemon = threading.Thread(target=lambda: self.answer(listener.accept()[0]))
                daemon.start()
                told = self.run_program("thimble", *words, "--socket", path)
                daemon.join()
                self.assertEqual((told.returncode, told.stdout), (1, ""), words)
                self.assert_one_sentence(told.stderr, "the answer is not the daemon's")
        self.assertEqual(state.read_text(), "of an earlier day")

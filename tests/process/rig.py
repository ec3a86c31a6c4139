"""Starts the real programs in a folder of their own, and sees to it that none is left behind.

The waits are bounded by TIMEOUT_S, which only says when a test gives up: no test asserts how long
something takes.
"""

import contextlib
import ctypes
import functools
import json
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
BIN = pathlib.Path(os.environ.get("THIMBLE_BIN", ROOT / "build/release/bin"))
SAMPLE = pathlib.Path(os.environ.get("THIMBLE_SAMPLE_DRIVER", BIN.parent / "tests/support/sample_driver/sample_driver.so"))
TIMEOUT_S = 60.0
_PR_SET_PDEATHSIG = 1

HELLO = (ROOT / "tests/data/hello.toml").read_text()


def die_with_parent():
    # A test that is killed outright must not leave a daemon running.
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


@functools.cache
def sanitizer():
    """What the programs were built with: asan, tsan or None."""
    program = (BIN / "thimbled").read_bytes()
    return next((name for name in ("asan", "tsan") if f"__{name}_init".encode() in program), None)


def is_sanitized():
    return sanitizer() is not None


def free_udp_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def udp_socket(timeout_s=TIMEOUT_S):
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.settimeout(timeout_s)
    return sock


class Notifications:
    """The service manager's end of sd_notify."""

    def __init__(self, folder):
        self.path = str(folder / "notify")
        self.seen = []
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(self.path)
        os.chmod(self.path, 0o777)  # a daemon of another user tells it too

    def close(self):
        self._socket.close()
        with contextlib.suppress(FileNotFoundError):
            os.unlink(self.path)

    def take(self, timeout_s):
        """The next message's lines are kept in `seen`; False when none came in time."""
        self._socket.settimeout(timeout_s)
        try:
            self.seen += self._socket.recv(65536).decode().splitlines()
        except (TimeoutError, BlockingIOError):
            return False
        return True

    def drain(self):
        while self.take(0):
            pass


class Daemon:
    """One thimbled, ready when the constructor returns."""

    def __init__(self, folder, arguments, environment=None, preexec=None, program=None):
        self.folder = folder
        self.socket = str(folder / "thimble.sock")
        self.summary = folder / "summary.json"
        self.notifications = Notifications(folder)
        self._log_file = folder / "log"
        command = [str(program or BIN / "thimbled"), *map(str, arguments),
                   "--set", f"daemon.socket={self.socket}", "--summary", str(self.summary)]
        if not any("daemon.flight_directory" in str(word) for word in arguments):
            command += ["--set", f"daemon.flight_directory={folder}"]
        with open(self._log_file, "wb") as log:
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                env={**clean_environment(), "NOTIFY_SOCKET": self.notifications.path,
                     **(environment or {})},
                preexec_fn=preexec or die_with_parent)
        self._wait_ready()
        # GCC 12's ThreadSanitizer keeps a signal that comes while its thread waits for the very first
        # time in a place that it then replaces: the handler is never called (seen in the kernel's
        # trace: no byte in the pipe). A daemon that has answered has waited.
        if sanitizer() == "tsan":
            self.status()

    @property
    def pid(self):
        return self.process.pid

    def log(self):
        return self._log_file.read_text(errors="replace")

    def _wait_ready(self):
        deadline = time.monotonic() + TIMEOUT_S
        while "READY=1" not in self.notifications.seen:
            self.notifications.take(0.05)
            if self.process.poll() is not None and not self.notifications.take(0):
                code = self.process.returncode
                self.close()
                raise AssertionError(f"thimbled ended with {code} before it was ready:\n"
                                     f"{self.log()}")
            if time.monotonic() > deadline:
                self.close()
                raise AssertionError("thimbled did not become ready:\n" + self.log())

    def wait(self):
        """Exit code of a daemon that ends by itself."""
        deadline = time.monotonic() + TIMEOUT_S
        while self.process.poll() is None and time.monotonic() < deadline:
            # Like a service manager: the kernel keeps ten messages.
            self.notifications.take(0.02)
        self.notifications.drain()
        return self.process.wait(0)

    def stop(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        return self.wait()

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.notifications.close()

    def status(self):
        code, _, body = http_over(self.socket, "GET", "/v1/status")
        if code != 200:
            raise AssertionError(f"the status has HTTP status {code}: {body}")
        return json.loads(body)

    def final_status(self):
        return json.loads(self.summary.read_text())

    def status_when(self, condition):
        """The first status for which `condition` holds."""
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            status = self.status()
            if condition(status):
                return status
            if time.monotonic() > deadline:
                raise AssertionError(f"never came true; the last status: {status}\n{self.log()}")
            time.sleep(0.02)

    def thread_id(self, name):
        for task in pathlib.Path(f"/proc/{self.pid}/task").iterdir():
            if (task / "comm").read_text().strip() == name:
                return int(task.name)
        raise AssertionError(f"thimbled has no thread {name}")


def clean_environment():
    """Nothing that a service manager or a person set reaches the programs, but sanitizers' options."""
    kept = ("PATH", "ASAN_OPTIONS", "UBSAN_OPTIONS", "LSAN_OPTIONS", "TSAN_OPTIONS")
    return {name: os.environ[name] for name in kept if name in os.environ} | {"LC_ALL": "C.UTF-8"}


def unix_connection(path, timeout_s=TIMEOUT_S):
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    sock.connect(path)  # blocking: with a time-out it would not wait for a full backlog
    sock.settimeout(timeout_s)
    return sock


def http_request(sock, method, target, body=""):
    """One request on an open connection: status, header and body."""
    length = f"Content-Length: {len(body.encode())}\r\n" if body else ""
    sock.sendall(f"{method} {target} HTTP/1.1\r\nHost: thimble\r\n{length}\r\n{body}".encode())
    return http_answer(sock)


def http_answer(sock):
    data = b""
    while b"\r\n\r\n" not in data:
        data += _more(sock)
    header, body = data.split(b"\r\n\r\n", 1)
    length = int(re.search(rb"(?i)content-length: *(\d+)", header).group(1))
    while len(body) < length:
        body += _more(sock)
    return int(header.split()[1]), header.decode(), body[:length].decode()


def _more(sock):
    data = sock.recv(65536)
    if not data:
        raise ConnectionError("the daemon closed the connection")
    return data


def http_over(path, method, target, body=""):
    with unix_connection(path) as sock:
        return http_request(sock, method, target, body)


class ProcessTest(unittest.TestCase):
    """A folder per test; whatever was started in it has ended when the test has."""

    maxDiff = None

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thimble-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, name, content):
        file = self.folder / name
        file.write_bytes(content.encode() if isinstance(content, str) else content)
        return file

    def run_on_a_terminal(self, *arguments):
        """Of `thimble`: exit code, standard output, and what a terminal at standard error was shown."""
        ours, theirs = pty.openpty()
        self.addCleanup(os.close, ours)
        output = self.folder / "stdout"
        with output.open("wb") as file, open(theirs, "wb", closefd=True) as terminal:
            process = subprocess.Popen([str(BIN / "thimble"), *map(str, arguments)], stdin=subprocess.DEVNULL,
                                       stdout=file, stderr=terminal, env=clean_environment(),
                                       preexec_fn=die_with_parent)
        told = b""
        # A terminal that nobody writes to any more answers with EIO.
        with contextlib.suppress(OSError):
            while select.select([ours], [], [], TIMEOUT_S)[0]:
                told += os.read(ours, 65536)
        return process.wait(TIMEOUT_S), output.read_text(), told.decode()

    def start(self, *arguments, name="daemon", config=None, **how):
        """A ready daemon; `config` is text, else --config is among the arguments."""
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        if config is not None:
            (folder / "thimble.toml").write_text(config)
            arguments = ("--config", folder / "thimble.toml", *arguments)
        daemon = Daemon(folder, arguments, **how)
        self.addCleanup(daemon.close)
        return daemon

    def run_program(self, program, *arguments, environment=None, preexec=None,
                    stdout=subprocess.PIPE, timeout=TIMEOUT_S):
        return subprocess.run(
            [str(BIN / program), *map(str, arguments)], stdin=subprocess.DEVNULL,
            stdout=stdout, stderr=subprocess.PIPE, text=True, errors="replace", timeout=timeout, check=False,
            env={**clean_environment(), **(environment or {})},
            preexec_fn=preexec or die_with_parent)

    def thimbled(self, *arguments, **how):
        return self.run_program("thimbled", *arguments, **how)

    def thimble(self, daemon, *arguments, **how):
        return self.run_program("thimble", *arguments, "--socket", daemon.socket, **how)

    def assert_one_sentence(self, text, *parts):
        self.assertEqual(text.count("\n"), 1, text)
        for part in parts:
            self.assertIn(part, text)

    def assert_soon(self, condition):
        deadline = time.monotonic() + TIMEOUT_S
        while not condition():
            self.assertLess(time.monotonic(), deadline, "it never came true")
            time.sleep(0.001)

    def ask_the_far_world(self, arm, verb, answer, world, is_free):
        """What its board could not do in time on a busy machine is asked for again, as a person would. It may yet be
        done late: the last look is just before that, and what has come about has to stay."""
        def is_so():
            return world.status()["worlds"][0]["pieces"]["is_free_motion"] == is_free

        deadline = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline:
            told = self.thimble(arm, verb)
            if told.returncode == 0:
                self.assertEqual((told.stdout, told.stderr), (answer, ""))
            else:
                self.assert_one_sentence(told.stderr, "does not answer")
            looked_until = time.monotonic() + 2
            while (is_there := is_so()) or time.monotonic() < looked_until:
                time.sleep(0.1 if is_there else 0.02)
                if is_there and is_so():
                    return
        self.fail(f"{verb} never came about\n{world.log()}")

    def assert_servo_goes_on(self, daemon):
        """The ticks count up, and no fault is latched."""
        before = daemon.status()["servos"][0]["ticks"]
        after = daemon.status_when(lambda s: s["servos"][0]["ticks"] > before + 20)
        self.assertEqual(after["arms"][0]["faults"], [])

"""The real thimble-guard, told of an arm that is a pipe, by a daemon that is a process of ours.

What the guard does when is told by unit_guard in hand-moved time; here it is shown that it does so
with real processes that die, stop and hang. Waits are bounded by TIMEOUT_S and assert no time.
"""

import fcntl
import mmap
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import time
import unittest

from rig import BIN, TIMEOUT_S, clean_environment, die_with_parent

ZERO = bytes([0, 0, 0, 0, 7])
F_SEAL_SHRINK_AND_GROW = 0x0002 | 0x0004
# A servo that beats on a page of memory (descriptor 3) until it is told there to hang, and holds the connection (descriptor 4).
HANG = 64  # beyond what the guard reads
SERVO = f"""
import mmap, struct, time
page = mmap.mmap(3, 4096)
page[8:12] = struct.pack("<I", 1)
while page[{HANG}] == 0:
    page[0:8] = struct.pack("<q", time.clock_gettime_ns(time.CLOCK_BOOTTIME))
    time.sleep(0.001)
while True:
    time.sleep(1)
"""


def sealed_page():
    page = os.memfd_create("heartbeat", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    os.ftruncate(page, 4096)
    fcntl.fcntl(page, fcntl.F_ADD_SEALS, F_SEAL_SHRINK_AND_GROW)
    return page


def start_guard(connection):
    return subprocess.Popen([str(BIN / "thimble-guard")], stdin=connection,
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                            env=clean_environment(), preexec_fn=die_with_parent)


class Guarded(unittest.TestCase):
    """An arm that is a pipe, its guard, and a servo that beats."""

    def setUp(self):
        self.daemon, connection = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.arm, self.node = os.pipe()
        os.set_blocking(self.arm, False)
        self.page_file = sealed_page()
        self.page = mmap.mmap(self.page_file, 4096)
        self.guard = start_guard(connection)
        connection.close()
        self.servo = None
        self.addCleanup(self.end)

    def end(self):
        self.daemon.close()
        if self.servo is not None:
            self.servo.send_signal(signal.SIGCONT)
            self.servo.kill()
            self.servo.wait(TIMEOUT_S)
        self.guard.stderr.close()
        self.guard.kill()
        self.guard.wait(TIMEOUT_S)
        self.page.close()
        for descriptor in (self.arm, self.node, self.page_file):
            os.close(descriptor)

    def hand_over(self, packet=b"TG\2" + bytes([0, 0]) + ZERO):
        socket.send_fds(self.daemon, [packet], [self.node, self.page_file])

    def begin(self):
        self.hand_over()
        self.daemon.settimeout(TIMEOUT_S)
        self.assertEqual(self.daemon.recv(1), b"W")
        # Numbers above those which the child is given, whatever this process has open.
        page, connection = (fcntl.fcntl(fd, fcntl.F_DUPFD, 50)
                            for fd in (self.page_file, self.daemon.fileno()))

        def place():
            die_with_parent()
            os.dup2(page, 3, inheritable=True)
            os.dup2(connection, 4, inheritable=True)
        self.servo = subprocess.Popen([sys.executable, "-c", SERVO],
                                      pass_fds=(3, 4), preexec_fn=place)
        os.close(page)
        os.close(connection)
        self.wait_for(lambda: self.last_beat() > 0)
        first = self.last_beat()
        self.wait_for(lambda: self.last_beat() > first + 50_000_000)

    def wait_for(self, condition):
        deadline = time.monotonic() + TIMEOUT_S
        while not condition():
            self.assertLess(time.monotonic(), deadline, "waited in vain")
            time.sleep(0.002)

    def last_beat(self):
        return struct.unpack("<q", self.page[0:8])[0]

    def interventions(self):
        return struct.unpack("<I", self.page[12:16])[0]

    def zeros(self):
        """How often the arm was given zero since the last call; nothing else may reach it."""
        try:
            reports = os.read(self.arm, 1 << 16)
        except BlockingIOError:
            return 0
        self.assertEqual(reports, ZERO * (len(reports) // len(ZERO)))
        return len(reports) // len(ZERO)

    def wait_for_zero(self):
        self.assertTrue(select.select([self.arm], [], [], TIMEOUT_S)[0], "the arm was not let go")
        self.assertGreater(self.zeros(), 0)

    def test_a_servo_that_is_killed_lets_its_arm_go_and_the_guard_ends(self):
        self.begin()
        self.daemon.close()  # the servo's copy is the last
        self.servo.kill()
        self.servo.wait(TIMEOUT_S)
        self.wait_for_zero()
        self.assertEqual(self.guard.wait(TIMEOUT_S), 0)

    def test_a_servo_that_is_stopped_lets_its_arm_go_until_it_took_the_force_away(self):
        self.begin()
        self.servo.send_signal(signal.SIGSTOP)
        self.wait_for_zero()
        self.assertGreaterEqual(self.interventions(), 1)
        self.wait_for(lambda: self.zeros() == 0)
        self.servo.send_signal(signal.SIGCONT)
        self.wait_for_zero()

        self.page[8:12] = struct.pack("<I", 0)
        self.wait_for(lambda: self.zeros() == 0)
        self.assertIsNone(self.guard.poll())

    def test_a_servo_that_hangs_lets_its_arm_go(self):
        self.begin()
        self.page[HANG] = 1
        self.wait_for_zero()
        self.assertIsNone(self.servo.poll())

    def test_a_daemon_that_ends_while_it_drives_leaves_the_arm_at_zero(self):
        self.hand_over()
        self.assertEqual(self.daemon.recv(1), b"W")
        self.page[8:12] = struct.pack("<I", 1)
        self.daemon.close()
        self.wait_for_zero()
        self.assertEqual(self.guard.wait(TIMEOUT_S), 0)

    def test_asked_to_end_it_lets_the_arm_go_first(self):
        self.begin()
        self.guard.send_signal(signal.SIGTERM)
        self.daemon.close()
        self.servo.kill()
        self.servo.wait(TIMEOUT_S)
        self.wait_for_zero()
        self.assertEqual(self.guard.wait(TIMEOUT_S), 0)

    def test_a_packet_that_is_no_handover_ends_the_guard_with_a_word(self):
        self.hand_over(b"GET / HTTP/1.1\r\n\r\n")
        self.assertEqual(self.guard.wait(TIMEOUT_S), 1)
        self.assertIn(b"not one of version 2", self.guard.stderr.read())
        self.assertEqual(self.zeros(), 0)


class ByHand(unittest.TestCase):
    def run_guard(self, *arguments):
        return subprocess.run([str(BIN / "thimble-guard"), *arguments], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=TIMEOUT_S, check=False,
                              env=clean_environment())

    def test_started_by_hand_it_says_who_starts_it(self):
        result = self.run_guard("--help")
        self.assertEqual(result.returncode, 2)
        self.assertIn("thimbled starts it", result.stderr)
        self.assertRegex(self.run_guard("--version").stdout, r"^thimble-guard \d")

    def test_without_a_connection_it_ends_with_a_word(self):
        result = self.run_guard()
        self.assertEqual(result.returncode, 1)
        self.assertIn("thimble-guard: cannot be handed an arm", result.stderr)


if __name__ == "__main__":
    unittest.main()

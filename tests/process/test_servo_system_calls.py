"""What the servo thread of the running daemon asks of the kernel, seen by strace."""

import pathlib
import shutil
import signal
import subprocess
import sys
import time

from rig import HELLO, TIMEOUT_S, ProcessTest, clean_environment

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import servo_calls  # noqa: E402

_CALLS = 2000


class ServoSystemCalls(ProcessTest):
    def setUp(self):
        super().setUp()
        if shutil.which("strace") is None:
            self.skipTest("strace is not installed (package strace)")
        allowed = subprocess.run(["strace", "-o", "/dev/null", "true"], capture_output=True,
                                 text=True, timeout=TIMEOUT_S, check=False)
        if allowed.returncode != 0:
            self.skipTest("ptrace is not permitted here: " + allowed.stderr.strip())

    def trace(self, daemon, thread):
        """System calls of one thread of a daemon that runs already, one a line."""
        output = self.folder / "strace"
        tracer = subprocess.Popen(
            ["strace", "-y", "-o", str(output), "-p", str(daemon.thread_id(thread))],
            stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=clean_environment())
        self.addCleanup(tracer.stderr.close)
        self.addCleanup(tracer.wait)
        self.addCleanup(tracer.kill)
        deadline = time.monotonic() + TIMEOUT_S
        while not output.exists() or output.read_bytes().count(b"\n") < _CALLS:
            if tracer.poll() is not None or time.monotonic() > deadline:
                self.skip_if_refused(tracer)
                self.fail(f"strace saw too few calls; the daemon says:\n{daemon.log()}")
            time.sleep(0.05)
        tracer.send_signal(signal.SIGINT)
        tracer.wait(TIMEOUT_S)
        return output.read_text().splitlines()

    def skip_if_refused(self, tracer):
        if tracer.poll() is None:
            return
        words = tracer.stderr.read()
        if "Operation not permitted" in words:
            self.skipTest("ptrace may not attach here: " + words.strip())

    def test_are_the_sleep_and_the_wake_of_the_net_plane_only(self):
        daemon = self.start(config=HELLO)
        daemon.status_when(lambda s: s["arms"][0]["is_in_contact"])
        calls = self.trace(daemon, "servo-right")

        self.assertEqual(servo_calls.forbidden(calls), [])
        for expected in (servo_calls.SLEEP, servo_calls.WAKE):
            self.assertTrue(any(expected.fullmatch(call) for call in calls))
        self.assertEqual(daemon.stop(), 0)

    def test_of_other_threads_are_not_those(self):
        """The filter can fail: the net plane does more than sleep and wake."""
        daemon = self.start(config=HELLO)
        calls = self.trace(daemon, "thimbled")
        self.assertTrue(any(call.startswith("epoll_wait") for call in calls), calls[:20])
        self.assertNotEqual(servo_calls.forbidden(calls), [])

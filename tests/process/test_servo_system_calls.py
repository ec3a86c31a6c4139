"""What the servo thread of the running daemon asks of the kernel, seen by strace."""

import re
import shutil
import signal
import subprocess
import time

from rig import HELLO, TIMEOUT_S, ProcessTest, clean_environment

_CALLS = 2000
_SLEEP = re.compile(r"clock_nanosleep\(CLOCK_MONOTONIC, TIMER_ABSTIME, .*")
_WAKE = re.compile(r'write\(\d+<anon_inode:\[eventfd\]>, "\\1\\0\\0\\0\\0\\0\\0\\0", 8\) += .*')
# How strace tells that it came or went in the middle of a sleep or of that write.
_INTERRUPTED = re.compile(r"restart_syscall\(<\.\.\. resuming .*|strace: Process .*|"
                          r"(clock_nanosleep|write)\(.* <detached \.\.\.>")


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

        others = [call for call in calls[1:]
                  if not _SLEEP.fullmatch(call) and not _WAKE.fullmatch(call)
                  and not _INTERRUPTED.fullmatch(call)]
        self.assertEqual(others, [])
        self.assertGreater(sum(bool(_SLEEP.fullmatch(call)) for call in calls), 0)
        self.assertGreater(sum(bool(_WAKE.fullmatch(call)) for call in calls), 0)
        self.assertEqual(daemon.stop(), 0)

    def test_of_other_threads_are_not_those(self):
        """The filter can fail: the net plane does more than sleep and wake."""
        daemon = self.start(config=HELLO)
        calls = self.trace(daemon, "thimbled")
        self.assertTrue(any(call.startswith("epoll_wait") for call in calls), calls[:20])
        self.assertFalse(all(_SLEEP.fullmatch(call) or _WAKE.fullmatch(call) for call in calls))

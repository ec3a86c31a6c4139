"""What is printed and cannot be written is said; what was never open is not written to."""

import contextlib
import os
import resource
import signal
import threading

from rig import EXAMPLES, HELLO, ProcessTest, die_with_parent

CHECK = ("--config", EXAMPLES / "hello-voxel.toml", "--check")


def closing(*descriptors):
    """For `preexec`: the program starts without these."""
    def close():
        die_with_parent()
        for descriptor in descriptors:
            os.close(descriptor)
    return close


def with_stuck_standard_error():
    """For `preexec`: standard error is a full pipe that nobody reads. The reader must stay open."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, b"x" * 4096)
    os.set_blocking(writer, True)

    def redirect():
        die_with_parent()
        os.dup2(writer, 2)
    return redirect, (reader, writer)


class StuckStandardError(ProcessTest):
    def test_holds_up_neither_start_nor_status_nor_stop(self):
        redirect, ends = with_stuck_standard_error()
        for end in ends:
            self.addCleanup(os.close, end)
        daemon = self.start(config=HELLO, preexec=redirect)
        daemon.status_when(lambda status: status["arms"][0]["state"] == "active")
        self.assert_servo_goes_on(daemon)
        self.assertEqual(daemon.stop(), 0)


class StuckEnd(ProcessTest):
    """Signals have their handlers until the process has ended: what waits here waits for SIGKILL."""

    def run_until_the_end(self, summary, **how):
        return self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--for", 0.1, "--set",
                             f"daemon.socket={self.folder}/s", "--summary", summary, **how)

    def test_a_summary_that_nobody_reads_is_given_up(self):
        pipe = self.folder / "summary"
        os.mkfifo(pipe)
        # Reads while the daemon tries the place, and is gone when it has something to say.
        reader = threading.Thread(target=lambda: os.close(os.open(pipe, os.O_RDONLY)), daemon=True)
        reader.start()
        result = self.run_until_the_end(pipe)
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"the summary could not be written to {pipe}", result.stderr)

    def test_the_last_word_does_not_wait_for_its_reader(self):
        redirect, ends = with_stuck_standard_error()
        for end in ends:
            self.addCleanup(os.close, end)
        self.assertEqual(self.run_until_the_end("/dev/full", preexec=redirect).returncode, 1)


class SmallFiles(ProcessTest):
    """No file of the process may grow beyond that: who writes more is told by a signal, which ends whoever does not mind."""

    MOST_BYTES = 1 << 16

    def limit(self):
        die_with_parent()
        resource.setrlimit(resource.RLIMIT_FSIZE, (self.MOST_BYTES, self.MOST_BYTES))

    def test_a_recording_that_may_not_be_written_is_said_and_the_daemon_goes_on(self):
        flights = self.folder / "flights"
        daemon = self.start("--set", f"daemon.flight_directory={flights}", "--set", "arm.limits.overspeed_m_per_s=0.001",
                            config=HELLO, preexec=self.limit)
        daemon.status_when(lambda status: status["arms"][0]["state"] == "fault")
        self.assert_soon(lambda: "could not be written" in daemon.log())
        self.assertIn("File too large", daemon.log())
        self.assertEqual(list(flights.glob("[!.]*")), [])
        ticks = daemon.status()["servos"][0]["ticks"]
        daemon.status_when(lambda status: status["servos"][0]["ticks"] > ticks)
        self.assertEqual(daemon.stop(), 0)

    def test_what_the_command_line_may_not_write_is_said(self):
        result = self.run_program("thimble", "cam", "run", "life", "--size", "512x512", "--steps", "0", "--write", self.folder / "x.npy", preexec=self.limit)
        self.assertEqual(result.returncode, 1, result.args)
        self.assert_one_sentence(result.stderr, "x.npy")


class Escapes(ProcessTest):
    """What somebody else may have chosen, as the name of a file, steers no terminal."""

    STEERING = "\x1b[31mX\x07"

    def assert_tame(self, result, code):
        self.assertEqual(result.returncode, code, result.args)
        self.assertIn("[31mX", result.stderr, "it is told")
        self.assertNotRegex(result.stderr, "[\x00-\x09\x0b-\x1f\x7f-\x9f]")

    def test_of_arguments_are_shown_as_letters(self):
        for program, words in (("thimbled", ("--config", "x", self.STEERING)), ("thimble", ("status", self.STEERING)),
                               ("thimble", ("cam", "run", "life", "--size", "8x8", "--steps", "1", "--engine", self.STEERING)),
                               ("thimble-simdev", ("--usbip", self.STEERING, "falcon"))):
            with self.subTest(program):
                self.assert_tame(self.run_program(program, *words), 2)

    def test_of_paths_are_shown_as_letters(self):
        start = "--config", EXAMPLES / "hello-voxel.toml", "--for", 0.1, "--set"
        folder = self.folder / self.STEERING
        self.assert_tame(self.thimbled(*start, f"daemon.socket={folder}/s"), 2)
        folder.mkdir()
        self.assert_tame(self.thimbled(*start, f"daemon.socket={folder}/s"), 0)
        self.assert_tame(self.thimbled(*start, f"daemon.socket={self.folder}/s", "--summary", f"/nowhere/{self.STEERING}"), 1)


class FullDisk(ProcessTest):
    def assert_said(self, result, *parts):
        self.assertEqual(result.returncode, 1, result.args)
        self.assert_one_sentence(result.stderr, *parts)

    def test_of_the_command_line_is_said(self):
        daemon = self.start("--for", 0.2, config=HELLO, name="summarised")
        self.assertEqual(daemon.wait(), 0)
        summary = daemon.summary
        daemon = self.start(config=HELLO)
        with open("/dev/full", "w") as full:
            for words in (["status"], ["status", "--json"], ["watch", "--for", "0.3"],
                          ["report", summary], ["activate"], ["--help"], ["--version"]):
                result = self.thimble(daemon, *words, stdout=full)
                self.assert_said(result, "thimble: cannot write to standard output")

    def test_of_the_daemon_is_said(self):
        with open("/dev/full", "w") as full:
            for words in (CHECK, ("--help",), ("--version",)):
                self.assert_said(self.thimbled(*words, stdout=full),
                                 "thimbled: cannot write to standard output")

    def test_for_the_summary_is_said(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--for", 0.1,
                               "--set", f"daemon.socket={self.folder}/s", "--summary", "/dev/full")
        self.assertEqual(result.returncode, 1)
        self.assertIn("the summary could not be written to /dev/full", result.stderr)

    def test_leaves_a_worse_exit_code_alone(self):
        with open("/dev/full", "w") as full:
            result = self.run_program("thimble", "status", "--socket", self.folder / "none",
                                      stdout=full)
        self.assertEqual(result.returncode, 3)


class Gone(ProcessTest):
    def setUp(self):
        super().setUp()
        reader, self.pipe = os.pipe()
        os.close(reader)
        self.addCleanup(os.close, self.pipe)

    def test_a_reader_that_is_gone_ends_the_command_line_without_words(self):
        daemon = self.start(config=HELLO)
        for words in (["status"], ["status", "--json"], ["watch"], ["--help"]):
            result = self.thimble(daemon, *words, stdout=self.pipe)
            self.assertEqual((result.returncode, result.stderr), (-signal.SIGPIPE, ""), words)


class Closed(ProcessTest):
    def test_standard_output_is_no_socket_of_the_daemon(self):
        daemon = self.start(config=HELLO)
        for words in (["status"], ["status", "--json"]):
            result = self.thimble(daemon, *words, preexec=closing(1))
            self.assertEqual(result.returncode, 1)
            self.assert_one_sentence(result.stderr, "cannot write to standard output")
        self.assertEqual(self.thimble(daemon, "status", preexec=closing(0, 2)).returncode, 0)

    def test_standard_descriptors_of_the_daemon_are_nothing_that_it_opened(self):
        daemon = self.start(config=HELLO, preexec=closing(0, 1, 2))
        for descriptor in (0, 1, 2):
            self.assertEqual(os.readlink(f"/proc/{daemon.pid}/fd/{descriptor}"), "/dev/null")
        self.assertEqual(daemon.stop(), 0)

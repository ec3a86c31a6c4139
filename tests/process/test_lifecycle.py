"""thimbled from its command line to its last command: --check, --for, --summary, signals."""

import os
import pathlib
import re
import signal
import subprocess
import unittest

from rig import (BIN, EXAMPLES, HELLO, ROOT, TIMEOUT_S, ProcessTest, clean_environment,
                 die_with_parent, is_sanitized)

ARM_KEYS = {"name", "device", "state", "calibration", "position_m", "force_newton",
            "peak_force_newton", "offset_m", "contacts", "faults"}
SERVO_KEYS = {"rate_hz", "ticks", "overruns", "wakeup_error_s", "compute_s"}
LINK_KEYS = {"peer", "round_trip_s", "sent", "received", "lost", "rejected", "stale"}


def bytes_read_by(pid):
    """As the kernel counts what it read of files."""
    words = pathlib.Path(f"/proc/{pid}/io").read_text().split()
    return int(words[words.index("rchar:") + 1])


def zeros(path, edge):
    """A NumPy file of edge^3 zeros of 16 bits: a hole, which takes no room on the disk."""
    header = f"{{'descr': '<u2', 'fortran_order': False, 'shape': ({edge}, {edge}, {edge}), }}"
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + (118).to_bytes(2, "little") + header.ljust(117).encode() + b"\n")
        file.truncate(128 + 2 * edge ** 3)
    return path


def session_in(source, materials=0):
    labels = "".join(f'[[world.material]]\nname = "m{n}"\nfrom = {n}\nfriction = 0.1\n'
                     for n in range(1, 1 + materials))
    return (f'[[world]]\nname = "w"\nsource = "{source}"\nworkspace_m = 0.09\n{labels}[[arm]]\nname = "right"\n'
            'device = "sim:phantom-vintage"\namplifier_max_a = 3.0\nworld = "w"\n')


def is_touching(status):
    return status["arms"][0]["is_in_contact"] and any(status["arms"][0]["force_newton"])


class Check(ProcessTest):
    def test_every_example_is_good(self):
        for example in sorted(EXAMPLES.glob("*.toml")):
            result = self.thimbled("--config", example, "--check")
            self.assertEqual(result.returncode, 0, (example, result.stderr))
            if re.search(r'^device = "\w+:(SERIAL|PORT)"', example.read_text(), re.MULTILINE):
                self.assert_one_sentence(result.stderr, "thimble devices lists it")
            else:
                self.assertEqual(result.stderr, "", example)
            self.assertIn("good", result.stdout)

    def test_names_every_mistake_at_once_with_file_line_and_key(self):
        file = self.write("bad.toml", '[servo]\nrate_hz = 20\nspeed = 3\n[[arm]]\nname = "right"\n'
                                      'device = "sim:phantom-vintage"\namplifier_max_a = -1\n'
                                      'world = "nowhere"\n')
        result = self.thimbled("--config", file, "--check")

        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stdout, "")
        for line, key in ((2, "servo.rate_hz"), (3, "servo.speed"), (7, "amplifier_max_a"),
                          (8, "world")):
            self.assertRegex(result.stderr, rf"(?m)^{file}:{line}.*{key}")
        self.assertIn("500", result.stderr, "says what was expected")

    def test_a_bad_override_is_a_mistake_too(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--check",
                               "--set", "servo.rate_hz=fast", "--set", "arm.left.activate=false")
        self.assertEqual(result.returncode, 2)
        self.assertIn("servo.rate_hz", result.stderr)
        self.assertIn("left", result.stderr)

    def test_what_the_file_names_is_tried_and_told_with_the_rest(self):
        self.write("short.npy", b"\x93NUMPY")
        arm = '[[arm]]\nname = "{0}"\ndevice = "{1}"\n{2}\nworld = "{3}"\n'
        text = (arm.format("a", "sim:phantom-vintage", "amplifier_max_a = 40", "x")
                + arm.format("b", "sim:phantom-vintage", 'model = "opera"', "x")
                + arm.format("c", "sim:opera", "", "y")
                + arm.format("d", "pci:123", "amplifier_max_a = 3", "y")
                + '[[world]]\nname = "x"\nsource = "short.npy"\n'
                + '[[world]]\nname = "y"\nsource = "none.npy"\nthreshhold = 3\n')
        file = self.write("bad.toml", text)
        for more in (("--check",), ("--set", f"daemon.socket={self.folder}/s")):
            result = self.thimbled("--config", file, *more)
            self.assertEqual(result.returncode, 2)
            told = [line.removeprefix(f"{file}:") for line in result.stderr.splitlines()]
            expected = (("4:", "arm.0.amplifier_max_a", "32.767 A"),
                        ("6:", "arm.1.amplifier_max_a", "missing"),
                        ("9:", "arm.1.model", "opera", "woody-2015"),
                        ("13:", "arm.2.device", "sim:opera", "sim:woody-2015"),
                        ("18:", "arm.3.device", "pci:123", "no pci bus yet"),
                        ("23:", "world.0.source", "short.npy: "),
                        ("26:", "world.1.source", "none.npy: "),
                        ("27:", "world.1.threshhold", "threshold"))
            self.assertEqual(len(told), len(expected), result.stderr)
            for line, (start, *parts) in zip(told, expected):
                self.assertTrue(line.startswith(start), line)
                for part in parts:
                    self.assertIn(part, line)

    def test_the_places_that_a_start_needs_are_looked_at(self):
        text = (EXAMPLES / "hello-voxel.toml").read_text()
        self.assertNotIn("[daemon]", text)
        self.write("file", "")
        file = self.write("bad.toml", '[daemon]\nsocket = "file"\ngroup = "no-such-group"\nflight_directory = "file/below"\n' + text)
        for more in (("--check",), ()):
            result = self.thimbled("--config", file, *more)
            self.assertEqual(result.returncode, 2)
            self.assertRegex(result.stderr, rf"(?m)^{file}:2:\d+: daemon.socket: .*/file exists and is no socket")
            self.assertRegex(result.stderr, rf'(?m)^{file}:3:\d+: daemon.group: there is no group "no-such-group"')
            # For no recording a start ends.
            self.assertEqual(len(re.findall(rf"(?m)^{file}:4:\d+: daemon.flight_directory: .*/file is no folder", result.stderr)), len(more))

    def test_a_firmware_is_looked_at_but_ends_no_start(self):
        self.write("falcon.bin", "no firmware")
        text = ('[[arm]]\nname = "{0}"\ndevice = "usb:250-{0}"\nfirmware = "{1}"\nworld = "x"\n')
        file = self.write("falcons.toml", text.format(1, "none.bin") + text.format(2, "falcon.bin")
                          + f'firmware_sha256 = "{"0" * 64}"\n[[world]]\nname = "x"\nsource = "box:3"\n')
        result = self.thimbled("--config", file, "--check")
        self.assertEqual(result.returncode, 2)
        told = result.stderr.splitlines()
        self.assertEqual(len(told), 2, result.stderr)
        self.assertRegex(told[0], rf"^{file}:4:.*arm.0.firmware: there is no firmware at .*none.bin")
        self.assertRegex(told[1], rf"^{file}:9:.*arm.1.firmware: .*falcon.bin' does not begin as")
        result = self.thimbled("--config", file, "--for", "0.2",
                               "--set", f"daemon.socket={self.folder}/s")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_falcon_without_firmware_or_at_a_slow_servo_is_doubted_and_no_mistake(self):
        file = self.write("falcon.toml", '[servo]\nrate_hz = 1000\n[[arm]]\nname = "right"\ndevice = "usb:250-1"\nmodel = "falcon"\n'
                          'world = "x"\n[[world]]\nname = "x"\nsource = "box:3"\n')
        for words in (("--check",), ("--for", "0.2", "--set", f"daemon.socket={self.folder}/s")):
            result = self.thimbled("--config", file, *words)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("warning: arm 'right' lacks arm.firmware", result.stderr)
            self.assertIn("warning: arm 'right' may go on pushing until its own supply is switched off", result.stderr)
            self.assertIn("warning: arm 'right' does not give all of its 1000 samples a second at servo.rate_hz = 1000:", result.stderr)

    def test_a_sum_that_cannot_be_ends_every_start(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml",
                               "--set", "arm.firmware_sha256=00ff")
        self.assertEqual(result.returncode, 2)
        self.assertIn("expected 64 hexadecimal digits", result.stderr)

    def test_a_missing_file_is_named(self):
        result = self.thimbled("--config", self.folder / "none.toml", "--check")
        self.assertEqual(result.returncode, 2)
        self.assert_one_sentence(result.stderr, "none.toml")

    def test_a_folder_is_no_configuration(self):
        result = self.thimbled("--config", self.folder, "--check")
        self.assertEqual(result.returncode, 2)
        self.assert_one_sentence(result.stderr, str(self.folder))

    def test_a_wrong_command_line_is_exit_2_and_help_is_0(self):
        self.assertEqual(self.thimbled().returncode, 2)
        self.assertEqual(self.thimbled("--config", "a", "--for", "-1").returncode, 2)
        self.assertEqual(self.thimbled("--help").returncode, 0)
        self.assertIn("--summary", self.thimbled("--help").stdout)

    def test_a_time_that_is_no_finite_number_is_exit_2(self):
        good = ("--config", EXAMPLES / "hello-voxel.toml", "--check")
        for word in ("nan", "-nan", "NAN", "inf", "1e999"):
            self.assertEqual(self.thimbled(*good, f"--for={word}").returncode, 2, word)
            for option in ("--for", "--interval"):
                # There is no daemon: a time that is let through ends with 3.
                result = self.run_program("thimble", "watch", f"{option}={word}", "--socket",
                                          self.folder / "none")
                self.assertEqual(result.returncode, 2, (option, word))


class Run(ProcessTest):
    def test_ends_by_itself_and_summarises(self):
        daemon = self.start("--config", EXAMPLES / "hello-voxel.toml", "--for", 2)
        self.assertEqual(daemon.wait(), 0, daemon.log())

        status = daemon.final_status()
        self.assertEqual(ARM_KEYS - status["arms"][0].keys(), set())
        self.assertEqual(SERVO_KEYS - status["servos"][0].keys(), set())
        self.assertEqual(LINK_KEYS - status["links"][0].keys(), set())
        for histogram in ("wakeup_error_s", "compute_s"):
            self.assertEqual({"p50", "p99", "max"} - status["servos"][0][histogram].keys(), set())
        self.assertGreater(status["servos"][0]["ticks"], 0)
        self.assertEqual(status["arms"][0]["faults"], [])
        self.assertEqual(status["arms"][0]["force_newton"], [0, 0, 0])

    def test_a_summary_that_cannot_be_written_is_said_before_anything_begins(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml",
                               "--set", f"daemon.socket={self.folder}/s",
                               "--summary", self.folder / "no" / "folder.json")
        self.assertEqual(result.returncode, 1)
        self.assert_one_sentence(result.stderr, "folder.json")

    def test_a_summary_does_not_replace_the_configuration(self):
        text = (EXAMPLES / "hello-voxel.toml").read_text()
        file = self.write("mine.toml", text)
        (self.folder / "link").symlink_to(file)
        for summary in (file, self.folder / "link"):
            result = self.thimbled("--config", file, "--for", 0.1, "--set", f"daemon.socket={self.folder}/s", "--summary", summary)
            self.assertEqual(result.returncode, 2)
            self.assert_one_sentence(result.stderr, "names the configuration")
        self.assertEqual(file.read_text(), text)

    def test_a_configuration_has_a_name(self):
        result = self.thimbled("--config", "", "--check")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--config: expected the name of a file", result.stderr)

    def test_a_summary_has_a_name(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--for", 0.1, "--set", f"daemon.socket={self.folder}/s", "--summary", "")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--summary: expected the name of a file", result.stderr)

    def test_a_start_that_fails_leaves_no_summary(self):
        daemon = self.start(config=HELLO)
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--set", f"daemon.socket={daemon.socket}",
                               "--summary", self.folder / "none.json")
        self.assertEqual(result.returncode, 1)
        self.assert_one_sentence(result.stderr, "another daemon is running")
        self.assertFalse((self.folder / "none.json").exists())

    def test_a_summary_into_a_pipe_that_nobody_reads_is_refused_and_not_waited_for(self):
        os.mkfifo(self.folder / "pipe")
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--for", 0.1,
                               "--set", f"daemon.socket={self.folder}/s",
                               "--summary", self.folder / "pipe")
        self.assertEqual(result.returncode, 1)
        self.assert_one_sentence(result.stderr, "/pipe")

    def test_a_summary_that_finds_the_disk_full_at_the_end_is_said(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml", "--for", 0.1,
                               "--set", f"daemon.socket={self.folder}/s",
                               "--summary", "/dev/full")
        self.assertEqual(result.returncode, 1)
        self.assertIn("the summary could not be written to /dev/full", result.stderr)

    def test_signals_in_contact_take_the_force_off_and_end_well(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(number.name):
                daemon = self.start(config=HELLO, name=number.name)
                daemon.status_when(is_touching)
                self.assertEqual(daemon.stop(number), 0, daemon.log())

                arm = daemon.final_status()["arms"][0]
                self.assertEqual(arm["force_newton"], [0, 0, 0])
                self.assertEqual(arm["faults"], [])
                self.assertGreater(arm["peak_force_newton"], 0)
                self.assertFalse((daemon.folder / "thimble.sock").exists())

    def test_the_end_of_its_terminal_ends_it_but_where_that_was_refused(self):
        self.assertEqual(self.start(config=HELLO, name="plain").stop(signal.SIGHUP), 0)

        def as_nohup_does():
            die_with_parent()
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
        daemon = self.start(config=HELLO, name="nohup", preexec=as_nohup_does)
        daemon.process.send_signal(signal.SIGHUP)
        self.assert_servo_goes_on(daemon)
        self.assertEqual(daemon.stop(), 0, daemon.log())

    def test_a_signal_while_a_large_volume_loads_ends_it_at_once(self):
        config = self.write("large.toml", session_in(zeros(self.folder / "large.npy", 1024)))
        process = subprocess.Popen([BIN / "thimbled", "--config", config, "--set",
                                    f"daemon.socket={self.folder}/s"], stdin=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, env=clean_environment(),
                                   preexec_fn=die_with_parent)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.assert_soon(lambda: bytes_read_by(process.pid) > 1 << 26)  # past its header
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(TIMEOUT_S), -signal.SIGTERM, process.stderr.read())
        self.assertFalse((self.folder / "s").exists())

    def test_tells_the_service_manager(self):
        daemon = self.start("--for", 1, config=HELLO, environment={"WATCHDOG_USEC": "200000"})
        self.assertEqual(daemon.wait(), 0)
        seen = daemon.notifications.seen
        self.assertLess(seen.index("READY=1"), seen.index("STOPPING=1"))
        self.assertIn("WATCHDOG=1", seen)
        self.assertTrue(any(line.startswith("STATUS=") for line in seen), seen)

    def test_a_service_manager_that_stops_reading_holds_nothing_up(self):
        daemon = self.start(config=HELLO, environment={"WATCHDOG_USEC": "20000"})
        # Far more is said to it than the kernel keeps.
        daemon.status_when(lambda s: s["uptime_s"] > 2)
        self.assert_servo_goes_on(daemon)
        daemon.process.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.process.wait(TIMEOUT_S), 0, daemon.log())

    def test_asks_for_no_watchdog_where_there_is_none(self):
        daemon = self.start("--for", 0.3, config=HELLO)
        self.assertEqual(daemon.wait(), 0)
        self.assertNotIn("WATCHDOG=1", daemon.notifications.seen)


class Places(ProcessTest):
    def test_a_second_daemon_on_the_socket_is_refused_and_the_first_goes_on(self):
        first = self.start(config=HELLO)
        second = self.thimbled("--config", first.folder / "thimble.toml",
                               "--set", f"daemon.socket={first.socket}")
        self.assertEqual(second.returncode, 1)
        self.assert_one_sentence(second.stderr, "another daemon is running", first.socket)
        self.assert_servo_goes_on(first)

    def test_a_stale_socket_is_replaced(self):
        first = self.start(config=HELLO, name="same")
        first.process.kill()
        first.wait()
        first.close()
        self.assertTrue((first.folder / "thimble.sock").is_socket())
        second = self.start(config=HELLO, name="same")
        self.assert_servo_goes_on(second)

    def test_after_a_daemon_that_was_killed_no_arm_is_driven_before_somebody_asks(self):
        first = self.start(config=HELLO, name="same")
        first.status_when(lambda s: s["arms"][0]["state"] == "active")
        first.process.kill()
        first.wait()
        first.close()
        for number in (signal.SIGKILL, signal.SIGTERM):  # it is no second start that forgives
            held = self.start(config=HELLO, name="same")
            held.status_when(lambda s: s["arms"][0]["state"] == "inactive")
            self.assert_servo_goes_on(held)
            arm = held.status()["arms"][0]
            self.assertEqual((arm["state"], arm["lease"], arm["peak_force_newton"]), ("inactive", "none", 0))
            if number == signal.SIGTERM:
                self.assertEqual(self.thimble(held, "activate", arm["name"]).returncode, 0)
                held.status_when(lambda s: s["arms"][0]["state"] == "active" and s["arms"][0]["lease"] == "configuration")
            held.process.send_signal(number)
            held.wait()
            held.close()
        asked = self.start(config=HELLO, name="same")
        asked.status_when(lambda s: s["arms"][0]["state"] == "active")

    def test_a_file_where_the_socket_should_be_is_left_alone(self):
        file = self.write("precious", "text")
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml",
                               "--set", f"daemon.socket={file}")
        self.assertEqual(result.returncode, 2)
        self.assert_one_sentence(result.stderr, str(file))
        self.assertEqual(file.read_text(), "text")

    def test_the_socket_is_for_owner_and_group_only(self):
        daemon = self.start(config=HELLO)
        self.assertEqual((daemon.folder / "thimble.sock").stat().st_mode & 0o777, 0o660)

    def test_an_unwritable_flight_directory_stops_nothing(self):
        for name, place in (("away", "/proc/nowhere"), ("beneath", self.write("file", ""))):
            with self.subTest(name):
                daemon = self.start("--set", f"daemon.flight_directory={place}", config=HELLO, name=name)
                self.assert_servo_goes_on(daemon)
                self.assertEqual(daemon.stop(), 0)
        self.assertIn(f"degraded: no flight recording can be written: {place}: ", daemon.log())

    def test_an_unknown_device_is_named_with_those_there_are(self):
        result = self.thimbled("--config", EXAMPLES / "hello-voxel.toml",
                               "--set", f"daemon.socket={self.folder}/s",
                               "--set", "arm.device=sim:phantom-of-the-opera")
        self.assertEqual(result.returncode, 2)
        self.assert_one_sentence(result.stderr, "phantom-of-the-opera", "phantom-vintage")


class Materials(ProcessTest):
    def test_a_daemon_says_who_does_not_feel_them(self):
        zeros(self.folder / "scan.npy", 8)
        daemon = self.start("--set", "world.listen=udp://127.0.0.1:0", name="scan",
                            config=session_in(self.folder / "scan.npy", materials=1))
        sentence = "arms that speak the datagrams of 1999 feel none of its materials"
        self.assertTrue(any(sentence in line for line in daemon.status()["degraded"]))
        self.assertEqual(daemon.stop(), 0)
        self.assertIn(sentence, daemon.log())


class Memory(ProcessTest):
    def peak_of(self, source, name, materials=0):
        """Bytes of memory that a daemon in this world had at most, until it was ready."""
        daemon = self.start(config=session_in(source, materials), name=name)
        words = pathlib.Path(f"/proc/{daemon.pid}/status").read_text().split()
        self.assertEqual(daemon.stop(), 0, daemon.log())
        return int(words[words.index("VmHWM:") + 1]) * 1024

    def test_a_volume_file_takes_little_more_than_its_bits(self):
        edge = 512
        volume = zeros(self.folder / "scan.npy", edge)
        extra = self.peak_of(volume, "scan") - self.peak_of(f"box:{edge}", "box")
        # The goal is an eighth of the file: 256 MiB for 2 GiB. A box of as many cells has the bits.
        bits = edge ** 3 // 8
        self.assertLess(bits + extra, volume.stat().st_size // 8)

    @unittest.skipIf(is_sanitized(), "a sanitizer's shadow of the memory is memory, too")
    def test_materials_take_the_bits_a_cell_that_the_manual_says(self):
        edge = 512
        text = (ROOT / "docs" / "configuration.md").read_text()
        rows = re.findall(r"^\|.*?(\d+) \| (\d) bits a cell: (\d+) MiB for 512³ cells, (\d+) MiB for", text, re.M)
        said = {int(most): [int(number) for number in rest] for most, *rest in rows}
        self.assertEqual(list(said), [1, 3, 15])
        box = self.peak_of(f"box:{edge}", "box")
        bits = edge ** 3 // 8
        volume = zeros(self.folder / "scan.npy", edge)
        for materials, (bits_a_cell, mebibytes, of_1024) in said.items():
            self.assertEqual((mebibytes * 2 ** 20, of_1024 * 2 ** 20), (bits * bits_a_cell, 8 * bits * bits_a_cell))
            taken = bits + self.peak_of(volume, f"scan{materials}", materials) - box
            # Two daemons differ by a few pages that have nothing to do with the volume.
            self.assertAlmostEqual(taken, mebibytes * 2 ** 20, delta=4 * 2 ** 20)


class Programs(ProcessTest):
    def test_are_where_the_tests_look_for_them(self):
        for program in ("thimbled", "thimble"):
            self.assertTrue((BIN / program).is_file(), BIN / program)
            self.assertEqual(self.run_program(program, "--version").returncode, 0)


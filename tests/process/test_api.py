"""The command line and the API over a living daemon: status, watch, leases, faults, rights."""

import json
import os
import pathlib
import pwd
import resource
import shutil
import signal
import socket
import subprocess
import threading

from rig import (BIN, HELLO, TIMEOUT_S, ProcessTest, die_with_parent, clean_environment,
                 http_over, http_request, unix_connection)

IDLE = HELLO.replace('world = "box"\n', 'world = "box"\nactivate = false\n', 1)
# A hand that moves at all is too fast for this arm.
TOO_FAST = HELLO.replace("[arm.hand]", "[arm.limits]\noverspeed_m_per_s = 0.0005\n[arm.hand]")


def state_is(state):
    return lambda status: status["arms"][0]["state"] == state


class Words(ProcessTest):
    def test_status_for_people_and_for_programs(self):
        daemon = self.start(config=HELLO)
        people = self.thimble(daemon, "status")
        self.assertEqual((people.returncode, people.stderr), (0, ""))
        self.assertIn("right", people.stdout)
        self.assertLessEqual(max(map(len, people.stdout.splitlines())), 80)

        programs = self.thimble(daemon, "status", "--json")
        self.assertEqual(programs.returncode, 0)
        self.assertEqual(json.loads(programs.stdout)["arms"][0]["name"], "right")

    def test_commands_that_a_slower_bus_never_took_are_counted(self):
        daemon = self.start("--set", "servo.rate_hz=2000", config=HELLO)  # its bus takes 1000
        daemon.status_when(lambda status: status["servos"][0]["superseded_commands"] > 100)

    def test_watch_into_a_pipe_is_lines_without_escapes(self):
        daemon = self.start(config=HELLO)
        result = self.thimble(daemon, "watch", "--for", 2)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertGreater(result.stdout.count("\n"), 3)
        self.assertNotIn("\x1b", result.stdout)

    def test_watch_goes_on_where_a_connection_was_closed_between_two_pictures(self):
        """As of one that asks seldomer than every 30 s; here after each answer."""
        document = json.dumps(self.start(config=HELLO).status()).encode()
        head = f"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: {len(document)}\r\n\r\n"
        path = self.folder / "closing.sock"
        asked = []

        def answer_once(place):
            there, _ = place.accept()
            with there:
                asked.append(there.recv(65536))
                there.sendall(head.encode() + document)

        with socket.socket(socket.AF_UNIX) as place:
            place.bind(str(path))
            place.listen()
            server = threading.Thread(target=lambda: [answer_once(place) for _ in range(4)])
            server.start()
            shown = self.run_program("thimble", "watch", "--interval", "0.1", "--for", "0.4", "--socket", path)
            server.join()
        self.assertEqual((shown.returncode, shown.stderr), (0, ""))
        self.assertEqual(shown.stdout.count("\n"), 4)
        self.assertEqual(len(asked), 4)

    def test_watch_says_when_the_daemon_ends(self):
        daemon = self.start("--for", 1, config=HELLO)
        result = self.thimble(daemon, "watch", "--for", 50)
        self.assertEqual(result.returncode, 3)
        self.assert_one_sentence(result.stderr, "daemon")

    def test_no_daemon_is_one_sentence_and_exit_3(self):
        for words in (["status"], ["status", "--json"], ["watch", "--for", "1"],
                      ["activate", "right"], ["deactivate"], ["clear-fault"]):
            result = self.run_program("thimble", *words, "--socket", self.folder / "none")
            self.assertEqual((result.returncode, result.stdout), (3, ""), words)
            self.assert_one_sentence(result.stderr, "no daemon is running", "none")

    def test_where_the_service_failed_that_is_what_is_told(self):
        manager = self.write("systemctl", "#!/bin/sh\nprintf 'LoadState=loaded\\nActiveState=failed\\nResult=watchdog\\n'\n")
        manager.chmod(0o700)
        where = {"PATH": f"{self.folder}:{os.environ['PATH']}"}
        result = self.run_program("thimble", "status", "--socket", self.folder / "none", environment=where)
        self.assertEqual(result.returncode, 3)
        self.assert_one_sentence(result.stderr, "no daemon is running", "thimbled has failed (watchdog)", "journalctl -u thimbled")
        result = self.run_program("thimble", "doctor", environment=where)
        self.assertEqual(result.returncode, 1)
        self.assertIn("WRONG  service: thimbled.service has failed (watchdog)", result.stdout)

    def test_the_report_of_a_summary(self):
        daemon = self.start("--for", 1, config=HELLO)
        self.assertEqual(daemon.wait(), 0)
        result = self.run_program("thimble", "report", daemon.summary)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("right", result.stdout)

    def test_a_report_of_what_is_no_summary_says_what_is_the_matter(self):
        large = self.write("large", " " * (4 << 20) + "{}")
        for file, said in ((self.folder / "none", "cannot open it: No such file or directory"),
                           (self.folder, "cannot read it: Is a directory"),
                           (large, "has more than 4096 KiB, which no summary of thimbled has"),
                           (self.write("other", "no document"), "is no summary of thimbled"),
                           (self.write("any.json", "{}"), "is no summary of thimbled"),
                           (self.write("package.json", '{"name": "left-pad", "version": "1.0.0"}'), "is no summary of thimbled")):
            with self.subTest(said):
                result = self.run_program("thimble", "report", file)
                self.assertEqual((result.returncode, result.stdout), (1, ""))
                self.assert_one_sentence(result.stderr, str(file), said)

    def test_an_arm_that_is_not_there(self):
        daemon = self.start(config=HELLO)
        for verb in ("activate", "deactivate", "clear-fault"):
            result = self.thimble(daemon, verb, "left")
            self.assertEqual(result.returncode, 1)
            self.assert_one_sentence(result.stderr, "left")


class Leases(ProcessTest):
    def test_an_arm_is_active_while_the_connection_that_activated_it_lasts(self):
        daemon = self.start(config=IDLE)
        daemon.status_when(state_is("inactive"))
        with unix_connection(daemon.socket) as connection:
            code, _, body = http_request(connection, "POST", "/v1/arms/right/activate")
            self.assertEqual((code, json.loads(body)["lease"], json.loads(body)["state"]),
                             (200, "client", "active"))
            self.assertEqual(daemon.status()["arms"][0]["state"], "active")
            code, _, _ = http_over(daemon.socket, "POST", "/v1/arms/right/activate")
            self.assertEqual(code, 409, "another connection holds it")
        status = daemon.status_when(state_is("inactive"))
        self.assertEqual(status["arms"][0]["lease"], "none")
        self.assertEqual(status["arms"][0]["force_newton"], [0, 0, 0])
        self.assertEqual(status["arms"][0]["faults"], [])

    def test_thimble_activate_holds_it_and_its_death_releases_it(self):
        daemon = self.start(config=IDLE)
        for number in (signal.SIGINT, signal.SIGKILL):
            daemon.status_when(state_is("inactive"))
            holder = subprocess.Popen([str(BIN / "thimble"), "activate", "--socket", daemon.socket],
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True,
                                      env=clean_environment(), preexec_fn=die_with_parent)
            self.addCleanup(holder.stdout.close)
            self.addCleanup(holder.wait)
            self.addCleanup(holder.kill)
            # Not before it says so: until then a signal ends it as it ends any program.
            self.assertIn("Ctrl-C releases it", holder.stdout.readline())
            daemon.status_when(state_is("active"))
            holder.send_signal(number)
            self.assertEqual(holder.wait(TIMEOUT_S), 0 if number == signal.SIGINT else -number)
            daemon.status_when(state_is("inactive"))

    def hold_arm(self, daemon):
        """A `thimble activate` that has the arm; whoever calls reads what it says until it ends."""
        holder = subprocess.Popen([str(BIN / "thimble"), "activate", "--socket", daemon.socket],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True, env=clean_environment(), preexec_fn=die_with_parent)
        self.addCleanup(holder.kill)
        self.assertIn("Ctrl-C releases it", holder.stdout.readline())
        return holder

    def test_thimble_activate_ends_when_somebody_else_deactivates_the_arm(self):
        daemon = self.start(config=IDLE)
        holder = self.hold_arm(daemon)
        self.assertEqual(self.thimble(daemon, "deactivate").returncode, 0)
        out, err = holder.communicate(timeout=TIMEOUT_S)
        self.assertEqual((holder.returncode, out), (1, ""))
        self.assert_one_sentence(err, "arm right was deactivated")

    def test_thimble_activate_ends_when_somebody_else_takes_the_arm_over_at_once(self):
        daemon = self.start(config=IDLE)
        holder = self.hold_arm(daemon)
        with unix_connection(daemon.socket) as connection:
            for verb in ("deactivate", "activate"):
                code, _, body = http_request(connection, "POST", f"/v1/arms/right/{verb}")
                self.assertEqual(code, 200, body)
            out, err = holder.communicate(timeout=TIMEOUT_S)
            self.assertEqual((holder.returncode, out), (1, ""))
            self.assert_one_sentence(err, "arm right was deactivated")
            arm = daemon.status_when(state_is("active"))["arms"][0]
            self.assertEqual((arm["lease"], arm["lease_number"]), ("client", json.loads(body)["lease_number"]))

    def test_anybody_may_stop_an_arm_and_start_it_again(self):
        daemon = self.start(config=HELLO)
        daemon.status_when(state_is("active"))
        self.assertEqual(self.thimble(daemon, "deactivate").returncode, 0)
        daemon.status_when(state_is("inactive"))
        result = self.thimble(daemon, "activate")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("configuration", result.stdout)
        daemon.status_when(state_is("active"))


class Faults(ProcessTest):
    def test_a_stop_is_told_recorded_and_cleared_once(self):
        daemon = self.start(config=TOO_FAST)
        status = daemon.status_when(
            lambda s: s["arms"][0]["faults"] and s["arms"][0]["faults"][0]["recording"])
        fault = status["arms"][0]["faults"][0]
        self.assertIn("overspeed", fault["code"])
        self.assertEqual(status["arms"][0]["state"], "fault")
        self.assertEqual(status["arms"][0]["force_newton"], [0, 0, 0])
        recording = pathlib.Path(fault["recording"])
        self.assertEqual(recording.parent, daemon.folder)
        self.assertGreater(recording.stat().st_size, 1000)
        self.assertIn("overspeed", self.thimble(daemon, "status").stdout)
        self.assert_shown(recording)

        refused = self.thimble(daemon, "activate")
        self.assertEqual(refused.returncode, 1)
        self.assert_one_sentence(refused.stderr, "overspeed", "clear")

        # Released first, else the hand moves on and the next stop follows.
        self.assertEqual(self.thimble(daemon, "deactivate").returncode, 0)
        number = fault["number"]
        self.assertIn(f"{number} overspeed", self.thimble(daemon, "status").stdout)
        for wrong in (number + 1, 4294967295):
            guessed = self.thimble(daemon, "clear-fault", "--fault", wrong)
            self.assertEqual(guessed.returncode, 1)
            self.assert_one_sentence(guessed.stderr, f"after fault {number} (overspeed",
                                     f"not after fault {wrong}")
        for wrong in ("0", "-1", "1.5", "1e0", "", "4294967296"):
            self.assertEqual(self.thimble(daemon, "clear-fault", "--fault", wrong).returncode, 2)
            body = f'{{"fault": {wrong or "null"}}}'
            code, _, said = http_over(daemon.socket, "POST", "/v1/arms/right/clear-fault", body)
            self.assertEqual((code, json.loads(said)["error"]["code"]), (400, "malformed"), wrong)
        self.assertEqual(daemon.status()["arms"][0]["state"], "fault")
        cleared = self.thimble(daemon, "clear-fault", "--fault", number)
        self.assertEqual((cleared.returncode, cleared.stderr), (0, ""))
        self.assertIn("the fault is cleared", cleared.stdout)
        self.assertEqual(daemon.status()["arms"][0]["faults"], [], "answered when it was true")
        daemon.status_when(state_is("inactive"))  # calibrated again by the simulated person
        result = self.thimble(daemon, "clear-fault")
        self.assertEqual(result.returncode, 1)
        self.assert_one_sentence(result.stderr, "no latched fault")
        self.assertEqual(daemon.stop(), 0)

    def assert_shown(self, recording):
        shown = self.run_program("thimble", "flight", "show", recording)
        self.assertEqual((shown.returncode, shown.stderr), (0, ""))
        self.assertRegex(shown.stdout, r"(?m)^cause +overspeed at tick \d+$")
        # Which ticks there were before the stop is the machine's: -50.0 where none was missed.
        self.assertRegex(shown.stdout, r"(?m)^ *-\d+\.0 active ")
        self.assertRegex(shown.stdout, r"(?m)^ *0\.0 fault ")
        self.assertLessEqual(max(map(len, shown.stdout.splitlines())), 80)

    def test_a_recording_that_is_not_there_or_is_none_is_one_sentence(self):
        nothing = self.folder / "none.json"
        empty = self.write("empty.json", "")
        for file in (nothing, empty, self.folder):
            shown = self.run_program("thimble", "flight", "show", file)
            self.assertEqual((shown.returncode, shown.stdout), (1, ""), file)
            self.assert_one_sentence(shown.stderr, str(file), "daemon.flight_directory")

    def test_a_recording_that_cannot_be_written_is_told(self):
        daemon = self.start("--set", "daemon.flight_directory=/proc/nowhere", config=TOO_FAST)
        status = daemon.status_when(
            lambda s: s["arms"][0]["faults"] and s["arms"][0]["faults"][0]["recording"])
        self.assertIn("/proc/nowhere", status["arms"][0]["faults"][0]["recording"])
        self.assertEqual(status["arms"][0]["state"], "fault")
        self.assertEqual(daemon.stop(), 0)
        self.assertIn("could not be written", daemon.log())


class Rights(ProcessTest):
    """A person without real-time rights: no capability, RLIMIT_RTPRIO 0."""

    def setUp(self):
        super().setUp()
        self.program = BIN / "thimbled"
        self.uid = os.getuid()
        if self.uid == 0:
            # Nobody may neither read a home folder nor write to the test's.
            self.uid = pwd.getpwnam("nobody").pw_uid
            self.program = self.folder / "thimbled"
            shutil.copy(BIN / "thimbled", self.program)
            self.folder.chmod(0o755)

    def drop(self):
        resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
        if os.getuid() != self.uid:
            os.setgroups([])
            os.setresgid(self.uid, self.uid, self.uid)
            os.setresuid(self.uid, self.uid, self.uid)
        die_with_parent()

    def start_without_rights(self, realtime):
        folder = self.folder / "own"
        folder.mkdir()
        if os.getuid() != self.uid:
            os.chown(folder, self.uid, -1)
        return self.start("--set", f"servo.realtime={realtime}", config=HELLO, name="own",
                          preexec=self.drop, program=self.program)

    def test_required_refuses_and_names_what_is_missing(self):
        with self.assertRaises(AssertionError) as refused:
            self.start_without_rights("required")
        words = str(refused.exception)
        self.assertIn("ended with 1", words)
        self.assertIn("real time is required, but: ", words)
        self.assertNotIn("\\x", words, "nothing that has to be escaped")
        self.assertIn("RLIMIT_RTPRIO", words)
        self.assertIn("LimitRTPRIO", words, "names the cure")

    def test_best_effort_runs_and_shows_it(self):
        daemon = self.start_without_rights("best-effort")
        status = daemon.status()
        self.assertFalse(status["servos"][0]["is_realtime"])
        self.assertTrue(any("RLIMIT_RTPRIO" in line for line in status["degraded"]), status)
        self.assertIn("RLIMIT_RTPRIO", self.thimble(daemon, "status").stdout.replace("\n", " "))
        self.assertEqual(daemon.stop(), 0)

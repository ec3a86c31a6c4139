"""`thimble doctor` as a person meets it: its exit code follows what it found."""

import json

from rig import HELLO, ProcessTest


class Doctor(ProcessTest):
    def setUp(self):
        super().setUp()
        self.root = self.folder / "machine"
        self.plant("proc/self/status", "Uid:\t0\t0\t0\t0\nGid:\t0\t0\t0\t0\nCapEff:\tffffffff\n")

    def plant(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def test_warnings_alone_are_no_failure(self):
        result = self.run_program("thimble", "doctor", "--root", self.root)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("warn   kernel: ", result.stdout)
        self.assertIn(" 0 wrong\n", result.stdout)

    def test_what_is_wrong_is_an_exit_code(self):
        self.plant("proc/sys/kernel/sched_rt_runtime_us", "0\n")
        result = self.run_program("thimble", "doctor", "--json", "--root", self.root)
        self.assertEqual((result.returncode, result.stderr), (1, ""))
        document = json.loads(result.stdout)
        self.assertTrue(document["wrong"])
        self.assertEqual([check["check"] for check in document["checks"] if check["level"] == "wrong"],
                         ["rt-share"])

    def test_a_configuration_says_what_is_asked_for(self):
        self.plant("proc/self/status", "Uid:\t0\t0\t0\t0\nGid:\t0\t0\t0\t0\nCapEff:\t4002\n")
        self.plant("proc/self/limits", "Max realtime priority  80  80\n")
        file = self.write("thimble.toml", HELLO + "[servo]\npriority = 81\n")
        for words, wrong in (((), False), (("--config", file), True)):
            result = self.run_program("thimble", "doctor", "--json", "--root", self.root, *words)
            self.assertEqual((result.returncode, result.stderr), (int(wrong), ""))
            found = [check["finding"] for check in json.loads(result.stdout)["checks"]
                     if check["check"] == "rtprio"]
            self.assertIn(f"priority {81 if wrong else 80}", found[0])
        file = self.write("thimble.toml", "[servo]\npriority = 'high'\n")
        result = self.run_program("thimble", "doctor", "--config", file)
        self.assertEqual((result.returncode, result.stderr), (1, ""))
        self.assertRegex(" ".join(result.stdout.split()), "WRONG configuration: .*servo.priority")
        result = self.run_program("thimble", "doctor", "--config", "")
        self.assertEqual((result.returncode, result.stdout), (2, ""), "it is no wish for none")

    def test_knows_the_daemon_by_its_socket(self):
        daemon = self.start(config=HELLO)
        file = self.write("other.toml", HELLO + f"[daemon]\nsocket = '{daemon.socket}'\n")
        for words in (("--socket", daemon.socket), ("--config", file)):
            result = self.run_program("thimble", "doctor", "--json", *words)
            found = [check["finding"] for check in json.loads(result.stdout)["checks"] if check["check"] == "daemon"]
            self.assertIn(f"thimbled (process {daemon.pid} of user ", found[0])
            self.assertIn(" listens at the socket", found[0])
        self.assert_servo_goes_on(daemon)

    def test_examines_this_machine_without_a_daemon(self):
        result = self.run_program("thimble", "doctor")
        self.assertIn(result.returncode, (0, 1))
        self.assertIn("kernel: Linux ", result.stdout)

    def test_a_root_that_is_not_there_is_a_wrong_argument(self):
        result = self.run_program("thimble", "doctor", "--root", self.folder / "none")
        self.assertEqual(result.returncode, 2)

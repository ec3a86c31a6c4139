"""`[safety]` in the real daemon, on a simulated chip whose contacts are closed."""

from rig import HELLO, ProcessTest

SAFETY = """[safety]
chip = "CHIP"
estop = ["0", "1"]
deadman = "2"
enable = "3"
lamp = "4"

"""


class Safety(ProcessTest):
    def started_on(self, chip):
        return self.start(config=SAFETY.replace("CHIP", chip) + HELLO)

    def wait_for(self, daemon, **wanted):
        daemon.status_when(lambda status: wanted.items() <= status["safety"].items())
        return daemon.status()["safety"]

    def test_nothing_moves_before_somebody_clears(self):
        daemon = self.started_on("sim:bench")
        self.assertIn("clear", self.wait_for(daemon, state="waiting", is_deadman_held=True,
                                             is_enable_beating=False)["message"])
        arm = daemon.status_when(lambda status: status["arms"][0]["faults"])["arms"][0]
        self.assertIn("not yet cleared since the start", arm["faults"][0]["message"])
        self.assertIn("thimble clear-fault right", arm["instruction"])
        cleared = self.thimble(daemon, "clear-fault", "right")
        self.assertEqual(cleared.returncode, 0, cleared.stderr)
        self.wait_for(daemon, state="free", is_enable_beating=True, message="", stops=0)
        self.assertIn("safety sim:bench  FREE", self.thimble(daemon, "status").stdout)
        self.assertEqual(daemon.stop(), 0)
        self.assertRegex(daemon.log(), r"info: .*not yet cleared since the start")
        self.assertNotIn("emergency stop is pressed", daemon.log())
        self.assertFalse(list(daemon.folder.glob("flight-*")), "a start is no stop")

    def test_a_simulated_chip_beside_a_real_arm_starts_nowhere(self):
        file = self.write("thimble.toml", SAFETY.replace("CHIP", "sim:bench") + HELLO)
        self.assertEqual(self.thimbled("--config", file, "--check").returncode, 0)
        for more in ((), ("--check",)):
            refused = self.thimbled("--config", file, "--set", "arm.device=hid:NOBODY",
                                    "--set", f"daemon.socket={self.folder}/s", *more)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn("safety.chip: ", refused.stderr)
            self.assertIn("arm 'right' is a real one", refused.stderr)
        advice = self.run_program("thimble", "doctor", "--config", file)
        self.assertIn("the safety lines are simulated", advice.stdout)
        file.write_text(file.read_text().replace("sim:phantom-vintage", "hid:NOBODY"))
        advice = self.run_program("thimble", "doctor", "--config", file)
        self.assertRegex(advice.stdout, r"WRONG +configuration: [^ ]* safety.chip:")
        self.assertNotIn("the safety lines are simulated", advice.stdout)

    def test_lines_that_are_not_there_are_a_stop_that_says_why(self):
        daemon = self.started_on("no-such-chip")
        self.wait_for(daemon, state="stopped", trouble="no-lines", is_deadman_held=False)
        refused = self.thimble(daemon, "clear-fault", "right")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("no GPIO chip of this label", refused.stderr)

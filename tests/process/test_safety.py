"""`[safety]` in the real daemon, on a simulated chip whose contacts are closed."""

import time

from rig import HELLO, TIMEOUT_S, ProcessTest

SAFETY = """[safety]
chip = "CHIP"
estop = ["0", "1"]
deadman = "2"
enable = "3"
lamp = "4"

"""
# What the daemon says of a stop by a machine that held it up.
HELD_UP = ("does not answer", "did not answer", "not looked after in time", "ENABLE paused")


class Safety(ProcessTest):
    def started_on(self, chip):
        return self.start(config=SAFETY.replace("CHIP", chip) + HELLO)

    def wait_for(self, daemon, **wanted):
        return daemon.status_when(lambda status: wanted.items() <= status["safety"].items())["safety"]

    def clear(self, daemon):
        """Until all is free and shown to be so: whether a busy machine stopped it meanwhile, so that it was cleared anew."""
        deadline = time.monotonic() + TIMEOUT_S
        most_stops = 10  # a busy machine, not a daemon that stops itself whenever it is cleared
        cleared = self.thimble(daemon, "clear-fault", "right")
        was_held_up = False
        while time.monotonic() < deadline:
            safety = daemon.status()["safety"]
            if any(words in cleared.stderr + safety["message"] for words in HELD_UP):
                was_held_up = True
                self.assertLessEqual(safety["stops"], most_stops, safety)
                cleared = self.thimble(daemon, "clear-fault", "right")
                continue
            self.assertEqual(cleared.returncode, 0, cleared.stderr)
            is_free = (safety["state"], safety["message"], safety["is_enable_beating"]) == ("free", "", True)
            if is_free and "safety sim:bench  FREE" in self.thimble(daemon, "status").stdout:
                self.assertTrue(was_held_up or safety["stops"] == 0, safety)
                return was_held_up
            time.sleep(0.02)
        self.fail(f"it never was free: {safety}\n{daemon.log()}")

    def test_nothing_moves_before_somebody_clears(self):
        daemon = self.started_on("sim:bench")
        self.assertIn("clear", self.wait_for(daemon, state="waiting", is_deadman_held=True,
                                             is_enable_beating=False)["message"])
        arm = daemon.status_when(lambda status: status["arms"][0]["faults"])["arms"][0]
        self.assertIn("not yet cleared since the start", arm["faults"][0]["message"])
        self.assertIn("thimble clear-fault right", arm["instruction"])
        was_held_up = self.clear(daemon)
        self.assertEqual(daemon.stop(), 0)
        self.assertRegex(daemon.log(), r"info: .*not yet cleared since the start")
        if not was_held_up and not daemon.final_status()["arms"][0]["faults"]:
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

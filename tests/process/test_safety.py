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

    def test_lines_that_are_not_there_are_a_stop_that_says_why(self):
        daemon = self.started_on("no-such-chip")
        self.wait_for(daemon, state="stopped", trouble="no-lines", is_deadman_held=False)
        refused = self.thimble(daemon, "clear-fault", "right")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("no GPIO chip of this label", refused.stderr)

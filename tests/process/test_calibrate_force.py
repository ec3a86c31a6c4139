"""`thimble calibrate-force` over a living daemon: what a person types becomes a line of the configuration."""

import re
import subprocess

from rig import BIN, HELLO, TIMEOUT_S, ProcessTest, clean_environment, die_with_parent

FALCON = HELLO.replace("sim:phantom-vintage", "sim:falcon-loaded").replace(
    'world = "box"\n', 'world = "box"\nactivate = false\n', 1)
STILL = ("--set", "arm.0.hand.motion=still")


def grams(newton):
    return 250 + 1000 * 1.3 * newton / 9.80665  # an arm of a quarter of a kilo, 30 % stronger


class CalibrateForce(ProcessTest):
    def calibrate(self, daemon, typed, *words):
        return subprocess.run(
            [BIN / "thimble", "--socket", daemon.socket, "calibrate-force", *map(str, words)], input=typed,
            capture_output=True, text=True, env=clean_environment(), timeout=TIMEOUT_S, check=False,
            preexec_fn=die_with_parent)

    def test_the_line_to_paste_is_what_the_scale_said(self):
        daemon = self.start(*STILL, config=FALCON)
        typed = "".join(f"{grams(1.4 * step):.0f} g\n" for step in range(4)) + "oops\n" + "".join(
            f"{grams(1.4 * step):.0f}\n" for step in (4, 5))
        result = self.calibrate(daemon, typed, "right", "--most", 7)
        self.assertEqual(result.returncode, 0, result.stderr)
        line = re.fullmatch(r"newton_per_count = (\S+)\n", result.stdout)
        self.assertTrue(line, result.stdout)
        assumed = daemon.status()["arms"][0]["newton_per_count"]
        self.assertAlmostEqual(float(line[1]) / assumed, 1.3, delta=0.01)
        self.assertIn("type what the scale shows", result.stderr)
        daemon.status_when(lambda status: status["arms"][0]["state"] == "inactive")

    def test_readings_that_no_scale_gives_are_refused(self):
        daemon = self.start(*STILL, config=FALCON)
        result = self.calibrate(daemon, "100\n" * 6)
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("does not follow the force", result.stderr)

    def test_an_end_of_the_input_lets_the_arm_go(self):
        daemon = self.start(*STILL, config=FALCON)
        result = self.calibrate(daemon, "100\n", "--most", 3, "--steps", 3)
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("input ended", result.stderr)
        daemon.status_when(lambda status: status["arms"][0]["state"] == "inactive")

    def test_an_arm_that_is_told_amperes_is_left_alone(self):
        daemon = self.start(config=HELLO)
        result = self.calibrate(daemon, "")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("told amperes", result.stderr)

    def test_a_limit_below_what_is_asked_is_told_before_the_arm_is_activated(self):
        daemon = self.start(*STILL, "--set", "arm.right.limits.force_newton=1", config=FALCON)
        result = self.calibrate(daemon, "100\n" * 6)
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("given 1 N at most, and 7.0 N is asked for", result.stderr)
        self.assertIn("--most 1", result.stderr)
        self.assertNotIn("pressing", result.stderr)
        self.assertEqual(daemon.status()["arms"][0]["lease"], "none")
        typed = "".join(f"{grams(newton / 5):.1f}\n" for newton in range(6))
        trial = self.calibrate(daemon, typed, "--most", 1)
        self.assertEqual((trial.returncode, trial.stdout), (0, ""), trial.stderr)

    def test_a_trial_of_the_direction_gives_no_line_to_paste(self):
        daemon = self.start(*STILL, "--set", "arm.right.limits.force_newton=1", config=FALCON)
        for gram, code, words in ((15, 0, "The arm presses down: the scale shows 15 g more"), (0, 1, "does not show"),
                                  (-15, 1, "does not press down; stop here")):
            with self.subTest(gram=gram):
                typed = "".join(f"{250 + gram * step / 5:.0f}\n" for step in range(6))
                result = self.calibrate(daemon, typed, "--most", 1)
                self.assertEqual((result.returncode, result.stdout), (code, ""), result.stderr)
                self.assertIn("a trial of the direction only", result.stderr)
                self.assertIn(words, result.stderr)
                self.assertEqual(code == 0, "without --most" in result.stderr)

    def test_a_line_of_too_few_grams_is_not_trusted(self):
        daemon = self.start(*STILL, "--set", "arm.right.newton_per_count=0.0024", config=FALCON)
        result = self.calibrate(daemon, "".join(f"{250 + 7 * step}\n" for step in range(6)))
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("only 35 g more", result.stderr)

    def test_an_absent_arm_is_said_to_be_lost(self):
        daemon = self.start(config=FALCON.replace("sim:falcon-loaded", "usb:250-1").replace("amplifier_max_a = 3.0", 'model = "falcon"').replace(
            '[arm.hand]\nmotion = "explore"\nseed = 1\n', ""))
        result = self.calibrate(daemon, "")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("is lost", result.stderr)
        self.assertNotIn("amperes", result.stderr)

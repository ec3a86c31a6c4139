"""Emergency stop, deadman and enable line on a chip whose kernel driver tells edges, gpio-sim's, under the real libgpiod: told at once, where a CP2112 is read every 20 ms (test_estop.py, which has
all that does not depend on the chip)."""

import re
import sys

import arms
import estop
import gpio_sim
import lines
import simdev

LABEL = "bench"
# A thread of the kernel's for the edge, one of the daemon's, in which time it acts then, and the period in which zero leaves; the arm's own log has a frame more.
PRESSED_S = 0.001 + 0.002 + 1 / arms.QUIET_HZ + 0.001
FADE_S = 0.02
# As many as the kernel keeps of a line are 16.
TOO_MANY = 20
# In scripts of the guest: the thread that reads edges and levels.
READER = f"$(ps -L -o lwp=,comm= -p {arms.PID} | awk '$2 == \"gpio\" {{print $1}}')"


class Arm(arms.HidArm):
    daemon_words = lines.SAFETY.replace("cp2112_gpio", LABEL)


class Edges(estop.Estop):
    """Numbered: each test goes on where the one before it ended."""

    arm_kind = Arm

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.open_as_doctor_says()

    @classmethod
    def plug_in_lines(cls):
        gpio_sim.load(cls.guest)
        return gpio_sim.Chip(cls.guest, LABEL)

    @classmethod
    def open_as_doctor_says(cls):
        """The chip, which is root's."""
        printed = cls.guest.ask("thimble doctor --config /etc/thimble/thimble.toml")[1]
        mend = re.search(r"^WRONG +safety-chip: .*?^ +mend: (.*?)$", printed, re.MULTILINE | re.DOTALL)
        assert mend, printed
        cls.guest.run(mend[1].replace("sudo ", ""))

    def take_hold(self, adapter=None):
        self.guest.steps(self.adapter.opens(2), ("sleep", lines.LET_GO_S), self.adapter.opens(2, False))

    def beats(self):
        return int(self.guest.steps(self.adapter.beats(3))[0])

    def felt_since(self, *lines_that_open):
        """For how long there was a force since the first of them opened."""
        steps = (*map(self.adapter.opens, lines_that_open), ("sleep", 0.5), self.arm.step(estop.LOG))
        (opened_s, *_), (log,) = simdev.words_and_logs(self.guest.steps(*steps))
        lasted_s = self.last_force_since(float(opened_s), log) - float(opened_s)
        print(f"lines {lines_that_open}: the last force was felt {lasted_s:.4f} s later", file=sys.stderr)
        return lasted_s

    def test_1_cleared_the_enable_line_beats_and_the_wall_is_felt(self):
        self.wait_until("safety.state", "waiting")
        self.assertEqual(self.beats(), 0)
        self.start_again()
        self.assertGreaterEqual(self.beats(), lines.BEATS)
        self.lean()

    def test_2_pressed_there_is_no_force_within_the_time_of_its_edge(self):
        self.assertLess(self.felt_since(0, 1), PRESSED_S)
        self.assertEqual(self.wait_until("safety.state", "stopped")["trouble"], "open")
        self.assertEqual(self.beats(), 0)
        self.adapter.release(0, 1)
        self.start_again()

    def test_3_a_deadman_that_is_let_go_ends_the_force_within_its_ramp(self):
        self.lean()
        self.assertLess(self.felt_since(2), PRESSED_S + FADE_S)
        self.wait_until("safety.is_deadman_held", "false")
        self.adapter.release(2)
        self.wait_until("safety.is_deadman_held", "true")
        self.lean()

    def assert_stopped_by(self, cause, *steps):
        """Once, which is over."""
        stops = self.wait_until("safety.state", "free")["stops"]
        self.guest.steps(*steps, ("sleep", 0.3))
        said = self.wait_until("safety.state", "waiting")
        self.assertEqual(said["stops"], stops + 1)
        self.assertIn(cause, said["message"])
        simdev.wait_for_state(self.guest, "fault")
        self.assert_no_force()
        self.start_again()

    def test_4_a_pulse_too_short_for_any_reading_is_a_stop(self):
        """Where a CP2112 may not see it."""
        self.assert_stopped_by("was pressed", self.adapter.opens(0), self.adapter.opens(0, False))

    def test_5_more_edges_than_the_kernel_keeps_are_a_stop_though_every_level_is_as_it_was(self):
        """Of the deadman, which stops nobody otherwise. Meanwhile the thread that reads them hangs, for less than ENABLE may pause (decision 0525)."""
        hangs = f"python3 -B /run/tests/hang_thread.py {READER} 0.03 > /run/hung 2>&1 & until [ -s /run/hung ]; do sleep 0.001; done"
        self.assert_stopped_by("changed unseen", ("run", hangs), *(self.adapter.opens(2, i % 2 == 0) for i in range(TOO_MANY)))

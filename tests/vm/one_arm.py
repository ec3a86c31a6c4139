"""An arm on the kernel's own stack, from its coming to its end: the packaged daemon claims it, a hand brings it home and feels the box.

What is felt is judged by the arm's own log, of what its motors did.
"""

import json

import guest
import nodes
import simdev

WALL_NEWTON = 0.25


def assert_ended_by_its_watchdog(test, log, watchdog_s, pressed_newton):
    """By what the arm itself says of its motors, on its own clock: a pulled arm pushes as before until it has heard nothing for so long, and then never again."""
    silent_s = max(entry["t_s"] for entry in log if "out" in entry)
    after = [(entry["t_s"] - silent_s, simdev.norm(entry["force_newton"])) for entry in log if "tip_m" in entry and entry["t_s"] > silent_s]
    test.assertGreater(len(after), 1000 * (watchdog_s + 0.9))
    # Its last command acts from the next frame on; and the motors' pulse is 0.5 ms long.
    before_s, since_s = watchdog_s - 0.005, watchdog_s + 0.005
    test.assertGreater(min(newton for when_s, newton in after if 0.01 < when_s < before_s), pressed_newton)
    test.assertLess(max(newton for when_s, newton in after if when_s > since_s), simdev.NOTHING_NEWTON)


def press_from_the_middle(test, arm, least_newton):
    """Of the box, where nothing is felt, to where its wall at +x pushes back."""
    arm.say("move 0 0 0 0.15")
    test.guest.sleep(0.4)
    test.assertLess(simdev.norm(arm.felt(0.1)), 0.1)
    arm.say("move 0.018 0 0 0.15")
    test.guest.sleep(0.4)
    test.assertLess(arm.felt(0.1)[0], -least_newton)


class OneArm(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended. `plug_in()` makes the arm; it shows the first test, of its node."""

    pace = guest.COUNTED
    walls = ((0, 1), (1, -1), (2, 1))  # axis and side, as the hand comes from there:
    rest_m = (0.0, 0.0, 0.0)
    watchdog_s = 0.5  # of its controller, which has a supply of its own (drivers/phantom/README.md)
    to_wall_m = 0.018  # 3 mm of it behind its face

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arm = cls.plug_in()

    def daemon_has_open(self, node):
        self.guest.wait_for(f"ls -l /proc/$(systemctl show thimbled -p MainPID --value)/fd | grep -q {node}")

    def assert_node(self, node):
        """The daemon's, as the rules say."""
        self.guest.wait_for("systemctl is-active thimbled")
        nodes.assert_closed(self, self.guest, node)
        self.daemon_has_open(node)
        self.assertEqual(self.arm.status()["counters"]["malformed"], 0)

    def move(self, point_m, within_s):
        self.arm.say("move {} {} {} {}".format(*point_m, within_s))

    def press(self, axis=None, sign=1):
        """On that wall, or the first, from wherever the hand is: what is felt."""
        if axis is None:
            axis, sign = self.walls[0]
        point_m = list(self.rest_m)
        point_m[axis] += sign * self.to_wall_m
        self.move(point_m, 0.15)
        self.guest.sleep(0.3)
        return self.arm.felt(0.1)

    def test_2_brought_home_it_becomes_active(self):
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertLess(max(self.arm.forces(1)), simdev.NOTHING_NEWTON)
        self.arm.activate()
        # vm.boot shows it of an arm within the daemon; here the threads of a bus are started besides.
        self.assertEqual(self.guest.run("ps -L -o comm=,cls=,rtprio= -p $(systemctl show thimbled -p MainPID --value) | grep ^servo").split(),
                         ["servo-right", "FF", "80"])

    def test_3_where_no_wall_is_nothing_is_felt(self):
        self.move(self.rest_m, 0.15)
        self.guest.sleep(0.3)
        self.assertLess(simdev.norm(self.arm.felt(0.1)), 0.1)

    def test_4_a_wall_of_the_box_pushes_back(self):
        for axis, sign in self.walls:
            with self.subTest(axis=axis, sign=sign):
                force = self.press(axis, sign)
                self.assertLess(sign * force[axis], -WALL_NEWTON, force)
                self.move(self.rest_m, 0.1)
                self.guest.sleep(0.1)

    def test_5_pulled_out_while_the_hand_pushes_it_is_lost_and_comes_back_when_it_is_cleared(self):
        self.assertGreater(simdev.norm(self.press()), WALL_NEWTON)
        self.pull()
        arm = json.loads(simdev.wait_for_state(self.guest, "lost"))
        self.assertEqual(arm["force_newton"], [0, 0, 0])
        self.assertEqual([fault["code"] for fault in arm["faults"]], ["disconnected"])
        self.arm.say("plug")
        self.arm.plug()
        simdev.wait_for_state(self.guest, "calibrating")
        self.assertLess(max(self.arm.forces(0.2)), simdev.NOTHING_NEWTON)
        back = self.arm.bring_back()
        self.assertEqual([fault["number"] for fault in back["faults"]], [fault["number"] for fault in arm["faults"]])
        self.assertEqual((back["faults"][0]["code"], back["force_newton"]), ("disconnected", [0, 0, 0]))
        self.arm.clear()
        self.move(self.rest_m, 0.1)
        self.guest.sleep(0.2)

    def pull(self):
        """Its cable alone, so that its watchdog has to end the force."""
        steps = (self.arm.step("pull-cable"), ("sleep", self.watchdog_s + 1), self.arm.step(f"log {self.watchdog_s + 3}"))
        _, (log,) = simdev.words_and_logs(self.guest.steps(*steps))
        assert_ended_by_its_watchdog(self, log, self.watchdog_s, WALL_NEWTON)

    def test_6_stopped_while_the_hand_pushes_the_daemon_leaves_no_force(self):
        self.assertGreater(simdev.norm(self.press()), WALL_NEWTON)
        self.guest.steps(("run", "systemctl stop thimbled"), ("sleep", 0.2))
        self.assertLess(max(self.arm.forces(0.1)), simdev.NOTHING_NEWTON)

    def test_7_gone_with_its_daemon_it_keeps_no_guard_at_work(self):
        """Its zeros are refused; else they are tried for 25 s. Without its supply, so that it is calibrated again."""
        self.arm.say("unplug", "plug")
        self.arm.plug()
        self.guest.run("systemctl start thimbled")
        self.arm.activate()
        self.guest.steps(("run", "pgrep -x thimble-guard"), ("signal", "SIGSTOP"), self.arm.step("unplug"), ("signal", "SIGKILL"), ("sleep", 1),
                         ("run", "! pgrep -x thimble-guard"))



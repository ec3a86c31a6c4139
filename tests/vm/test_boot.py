"""The package, after a boot: the service runs, in its sandbox and with real-time rights, and talks to whom it shall."""

import json

import guest
import simdev

# The servo thread's name is "servo-" and the arm's.
SERVO = "$(ps -L -o lwp=,comm= -p $(systemctl show thimbled -p MainPID --value) | awk '$2 ~ /^servo-/ {print $1}')"

# A device that its unit does not name, with rights that let everybody read it.
NODE = "/dev/thimble-probe"
PROBE = "/usr/bin/python3 -B /run/tests/sandbox.py"
DROP_IN = "/run/systemd/system/thimbled.service.d/probe.conf"
# What the unit, with all that it says, runs in place of the daemon.
IN_ITS_PLACE = "[Service]\\nType=oneshot\\nRestart=no\\nWatchdogSec=0\\nExecStart=\\nExecStart={}\\nStandardOutput=truncate:/run/probed\\n"
# In the sandbox and its limits, and without: /boot and /usr are seen as read-only before anybody asks for rights.
TRIES = {
    "new /usr/lib/thimble-probe": ("EROFS", "EACCES"),
    "new /etc/thimble-probe": ("EROFS", "EACCES"),
    "new /boot/thimble-probe": ("EROFS", "EACCES"),
    "new /var/lib/thimble/probe": ("done", "done"),
    "device": ("EPERM", "done"),
    "packet": ("EAFNOSUPPORT", "EPERM"),
    "unix": ("done", "done"),
    "executable memory": ("EPERM", "done"),
    "others' processes": ("ENOENT", "done"),
    "homes": ("EACCES", "done"),
    "real time": ("done", "EPERM"),
    "more real time": ("EPERM", "EPERM"),
    "locked memory": ("done", "ENOMEM"),
    "tasks": ("EAGAIN", "done"),
}


class Boot(guest.GuestTest):
    pace = guest.ON_TWO

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.guest.run("useradd --create-home member; useradd --create-home other; adduser --quiet member thimble-users")
        cls.guest.wait_for("systemctl is-active thimbled")
        # It tells systemd first, then the log.
        cls.guest.wait_for("journalctl --no-pager -b -u thimbled | grep -q 'ready: '")
        # Before any test touches it.
        cls.first_words = cls.guest.run("journalctl --no-pager -b -u thimbled")
        cls.restarts = cls.properties("NRestarts")

    def test_the_service_runs_and_has_said_that_it_is_ready(self):
        state = self.properties("ActiveState", "SubState", "Type", "WatchdogUSec")
        self.assertEqual(state, {"ActiveState": "active", "SubState": "running", "Type": "notify", "WatchdogUSec": "3s"})
        self.assertIn("ready: 1 arm(s), 1 world(s), socket /run/thimble/thimble.sock", self.first_words)
        self.assertNotIn("degraded", self.first_words)
        self.assertEqual(self.restarts, {"NRestarts": "0"})

    def test_guards_of_arms_can_be_had(self):
        self.assertEqual(self.guest.run("systemctl is-active thimble-guard.socket; stat -c '%U:%G %a' /run/thimble-guard.sock").split(),
                         ["active", "root:thimble", "660"])

    def test_the_simulated_arm_becomes_active(self):
        self.guest.wait_for("systemctl show thimbled -p StatusText | grep -qi 'right active'")

    def test_no_unit_of_the_guest_failed(self):
        self.guest.ask("systemctl is-system-running --wait", timeout_s=240)
        self.assertEqual(self.guest.run("systemctl --failed --no-legend").strip(), "")

    def test_it_is_in_its_sandbox(self):
        text = self.guest.run("cat /proc/$(systemctl show thimbled -p MainPID --value)/status")
        status = dict(line.split(":\t", 1) for line in text.splitlines() if ":\t" in line)
        user = self.guest.run("id -u thimble").strip()
        self.assertEqual(set(status["Uid"].split()), {user})
        self.assertEqual(int(status["CapEff"], 16), 0)
        self.assertEqual(int(status["CapBnd"], 16), 0)
        self.assertEqual(status["NoNewPrivs"].strip(), "1")
        self.assertEqual(status["Seccomp"].strip(), "2")

    def in_its_place(self, words):
        """What the unit, with all that it says, made of the probe; afterwards it runs the daemon again."""
        self.guest.run(f"mkdir -p $(dirname {DROP_IN}); printf '{IN_ITS_PLACE.format(f'{PROBE} {words}')}' > {DROP_IN}; systemctl daemon-reload")
        self.guest.ask("systemctl restart thimbled")
        result = self.properties("Result", "ExecMainStatus")
        self.guest.run(f"rm {DROP_IN}; systemctl daemon-reload; systemctl reset-failed thimbled; systemctl restart thimbled")
        return result

    def test_its_sandbox_and_limits_are_what_makes_the_difference(self):
        self.guest.run(f"mknod -m 666 {NODE} b $(stat -c '0x%t 0x%T' /dev/vda)")
        self.assertEqual(self.in_its_place(NODE), {"Result": "success", "ExecMainStatus": "0"})
        inside = json.loads(self.guest.run("cat /run/probed"))
        outside = json.loads(self.guest.run(f"runuser -u thimble -g thimble-users -- {PROBE} {NODE}"))
        self.guest.run(f"rm {NODE}")
        self.assertEqual({name: (inside[name], outside[name]) for name in inside}, TRIES)

    def test_one_that_takes_a_processor_in_real_time_for_good_is_ended(self):
        self.assertEqual(self.in_its_place("--spin"), {"Result": "signal", "ExecMainStatus": "9"})

    def test_it_needs_little_of_the_memory_that_it_may_have(self):
        used, most = (int(word) for word in self.guest.run("cd /sys/fs/cgroup$(systemctl show thimbled -p ControlGroup --value); cat memory.peak memory.max").split())
        self.assertEqual(most, 2 << 30)
        self.assertLess(used, most // 10)

    def test_its_servo_has_real_time_rights_within_it(self):
        self.assertRegex(self.guest.run(f"chrt -p {SERVO}"), r"policy: SCHED_FIFO[^\n]*\n[^\n]*priority: 80")
        locked = self.guest.run("grep VmLck /proc/$(systemctl show thimbled -p MainPID --value)/status")
        self.assertGreater(int(locked.split()[1]), 0)

    def test_a_member_of_the_group_is_answered(self):
        self.assertIn("arm right", self.guest.run("runuser -u member -- thimble status"))

    def test_others_are_refused_and_told_what_to_do(self):
        status, words = self.guest.ask("runuser -u other -- thimble status")
        self.assertNotEqual(status, 0)
        self.assertIn("become a member of its group: sudo adduser \"$USER\" thimble-users", words)

    def test_nothing_listens_on_the_network(self):
        self.assertNotIn("thimbled", self.guest.run("ss -Hltunp"))

    def test_one_that_hangs_is_ended_and_started_anew(self):
        self.guest.run("kill -STOP $(systemctl show thimbled -p MainPID --value)")
        # More than once where the host stalls the guest.
        self.guest.wait_for("systemctl show thimbled -p NRestarts | grep -qx 'NRestarts=[1-9]' && systemctl is-active thimbled")
        self.assertIn("Watchdog timeout", self.guest.run("journalctl --no-pager -b -u thimbled"))
        # Nothing is active unasked after that, until one has ended in order.
        arm = simdev.wait_for_state(self.guest, "inactive")
        self.assertIn('"lease": "none"', arm)
        self.guest.run("systemctl restart thimbled")
        simdev.wait_for_state(self.guest, "active")

    def test_one_whose_configuration_is_wrong_fails_at_once_and_says_why(self):
        file = "/etc/thimble/thimble.toml"
        self.guest.run(f"cp {file} /run/kept.toml; sed -i '1i colour = \"red\"' {file}; ! systemctl restart thimbled")
        state = self.properties("ActiveState", "Result", "ExecMainStatus", "NRestarts")
        # systemd forgets what it counts against a unit that is started too often.
        self.guest.run(f"cp /run/kept.toml {file}; systemctl reset-failed thimbled; systemctl start thimbled")
        self.assertEqual(state, {"ActiveState": "failed", "Result": "exit-code", "ExecMainStatus": "2", "NRestarts": "0"})
        self.assertIn(f"{file}:1:1: colour: there is no such key", self.guest.run("journalctl --no-pager -b -u thimbled"))
        simdev.wait_for_state(self.guest, "active")

    def test_when_told_to_stop_it_ends_well(self):
        self.guest.run("systemctl stop thimbled")
        self.assertEqual(self.properties("Result", "ExecMainStatus"), {"Result": "success", "ExecMainStatus": "0"})
        self.guest.run("! test -e /run/thimble")
        self.guest.run("systemctl start thimbled")

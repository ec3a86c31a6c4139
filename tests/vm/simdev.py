"""A simulated device of ours, offered to the guest's kernel by the packaged thimble-simdev."""

import json
import math
import statistics


PORT = "3240"  # that of USB/IP
NOTHING_NEWTON = 1e-6  # a force below it is none


# The kernel's threads that carry USB/IP are a part of the hardware here, too, and wait for no program.
def carriers_at(priority):
    return f"for thread in $(pgrep ^vhci_); do chrt -f -p {priority} $thread; done"


RAISE_CARRIERS = carriers_at(86)


def attach_command():
    return f"usbip --tcp-port {PORT} attach -r 127.0.0.1 -b 1-1 && {RAISE_CARRIERS}"


def norm(vector):
    return math.sqrt(sum(value * value for value in vector))


def gaps(at_s):
    """Between those moments, s, which are in order: each with when it began."""
    return [(later - sooner, sooner) for sooner, later in zip(at_s, at_s[1:])]


def words_and_logs(printed):
    """Of what Guest.steps() printed: the lines that are of no log, and each log that was asked for in it, all entries but the closing one. Between two commands an idle guest's clock runs ahead,
    and an arm's log forgets what was before."""
    words, logs, entries = [], [], []
    for line in printed:
        if line.startswith('{"ok"') and '"entries"' in line:
            logs.append(entries)
            entries = []
        elif line.startswith("{") and not line.startswith('{"ok"'):
            entries.append(json.loads(line))
        else:
            words.append(line)
    return words, logs


def wait_for_state(guest, *states, arm=0):
    """Until the daemon's arm, counted as in its configuration, is in one of them: what the status says of that arm."""
    return guest.wait_for_module("status_until", f"arms.{arm}.state", *states)


class Simdev:
    """Runs in the guest until stop(). `options`: those of thimble-simdev, and the model."""

    # Above the servo: what is hardware does not wait for software.
    policy = "-p CPUSchedulingPolicy=fifo -p CPUSchedulingPriority=85"
    # Above other hardware and the threads that carry it, which one that misbehaves keeps at work: equals wait for each other.
    first = "-p CPUSchedulingPolicy=fifo -p CPUSchedulingPriority=87"

    def __init__(self, guest, name, *options, policy=None):
        self.guest = guest
        self.unit = f"simdev-{name}"
        self.socket = f"/run/{self.unit}.sock"
        self.options = options
        self.policy = self.policy if policy is None else policy
        self.start()

    def start(self):
        """Also again, after stop(): another one of its kind."""
        self.guest.run(f"systemd-run --quiet --collect --unit {self.unit} {self.policy} "
                       f"thimble-simdev --socket {self.socket} {' '.join(self.options)}; "
                       f"until [ -S {self.socket} ] || ! systemctl is-active --quiet {self.unit}; do sleep 0.05; done")
        self.status()

    def attach(self):
        """To the guest's kernel, where it is offered over USB/IP; what plugs itself into it is there."""
        self.guest.run(RAISE_CARRIERS if "--vhci" in self.options else attach_command())

    def step(self, *verbs):
        """For Guest.steps()."""
        return "say", self.socket, *verbs

    def say(self, *verbs):
        """The answers, a dictionary each; every verb must succeed."""
        return [json.loads(line) for line in self.guest.call("simdev", self.socket, *verbs).splitlines()]

    def status(self):
        return self.say("status")[0]

    def log(self, seconds=1):
        """What the model felt: all entries but the closing one."""
        return self.say(f"log {seconds}")[:-1]

    def samples(self, seconds=1):
        return [entry for entry in self.log(seconds) if "tip_m" in entry]

    def forces(self, seconds=1):
        """The size of each sample's force."""
        return [norm(entry["force_newton"]) for entry in self.samples(seconds)]

    def felt(self, seconds=0.5):
        """The force of its motors at the tip, the median of the last SECONDS in each axis."""
        forces = [entry["force_newton"] for entry in self.samples(seconds)]
        return [statistics.median(force[axis] for force in forces) for axis in range(3)]

    def calibrate(self):
        """As a person does: the arm to its home pose, the button pressed and let go."""
        self.say("home 0.2")
        self.guest.sleep(0.25)
        self.say("press 0")
        self.guest.sleep(0.06)
        self.say("release 0")

    def stop(self):
        self.guest.ask(f"systemctl stop {self.unit}")

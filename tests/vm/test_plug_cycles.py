"""An arm that is plugged in and pulled out 1,000 times through uhid and 50 times on the USB stack: the daemon keeps nothing of them, and drives the arm afterwards.

What is kept is what the daemon has more of after the last turns than after the first ones: descriptors, threads, guards, memory. It locks its
memory, so that each page of it is seen.
"""

import json

import arms
import guest
import simdev

# By then it has all that it needs once.
WARM_UP, CYCLES, HOLD = 100, 900, 30
LIES = 60
USB_WARM_UP, USB_CYCLES = 10, 40
# 300 bytes a turn. Ours: what allocators and caches take and keep for themselves is a tenth of it.
MOST_KIB = 256
LOOK = """
thimble status --json > /run/status
pid=$(systemctl show thimbled -p MainPID --value)
echo "{\\"pid\\": $pid, \\"restarts\\": $(systemctl show thimbled -p NRestarts --value),
\\"descriptors\\": $(ls /proc/$pid/fd | wc -l), \\"threads\\": $(ls /proc/$pid/task | wc -l),
\\"guards\\": $(systemctl list-units --all --no-legend 'thimble-guard@*' | wc -l),
\\"recordings\\": $(ls /var/lib/thimble | wc -l),
\\"memory_kib\\": $(awk '/^VmRSS/ {print $2}' /proc/$pid/status),
\\"state\\": \\"$(python3 -c 'import json; print(json.load(open("/run/status"))["arms"][0]["state"])')\\"}"
"""
KEPT = ("pid", "restarts", "descriptors", "threads", "guards", "state")
MOST_RECORDINGS = 64  # kMaxRecordings of daemon/app


class PlugCycles(guest.GuestTest):
    pace = guest.COUNTED

    def look(self):
        """At the daemon, when the last device is gone and everybody has done with it."""
        self.guest.run("udevadm settle; sleep 3")
        simdev.wait_for_state(self.guest, "lost")
        return json.loads(self.guest.run(LOOK))

    def cycle(self, what):
        return int(self.guest.run(f"python3 -B /run/tests/plug_cycles.py {what}", timeout_s=600).split()[-1])

    def assert_nothing_kept(self, before, after):
        self.assertEqual({key: after[key] for key in KEPT}, {key: before[key] for key in KEPT})
        self.assertLess(after["memory_kib"] - before["memory_kib"], MOST_KIB)
        self.assertLessEqual(after["recordings"], MOST_RECORDINGS)

    def assert_works(self, arm):
        arm.activate()
        arm.say("move 0.018 0 0 0.3")
        self.guest.wait_for("thimble status --json | python3 -c 'import json, sys; "
                            "sys.exit(not json.load(sys.stdin)[\"arms\"][0][\"is_in_contact\"])'")
        self.guest.run("sleep 0.4")  # until the hand, which comes to the wall first, is where it goes
        self.assertLess(arm.felt(0.2)[0], -0.3)

    def test_1_through_uhid(self):
        arm = arms.HidArm(self.guest)
        self.assert_works(arm)
        arm.stop()
        self.cycle(f"uhid {WARM_UP} {HOLD} {arms.SERIAL}")
        before = self.look()
        opened = self.cycle(f"uhid {CYCLES} {HOLD} {arms.SERIAL}")
        self.assertEqual(opened, CYCLES // HOLD)
        self.assert_nothing_kept(before, self.look())
        taken = self.cycle(f"lies {LIES} {arms.SERIAL}")
        self.assertGreater(taken, LIES // 10)
        self.assert_nothing_kept(before, self.look())
        arm.start()
        self.assert_works(arm)
        arm.stop()

    def test_2_on_the_usb_stack(self):
        arm = arms.HidArm(self.guest, "usbip")
        self.assert_works(arm)
        arm.say("unplug", "plug")
        self.cycle(f"usbip {USB_WARM_UP} {arm.socket}")
        before = self.look()
        arm.say("plug")
        used = self.cycle(f"usbip {USB_CYCLES} {arm.socket}")
        self.assertEqual(used, USB_CYCLES)
        self.assert_nothing_kept(before, self.look())
        arm.say("plug")
        arm.attach()
        self.assert_works(arm)

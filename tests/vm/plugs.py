"""An arm that is plugged in and pulled out again and again: the daemon keeps nothing of it, and drives it before, between and afterwards.

What is kept is what the daemon has more of after the last turns than after the first ones: descriptors, threads, guards, memory. It locks its
memory, so that each page of it is seen, and has one arena of the allocator for all its threads (decision 0011), as it is shipped.
"""

import json
import sys

import arms
import guest
import kept
import simdev

# Of a hand on the wall that each arm leans on; a Falcon feels 0.29 N there.
PRESSED_NEWTON = 0.2
USB_WARM_UP = 5  # of each arm: by then it has all that it needs once
# Each plug of 1,000 goes through all rules of udev; those that know nothing of these devices are half of what it costs (decision 0390).
ONLY_RULES_THAT_MATTER = """
mkdir -p /run/udev/rules.d
for file in /lib/udev/rules.d/*; do
  case $file in *thimble*|*/50-udev-default.rules|*/80-drivers.rules|*/99-systemd.rules) ;; *) ln -s /dev/null /run/udev/rules.d/${file##*/};; esac
done
udevadm control --reload
"""
# As it is shipped, the heap grows in steps of 132 KiB, in which what is kept could hide; here by what is asked for, in whole pages. Mostly it is not a page more; a few are what fragments leave,
# once. And the C library keeps the stack of a thread that has ended until the next one ends (nptl/nptl-stack.c: it cannot unmap its own), two where two end together: 264 KiB each, locked.
# What is kept of each plug or opening shows in each of the blocks in which they are made: there must be one that took no page. Of ten openings through uhid that is 410 bytes of each.
STACK_KIB = 264
MOST_STACKS = 2
KEPT_KIB = 64
BLOCKS = 3
NOTHING_IN_STORE = """
mkdir -p /run/systemd/system/thimbled.service.d
printf '[Service]\\nEnvironment=MALLOC_TOP_PAD_=0 GLIBC_TUNABLES=glibc.pthread.stack_cache_size=0\\n' > /run/systemd/system/thimbled.service.d/heap.conf
systemctl daemon-reload
"""
LOOK = """
pid=$(systemctl show thimbled -p MainPID --value)
grep -qz ^MALLOC_TOP_PAD_=0 /proc/$pid/environ || exit 1
echo "{\\"pid\\": $pid, \\"restarts\\": $(systemctl show thimbled -p NRestarts --value),
""" + kept.COUNTS + """,
\\"recordings\\": $(ls /var/lib/thimble | wc -l),
\\"memory_kib\\": $(awk '/^VmRSS/ {print $2}' /proc/$pid/status)}"
"""
MEMORY = f"awk '/^VmRSS/ {{print $2}}' /proc/{arms.PID}/status"
KEPT = ("pid", "restarts", "descriptors", "threads", "guards")
MOST_RECORDINGS = 32  # of one arm: kMaxRecordings of daemon/app


class PlugCycles:
    """For a guest.GuestTest."""

    pace = guest.COUNTED

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.guest.run(ONLY_RULES_THAT_MATTER + NOTHING_IN_STORE)

    def look(self):
        """At the daemon, when the last device is gone and everybody has done with it: what it had of one that pressed on a wall, too."""
        self.guest.run("udevadm settle; sleep 3")
        simdev.wait_for_state(self.guest, "lost")
        return json.loads(self.guest.run(LOOK))

    def cycle(self, what):
        return int(self.guest.call("plug_cycles", *what.split(), timeout_s=600).split()[-1])

    def assert_nothing_kept(self, before, after):
        self.assertEqual({key: after[key] for key in KEPT}, {key: before[key] for key in KEPT})
        print(f"{self._testMethodName}: {before['memory_kib']} KiB, then {after['memory_kib']}", file=sys.stderr)
        stacks, pages_kib = divmod(max(0, after["memory_kib"] - before["memory_kib"]), STACK_KIB)
        self.assertLessEqual(stacks, MOST_STACKS)
        self.assertLess(pages_kib, KEPT_KIB)
        self.assertLessEqual(after["recordings"], MOST_RECORDINGS)

    def cycle_in_blocks(self, before, block):
        """One of which took no page, nor hid one behind a stack that went."""
        memory = [before["memory_kib"]]
        for number in range(BLOCKS):
            block(number)
            simdev.wait_for_state(self.guest, "lost")
            memory.append(int(self.guest.run(MEMORY)))
        print(f"{self._testMethodName}: KiB {memory}", file=sys.stderr)
        grown = [later - sooner for sooner, later in zip(memory, memory[1:])]
        self.assertTrue(any(kib <= 0 and kib % STACK_KIB == 0 for kib in grown), grown)

    def live(self, arm, become_active):
        """Until a hand presses on a wall with it: whoever pulls it out then leaves a fault that is latched, and its recording."""
        become_active()
        arm.say("move 0.018 0 0 0.3")
        self.guest.wait_for_module("status_until", "arms.0.is_in_contact", "true")
        self.guest.sleep(0.4)  # until the hand, which comes to the wall first, is where it goes
        self.assertGreater(simdev.norm(arm.felt(0.2)), PRESSED_NEWTON)

    def live_again(self, arm):
        arm.say("plug")
        arm.plug()
        self.live(arm, arm.resume)
        arm.say("unplug")

    def plug_often(self, arm, cycles):
        self.addCleanup(arm.stop)
        self.live(arm, arm.activate)
        arm.say("unplug", "plug")
        self.cycle(f"usb {USB_WARM_UP} {arm.socket}")
        self.live_again(arm)
        before = self.look()

        def block(_):
            arm.say("plug")
            self.assertEqual(self.cycle(f"usb {cycles} {arm.socket}"), cycles)

        self.cycle_in_blocks(before, block)
        self.live_again(arm)
        self.assert_nothing_kept(before, self.look())

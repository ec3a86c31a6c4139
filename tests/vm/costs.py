"""What each command of a guest costs its emulator, for whoever looks for what is dear: lines in the file that THIMBLE_VM_COSTS names.

A line has the processor's seconds of the command, those that passed since the answer before it, and its words. Not for assertions.
"""

import os

TICKS_PER_S = os.sysconf("SC_CLK_TCK")
WORDS = 160  # of a script


def busy_s(process):
    """Of all threads of the emulator, since it began."""
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as stat:
        fields = stat.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S  # utime, stime: proc(5)


class Costs:
    """Of one guest."""

    def __init__(self, process):
        self.process = process
        self.path = os.environ.get("THIMBLE_VM_COSTS")
        self.answered_s = self.asked_s = 0.0
        self.words = "start"

    def asked(self, words):
        if self.path:
            self.words = " ".join(words.split())[:WORDS]
            self.asked_s = busy_s(self.process)

    def answered(self):
        if not self.path:
            return
        now_s = busy_s(self.process)
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(f"{now_s - self.asked_s:.2f} {self.asked_s - self.answered_s:.2f} {self.words}\n")
        self.answered_s = now_s

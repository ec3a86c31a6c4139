"""In the guest: which threads of a process take memory from the C library, or give it back, and on whose behalf.

usage: allocations.py PID SECONDS

Prints JSON: by thread ("NAME/TID", all that live at the end) the calls, as "malloc by libusb-1.0.so.0.3.0", and how many. The kernel counts
them, by probes on the C library's own functions: nothing is loaded into the process, which runs as it is installed.
"""

import collections
import ctypes
import json
import os
import pathlib
import re
import sys
import time

TRACING = pathlib.Path("/sys/kernel/tracing")
EVENTS = TRACING / "events/allocations"
FUNCTIONS = ("malloc", "calloc", "realloc", "reallocarray", "memalign", "aligned_alloc", "posix_memalign", "free")
ENTRY = re.compile(r"\{ common_pid: +(\d+), caller: ([0-9a-f]+) \} hitcount: +(\d+)")


def mappings(pid):
    """(start, end, offset in the file, path) of what is mapped from files."""
    for line in pathlib.Path(f"/proc/{pid}/maps").read_text(encoding="utf-8").splitlines():
        words = line.split(maxsplit=5)
        if len(words) == 6:
            start, end = (int(word, 16) for word in words[0].split("-"))
            yield start, end, int(words[2], 16), words[5]


def find(pid, address):
    for start, end, offset, path in mappings(pid):
        if start <= address < end:
            return path, address - start + offset
    return "?", 0


def tell_kernel(words):
    events = os.open(TRACING / "uprobe_events", os.O_WRONLY | os.O_APPEND)
    os.write(events, words.encode())
    os.close(events)


def probe(name, pid):
    """All calls of the function, told apart by thread and caller, whose address is on top of the stack on entry (x86-64)."""
    path, offset = find("self", ctypes.cast(getattr(ctypes.CDLL("libc.so.6"), name), ctypes.c_void_p).value)
    tell_kernel(f"p:allocations/{name} {path}:{offset:#x} caller=+0(%sp):x64\n")
    threads = " || ".join(f"common_pid == {task.name}" for task in pathlib.Path(f"/proc/{pid}/task").iterdir())
    trigger = f"hist:keys=common_pid,caller.hex if {threads}\n"
    (EVENTS / name / "trigger").write_text(trigger, encoding="utf-8")
    return trigger


def count(pid):
    calls = {int(task.name): collections.Counter() for task in pathlib.Path(f"/proc/{pid}/task").iterdir()}
    for name in FUNCTIONS:
        histogram = (EVENTS / name / "hist").read_text(encoding="utf-8")
        if not re.search(r"Dropped: 0$", histogram, re.MULTILINE):
            raise RuntimeError(f"not all calls were counted:\n{histogram}")
        for thread, caller, hits in ENTRY.findall(histogram):
            if int(thread) in calls:
                calls[int(thread)][f"{name} by {pathlib.Path(find(pid, int(caller, 16))[0]).name}"] += int(hits)
    return calls


def main(pid, seconds):
    triggers = {name: probe(name, pid) for name in FUNCTIONS}
    time.sleep(seconds)
    calls = count(pid)
    for name, trigger in triggers.items():
        (EVENTS / name / "trigger").write_text(f"!{trigger}", encoding="utf-8")
        tell_kernel(f"-:allocations/{name}\n")
    names = {thread: pathlib.Path(f"/proc/{pid}/task/{thread}/comm").read_text(encoding="utf-8").strip() for thread in calls}
    print(json.dumps({f"{names[thread]}/{thread}": objects for thread, objects in calls.items()}))


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]))

"""In the guest: one step after the other, in a process that is there already.

usage: steps.py STEP…    (each the JSON of a list: what, and its words)

  ["say", SOCKET, VERB…]       to a thimble-simdev, as simdev.py
  ["run", SCRIPT]              of bash; it must succeed
  ["sleep", SECONDS]
  ["now"]                      prints the monotonic clock, s
  ["signal", NAME]             to the daemon; prints when
  ["write", FILE, WORD]        a file of the kernel's; prints when
  ["beats", FILE, SECONDS]     how often a file of the kernel's changed: prints it
  ["hang", THREAD, SECONDS]    the daemon's thread of that name, as hang_thread.py

For what belongs together: between two commands of the host an idle guest's clock runs ahead, and to start an interpreter takes an emulated machine half a second.
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import hang_thread
import simdev

LOOK_S = 0.002
CGROUP = pathlib.Path("/sys/fs/cgroup/system.slice/thimbled.service/cgroup.procs")


def daemon():
    """Its process: the only one of its unit."""
    (pid,) = CGROUP.read_text().split()
    return int(pid)


def now():
    print(time.monotonic())


def run(script):
    done = subprocess.run(["bash", "-c", script], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    print(done.stdout.decode(errors="replace"), end="")
    if done.returncode != 0:
        sys.exit(done.returncode)


def send_signal(name):
    pid = daemon()
    now()
    os.kill(pid, getattr(signal, name))


def hang(thread, seconds):
    (found,) = (task.name for task in pathlib.Path(f"/proc/{daemon()}/task").iterdir() if (task / "comm").read_text().strip() == thread)
    hang_thread.main(found, seconds)


def write(path, word):
    file = open(path, "w", encoding="utf-8")
    now()
    with file:
        file.write(word)


def beats(path, seconds):
    changes = 0
    end = time.monotonic() + seconds
    with open(path, encoding="utf-8") as file:
        last = file.read()
        while time.monotonic() < end:
            time.sleep(LOOK_S)
            file.seek(0)
            changes += last != (last := file.read())
    print(changes)


STEPS = {"say": simdev.main, "run": run, "sleep": time.sleep, "now": now, "signal": send_signal, "write": write, "beats": beats, "hang": hang}


def main(*steps):
    for what, *words in map(json.loads, steps):
        STEPS[what](*words)


if __name__ == "__main__":
    main(*sys.argv[1:])

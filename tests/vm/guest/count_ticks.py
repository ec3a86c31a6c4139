"""In the guest: what servo, kernel and a simulated device count while it sleeps.

usage: count_ticks.py SECONDS LOG_SECONDS SOCKET    (the socket of a thimble-simdev, whose log of so long is asked for afterwards)

Prints a line of JSON, {"begin_s", "end_s", "before", "after"}, of the monotonic clock and two {"servo", "switches"}; then each line of
the log that is of a packet. In one process that is there already: between two commands an idle guest's clock runs ahead, and a slow one
takes so long to start a program that the device's log has forgotten.
"""

import json
import pathlib
import subprocess
import sys
import time

import simdev


def switches(pid):
    """Of each name of a thread: [voluntary, involuntary], of all that have it."""
    sums = {}
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        status = dict(line.split(":", 1) for line in (task / "status").read_text().splitlines())
        both = sums.setdefault(status["Name"].strip(), [0, 0])
        for way, name in enumerate(("voluntary_ctxt_switches", "nonvoluntary_ctxt_switches")):
            both[way] += int(status[name])
    return sums


def look(pid):
    status = subprocess.run(["thimble", "status", "--json"], stdout=subprocess.PIPE, check=True).stdout
    return {"servo": json.loads(status)["servos"][0], "switches": switches(pid)}


def main(seconds, log_seconds, path):
    pid = subprocess.run(["systemctl", "show", "thimbled", "-p", "MainPID", "--value"], stdout=subprocess.PIPE, check=True).stdout.strip().decode()
    with simdev.Verbs(path) as device:
        before = look(pid)
        begin_s = time.monotonic()
        time.sleep(float(seconds))
        end_s = time.monotonic()
        after = look(pid)
        packets = []
        device.say(f"log {log_seconds}", lambda line: packets.append(line) if '"in":' in line or '"out":' in line else None)
    print(json.dumps({"begin_s": begin_s, "end_s": end_s, "before": before, "after": after}))
    print("".join(packets), end="")


if __name__ == "__main__":
    main(*sys.argv[1:])

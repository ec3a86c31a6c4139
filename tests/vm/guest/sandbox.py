"""In the guest: tries what the service may not do, and prints as JSON what came of each: the name of the error, or "done".

usage: sandbox.py NODE    (a device node that the user's own rights would let it open)
       sandbox.py --spin  takes a processor as a servo that does not sleep any more would, for SPIN_S at most

Run by systemd in place of the daemon, and once more as the same user without the unit: what comes of it there, too, is no work of the unit.
"""

import ctypes
import errno
import json
import mmap
import os
import signal
import socket
import sys
import time

NEW_FILES = ("/usr/lib/thimble-probe", "/etc/thimble-probe", "/boot/thimble-probe", "/var/lib/thimble/probe")
TASKS = 200
SPIN_S = 5
LOCKED_BYTES = 512 << 20  # systemd gives each user an eighth of a machine's memory
MLOCK_ONFAULT = 1


def create(path):
    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
    os.unlink(path)


def look(path):
    os.stat(path)


def run_in_real_time(priority):
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


def lock_memory():
    libc = ctypes.CDLL(None, use_errno=True)
    with mmap.mmap(-1, LOCKED_BYTES) as memory:
        first = ctypes.c_char.from_buffer(memory)
        failed, why = libc.mlock2(ctypes.byref(first), ctypes.c_size_t(LOCKED_BYTES), MLOCK_ONFAULT), ctypes.get_errno()
        del first
    if failed:
        raise OSError(why, os.strerror(why))


def begin_tasks():
    begun = []
    try:
        for _ in range(TASKS):
            child = os.fork()
            if child == 0:
                signal.pause()
            begun.append(child)
    finally:
        for child in begun:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)


def spin():
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    end = time.monotonic() + SPIN_S
    while time.monotonic() < end:
        pass


def tries(node):
    yield from ((f"new {path}", lambda path=path: create(path)) for path in NEW_FILES)
    yield "device", lambda: os.close(os.open(node, os.O_RDONLY))
    yield "packet", lambda: socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM).close()
    yield "unix", lambda: socket.socket(socket.AF_UNIX).close()
    yield "executable memory", lambda: mmap.mmap(-1, mmap.PAGESIZE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC).close()
    yield "others' processes", lambda: look("/proc/1")
    yield "homes", lambda: os.listdir("/home")
    yield "real time", lambda: run_in_real_time(98)
    yield "more real time", lambda: run_in_real_time(99)
    yield "locked memory", lock_memory
    yield "tasks", begin_tasks


def outcome(act):
    try:
        act()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "done"


def main(node):
    print(json.dumps({name: outcome(act) for name, act in tries(node)}))


if __name__ == "__main__":
    if sys.argv[1:] == ["--spin"]:
        spin()
    else:
        main(*sys.argv[1:])

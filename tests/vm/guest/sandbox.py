"""In the guest: tries what the service may not do, and prints as JSON what came of each: the name of the error, or "done".

usage: sandbox.py NODE    (a device node that the user's own rights would let it open)

Run by systemd in place of the daemon, and once more as the same user without the unit: what is refused there, too, is no work of the sandbox.
"""

import errno
import json
import mmap
import os
import socket
import sys

NEW_FILES = ("/usr/lib/thimble-probe", "/etc/thimble-probe", "/boot/thimble-probe", "/var/lib/thimble/probe")


def create(path):
    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
    os.unlink(path)


def look(path):
    os.stat(path)


def tries(node):
    yield from ((f"new {path}", lambda path=path: create(path)) for path in NEW_FILES)
    yield "device", lambda: os.close(os.open(node, os.O_RDONLY))
    yield "packet", lambda: socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM).close()
    yield "unix", lambda: socket.socket(socket.AF_UNIX).close()
    yield "executable memory", lambda: mmap.mmap(-1, mmap.PAGESIZE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC).close()
    yield "others' processes", lambda: look("/proc/1")
    yield "homes", lambda: os.listdir("/home")


def outcome(act):
    try:
        act()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "done"


def main(node):
    print(json.dumps({name: outcome(act) for name, act in tries(node)}))


if __name__ == "__main__":
    main(*sys.argv[1:])

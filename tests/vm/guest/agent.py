"""In the guest: runs what the host asks for, over the virtio port vm.cmd.

A line from the host is "run", "call" or "mount" and base64: of a bash script, of the JSON of a module's name and of words for its main(), or
of the JSON of the folders of the host that are to be seen as /run/NAME. The answer is a line too: its exit status and the base64 of what it printed, packed. The first line is said unasked, as soon as the guest is up.

Modules lie in FOLDER and stay: to start an interpreter takes an emulated machine half a second.
"""

import base64
import contextlib
import ctypes
import importlib
import io
import json
import os
import subprocess
import sys
import time
import traceback
import zlib

PORT = "/dev/virtio-ports/vm.cmd"
FOLDER = "/run/tests"
READ_ONLY = 1  # MS_RDONLY of linux/mount.h


def run(script):
    done = subprocess.run(["bash", "-c", script.decode()], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    return done.returncode, done.stdout


def call(request):
    module, *words = json.loads(request)
    status = 0
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        try:
            importlib.import_module(module).main(*words)
        except SystemExit as end:
            status = end.code or 0
        except Exception:  # whatever it is, the host is told
            traceback.print_exc(file=sys.stdout)
            status = 1
    return status, printed.getvalue().encode()


def mount(request):
    """Without programs, each of which takes an emulated machine that was just switched on a fifth of a second."""
    libc = ctypes.CDLL(None, use_errno=True)
    for name in json.loads(request):
        folder = f"/run/{name}"
        os.makedirs(folder, exist_ok=True)
        if os.path.ismount(folder):
            continue
        if libc.mount(name.encode(), folder.encode(), b"9p", READ_ONLY, b"trans=virtio,version=9p2000.L") != 0:
            return 1, f"{folder}: {os.strerror(ctypes.get_errno())}".encode()
    return 0, b""


def main():
    sys.path.insert(0, FOLDER)
    sys.dont_write_bytecode = True
    port = os.open(PORT, os.O_RDWR)

    def say(status, printed):
        line = b"%d %s\n" % (status, base64.b64encode(zlib.compress(printed, 1)))
        while line:
            line = line[os.write(port, line):]

    say(0, b"up")
    pending = b""
    while True:
        data = os.read(port, 65536)
        if not data:  # the host has not connected
            time.sleep(0.1)
        pending += data
        while b"\n" in pending:
            line, pending = pending.split(b"\n", 1)
            kind, _, request = line.partition(b" ")
            say(*{b"run": run, b"call": call, b"mount": mount}[kind](base64.b64decode(request)))


if __name__ == "__main__":
    main()

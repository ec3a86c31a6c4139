"""In the guest: runs what the host asks for, over the virtio port vm.cmd.

A line from the host is the base64 of a bash script; the answer is a line too: its exit status and the base64 of what it
printed. The first line is said unasked, as soon as the guest is up.
"""

import base64
import os
import subprocess
import time

PORT = "/dev/virtio-ports/vm.cmd"


def main():
    port = os.open(PORT, os.O_RDWR)

    def say(status, printed):
        os.write(port, b"%d %s\n" % (status, base64.b64encode(printed)))

    say(0, b"up")
    pending = b""
    while True:
        data = os.read(port, 65536)
        if not data:  # the host has not connected
            time.sleep(0.1)
        pending += data
        while b"\n" in pending:
            line, pending = pending.split(b"\n", 1)
            done = subprocess.run(["bash", "-c", base64.b64decode(line).decode()], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            say(done.returncode, done.stdout)


if __name__ == "__main__":
    main()

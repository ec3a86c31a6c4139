"""usage: hold_hidraw.py NODE: holds up all writes to HID devices, as far as hidraw carries them.

The first opening of a HID device on USB takes the kernel 50 ms, with hidraw's lock. Then NODE's device takes nothing: a write to it waits
in the kernel, with that lock; another opening waits for the lock alone. Prints the time before all this, by CLOCK_MONOTONIC, and again
when the lock was had.
"""

import contextlib
import os
import sys
import threading
import time


def write(to):
    with contextlib.suppress(OSError):  # the kernel gives it up in the end
        os.write(to, bytes(15))


print(time.monotonic(), flush=True)
node = os.open(sys.argv[1], os.O_RDWR)
threading.Thread(target=write, args=(node,)).start()
time.sleep(0.05)
os.open(sys.argv[1], os.O_RDONLY)
print(time.monotonic(), flush=True)

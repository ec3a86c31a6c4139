"""In the guest: keeps one thread of a process from running for a while, and no other, as a debugger would.

usage: hang_thread.py THREAD SECONDS
"""

import ctypes
import os
import sys
import time

PTRACE_SEIZE, PTRACE_INTERRUPT, PTRACE_DETACH = 0x4206, 0x4207, 17  # linux/ptrace.h
WAIT_ALL = 0x40000000  # __WALL of linux/wait.h: threads, too


def ptrace(request, thread):
    libc = ctypes.CDLL(None, use_errno=True)
    libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    if libc.ptrace(request, thread, None, None) != 0:
        raise OSError(ctypes.get_errno(), "ptrace")


def main(thread, seconds):
    thread = int(thread)
    ptrace(PTRACE_SEIZE, thread)
    ptrace(PTRACE_INTERRUPT, thread)
    os.waitpid(thread, WAIT_ALL)
    print(time.monotonic(), flush=True)
    time.sleep(float(seconds))
    ptrace(PTRACE_DETACH, thread)


if __name__ == "__main__":
    main(*sys.argv[1:])

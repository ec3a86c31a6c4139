"""What a servo thread may ask of the kernel, told by the lines that strace -y writes: its sleep, and eight bytes for an eventfd, by
which it wakes the net plane, or the thread of a bus. Nothing else, so nothing that a bus could hold up.
"""

import re

SLEEP = re.compile(r"clock_nanosleep\(CLOCK_BOOTTIME, TIMER_ABSTIME, .*")
WAKE = re.compile(r'write\(\d+<anon_inode:\[eventfd\]>, "\\1\\0\\0\\0\\0\\0\\0\\0", 8\) += .*')
# How strace tells that it came or went in the middle of a sleep or of that write.
_INTERRUPTED = re.compile(r"restart_syscall\(<\.\.\. resuming .*|strace: Process .*|"
                          r"(clock_nanosleep|write)\(.* <detached \.\.\.>")


def forbidden(calls):
    """Those of the lines that are neither; the first is left out, for strace came in the middle of it."""
    return [call for call in calls[1:]
            if not any(allowed.fullmatch(call) for allowed in (SLEEP, WAKE, _INTERRUPTED))]

"""In the guest: a device that is plugged in and pulled out again and again.

usage: plug_cycles.py uhid COUNT HOLD SERIAL    a HID arm; each HOLD-th stays until somebody has opened its node
       plug_cycles.py lies COUNT SERIAL SEED    the same, with report descriptors that are cut, longer, or have bits turned over
       plug_cycles.py usb COUNT SOCKET          the thimble-simdev at SOCKET, which plugs itself in; each until somebody uses it

Prints how many were opened; of the lies, how many the kernel took for devices. All waits are bounded.
"""

import contextlib
import os
import random
import select
import sys
import time

import simdev
import uhid_device

PATIENCE_S = 20
LIE_S = 0.2  # a lie that the kernel refuses is not told of
UHID_OPEN = 4
UHID_DESTROY = 1


def await_event(device, wanted, patience_s=PATIENCE_S):
    """Whether the kernel said so in time."""
    end = time.monotonic() + patience_s
    while select.select([device], [], [], max(0, end - time.monotonic()))[0]:
        if uhid_device.next_event(device) == wanted:
            return True
    return False


def cycle_uhid(device, count, hold, serial):
    opened = 0
    for turn in range(1, count + 1):
        uhid_device.create(device, 0x1234, 0x0006, serial)
        if not await_event(device, uhid_device.UHID_START):
            raise TimeoutError(f"turn {turn}: the kernel did not take the device")
        if turn % hold == 0:
            opened += await_event(device, UHID_OPEN)
        uhid_device.tell(device, UHID_DESTROY)
    return opened


def spoilt(descriptor, chance):
    data = bytearray(descriptor)
    for _ in range(chance.randrange(1, 5)):
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    if chance.randrange(3) == 0:
        del data[chance.randrange(1, len(data)):]
    if chance.randrange(3) == 0:
        data += chance.randbytes(chance.randrange(1, 4000))
    return bytes(data)


def cycle_lies(device, count, serial, seed):
    chance = random.Random(seed)
    taken = 0
    for _ in range(count):
        uhid_device.create(device, 0x1234, 0x0006, serial, spoilt(uhid_device.DESCRIPTOR, chance))
        if await_event(device, uhid_device.UHID_START, LIE_S):
            taken += 1
            await_event(device, UHID_OPEN, LIE_S)
        with contextlib.suppress(OSError):  # there is none
            uhid_device.tell(device, UHID_DESTROY)
    return taken


def cycle_usb(count, path):
    used = 0
    with simdev.Verbs(path) as verbs:
        for turn in range(count):
            if turn:
                verbs.say("plug")
            end = time.monotonic() + PATIENCE_S
            while not (is_used := verbs.say("status")["open"]) and time.monotonic() < end:
                time.sleep(0.03)
            used += is_used
            verbs.say("unplug")
    return used


def main(way, count, *words):
    if way == "usb":
        print(cycle_usb(int(count), words[0]))
        return
    with open("/dev/uhid", "r+b", buffering=0) as uhid:
        device = uhid.fileno()
        print(cycle_uhid(device, int(count), int(words[0]), words[1]) if way == "uhid" else cycle_lies(device, int(count), words[0], int(words[1])))


if __name__ == "__main__":
    main(*sys.argv[1:])

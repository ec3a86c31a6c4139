"""In the guest: a HID device of the kernel's own making, through /dev/uhid, for as long as this runs.

usage: uhid_device.py VENDOR PRODUCT SERIAL    (ids in hexadecimal)

It speaks the shape of a WoodenHaptics controller: one input and one output report of 14 bytes, no report ids. What it is
sent goes nowhere. Numbers and layout: linux/uhid.h.
"""

import os
import struct
import sys

UHID_CREATE2 = 11
UHID_START = 2
BUS_USB = 3
# Vendor-defined page, 14 bytes in, 14 bytes out (HID 1.11, section 6.2.2).
DESCRIPTOR = bytes.fromhex("0600ff 0901 a101 1500 26ff00 7508 950e 0901 8102 0901 9102 c0")


def tell(device, event, payload=b""):
    os.write(device, struct.pack("<I", event) + payload)


def create(device, vendor, product, serial, descriptor=DESCRIPTOR):
    tell(device, UHID_CREATE2,
         struct.pack("<128s64s64sHHIIII4096s", b"Thimble test device", b"", serial.encode(), len(descriptor),
                     BUS_USB, vendor, product, 0, 0, descriptor))


def next_event(device):
    """Its number; waits for it."""
    return struct.unpack_from("<I", os.read(device, 4380))[0]


def main(vendor, product, serial):
    device = os.open("/dev/uhid", os.O_RDWR)
    create(device, int(vendor, 16), int(product, 16), serial)
    while True:
        if next_event(device) == UHID_START:
            print("started", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])

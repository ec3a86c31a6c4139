#!/usr/bin/env python3
"""Writes cave.npy beside itself: a solid cube of 32 cells a side with a round cave in its middle.

Plain Python, without NumPy: the header of format 1.0 is a line of text
(numpy.org, NEP 1 and numpy/lib/format.py)."""
import pathlib
import struct

SIDE = 32
RADIUS = 0.45  # of half the side


def is_filled(x, y, z):
    centre = (SIDE - 1) / 2
    squared = sum((c - centre) ** 2 for c in (x, y, z))
    return squared > (RADIUS * SIDE / 2) ** 2


def main():
    header = "{'descr': '|u1', 'fortran_order': False, 'shape': (%d, %d, %d), }" % (SIDE, SIDE, SIDE)
    header += " " * (-(len(header) + 11) % 64) + "\n"
    cells = bytes(is_filled(x, y, z)
                  for x in range(SIDE) for y in range(SIDE) for z in range(SIDE))
    path = pathlib.Path(__file__).with_name("cave.npy")
    path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) +
                     header.encode() + cells)


if __name__ == "__main__":
    main()

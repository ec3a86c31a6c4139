#!/usr/bin/env python3
"""Writes scan.nhdr and scan.raw.gz beside itself: what a scanner's export looks like, a detached NRRD header
and gzip data, 24 slices of 32 x 32 pixels, the slices 1.5 pixels apart. Soft matter (200) around a
cavity, with a hard floor (1000).

Plain Python; the format: teem.sourceforge.net/nrrd/format.html."""
import gzip
import pathlib
import struct

PIXELS, SLICES = 32, 24
RADIUS = 0.55  # of half the side


def density(x, y, z):
    across = [(c - (n - 1) / 2) / (n / 2) for c, n in ((x, PIXELS), (y, PIXELS), (z, SLICES))]
    if across[2] < -0.25:
        return 1000
    return 200 if sum(c * c for c in across) > RADIUS * RADIUS else 0


def main():
    folder = pathlib.Path(__file__).parent
    numbers = [density(x, y, z)
               for z in range(SLICES) for y in range(PIXELS) for x in range(PIXELS)]
    packed = gzip.compress(struct.pack("<%dh" % len(numbers), *numbers), mtime=0)
    (folder / "scan.raw.gz").write_bytes(packed)
    (folder / "scan.nhdr").write_text(
        "NRRD0004\n# written by make_scan.py\ntype: short\ndimension: 3\n"
        "sizes: %d %d %d\nspacings: 1 1 1.5\nendian: little\nencoding: gzip\n"
        "data file: scan.raw.gz\n\n" % (PIXELS, PIXELS, SLICES))


if __name__ == "__main__":
    main()

"""`thimble lab` as a person runs it: what it draws is looked at, whatever it is run for."""

import pathlib
import shutil
import struct
import unittest
import xml.etree.ElementTree
import zlib

from rig import ProcessTest, is_sanitized


reckons = unittest.skipIf(is_sanitized(), "reckons for minutes there; the release build plays it")
SVG = "{http://www.w3.org/2000/svg}"


def pixels_of_png(content):
    """Width, height and the inflated rows of a picture."""
    if not content.startswith(b"\x89PNG\r\n\x1a\n"):
        raise AssertionError("it has not the signature of PNG")
    place, packed, size = 8, b"", None
    while place < len(content):
        length, kind = struct.unpack_from(">I4s", content, place)
        data = content[place + 8:place + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack_from(">II", data)
        elif kind == b"IDAT":
            packed += data
        place += 12 + length
    return (*size, zlib.decompress(packed))


class LabTest(ProcessTest):
    def run_experiment(self, *arguments):
        # A minute of one processor, at most, and several on one that others use.
        shown = self.run_program("thimble", "lab", *arguments, timeout=280)
        if "--out" in arguments and shutil.which("gnuplot"):
            folder = pathlib.Path(arguments[arguments.index("--out") + 1])
            if folder.is_dir():  # also where a criterion is not met
                self.assert_all_is_drawn(folder)
        return shown

    def assert_all_is_drawn(self, folder):
        plots = sorted(folder.glob("*.gp"))
        self.assertTrue(plots, "nothing to draw")
        for plot in plots:
            with self.subTest(plot.name):
                drawn = xml.etree.ElementTree.parse(plot.with_suffix(".svg"))
                self.assertTrue(any(group.get("id", "").startswith("gnuplot_plot_") for group in drawn.iter(SVG + "g")))
                _, _, rows = pixels_of_png(plot.with_suffix(".png").read_bytes())
                # Rows are stored as differences: an empty picture has hardly any that is not 0.
                self.assertGreater(len(rows) - rows.count(0), 10000)

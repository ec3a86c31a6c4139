"""A small tree in a temporary folder, for tests that plant a breach in it."""

import pathlib
import shutil
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent


class PlantedTreeTest(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="thimble-lint-")).resolve()
        self.addCleanup(shutil.rmtree, self.root)

    def plant(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def plant_copy(self, path):
        """A file of the real tree at its own place."""
        self.plant(path, (HERE.parents[1] / path).read_text(encoding="utf-8"))

    def assert_one_breach(self, breaches, *words):
        self.assertEqual(len(breaches), 1, breaches)
        for word in words:
            self.assertIn(word, breaches[0])

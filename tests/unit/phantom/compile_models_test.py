#!/usr/bin/env python3
"""What the models compiler accepts, refuses and says. First argument: the compiler."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

COMPILER = sys.argv.pop(1)
SCHEMA = '[schema]\nnote = "text"\nlink_m = "positive3"\ndirection = "sign3"\nforce_newton = "positive"\ncounts = "zero_or_more3"\nproduct = "id"\n'
MODEL = {
    "note": '{ value = "an \\"arm\\"", from = "ours: a test" }',
    "link_m": '{ value = [0.1, 2, 3e-1], from = "sheet: 1" }',
    "direction": '{ value = [1, -1, 1], from = "source: 2" }',
    "force_newton": '{ value = 5, from = "sheet: 3" }',
    "counts": '{ value = [0, 1024, 0], from = "sheet: 4" }',
    "product": '{ value = 0xc62b, from = "sheet: 5" }',
}


def table(**changes):
    entries = {key: text for key, text in (MODEL | changes).items() if text is not None}
    return SCHEMA + "[arm-1]\n" + "".join(f"{key} = {text}\n" for key, text in entries.items())


class CompileModels(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.source = pathlib.Path(folder.name, "some_models.toml")
        self.output = pathlib.Path(folder.name, "some_models.hpp")

    def compile(self, text):
        self.source.write_text(text, encoding="utf-8")
        return subprocess.run(
            [sys.executable, COMPILER, self.source, "--output", self.output, "--include", "a/b.hpp",
             "--namespace", "n", "--struct", "S", "--table", "kTable"],
            capture_output=True, text=True, check=False)

    def refuses(self, text, *words):
        result = self.compile(text)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in ("some_models.toml", *words):
            self.assertIn(word, result.stderr)
        self.assertFalse(self.output.exists())

    def test_writes_values_with_their_sources(self):
        self.assertEqual(self.compile(table()).returncode, 0)
        header = self.output.read_text(encoding="utf-8")
        self.assertIn('.name = "arm-1",', header)
        self.assertIn('.note = "an \\"arm\\"",', header)
        self.assertIn("// sheet: 1\n        .link_m = {0.1, 2.0, 0.3},", header)
        self.assertIn(".direction = {1.0, -1.0, 1.0},", header)
        self.assertIn(".counts = {0.0, 1024.0, 0.0},", header)
        self.assertIn(".product = 0xc62b,", header)
        self.assertIn("std::array<S, 1> kTable", header)

    def test_names_an_id_that_is_none(self):
        for wrong in ("65536", "-1", "1.0", "true"):
            self.refuses(table(product=f'{{ value = {wrong}, from = "sheet: 5" }}'), "'product'", "USB id")

    def test_names_a_missing_key(self):
        self.refuses(table(force_newton=None), "'arm-1'", "'force_newton'", "missing")

    def test_names_an_unknown_key(self):
        self.refuses(table(mass_kg='{ value = 1, from = "sheet: 1" }'), "'arm-1'", "'mass_kg'", "unknown")

    def test_names_a_bad_value(self):
        for key, value, word in (
            ("link_m", "[0.1, 0.2]", "three numbers"),
            ("link_m", "[0.1, 0.2, 0]", "positive"),
            ("link_m", '[0.1, 0.2, "x"]', "number"),
            ("direction", "[1, 2, 1]", "neither"),
            ("counts", "[0, -1, 0]", "negative"),
            ("counts", "[0, nan, 0]", "finite"),
            ("force_newton", "nan", "finite"),
            ("force_newton", "inf", "finite"),
            ("force_newton", "true", "number"),
            ("force_newton", "-5", "positive"),
            ("note", '""', "text"),
        ):
            with self.subTest(key=key, value=value):
                entry = f'{{ value = {value}, from = "sheet: 1" }}'
                self.refuses(table(**{key: entry}), "'arm-1'", f"'{key}'", word)

    def test_wants_to_know_where_a_value_comes_from(self):
        self.refuses(table(force_newton="{ value = 5 }"), "'force_newton'", "'from'")
        self.refuses(table(force_newton="5"), "'force_newton'", "'from'")
        self.refuses(table(force_newton='{ value = 5, from = "a friend" }'), "'force_newton'", "sheet:")
        self.refuses(table(force_newton='{ value = 5, from = "ours: " }'), "'force_newton'", "why")

    def test_refuses_what_is_no_table(self):
        self.refuses("[arm-1\n", "line 1")
        self.refuses("[arm-1]\n", "[schema]")
        self.refuses(SCHEMA, "no models")
        self.refuses('[schema]\na = "colour"\n[m]\n', "'a'", "colour")


if __name__ == "__main__":
    unittest.main()

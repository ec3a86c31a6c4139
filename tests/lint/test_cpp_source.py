import errno
import os
from unittest import mock

import cpp_source
from planted_tree import PlantedTreeTest

SOURCE = "daemon/link/port.cpp"


class CppSource(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant(SOURCE, "int a;\n")
        self.plant("daemon/link/other.cpp", "int b;\n")

    def checked(self, meanwhile):
        def check(root):
            meanwhile()
            return [f"{len(cpp_source.tree_files(root))} files"]

        return cpp_source.checked(check, self.root)

    def test_hands_on_the_breaches_of_a_tree_that_stands_still(self):
        self.assertEqual(self.checked(lambda: None), ["2 files"])

    def test_ignores_what_is_no_part_of_the_tree(self):
        def build():
            self.plant("build/release/a.cpp", "")
            self.plant(".git/index.lock", "")
            self.plant("tests/__pycache__/a.pyc", "")

        self.assertEqual(self.checked(build), ["2 files"])

    def test_believes_nothing_of_a_tree_that_changes(self):
        def replace():
            (self.root / SOURCE).unlink()
            self.plant(SOURCE, "int c;\n")

        for meanwhile in (lambda: self.plant(SOURCE, "int abc;\n"), replace,
                          lambda: (self.root / SOURCE).unlink(), lambda: self.plant(SOURCE, "int d;\n")):
            self.assert_one_breach(self.checked(meanwhile), SOURCE, "run it again")

    def test_believes_nothing_when_a_file_goes_away_before_it_is_read(self):
        def check(root):
            cpp_source.read(root, "daemon/link/gone.cpp")

        self.assert_one_breach(cpp_source.checked(check, self.root), "gone.cpp", "run it again")

    def test_refuses_a_tree_without_a_file(self):
        (self.root / "empty").mkdir()

        self.assert_one_breach(cpp_source.checked(lambda root: [], self.root / "empty"), "--root")

    def test_a_folder_that_cannot_be_read_is_not_left_out(self):
        scandir = os.scandir

        def too_many_files(path):
            if str(path).endswith("link"):
                raise OSError(errno.EMFILE, "Too many open files", str(path))
            return scandir(path)

        with mock.patch("os.scandir", too_many_files), self.assertRaises(OSError):
            cpp_source.tree_files(self.root)

import unittest

import check_hidden_names
from planted_tree import PlantedTreeTest

HEADER = "#pragma once\nnamespace a::b {\ninline constexpr std::size_t kMost = 32;\n}\n"
SOURCE = "namespace a::b {\nnamespace {\n\nconstexpr std::size_t kMost = 31;  // of another thing\n\n}\n}\n"


class HiddenNames(PlantedTreeTest):
    def check(self, source=SOURCE, header=HEADER, path="hal/base/x.cpp"):
        self.plant("hal/base/limits.hpp", header)
        self.plant(path, source)
        return check_hidden_names.check(self.root)

    def test_refuses_a_constant_that_a_header_beside_it_has(self):
        self.assert_one_breach(self.check(), "hal/base/x.cpp:4:", "kMost", "hal/base/limits.hpp")

    def test_refuses_it_whatever_its_type_and_way_to_begin(self):
        for begins in ("constexpr int kMost{3}", "const char* kMost = \"x\"", "static constexpr double kMost = 1",
                       "constexpr std::array<int, 2> kMost{1, 2}", "constexpr int kMost[] = {1}"):
            with self.subTest(begins):
                self.assert_one_breach(self.check(f"namespace a::b {{\nnamespace {{\n{begins};\n}}\n}}\n"), "x.cpp:3:")

    def test_takes_other_names_namespaces_and_folders(self):
        self.assertEqual(self.check(SOURCE.replace("kMost", "kMostOfIt")), [])
        self.assertEqual(self.check(SOURCE.replace("a::b", "a::c")), [])
        self.assertEqual(self.check("", path="hal/base/x.cpp") + self.check(path="hal/bus/x.cpp"), [])

    def test_takes_what_is_of_a_class_or_of_a_function(self):
        self.assertEqual(self.check(header=HEADER.replace("inline constexpr", "struct S {\n  static constexpr")), [])
        self.assertEqual(self.check("namespace a::b {\nint f() {\n  constexpr int kMost = 3;\n  return kMost;\n}\n}\n"), [])

    def test_is_not_misled_by_comments(self):
        self.assertEqual(self.check("namespace a::b {\n/*\nconstexpr int kMost = 3;\n*/\n}\n"), [])


if __name__ == "__main__":
    unittest.main()

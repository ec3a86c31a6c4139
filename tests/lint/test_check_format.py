import check_format
from planted_tree import PlantedTreeTest


class CheckFormat(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy(".clang-format")

    def test_accepts_formatted_files(self):
        self.plant("hal/base/a.cpp", "int f() { return 1; }\n")

        self.assertEqual(check_format.check(self.root), [])

    def test_refuses_a_file_that_is_not(self):
        self.plant("hal/base/a.cpp", "int f() { return 1; }\n")
        self.plant("tests/unit/b.cpp", "int  f( ){return 1;}\n")

        self.assert_one_breach(check_format.check(self.root), "tests/unit/b.cpp:1",
                               "clang-format-14 -i tests/unit/b.cpp")

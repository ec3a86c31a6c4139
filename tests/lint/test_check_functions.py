import unittest

import check_functions
from planted_tree import PlantedTreeTest


def long_function(head="int f()", lines=61, before="", inside=""):
    """A function whose text from head to closing brace has so many lines."""
    body = "  step();\n" * (lines - 2 - inside.count("\n"))
    return f"{before}{head} {{\n{inside}{body}}}\n"


class Functions(unittest.TestCase):
    def test_finds_plain_member_and_template_functions(self):
        text = ("namespace a {\nclass B {\n  int c() const { return 1; }\n};\n"
                "template <class T>\nT d(T t)\n{\n  return t;\n}\n}\n")

        self.assertEqual(check_functions.functions(text), [(3, 3), (5, 9)])

    def test_takes_initialisers_with_braces_as_part_of_the_constructor(self):
        text = "A::A(int b)\n    : b_{b},\n      c_{1} {\n  go();\n}\nint d() { return 0; }\n"

        self.assertEqual(check_functions.functions(text), [(1, 5), (6, 6)])

    def test_takes_lambdas_and_blocks_as_part_of_their_function(self):
        text = "int f() {\n  auto g = [](int x) {\n    return x;\n  };\n  if (g(1)) {\n  }\n}\n"

        self.assertEqual(check_functions.functions(text), [(1, 7)])

    def test_is_not_misled_by_braces_in_literals_and_comments(self):
        text = ("int f() {\n  // }\n  put('}'); put(\"}\\\"}\"); /* } */\n"
                "  put(R\"x(}\")x\"); int n = 1'000'000;\n}\nint g() { return 1; }\n")

        self.assertEqual(check_functions.functions(text), [(1, 5), (6, 6)])

    def test_does_not_take_types_and_tables_for_functions(self):
        text = "struct A {\n  int b{1};\n};\nconst int kC[] = {1, f(2)};\nenum class D { E };\n"

        self.assertEqual(check_functions.functions(text), [])


class CheckFunctions(PlantedTreeTest):
    def check(self, text, path="hal/base/x.cpp"):
        self.plant(path, text)
        return check_functions.check(self.root)

    def test_accepts_sixty_lines(self):
        self.assertEqual(self.check(long_function(lines=60)), [])

    def test_refuses_sixty_one_lines(self):
        self.assert_one_breach(self.check(long_function(lines=61)), "hal/base/x.cpp:1:",
                               "61 lines", "lint: long-function")

    def test_refuses_a_long_constructor_with_initialisers(self):
        self.assert_one_breach(self.check(long_function("A::A() : b_{1}, c_{2}")), "61 lines")

    def test_refuses_a_long_test(self):
        self.assert_one_breach(
            self.check(long_function("TEST(A, B)"), "tests/unit/a_test.cpp"), "tests/unit")

    def test_accepts_a_waiver_with_a_reason_only(self):
        before = "// lint: long-function one row for each state\n"
        self.assertEqual(self.check(long_function(before=before)), [])

        self.assertEqual(len(self.check(long_function(before="// lint: long-function\n"))), 1)

    def test_refuses_a_long_file_without_a_reason(self):
        self.assert_one_breach(self.check("int a;\n" * 401), "401 lines", "lint: long-file")
        self.assertEqual(self.check("// lint: long-file one table\n" + "int a;\n" * 401), [])

    def test_reports_braces_that_do_not_balance(self):
        self.assert_one_breach(self.check("int f() {\n"), "balance")

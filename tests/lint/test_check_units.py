import check_units
from planted_tree import PlantedTreeTest

HEADER = "daemon/servo/limits.hpp"


class CheckUnits(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant(check_units.UNITS_FILE, "unit m s m_per_s\nnone gain  # a factor\n")

    def test_accepts_names_that_end_in_a_unit_or_have_none(self):
        self.plant(HEADER, "double reach_m{0};\nfloat speed_m_per_s_;\ndouble activation_gain;\n"
                           "constexpr double kLongestPauseS = 1;\nstd::array<double, 3> origin_m;\n"
                           "[[nodiscard]] double length_m() const;\nvoid wait(double for_s);\n")

        self.assertEqual(check_units.check(self.root), [])

    def test_refuses_a_number_without(self):
        for declaration in ("double reach{0};", "void wait(double duration);",
                            "constexpr double kLongestPause = 1;", "float speed_;",
                            "std::array<double, 3> origin;", "std::optional<double> reach;",
                            "[[nodiscard]] double length() const;", "const double& speed;",
                            "double atom{0};", "double m;", "double kS;"):
            with self.subTest(declaration):
                self.plant(HEADER, f"int a;\n{declaration}\n")

                self.assert_one_breach(check_units.check(self.root), HEADER + ":2", "no unit",
                                       check_units.UNITS_FILE)

    def test_looks_at_headers_of_the_product_only(self):
        self.plant("daemon/servo/limits.cpp", "double reach;\n")
        self.plant("hal/base/geometry.hpp", "double x;\n")
        self.plant("tests/support/rig.hpp", "double reach;\n")
        self.plant(HEADER, "// double reach;\n")

        self.assertEqual(check_units.check(self.root), [])

    def test_refuses_a_key_of_the_configuration_without(self):
        self.plant(check_units.CONFIGURATION_PAGE,
                   "| `arm.reach_m` | how far | 0 to 1 | 1 |\n"
                   "| `arm.name` | what it is called | name | required |\n"
                   "| `arm.delay` | of replies | above 0 up to 2 | 1 |\n")

        self.assert_one_breach(check_units.check(self.root), "configuration.md:3", "'delay'")

    def test_takes_a_listed_name_whole_and_in_its_file_alone(self):
        self.plant(check_units.UNITS_FILE, f"unit m\n{HEADER}: value kept_low  # a reason\n")
        self.plant(HEADER, "double value_{0};\nconstexpr double kKeptLow = 1;\n")
        self.assertEqual(check_units.check(self.root), [])

        self.plant("daemon/servo/other.hpp", "double value;\n")
        self.assert_one_breach(check_units.check(self.root), "daemon/servo/other.hpp:1", "'value'")

        self.plant("daemon/servo/other.hpp", "double limit_value;\n")
        self.assert_one_breach(check_units.check(self.root), "'limit_value'")

    def test_the_list_of_this_tree_frees_no_number_of_another_place(self):
        self.plant_copy(check_units.UNITS_FILE)
        for name in ("limit_value", "force_max", "speed_low", "length_of_step", "a", "value", "from", "to"):
            with self.subTest(name):
                self.plant(HEADER, f"double {name};\n")
                self.assertEqual(len([b for b in check_units.check(self.root) if HEADER in b]), 1)

    def test_refuses_a_listed_name_that_is_gone(self):
        self.plant(check_units.UNITS_FILE, "unit m\ndaemon/servo/*: value\n")
        self.plant(HEADER, "double reach_m;\n")

        self.assert_one_breach(check_units.check(self.root), check_units.UNITS_FILE, "'value'", "daemon/servo/*")

    def test_refuses_a_line_of_the_list_that_says_nothing(self):
        self.plant(check_units.UNITS_FILE, "m s\n")

        with self.assertRaises(SystemExit):
            check_units.check(self.root)

import json
import pathlib
import tempfile

import check_tidy
from planted_tree import PlantedTreeTest

CLEAN = """
namespace thimble {
enum class Colour { Red };
inline constexpr int kLimit = 3;
inline constexpr double kReach_m = 0.3;
class WrenchLimiter {
 public:
  int step_count() const { return step_count_; }

 private:
  int step_count_{kLimit};
};
}  // namespace thimble
int use() { return thimble::WrenchLimiter{}.step_count(); }
"""


class CheckTidy(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy(".clang-tidy")
        self.plant("hal/base/other.hpp", "int other();\n")
        self.plant("build/x/compile_commands.json", json.dumps([{
            "directory": str(self.root), "file": "hal/base/a.cpp",
            "command": f"clang++-14 -std=c++20 -I{self.root} -c hal/base/a.cpp"}]))

    def check(self, text):
        self.plant("hal/base/a.cpp", text)
        return check_tidy.check(self.root, self.root / "build" / "x", self.root / "build" / "c")

    def test_accepts_the_names_of_the_house(self):
        self.assertEqual(self.check(CLEAN), [])

    def test_refuses_each_other_naming(self):
        for good, bad in (("step_count()", "stepCount()"), ("step_count_", "m_steps"),
                          ("WrenchLimiter", "wrench_limiter"), ("kLimit", "LIMIT"),
                          ("Red", "RED_COLOUR"), ("namespace thimble", "namespace Thimble")):
            with self.subTest(bad):
                text = CLEAN.replace("thimble", "Thimble") if "Thimble" in bad else \
                    CLEAN.replace(good, bad)
                breaches = self.check(text)

                self.assertIn("readability-identifier-naming", breaches[0])
                self.assertIn("hal/base/a.cpp:", breaches[0])
                self.assertIn("Mend:", breaches[-1])

    def test_reads_what_was_changed_and_no_more(self):
        build, cache = self.root / "build" / "x", self.root / "build" / "c"
        self.plant("hal/base/a.cpp", '#include "hal/base/a.hpp"\n#include "hal/base/alone.hpp"\nint useIt();\n')
        self.plant("hal/base/a.hpp", "")
        self.plant("hal/base/alone.hpp", "")

        for path, is_read in (("hal/base/a.cpp", True), ("hal/base/a.hpp", True), ("hal/base/alone.hpp", True),
                              ("hal/base/other.hpp", False), ("docs/a.md", False)):
            with self.subTest(path):
                self.assertEqual(bool(check_tidy.check(self.root, build, cache, [path])), is_read)

    def test_reads_the_unit_that_holds_what_was_changed(self):
        unit = "build/x/hal/unity_0_cxx.cxx"
        self.plant(unit, f'#include "{self.root}/hal/base/a.cpp"\n')
        self.plant("hal/base/a.cpp", '#include "hal/base/a.hpp"\n')
        self.plant("hal/base/a.hpp", "")

        for path, expected in (("hal/base/a.hpp", [unit]), ("hal/base/a.cpp", [unit]), ("hal/base/b.cpp", [])):
            self.assertEqual(check_tidy.touched(self.root, self.root / "build" / "x", [unit], [path]), expected)

    def test_reads_everything_where_history_is_short(self):
        self.assertIsNone(check_tidy.changed_files(self.root, 30))

    def test_refuses_a_bug_that_it_knows(self):
        breaches = self.check("bool f(double* a, double* b) "
                              "{ return __builtin_memcmp(a, b, sizeof(a)) == 0; }\n"
                              "int g(int a) { if (a) return 1; return a ? a : a; }\n"
                              "unsigned h(const char* s) { return sizeof(s) / sizeof(s[0]); }\n")

        self.assertIn("bugprone-", breaches[0])

    def test_reads_a_clean_file_once_until_a_header_changes(self):
        runs, original = [], check_tidy.tidy
        self.addCleanup(setattr, check_tidy, "tidy", original)
        check_tidy.tidy = lambda *arguments: runs.append(arguments) or ""
        text = '#include "hal/base/other.hpp"\n'

        self.check(text)
        self.check(text)
        self.assertEqual(len(runs), 1)

        self.plant("hal/base/other.hpp", "long other();\n")
        self.check(text)
        self.assertEqual(len(runs), 2)

    def test_reads_files_that_are_compiled_together_as_one_and_names_each(self):
        together = self.root / "build/x/hal/a.dir/Unity/unity_0_cxx.cxx"
        self.plant("hal/base/b.cpp", "int GoodName() { return 2; }\n")
        self.plant(str(together.relative_to(self.root)),
                   f'#include "{self.root}/hal/base/a.cpp"\n#include "{self.root}/hal/base/b.cpp"\n')
        self.plant("build/x/compile_commands.json", json.dumps([{
            "directory": str(self.root / "build/x"), "file": str(together),
            "command": f"clang++-14 -std=c++20 -I{self.root} -c {together}"}]))

        breaches = self.check("int BadName() { return 1; }\n")

        self.assertIn("hal/base/a.cpp:1:5", breaches[0])
        self.assertIn("hal/base/b.cpp:1:5", breaches[0])
        self.plant("hal/base/b.cpp", "int b() { return 2; }\n")
        self.assertEqual(self.check("int a() { return 1; }\n"), [])
        self.plant("hal/base/b.cpp", "int B() { return 2; }\n")
        self.assertTrue(self.check("int a() { return 1; }\n"))

    def test_takes_a_build_folder_that_lies_elsewhere(self):
        with tempfile.TemporaryDirectory() as folder:
            build = pathlib.Path(folder).resolve()
            together = build / "hal/unity_0_cxx.cxx"
            together.parent.mkdir()
            together.write_text(f'#include "{self.root}/hal/base/a.cpp"\n', encoding="utf-8")
            (build / "compile_commands.json").write_text(json.dumps([{
                "directory": str(build), "file": str(together),
                "command": f"clang++-14 -std=c++20 -I{self.root} -c {together}"}]))
            self.plant("hal/base/a.cpp", "int BadName() { return 1; }\n")

            breaches = check_tidy.check(self.root, build, self.root / "build" / "c")

            self.assertIn("hal/base/a.cpp:1:5", breaches[0])

    def test_reads_a_file_with_breaches_again(self):
        self.assertTrue(self.check("int BadName() { return 1; }\n"))
        self.assertTrue(self.check("int BadName() { return 1; }\n"))

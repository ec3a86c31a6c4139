import check_repository
from planted_tree import PlantedTreeTest

FEATURES = "| feature | where | proof | state |\n|---|---|---|---|\n"

DEFECTS = "| defect | effect | here | proof | weight |\n|---|---|---|---|---|\n"


class CheckRepository(PlantedTreeTest):
    def check_code(self, path, text):
        breaches = []
        check_repository.check_code(path, text, breaches)
        return breaches

    def check_all(self):
        return check_repository.check(self.root)

    def test_refuses_unfinished_work_without_a_reason(self):
        self.assert_one_breach(self.check_code("hal/a.cpp", "\n// TODO more\n"), "hal/a.cpp:2:")
        self.assert_one_breach(self.check_code("hal/a.cpp", "// FIXME() more\n"), "FIXME")
        self.assertEqual(self.check_code("hal/a.cpp", "// TODO(waits for gpio) more\n"), [])

    def test_refuses_a_clock_outside_hal_linux(self):
        for clock in ("std::chrono::steady_clock::now()", "clock_gettime(CLOCK_MONOTONIC, &t)",
                      "std::chrono::system_clock::now()"):
            with self.subTest(clock):
                text = f"auto t = {clock};\n"
                self.assert_one_breach(self.check_code("daemon/servo/a.cpp", text), "Clock&")
                self.assertEqual(self.check_code("hal/linux/clock.cpp", text), [])
                self.assertEqual(self.check_code("bench/a.cpp", text), [])
        self.assertEqual(self.check_code("hal/a.cpp", "// like steady_clock\n"), [])

    def test_refuses_a_test_that_sleeps(self):
        for call in ("std::this_thread::sleep_for(1ms)", "usleep(1)", "sleep(1)",
                     "nanosleep(&t, nullptr)", "std::this_thread::sleep_until(t)"):
            with self.subTest(call):
                self.assert_one_breach(self.check_code("tests/unit/a.cpp", f"  {call};\n"),
                                       "do not sleep")
        self.assertEqual(self.check_code("tests/unit/a.cpp", "sut.sleep_until(t);\n"), [])

    def test_refuses_a_skip_without_a_reason(self):
        self.assert_one_breach(self.check_code("tests/a.cpp", "GTEST_SKIP();\n"), "reason")
        self.assertEqual(self.check_code("tests/a.cpp", 'GTEST_SKIP() << "no strace";\n'), [])

    def plant_fuzz_table(self, *rows):
        self.plant("tests/fuzz/README.md", "| bytes of | parser | target |\n|---|---|---|\n" + "".join(rows))

    @staticmethod
    def fuzz_row(target, parser="tests/README.md"):
        return f"| somebody | `{parser}` | `{target}` |\n"

    def test_refuses_a_corpus_without_a_target_and_the_reverse(self):
        self.plant("tests/README.md", "")
        self.plant_fuzz_table(self.fuzz_row("codec_fuzz"))
        self.plant("tests/fuzz/CMakeLists.txt", "thimble_fuzz(codec_fuzz\n  SOURCES a.cpp)\n")
        self.plant("tests/data/README.md", "")
        self.plant("tests/data/corpus/codec_fuzz/seed", "")
        self.assertEqual(self.check_all(), [])

        self.plant("tests/data/corpus/lonely_fuzz/seed", "")
        self.assert_one_breach(self.check_all(), "corpus/lonely_fuzz", "thimble_fuzz")

        self.plant_fuzz_table(*(self.fuzz_row(f"{name}_fuzz") for name in ("codec", "lonely", "bare")))
        self.plant("tests/fuzz/CMakeLists.txt",
                   "thimble_fuzz(codec_fuzz)\nthimble_fuzz(lonely_fuzz)\nthimble_fuzz(bare_fuzz)\n")
        self.assert_one_breach(self.check_all(), "bare_fuzz", "seed files")

    def test_refuses_a_fuzz_target_without_its_row_and_the_reverse(self):
        self.plant("tests/README.md", "")
        self.plant("tests/data/README.md", "")
        self.plant("tests/data/corpus/codec/seed", "")
        self.plant("tests/fuzz/CMakeLists.txt", "thimble_fuzz(codec SOURCES a.cpp)\n")
        for rows, words in (((), ("codec has no row",)),
                            ((self.fuzz_row("codec"), self.fuzz_row("gone")), ("no fuzz target gone",)),
                            ((self.fuzz_row("codec", "hal/gone.hpp"),), ("hal/gone.hpp does not exist",)),
                            ((self.fuzz_row("codec"), "| somebody | a parser | `codec` |\n"),
                             ("README.md:4:", "a row is"))):
            with self.subTest(words):
                self.plant_fuzz_table(*rows)
                self.assert_one_breach(self.check_all(), *words)
        self.plant_fuzz_table(self.fuzz_row("codec"))
        self.assertEqual(self.check_all(), [])

    def test_refuses_a_folder_without_readme(self):
        self.plant("hal/README.md", "")
        self.plant("hal/base/a.hpp", "")
        self.assert_one_breach(self.check_all(), "hal/base: no README.md")

        self.plant("hal/base/README.md", "")
        self.assertEqual(self.check_all(), [])

    def plant_features(self, row):
        self.plant("docs/README.md", "")
        self.plant("docs/features.md", FEATURES + row + "\n")

    def test_accepts_a_feature_that_is_where_it_says(self):
        self.plant("run", "")
        self.plant("tests/README.md", "")
        self.plant("tests/a_test.cpp", "TEST(Limiter, Clamps) {}\n")
        self.plant_features("| one script | `run` | `ctest -R Limiter` | there |")

        self.assertEqual(self.check_all(), [])

    def test_refuses_a_feature_at_a_path_that_is_not(self):
        self.plant_features("| one script | `walk` | `ninja test` | there |")
        self.assert_one_breach(self.check_all(), "docs/features.md:3", "walk does not exist")

        self.plant_features("| one script | `walk` | `ninja test` | not yet |")
        self.assertEqual(self.check_all(), [])

    def test_refuses_a_proof_that_cannot_run(self):
        self.plant("run", "")
        self.plant_features("| one script | `run` | `frobnicate` | there |")
        self.assert_one_breach(self.check_all(), "no known program")

        self.plant_features("| one script | `run` | `ctest -R NoSuchSuite` | there |")
        self.assert_one_breach(self.check_all(), "NoSuchSuite")

        self.plant_features("| one script | `run` | believe me | there |")
        self.assert_one_breach(self.check_all(), "names no `command`")

    def breaches_of_proof(self, command):
        self.plant("tests/README.md", "")
        self.plant("docs/man/README.md", "")
        self.plant("bench/README.md", "")
        self.plant("run", 'case $command in\n  test | bench) "command_$command" "$@" ;;\n'
                          "  vm)\n    exit 2 ;;\n  -h | --help) usage ;;\n  *) exit 2 ;;\nesac\n")
        self.plant("bench/run_benchmarks.py", 'ALL = ("servo_tick", "wakeup",\n       "daemon")\nX = ("other")\n')
        self.plant("docs/man/thimble.1", ".SS status\n.SS flight show FILE\n.SS activate [ARM]\n")
        self.plant_features(f"| one script | `run` | `{command}` | there |")
        return self.check_all()

    def test_accepts_a_proof_with_a_subcommand_that_is_there(self):
        for command in ("./run test --quick", "./run --help", "./run bench", "./run bench daemon wakeup",
                        "./run bench --json old.json daemon", "thimble status --json", "thimble flight show FILE",
                        "thimble --socket s status", "thimble --help", "thimble activate arm"):
            with self.subTest(command):
                self.assertEqual(self.breaches_of_proof(command), [])

    def test_refuses_a_proof_with_a_subcommand_that_is_not_there(self):
        for command, words in (("./run nonsense", "run has no 'nonsense'"), ("./run", "run has no ''"),
                               ("./run vm", "run has no 'vm'"), ("./run bench no_such", "no benchmark 'no_such'"),
                               ("./run bench other", "no benchmark 'other'"),
                               ("thimble frobnicate", "thimble.1 has no 'frobnicate'"),
                               ("thimble", "thimble.1 has no ''"),
                               ("thimble flight hide FILE", "thimble.1 has no 'flight hide'")):
            with self.subTest(command):
                self.assert_one_breach(self.breaches_of_proof(command), "docs/features.md:3", words)

    def test_a_proof_is_one_test_not_words_of_several(self):
        self.plant("run", "")
        self.plant("tests/README.md", "")
        self.plant("tests/a_test.cpp", "TEST(Limiter, Clamps) {}\nTEST(Filter, Smooths) {}\n")
        self.plant("tests/CMakeLists.txt", "foreach(kind words figures)\n"
                                           "add_test(NAME lint.${kind} COMMAND x)\nendforeach()\n")
        for proof in ("Limiter.Clamps", "Filter", "lint.words", "'lint\\.figures'"):
            self.plant_features(f"| one script | `run` | `ctest -R {proof}` | there |")
            self.assertEqual(self.check_all(), [], proof)
        for proof in ("Limiter.Smooths", "lint.units", "Limite.Clamps"):
            self.plant_features(f"| one script | `run` | `ctest -R {proof}` | there |")
            self.assert_one_breach(self.check_all(), proof)

    def test_refuses_a_row_of_another_form(self):
        self.plant_features("| one script | `run` | nearly |")
        self.assert_one_breach(self.check_all(), "there or not yet")

    def breaches_of_defect(self, proof, weight):
        for folder in ("docs", "tests", "tests/process"):
            self.plant(f"{folder}/README.md", "")
        self.plant("tests/a_test.cpp", "TEST(ThesisDefect, Heals) {}\nTEST_F(Arm, Clamps) {}\n")
        self.plant("tests/process/test_api.py", "")
        self.plant("docs/thesis-defects.md",
                   DEFECTS + f"| it hurts | pain | none | {proof} | {weight} |\n"
                   "| it bites | pain | none | `ctest -R ThesisDefect.Heals` | serious |\n")
        return self.check_all()

    def test_accepts_a_defect_with_tests_that_exist(self):
        for proof in ("`ctest -R Arm.Clamps`", "`ctest -R Arm`, `ctest -R process.api`"):
            self.assertEqual(self.breaches_of_defect(proof, "minor"), [])
        self.assertEqual(self.breaches_of_defect("`ctest -R ThesisDefect.Heals`", "serious"), [])

    def test_refuses_a_defect_whose_test_does_not_exist(self):
        for proof in ("`ctest -R Arm.Clamp`", "`ctest -R ThesisDefect.Heal`",
                      "`ctest -R Arm.Heals`", "`ctest -R process.ap`"):
            with self.subTest(proof):
                self.assert_one_breach(self.breaches_of_defect(proof, "minor"), "there is no test")
        self.assert_one_breach(self.breaches_of_defect("believe me", "minor"), "names no test")

    def test_refuses_a_serious_defect_without_a_test_named_after_it(self):
        self.assert_one_breach(self.breaches_of_defect("`ctest -R Arm.Clamps`", "serious"),
                               "docs/thesis-defects.md:3", "named after it")

    def test_refuses_a_defect_of_another_form(self):
        self.assert_one_breach(self.breaches_of_defect("`ctest -R Arm`", "hardly"),
                               "serious or minor")

    def test_refuses_a_test_of_a_defect_without_a_row(self):
        self.breaches_of_defect("`ctest -R Arm.Clamps`", "minor")
        self.plant("tests/b_test.cpp", "TEST_F(ThesisDefect, Soothes) {}\n")
        self.assert_one_breach(self.check_all(), "ThesisDefect.Soothes has no row")

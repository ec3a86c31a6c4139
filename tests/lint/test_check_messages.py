import check_messages
from planted_tree import PlantedTreeTest

SOURCE = "daemon/link/port.cpp"
PAGE = check_messages.PAGE


class CheckMessages(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_page("| `the port is taken` | choose another |")
        self.plant(SOURCE, 'return fail("the port is taken");\n')

    def plant_page(self, *rows, heading="## Links: `daemon/link`"):
        self.plant(PAGE, "\n".join(["# Messages", heading, "", "| message | cure |", "|---|---|", *rows, ""]))

    def breaches(self):
        return check_messages.check(self.root)

    def test_accepts_a_page_that_lists_what_is_said(self):
        self.assertEqual(self.breaches(), [])

    def test_refuses_a_sentence_without_a_row(self):
        self.plant("hal/device/fault.cpp", 'case A:\n  return "the arm has gone away";\n')

        self.assert_one_breach(self.breaches(), "hal/device/fault.cpp:2", "`the arm has gone away`", "cure")

    def test_refuses_a_row_that_nothing_says(self):
        self.plant_page("| `the port is taken` | choose another |", "| `the port is closed` | open it |")

        self.assert_one_breach(self.breaches(), PAGE + ":7", "`the port is closed`", "daemon/link")

    def test_refuses_a_row_without_a_cure(self):
        self.plant_page("| `the port is taken` |  |")

        self.assert_one_breach(self.breaches(), PAGE + ":6", "no cure")

    def test_refuses_a_row_that_would_list_everything(self):
        self.plant_page("| `…` | nothing helps |")

        self.assert_one_breach(self.breaches(), "would list everything")

    def test_looks_for_a_row_below_a_heading_that_names_the_place(self):
        self.plant_page("| `the port is taken` | choose another |", heading="## Else: `daemon/api`")

        self.assertEqual(len(self.breaches()), 2)  # the sentence has no row, the row no sentence

    def test_joins_what_the_program_joins(self):
        self.plant(SOURCE, 'a = "the port " + std::to_string(port) +\n    " is" " taken by " + name;\n')
        self.plant_page("| `the port … is taken by` | choose another |")

        self.assertEqual(self.breaches(), [])

    def test_takes_each_branch_as_a_sentence_of_its_own(self):
        self.plant(SOURCE, 'a = is_bad ? "the port is taken" : "all is very well";\n')

        self.assert_one_breach(self.breaches(), "`all is very well`")

    def test_takes_a_row_for_the_beginning_and_dots_for_anything(self):
        self.plant(SOURCE, 'a = "expected a port above 1024, found " + x;\nb = "expected a name of its own";\n')
        self.plant_page("| `expected …` | write that |")

        self.assertEqual(self.breaches(), [])

    def test_takes_two_words_that_a_call_says(self):
        for statement in ('return fail(Errc::System, "cannot bind " + name);', 'return fail_errno("cannot bind");',
                          'return malformed(field(x) + " cannot bind");', 'spdlog::warn("{}: cannot bind", (a));',
                          'return unsupported(is_it(x) ? "the port is taken" : "cannot bind");'):
            with self.subTest(statement):
                self.plant("daemon/link/other.cpp", f"if (a) {statement}\n")
                self.assert_one_breach(self.breaches(), "daemon/link/other.cpp:1", "cannot bind")

    def test_leaves_keys_and_what_no_call_says(self):
        self.plant("daemon/link/other.cpp", 'reject("socket_mode", x);\nreturn fail_errno("socket");\n'
                                            'a = fail(b) || is("two words");\n')

        self.assertEqual(self.breaches(), [])

    def test_leaves_help_but_not_what_an_option_refuses(self):
        self.plant("daemon/app/options.cpp", 'CLI::App cli{\n    "drives arms and lets people touch"};\n'
                                             'cli.add_option("--for", x, "end after so many seconds")->check(f);\n')
        self.assertEqual(self.breaches(), [])

        self.plant("daemon/app/options.cpp", 'cli.add_flag("--for", x, "end after so many seconds");\n'
                                             'if (a) return "expected a finite number";\n')
        self.assert_one_breach(self.breaches(), "daemon/app/options.cpp:2", "`expected a finite number`")

    def test_holds_the_guard_to_it(self):
        self.plant("guard/watch.cpp", 'return "the arm was let go";\n')

        self.assert_one_breach(self.breaches(), "guard/watch.cpp:1", "`the arm was let go`")

    def test_refuses_a_row_that_swallows_many(self):
        self.plant_page("| `the port …` | choose another |")
        for count in range(1, 6):
            self.plant(SOURCE, "".join(f'f("the port is no {word}");\n' for word in "abcdefgh"[:count]))
            with self.subTest(count):
                if count <= check_messages.MAX_SENTENCES_OF_A_ROW:
                    self.assertEqual(self.breaches(), [])
                else:
                    self.assert_one_breach(self.breaches(), PAGE + ":6", f"lists {count} sentences",
                                           "`the port is no a`")

    def test_takes_a_row_of_a_whole_sentence_for_that_alone(self):
        self.plant(SOURCE, 'f("the port is taken");\ng("the port is taken by " + name);\n')

        self.assert_one_breach(self.breaches(), SOURCE + ":2", "`the port is taken by`")

    def test_leaves_words_comments_and_other_folders_alone(self):
        self.plant(SOURCE, '// "not said to anybody"\nstatic_assert(a, "never said at all");\nb = "two words";\n'
                           'c = "unsigned long long int"; d = "the port is taken";\n')
        self.plant("cli/text.cpp", 'a = "said by another program";\n')

        self.assertEqual(self.breaches(), [])

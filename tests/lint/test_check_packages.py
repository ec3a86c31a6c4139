import check_packages
from planted_tree import PlantedTreeTest

CONTROL = """Source: thimble
Build-Depends: debhelper-compat (= 13), cmake, python3:any,
 libsodium-dev (>= 1.0),
 zlib1g-dev
Standards-Version: 4.6.2
"""


class CheckPackages(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant("debian/control", CONTROL)
        self.plant("debian/thimbled.install", "usr/bin/thimbled\ndocs/api.md usr/share/doc/thimbled/docs\n")
        self.plant("debian/thimble.examples", "examples/*\n")
        self.plant("docs/api.md", "# API\n")
        self.plant("docs/inner.md", "# For who builds it\n")
        self.plant("examples/one.toml", "# thimbled --config examples/one.toml\n")
        self.plant_run("g++ cmake python3 libsodium-dev zlib1g-dev")

    def plant_run(self, packages):
        self.plant("run", f"#!/bin/bash\nreadonly build_packages=(\n  {packages})\nreadonly test_packages=(clang-14)\n")

    def test_accepts_the_same_list(self):
        self.assertEqual(check_packages.check(self.root), [])

    def test_refuses_what_only_the_package_names(self):
        self.plant_run("g++ cmake python3 zlib1g-dev")
        self.assert_one_breach(check_packages.check(self.root), "run", "libsodium-dev", "bare machine")

    def test_refuses_what_only_a_checkout_installs(self):
        self.plant_run("g++ cmake python3 libsodium-dev zlib1g-dev libudev-dev")
        self.assert_one_breach(check_packages.check(self.root), "debian/control", "libudev-dev")

    def test_refuses_a_list_that_it_does_not_find(self):
        self.plant("run", "#!/bin/bash\n")
        self.assert_one_breach(check_packages.check(self.root), "run", "not where")

    def test_accepts_names_of_what_is_installed(self):
        self.plant("daemon/api/a.cpp", '// docs/inner.md has it\nauto text = "see docs/api.md and examples/one.toml";\n')
        self.plant("docs/api.md", "[this page](api.md#top), `examples/one.toml`, https://x.org/docs/x.md\n")
        self.assertEqual(check_packages.check(self.root), [])

    def test_refuses_a_program_that_names_what_no_package_brings(self):
        self.plant("cli/main.cpp", 'auto text = "as it says; docs/inner.md has each kind";\n')
        self.assert_one_breach(check_packages.check(self.root), "cli/main.cpp:1", "docs/inner.md", "no package brings")

    def test_refuses_a_name_of_nothing_in_units_manual_pages_and_examples(self):
        for path in ("systemd/a.service", "docs/man/thimble.1", "examples/two.toml", "udev/61-a.rules"):
            with self.subTest(path):
                self.plant(path, "# as docs/gone.md says\n")
                self.assert_one_breach(check_packages.check(self.root), f"{path}:1", "there is no docs/gone.md")
                self.plant(path, "\n")

    def test_refuses_a_page_that_leads_to_one_that_stays_behind(self):
        self.plant("docs/api.md", "# API\n\nSee [the rest](inner.md).\n")
        self.assert_one_breach(check_packages.check(self.root), "docs/api.md:3", "docs/inner.md", "no package brings")

    def test_lets_pages_that_stay_behind_name_what_they_like(self):
        self.plant("docs/inner.md", "docs/gone.md and [more](../src.md)\n")
        self.assertEqual(check_packages.check(self.root), [])

    def test_refuses_a_number_of_a_decision_that_stays_behind(self):
        self.plant("docs/decisions/0001-it-is-so.md", "# 0001\n\nAs decision 0002 has it.\n")
        self.plant("docs/decisions/0002-so-is-this.md", "# 0002\n")
        self.plant("docs/api.md", "# API (decisions 0001 and 0002)\n")
        self.plant("debian/thimbled.install", "docs/api.md x\ndocs/decisions/0001-it-is-so.md x\n")
        self.assert_one_breach(check_packages.check(self.root), "docs/api.md:1", "decision 0002", "no package brings")

    def test_refuses_packages_without_pages(self):
        self.plant("debian/thimbled.install", "usr/bin/thimbled\n")
        self.assert_one_breach(check_packages.check(self.root), "debian", "no package brings any page")

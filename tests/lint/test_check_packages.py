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

import check_rt_headers
from planted_tree import PlantedTreeTest


class CheckRtHeaders(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy("tests/lint/rt_headers.txt")

    def test_accepts_headers_of_the_list(self):
        self.plant("daemon/servo/loop.cpp", "#include <array>\n#include <atomic>\n")
        self.plant("daemon/api/server.cpp", "#include <iostream>\n")

        self.assertEqual(check_rt_headers.check(self.root), [])

    def test_refuses_a_header_that_allocates(self):
        for header in ("vector", "functional", "mutex", "iostream"):
            with self.subTest(header):
                self.plant("daemon/servo/loop.cpp", f"#include <array>\n#include <{header}>\n")

                self.assert_one_breach(check_rt_headers.check(self.root),
                                       "daemon/servo/loop.cpp:2", header, "rt_headers.txt")

    def test_lets_the_named_file_alone_use_its_own_header(self):
        self.plant("tests/lint/rt_headers.txt", "array\ndaemon/servo/file.*: cstdio  # why\n")
        self.plant("daemon/servo/file.cpp", "#include <array>\n#include <cstdio>\n")
        self.assertEqual(check_rt_headers.check(self.root), [])

        self.plant("daemon/servo/loop.cpp", "#include <cstdio>\n")
        self.assert_one_breach(check_rt_headers.check(self.root), "daemon/servo/loop.cpp:1")

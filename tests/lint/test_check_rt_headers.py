import check_rt_headers
from planted_tree import PlantedTreeTest


class CheckRtHeaders(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy(check_rt_headers.LIST)
        text = (self.root / check_rt_headers.LIST).read_text(encoding="utf-8")
        files, _, special = check_rt_headers.rules(text)
        for pattern in files["servo"] + files["exempt"] + list(special):
            self.plant(pattern.replace("/*", "/some.hpp").replace(".*", ".hpp"), "")

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

    def test_looks_at_all_that_the_tick_runs(self):
        for path in ("hal/rt/ring.hpp", "hal/device/fault.cpp", "daemon/coupling/ghost_point_arm.cpp",
                     "drivers/phantom/phantom_device.cpp", "drivers/phantom/phantom_codec.hpp",
                     "hal/plugin/plugin_device.cpp", "daemon/link/arm_mailbox.hpp",
                     "daemon/devices/replaceable_device.cpp", "hal/linux/hid_device.cpp", "daemon/world/push_out.hpp"):
            with self.subTest(path):
                self.plant(path, "#include <mutex>\n")
                self.assert_one_breach(check_rt_headers.check(self.root), path + ":1", "<mutex>")
                self.plant(path, "")

        for path in ("drivers/phantom/phantom_match.cpp", "daemon/link/udp_port.cpp"):
            self.plant(path, "#include <mutex>\n")
        self.assertEqual(check_rt_headers.check(self.root), [])

    def test_refuses_a_mark_in_a_file_that_nothing_names(self):
        mark = "THIMBLE_RT void step() noexcept;\n"
        self.plant("daemon/api/server.hpp", "#pragma once\n" + mark)
        self.assert_one_breach(check_rt_headers.check(self.root), "daemon/api/server.hpp:2", "THIMBLE_RT", "servo")

        self.plant("daemon/api/server.hpp", "// THIMBLE_RT is for others.\n#define THIMBLE_RT\n")
        self.plant("sim/model/arm/plant.hpp", mark)
        self.plant("daemon/servo/loop.hpp", mark)
        self.assertEqual(check_rt_headers.check(self.root), [])

    def test_follows_what_a_servo_file_includes(self):
        self.plant("daemon/servo/loop.cpp", '#include "daemon/world/light.hpp"\n')
        self.plant("daemon/world/light.hpp", '#pragma once\n#include "daemon/world/heavy.hpp"\n')
        self.plant("daemon/world/heavy.hpp", "#pragma once\n#include <mutex>\n")
        self.assert_one_breach(check_rt_headers.check(self.root), "daemon/world/heavy.hpp:2", "<mutex>",
                               "daemon/world/light.hpp includes this file")

        self.plant("daemon/servo/loop.cpp", '// #include "daemon/world/light.hpp"\n')
        self.assertEqual(check_rt_headers.check(self.root), [])

    def test_refuses_an_include_that_a_macro_names(self):
        self.plant("daemon/servo/loop.cpp", "#define LOCKS <mutex>\n#include LOCKS\n")
        self.assert_one_breach(check_rt_headers.check(self.root), "daemon/servo/loop.cpp:2", "macro")

    def test_refuses_a_mark_behind_another_name(self):
        self.plant("daemon/api/server.hpp", "#define FAST THIMBLE_RT\n")
        self.assert_one_breach(check_rt_headers.check(self.root), "daemon/api/server.hpp:1", "THIMBLE_RT")

    def test_refuses_a_pattern_of_no_file(self):
        self.plant("hal/rt/a.hpp", "")
        for line in ("servo hal/rt/b.*", "exempt hal/rt/b.*", "hal/rt/b.hpp: cstdio"):
            with self.subTest(line):
                self.plant(check_rt_headers.LIST, f"servo hal/rt/a.*\n{line}\n")
                self.assert_one_breach(check_rt_headers.check(self.root), check_rt_headers.LIST, "hal/rt/b.")

    def test_lets_the_named_file_alone_use_its_own_header(self):
        self.plant(check_rt_headers.LIST, "servo daemon/servo/*\narray\ndaemon/servo/file.*: cstdio  # why\n")
        self.plant("daemon/servo/file.cpp", "#include <array>\n#include <cstdio>\n")
        self.assertEqual(check_rt_headers.check(self.root), [])

        self.plant("daemon/servo/loop.cpp", "#include <cstdio>\n")
        self.assert_one_breach(check_rt_headers.check(self.root), "daemon/servo/loop.cpp:1")

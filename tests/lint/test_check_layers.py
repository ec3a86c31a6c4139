import check_layers
from planted_tree import PlantedTreeTest


class CheckLayers(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy("tests/lint/layers.txt")

    def check(self):
        return check_layers.check(self.root)

    def test_accepts_what_the_table_allows(self):
        self.plant("drivers/phantom/phantom_device.cpp",
                   '#include "drivers/phantom/phantom_device.hpp"\n#include <vector>\n'
                   '#include "hal/bus/hid_device.hpp"\n')
        self.plant("drivers/phantom/phantom_kinematics.cpp", "#include <Eigen/Dense>\n")
        self.plant("hal/base/result.hpp", "#include <tl/expected.hpp>\n")

        self.assertEqual(self.check(), [])

    def test_expands_a_set_within_a_set(self):
        self.plant("cli/client.hpp", '#include "hal/base/result.hpp"\n')

        self.assertEqual(self.check(), [])

    def test_refuses_a_device_below_the_servo(self):
        self.plant("daemon/servo/loop.cpp",
                   '#include <array>\n#include "drivers/phantom/phantom_device.hpp"\n')

        self.assert_one_breach(self.check(), "daemon/servo/loop.cpp:2:", "drivers/phantom",
                               "layers.txt", "Move the code")

    def test_refuses_a_driver_that_sees_another_driver(self):
        self.plant("drivers/falcon/falcon.cpp", '#include "drivers/phantom/phantom_device.hpp"\n')

        self.assert_one_breach(self.check(), "drivers/falcon/falcon.cpp:1", "layers.txt")

    def test_lets_a_model_see_facts_but_no_codec(self):
        self.plant("sim/model/arm/firmware.cpp", '#include "drivers/phantom/phantom_wire.hpp"\n')
        self.assertEqual(self.check(), [])

        self.plant("sim/model/arm/firmware.cpp", '#include "drivers/phantom/phantom_codec.hpp"\n')
        self.assert_one_breach(self.check(), "phantom_codec.hpp")

    def test_refuses_a_hardware_header_outside_hal_linux(self):
        self.plant("hal/linux/hid.cpp", "#include <hidapi/hidapi.h>\n")
        self.assertEqual(self.check(), [])

        self.plant("drivers/phantom/phantom_driver.cpp", "#include <hidapi/hidapi.h>\n")
        self.assert_one_breach(self.check(), "drivers/phantom/phantom_driver.cpp:1", "hardware")

    def test_keeps_eigen_to_the_kinematics(self):
        self.plant("drivers/phantom/phantom_codec.cpp", "#include <Eigen/Core>\n")

        self.assert_one_breach(self.check(), "eigen")

    def test_refuses_a_library_that_the_table_does_not_know(self):
        self.plant("daemon/api/server.cpp", "#include <curl/curl.h>\n")

        self.assert_one_breach(self.check(), "curl/curl.h", "decision record")

    def test_refuses_a_path_that_is_not_from_the_root(self):
        self.plant("hal/base/geometry.cpp", '#include "geometry.hpp"\n')

        self.assert_one_breach(self.check(), "from the root")

    def test_refuses_a_folder_without_a_line(self):
        self.plant("daemon_two/x.cpp", "")
        self.plant("drivers/nobody/x.cpp", "")

        self.assert_one_breach(self.check(), "drivers/nobody/x.cpp:1", "no line")

    def test_ignores_includes_in_comments_and_strings(self):
        self.plant("hal/rt/ring.hpp", '// #include "daemon/api/server.hpp"\n/*\n'
                                      '#include "daemon/api/server.hpp"\n*/\n')

        self.assertEqual(self.check(), [])

    def test_refuses_a_link_edge_against_the_table(self):
        self.plant("daemon/api/CMakeLists.txt", "thimble_library(daemon/api SOURCES a.cpp)\n")
        self.plant("daemon/servo/CMakeLists.txt",
                   "thimble_library(daemon/servo SOURCES s.cpp\n  LINKS thimble_daemon_api)\n")

        self.assert_one_breach(self.check(), "daemon/servo/CMakeLists.txt:1", "thimble_daemon_api")

    def test_refuses_an_outside_link_against_the_table(self):
        self.plant("daemon/servo/CMakeLists.txt",
                   "thimble_library(daemon/servo SOURCES s.cpp LINKS Boost::json)\n")

        self.assert_one_breach(self.check(), "Boost::json")

import check_udev
from planted_tree import PlantedTreeTest

RIGHTS = 'OWNER:="root", GROUP:="thimble", MODE:="0660", TAG-="uaccess", TAG+="systemd"'
FALCON = ('SUBSYSTEM=="usb", ENV{DEVTYPE}=="usb_device", ATTR{idVendor}=="0403", ATTR{idProduct}=="cb48", '
          f'{RIGHTS}, ATTR{{power/control}}="on"')
ARM = f'SUBSYSTEM=="hidraw", KERNELS=="0003:1234:0006.*", {RIGHTS}'
PUCK = 'SUBSYSTEM=="hidraw", KERNELS=="0003:256F:C635.*|0003:256F:C636.*", GROUP="thimble", MODE="0660", TAG+="uaccess", TAG+="systemd"'
PORT = (f'SUBSYSTEM=="tty", ATTRS{{idVendor}}=="16c0", ATTRS{{idProduct}}=="0483", {RIGHTS}, '
        'ENV{ID_MM_DEVICE_IGNORE}="1"')


class CheckUdev(PlantedTreeTest):
    def breaches_of(self, *lines, name="72-thimble.rules"):
        self.plant(f"udev/{name}", "\n".join(lines) + "\n")
        return check_udev.check(self.root)

    def assert_refused(self, line, *words):
        self.assert_one_breach(self.breaches_of("# words", line), "udev/72-thimble.rules:2:", *words)

    def test_accepts_arms_pucks_ports_and_the_latency_node(self):
        self.assertEqual(self.breaches_of('ACTION=="remove", GOTO="end"', FALCON, ARM, PUCK, PORT,
                                          'SUBSYSTEM=="misc", KERNEL=="cpu_dma_latency", GROUP="thimble", MODE="0660"',
                                          'LABEL="end"'), [])

    def test_accepts_the_rules_of_this_tree(self):
        self.plant_copy("udev/72-thimble.rules")
        self.plant_copy("drivers/phantom/phantom_wire.hpp")
        self.assertEqual(check_udev.check(self.root), [])

    def test_refuses_rights_for_others(self):
        self.assert_refused(ARM.replace("0660", "0666"), "0666")
        self.assert_refused(PUCK.replace("0660", "0664"), "0664")

    def test_refuses_a_vendor_id_alone(self):
        self.assert_refused(FALCON.replace('ATTR{idProduct}=="cb48", ', ""), "whole id")
        self.assert_refused(ARM.replace(":0006", ":*"), "whole id")
        self.assert_refused(PUCK.replace("|0003:256F:C636.*", "|0003:256F:*"), "whole id")
        self.assert_refused(FALCON.replace("cb48", "*"), "whole id")

    def test_refuses_ids_in_the_wrong_case(self):
        self.assert_refused(FALCON.replace("cb48", "CB48"), "lower case")
        self.assert_refused(PUCK.replace("C635", "c635"), "upper case")

    def test_refuses_an_arm_for_whoever_sits_at_the_machine(self):
        self.assert_refused(ARM.replace('TAG-="uaccess"', 'TAG+="uaccess"'), "uaccess")
        self.assert_refused(ARM.replace('TAG-="uaccess", ', ""), "uaccess")

    def test_refuses_rights_that_a_later_rule_could_change(self):
        self.assert_refused(ARM.replace("MODE:=", "MODE="), "MODE:=")
        self.assert_refused(ARM.replace("GROUP:=", "GROUP="), "GROUP:=")

    def test_refuses_another_group(self):
        self.assert_refused(ARM.replace('"thimble"', '"plugdev"'), "thimble")

    def test_refuses_a_rule_that_mixes_pucks_with_others(self):
        self.assert_refused(PUCK.replace("256F:C636", "1234:0006"), "puck")

    def test_refuses_an_arm_that_may_be_suspended(self):
        self.assert_refused(FALCON.replace(', ATTR{power/control}="on"', ""), "suspended")

    def test_refuses_a_port_that_ModemManager_would_try(self):
        self.assert_refused(PORT.replace(', ENV{ID_MM_DEVICE_IGNORE}="1"', ""), "ModemManager")

    def test_refuses_a_node_that_systemd_does_not_see(self):
        self.assert_refused(ARM.replace(', TAG+="systemd"', ""), "systemd")

    def test_refuses_what_it_cannot_read(self):
        self.assert_refused(ARM.replace('=="hidraw"', "==hidraw"), "cannot be read")
        self.assert_refused(ARM + ', RUN+="/bin/chmod 0666 $devnode"', "RUN")
        self.assert_refused(ARM.replace("GROUP", "GRUOP"), "GRUOP")

    def test_refuses_a_file_that_sorts_wrongly(self):
        for name in ("60-thimble.rules", "70-thimble.rules", "73-thimble.rules", "99-thimble.rules", "thimble.rules"):
            with self.subTest(name):
                self.assert_one_breach(self.breaches_of(ARM, name=name), name, "sort")
                (self.root / "udev" / name).unlink()

    def test_refuses_an_id_of_a_driver_without_a_rule(self):
        self.plant("drivers/gantry/gantry_wire.hpp", "constexpr int kVendorId = 0x16D0;\nconstexpr int kProductId = 0x0483;\n")
        self.assert_one_breach(self.breaches_of(ARM), "gantry_wire.hpp", "16d0:0483")

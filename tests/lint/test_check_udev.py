import check_udev
from planted_tree import PlantedTreeTest

RIGHTS = 'OWNER:="root", GROUP:="thimble", MODE:="0660"'
ARM = 'SUBSYSTEMS=="hid", KERNELS=="*:1234:0006.*"'
PUCK = ('SUBSYSTEM=="hidraw", SUBSYSTEMS=="hid", KERNELS=="*:256F:C635.*|*:256F:C636.*", GROUP="thimble", MODE="0660", '
        'TAG+="uaccess", TAG+="systemd"')


def usb(vendor, product):
    return f'SUBSYSTEMS=="usb", ATTRS{{idVendor}}=="{vendor}", ATTRS{{idProduct}}=="{product}"'


def awake(vendor, product):
    return (f'SUBSYSTEM=="usb", ENV{{DEVTYPE}}=="usb_device", ATTR{{idVendor}}=="{vendor}", ATTR{{idProduct}}=="{product}", '
            'ATTR{power/control}="on"')


FALCON = f"{usb('0403', 'cb48')}, {RIGHTS}"
PORT = f'{usb("16c0", "0483")}, {RIGHTS}, ENV{{ID_MM_DEVICE_IGNORE}}="1"'


class CheckUdev(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.rights = ['ACTION=="remove", GOTO="end"', FALCON, f"{ARM}, {RIGHTS}", PUCK, PORT,
                       'SUBSYSTEM=="misc", KERNEL=="cpu_dma_latency", GROUP="thimble", MODE="0660"', 'LABEL="end"']
        self.awake = ['ACTION=="remove", GOTO="end"', awake("0403", "cb48"), awake("16c0", "0483"), awake("256f", "c635|c636"), 'LABEL="end"']
        self.hwdb = "# words\n\nusb:v0403pCB48*\nusb:v16C0p0483*\nusb:v256FpC635*\nusb:v256FpC636*\n ID_AUTOSUSPEND=0\n"
        self.tags = [f'{match}, TAG="systemd"' for match in (usb("0403", "cb48"), usb("16c0", "0483"), ARM)]

    def breaches(self):
        self.plant("udev/0-thimble.rules", "\n".join(self.rights) + "\n")
        self.plant("udev/73-seat-ignores-thimble.rules", "# words\n\n" + "\n".join(self.tags) + "\n")
        self.plant("udev/99-zz-thimble-awake.rules", "\n".join(self.awake) + "\n")
        self.plant("udev/61-thimble.hwdb", self.hwdb)
        return check_udev.check(self.root)

    def assert_refused(self, old, new, *words):
        """With one rule of rights changed."""
        kept = list(self.rights)
        self.assertTrue(any(old in line for line in kept), old)
        self.rights = [line.replace(old, new) for line in kept]
        self.assert_one_breach(self.breaches(), "udev/", *words)
        self.rights = kept

    def test_accepts_arms_pucks_ports_and_the_latency_node(self):
        self.assertEqual(self.breaches(), [])

    def test_accepts_the_rules_of_this_tree(self):
        for path in ("udev/0-thimble.rules", "udev/73-seat-ignores-thimble.rules", "udev/99-zz-thimble-awake.rules", "udev/61-thimble.hwdb",
                     "drivers/phantom/phantom_wire.hpp", "drivers/spacemouse/spacemouse_models.toml"):
            self.plant_copy(path)
        self.assertEqual(check_udev.check(self.root), [])

    def test_refuses_rights_for_others(self):
        self.assert_refused(f"{ARM}, {RIGHTS}", f"{ARM}, {RIGHTS}".replace("0660", "0666"), "0-thimble.rules:3", "0666")
        self.assert_refused(PUCK, PUCK.replace("0660", "0664"), "0664")

    def test_refuses_a_vendor_id_alone(self):
        self.assert_refused(FALCON, FALCON.replace(', ATTRS{idProduct}=="cb48"', ""), "whole id")
        self.assert_refused(FALCON, FALCON.replace("cb48", "*"), "whole id")
        self.assert_refused(":0006", ":*", "whole id")
        self.assert_refused("|*:256F:C636.*", "|*:256F:*", "whole id")

    def test_refuses_ids_in_the_wrong_case(self):
        self.assert_refused(FALCON, FALCON.replace("cb48", "CB48"), "lower case")
        self.assert_refused("C635", "c635", "upper case")

    def test_refuses_an_arm_for_whoever_sits_at_the_machine(self):
        self.assert_refused(f"{ARM}, {RIGHTS}", f'{ARM}, {RIGHTS}, TAG+="uaccess"', "uaccess")
        self.tags.pop()
        self.assert_one_breach(self.breaches(), "hid 1234 0006", "uaccess")

    def test_refuses_tags_that_are_only_taken_away(self):
        self.tags[0] = self.tags[0].replace('TAG="systemd"', 'TAG-="uaccess"')
        self.assert_one_breach(self.breaches(), "usb 0403 cb48", "uaccess")
        self.tags[0] = f'{usb("0403", "cb48")}, TAG="uaccess"'
        self.assert_one_breach(self.breaches(), "still matches")

    def test_refuses_tags_of_what_has_no_rights(self):
        self.tags.append(f'{usb("1234", "0006")}, TAG="systemd"')
        self.assert_one_breach(self.breaches(), "usb 1234 0006", "no rights")

    def test_refuses_rights_that_another_rule_could_change(self):
        for key in ("MODE", "GROUP", "OWNER"):
            self.assert_refused(FALCON, FALCON.replace(f"{key}:=", f"{key}="), f"{key}:=")

    def test_refuses_another_group(self):
        self.assert_refused(FALCON, FALCON.replace('"thimble"', '"plugdev"'), "thimble")

    def test_refuses_a_rule_for_some_nodes_of_an_arm(self):
        self.assert_refused(f"{ARM}, {RIGHTS}", f'SUBSYSTEM=="hidraw", {ARM}, {RIGHTS}', "every node")

    def test_refuses_a_rule_that_mixes_pucks_with_others(self):
        self.assert_refused("256F:C636", "1234:0006", "puck")

    def test_refuses_an_arm_that_may_be_suspended(self):
        self.awake.remove(awake("0403", "cb48"))
        self.assert_one_breach(self.breaches(), "usb 0403 cb48", "99-zz-thimble-awake.rules", "suspended")

    def test_refuses_a_puck_that_may_be_suspended(self):
        self.awake[3] = awake("256f", "c635")
        self.assert_one_breach(self.breaches(), "256f c636", "99-zz-thimble-awake.rules", "suspended")

    def test_refuses_an_awake_device_where_a_later_file_could_undo_it(self):
        self.rights.insert(2, self.awake.pop(1))
        self.assert_one_breach(self.breaches(), "0-thimble.rules:3", "99-zz-thimble-awake.rules", "undo")

    def test_refuses_a_rule_that_keeps_another_thing_awake_or_does_something_else(self):
        kept = list(self.awake)
        for old, new, words in (('="on"', '="auto"', "power/control"), (', ATTR{power/control}="on"', "", "power/control"),
                                ('ATTR{power/control}="on"', 'ATTR{power/control}="on", MODE="0660"', "nothing else"),
                                ('SUBSYSTEM=="usb", ', "", "the device"), ('"usb_device"', '"usb_interface"', "the device"),
                                (', ATTR{idProduct}=="cb48"', "", "whole id")):
            with self.subTest(new):
                self.awake[1] = kept[1].replace(old, new)
                self.assertNotEqual(self.awake, kept)
                self.assert_one_breach(self.breaches(), "99-zz-thimble-awake.rules:2", words)

    def test_refuses_to_keep_awake_what_has_no_rights(self):
        for vendor, product in (("10c4", "ea90"), ("256f", "c633")):
            with self.subTest(vendor):
                self.awake.insert(1, awake(vendor, product))
                self.assert_one_breach(self.breaches(), "99-zz-thimble-awake.rules", f"{vendor} {product}", "no rights")
                self.awake.pop(1)

    def test_refuses_an_arm_that_anothers_hwdb_may_let_sleep(self):
        all_four = ("0403:cb48", "16c0:0483", "256f:c635", "256f:c636")
        for whole, words in (("", all_four), (self.hwdb.replace("=0", "=1"), all_four),
                             (self.hwdb.replace("usb:v16C0p0483*\n", ""), ("16c0:0483",))):
            with self.subTest(whole):
                self.hwdb = whole
                self.assertEqual([[pair in breach for pair in words].count(True) for breach in self.breaches()], len(words) * [1])

    def test_refuses_an_entry_of_the_hwdb_that_systemd_would_not_meet(self):
        kept = self.hwdb
        for old, new in (("v0403pCB48*", "v0403pcb48*"), ("v0403pCB48*", "v0403p*"), ("usb:v0403", "v0403"), (" ID_", "ID_"),
                         ("ID_AUTOSUSPEND", "ID_AUTO_SUSPEND"), ("*\n ID", "*\n\n ID")):
            with self.subTest(new):
                self.hwdb = kept.replace(old, new, 1)
                self.assertTrue(self.breaches())

    def test_refuses_a_hwdb_for_what_has_no_rights(self):
        self.hwdb += "\nusb:v10C4pEA90*\n ID_AUTOSUSPEND=0\n"
        self.assert_one_breach(self.breaches(), "61-thimble.hwdb", "10c4:ea90", "no rights")

    def test_refuses_a_hwdb_that_sorts_wrongly(self):
        self.plant("udev/60-autosuspend-thimble.hwdb", self.hwdb)
        self.assert_one_breach(self.breaches(), "60-autosuspend-thimble.hwdb", "sort")

    def test_refuses_a_port_that_ModemManager_would_try(self):
        self.assert_refused(', ENV{ID_MM_DEVICE_IGNORE}="1"', "", "ModemManager")

    def test_refuses_what_it_cannot_read(self):
        self.assert_refused(FALCON, FALCON.replace('=="usb"', "==usb"), "cannot be read")
        self.assert_refused(FALCON, FALCON + ', RUN+="/bin/chmod 0666 $devnode"', "RUN")
        self.assert_refused(FALCON, FALCON.replace("GROUP", "GRUOP"), "GRUOP")

    def test_refuses_rights_and_tags_in_each_others_files(self):
        self.tags.append(FALCON)
        self.assert_one_breach(self.breaches(), "73-seat-ignores-thimble.rules:6", "rights belong")

    def test_refuses_a_file_that_sorts_wrongly(self):
        for name in ("70-thimble.rules", "72-thimble.rules", "73-thimble.rules", "99-thimble.rules", "99-thimble-awake.rules", "thimble.rules"):
            with self.subTest(name):
                self.plant(f"udev/{name}", FALCON)
                self.assert_one_breach(self.breaches(), name, "sort")
                (self.root / "udev" / name).unlink()

    def test_refuses_an_id_of_a_driver_without_a_rule(self):
        self.plant("drivers/gantry/gantry_wire.hpp", "constexpr int kVendorId = 0x16D0;\nconstexpr int kProductId = 0x0483;\n")
        self.assert_one_breach(self.breaches(), "gantry_wire.hpp", "16d0:0483")

    def test_refuses_a_puck_of_a_drivers_table_without_a_rule(self):
        row = '[schema]\nvendor_id = "id"\n[one]\nvendor_id = {{ value = 0x256f }}\nproduct_id = {{ value = 0x{} }}\n'
        self.plant("drivers/puck/puck_models.toml", row.format("c636"))
        self.assertEqual(self.breaches(), [])
        self.plant("drivers/puck/puck_models.toml", row.format("c633"))
        self.assert_one_breach(self.breaches(), "puck_models.toml", "256f:c633")

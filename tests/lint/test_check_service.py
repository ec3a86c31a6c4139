import check_service
from planted_tree import HERE, PlantedTreeTest

PATH = "systemd/thimbled.service"
GUARD = "systemd/thimble-guard@.service"
BOARD = "systemd/thimble-board@.service"


class CheckService(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy(PATH)
        self.plant_copy(GUARD)
        self.plant_copy(BOARD)

    def breaches_with(self, old, new, path=PATH):
        shipped = (HERE.parents[1] / path).read_text(encoding="utf-8")
        self.assertIn(old, shipped)
        self.plant(path, shipped.replace(old, new))
        return check_service.check(self.root)

    def test_accepts_the_units_as_shipped(self):
        self.assertEqual(check_service.check(self.root), [])

    def test_refuses_units_without_room_for_as_many_arms_as_a_configuration_may_have(self):
        for path in (check_service.LIMITS, check_service.GUARD_SOCKET):
            self.plant_copy(path)
        self.assertEqual(check_service.check(self.root), [])
        self.assert_one_breach(self.breaches_with("TasksMax=192", "TasksMax=160"), "needs TasksMax= of at least 192")
        self.plant_copy(PATH)
        self.assert_one_breach(self.breaches_with("MaxConnections=64\n", "", check_service.GUARD_SOCKET), "needs MaxConnections= of at least 64")
        self.plant_copy(check_service.GUARD_SOCKET)
        breaches = self.breaches_with("kMaxArms = 32", "kMaxArms = 48", check_service.LIMITS)
        self.assertEqual(len(breaches), 2, breaches)

    def test_refuses_a_tree_without_a_unit(self):
        (self.root / GUARD).unlink()
        self.assert_one_breach(check_service.check(self.root), GUARD, "missing")

    def test_refuses_a_guard_that_ends_with_the_daemon_or_reaches_further_than_its_connection(self):
        self.assert_one_breach(self.breaches_with("[Service]", "PartOf=thimbled.service\n[Service]", GUARD), "outlive")
        self.assert_one_breach(self.breaches_with("Before=thimbled.service\n", "", GUARD), "ends first")
        self.assert_one_breach(self.breaches_with("[Service]", "[Service]\nDeviceAllow=char-hidraw rw", GUARD), "opens nothing")
        self.assert_one_breach(self.breaches_with("LimitRTPRIO=98\n", "", GUARD), "LimitRTPRIO")

    def test_refuses_a_helper_with_more_rights_than_enabling_needs(self):
        self.assert_one_breach(self.breaches_with("CapabilityBoundingSet=CAP_SYS_ADMIN", "CapabilityBoundingSet=CAP_SYS_ADMIN CAP_SYS_RAWIO", BOARD),
                               "nothing it does needs more")
        self.assert_one_breach(self.breaches_with("[Service]", "[Service]\nDeviceAllow=char-hidraw rw", BOARD), "opens none")

    def test_refuses_a_helper_that_may_hang(self):
        for line in ("RuntimeMaxSec=5\n", "TimeoutStopSec=5\n"):
            with self.subTest(line):
                self.assert_one_breach(self.breaches_with(line, "", BOARD), line.partition("=")[0], "keeps a connection" if "Run" in line else "likewise")
        self.assert_one_breach(self.breaches_with("RuntimeMaxSec=5\n", "RuntimeMaxSec=infinity\n", BOARD), "RuntimeMaxSec")
        self.assert_one_breach(self.breaches_with("[Service]", "[Service]\nType=oneshot", BOARD), "RuntimeMaxSec")

    def test_refuses_more_exposure(self):
        self.assert_one_breach(self.breaches_with("CapabilityBoundingSet=\n", ""), "exposure")

    def test_refuses_what_forbids_real_time(self):
        self.assert_one_breach(self.breaches_with("SystemCallFilter=~@privileged", "SystemCallFilter=~@privileged @resources"),
                               "sched_setscheduler")
        self.assert_one_breach(self.breaches_with("[Install]", "RestrictRealtime=yes\n[Install]"), "SCHED_FIFO")

    def test_refuses_what_hides_arms(self):
        self.assert_one_breach(self.breaches_with("[Install]", "PrivateDevices=yes\n[Install]"), "hides")
        for line in ("char-hidraw rw", "char-usb_device rw", "char-usb r", "char-ttyACM rw", "char-gpiochip rw",
                     "/dev/cpu_dma_latency rw"):
            with self.subTest(line):
                self.assert_one_breach(self.breaches_with(f"DeviceAllow={line}\n", ""), f"needs DeviceAllow={line}:")
        self.assert_one_breach(self.breaches_with("Wants=modprobe@hid.service ", "Wants="), "Wants=")

    def test_refuses_a_device_that_nothing_opens(self):
        self.assert_one_breach(self.breaches_with("[Install]", "DeviceAllow=char-input r\n[Install]"), "char-input", "opens")

    def test_asks_for_the_line_of_every_node_that_hal_linux_looks_for(self):
        for code, word in (('::udev_enumerate_add_match_subsystem(list.get(), "input");', "input"),
                           ('::udev_monitor_filter_add_match_subsystem_devtype(monitor.get(), "block", nullptr);', "block"),
                           ('add_places(context_.get(),\n           "input", places);', "input"),
                           ('::open("/dev/uinput", O_RDWR);', "/dev/uinput")):
            with self.subTest(code):
                self.plant("hal/linux/some.cpp", "int a;\n" + code)
                self.assert_one_breach(check_service.check(self.root), "hal/linux/some.cpp:2:", f" {word}: ", "DeviceAllow=")
        self.plant("hal/linux/some.cpp", '// "/dev/uinput"\nadd_places(context_.get(), "hidraw", places); ::open("/dev/null", mode);')
        self.assertEqual(check_service.check(self.root), [])

    def test_sees_each_node_that_hal_linux_opens_today(self):
        shipped = "".join(path.read_text(encoding="utf-8") for path in sorted((HERE.parents[1] / "hal/linux").glob("*.?pp")))
        words = {found[found.lastgroup] for found in check_service.NODE_WORDS.finditer(shipped)}
        self.assertLessEqual(check_service.NODES.keys(), words)

    def test_refuses_a_service_without_bounds(self):
        for line in ("WatchdogSec=3", "LimitRTTIME=500ms", "MemoryMax=2G"):
            with self.subTest(line):
                key = line.partition("=")[0]
                self.assert_one_breach(self.breaches_with(line + "\n", ""), key)
                self.assert_one_breach(self.breaches_with(line + "\n", f"{key}=infinity\n"), key)

    def test_refuses_a_service_that_stays_away_or_comes_back_to_a_wrong_configuration(self):
        self.assert_one_breach(self.breaches_with("Restart=on-failure\n", ""), "needs Restart=on-failure", "come back")
        self.assert_one_breach(self.breaches_with("Restart=on-failure\n", "Restart=on-abort\n"), "needs Restart=on-failure")
        self.assert_one_breach(self.breaches_with("RestartPreventExitStatus=2\n", ""), "needs RestartPreventExitStatus=2", "wrong again")

    def test_refuses_other_hosts_as_shipped(self):
        breaches = self.breaches_with("[Install]", "IPAddressAllow=192.0.2.0/24\n[Install]")
        self.assertTrue(any("other hosts" in breach for breach in breaches), breaches)

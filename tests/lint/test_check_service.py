import check_service
from planted_tree import HERE, PlantedTreeTest

PATH = "systemd/thimbled.service"
GUARD = "systemd/thimble-guard@.service"


class CheckService(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant_copy(PATH)
        self.plant_copy(GUARD)

    def breaches_with(self, old, new, path=PATH):
        shipped = (HERE.parents[1] / path).read_text(encoding="utf-8")
        self.assertIn(old, shipped)
        self.plant(path, shipped.replace(old, new))
        return check_service.check(self.root)

    def test_accepts_the_units_as_shipped(self):
        self.assertEqual(check_service.check(self.root), [])

    def test_refuses_a_tree_without_a_unit(self):
        (self.root / GUARD).unlink()
        self.assert_one_breach(check_service.check(self.root), GUARD, "missing")

    def test_refuses_a_guard_that_ends_with_the_daemon_or_reaches_further_than_its_connection(self):
        self.assert_one_breach(self.breaches_with("[Service]", "PartOf=thimbled.service\n[Service]", GUARD), "outlive")
        self.assert_one_breach(self.breaches_with("Before=thimbled.service\n", "", GUARD), "ends first")
        self.assert_one_breach(self.breaches_with("[Service]", "[Service]\nDeviceAllow=char-hidraw rw", GUARD), "opens nothing")
        self.assert_one_breach(self.breaches_with("LimitRTPRIO=98\n", "", GUARD), "LimitRTPRIO")

    def test_refuses_more_exposure(self):
        self.assert_one_breach(self.breaches_with("CapabilityBoundingSet=\n", ""), "exposure")

    def test_refuses_what_forbids_real_time(self):
        self.assert_one_breach(self.breaches_with("SystemCallFilter=~@privileged", "SystemCallFilter=~@privileged @resources"),
                               "sched_setscheduler")
        self.assert_one_breach(self.breaches_with("[Install]", "RestrictRealtime=yes\n[Install]"), "SCHED_FIFO")

    def test_refuses_what_hides_arms(self):
        self.assert_one_breach(self.breaches_with("[Install]", "PrivateDevices=yes\n[Install]"), "hides")
        self.assert_one_breach(self.breaches_with("DeviceAllow=char-hidraw rw\n", ""), "char-hidraw")
        self.assert_one_breach(self.breaches_with("Wants=modprobe@hid.service ", "Wants="), "Wants=")

    def test_refuses_a_service_without_bounds(self):
        for line in ("WatchdogSec=3", "LimitRTTIME=500ms", "MemoryMax=2G"):
            with self.subTest(line):
                key = line.partition("=")[0]
                self.assert_one_breach(self.breaches_with(line + "\n", ""), key)
                self.assert_one_breach(self.breaches_with(line + "\n", f"{key}=infinity\n"), key)

    def test_refuses_other_hosts_as_shipped(self):
        breaches = self.breaches_with("[Install]", "IPAddressAllow=192.0.2.0/24\n[Install]")
        self.assertTrue(any("other hosts" in breach for breach in breaches), breaches)

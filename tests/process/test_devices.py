"""`thimble devices`, without a daemon and with one."""

import json

from rig import HELLO, ProcessTest


class Devices(ProcessTest):
    def test_needs_no_daemon(self):
        result = self.run_program("thimble", "devices", "--socket", self.folder / "none")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("sim:phantom-vintage", result.stdout)
        self.assertIn("no daemon is running", result.stdout)
        self.assertNotIn("in use by", result.stdout)

    def test_says_what_the_daemon_uses(self):
        daemon = self.start(config=HELLO)
        self.assertIn("in use by right", self.thimble(daemon, "devices").stdout)
        document = json.loads(self.thimble(daemon, "devices", "--json").stdout)
        used = [entry["address"] for entry in document["devices"] if entry["users"]]
        self.assertEqual(used, ["sim:phantom-vintage"])


class EveryArm(ProcessTest):
    def test_is_driven_and_shows_its_gimbal_where_it_has_one(self):
        for model in ("premium-1.5", "aluhaptics-2", "polhem-1"):
            with self.subTest(model=model):
                daemon = self.start("--set", f"arm.0.device=sim:{model}", config=HELLO, name=model)
                status = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
                arm = status["arms"][0]
                self.assertEqual(arm["model"], model)
                has_gimbal = model == "polhem-1"
                self.assertEqual(len(arm["gimbal_rad"]), 3 if has_gimbal else 0)
                self.assertEqual(has_gimbal, "gimbal" in self.thimble(daemon, "status").stdout)
                self.assertEqual(daemon.stop(), 0)

    def test_is_driven_on_bare_usb_too(self):
        daemon = self.start("--set", "arm.0.device=sim:falcon-loaded", config=HELLO)
        status = daemon.status_when(lambda s: s["arms"][0]["state"] == "active")
        self.assertEqual(status["arms"][0]["model"], "falcon")
        self.assertEqual(daemon.stop(), 0)

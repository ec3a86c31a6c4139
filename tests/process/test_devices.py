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

"""A driver that was built outside the tree, loaded by the real daemon."""

import json
import shutil
import subprocess

from rig import SAMPLE, ProcessTest

GANTRY = """
[daemon]
plugins = ["{plugin}"]
[[arm]]
name = "right"
device = "sim:gantry"
world = "box"
[arm.hand]
motion = "explore"
seed = 1
[[world]]
name = "box"
source = "box:3"
"""


class Plugins(ProcessTest):
    def setUp(self):
        super().setUp()
        # The build tree may be writable by a group, which the loader refuses.
        self.plugin = self.folder / "sample_driver.so"
        shutil.copyfile(SAMPLE, self.plugin)
        self.plugin.chmod(0o644)

    def configuration(self, plugin=None):
        return GANTRY.format(plugin=plugin or self.plugin)

    def refusal(self, plugin):
        file = self.write("thimble.toml", self.configuration(plugin))
        result = self.thimbled("--config", file, "--check")
        self.assertEqual(result.returncode, 2, result.stderr)
        line = [words for words in result.stderr.splitlines() if "daemon.plugins" in words]
        self.assertEqual(len(line), 1, result.stderr)
        self.assertIn(f"{file}:3:11: daemon.plugins: {plugin}", line[0])
        return line[0]

    def test_the_sample_exports_one_name_and_needs_nothing_of_ours(self):
        names = subprocess.run(["nm", "-D", "--defined-only", str(SAMPLE)], check=True,
                               capture_output=True, text=True).stdout.split()[2::3]
        self.assertEqual(names, ["thimble_plugin_v0"])
        wanted = subprocess.run(["nm", "-D", "--undefined-only", str(SAMPLE)], check=True,
                                capture_output=True, text=True).stdout
        self.assertNotIn("thimble", wanted)

    def test_its_arm_is_felt(self):
        daemon = self.start(config=self.configuration())
        status = daemon.status_when(lambda s: s["arms"][0]["contacts"] > 0)
        arm = status["arms"][0]
        self.assertEqual((arm["device"], arm["model"]), ("sim:gantry", "gantry"))
        self.assertEqual((arm["state"], arm["calibration"], arm["faults"]), ("active", "ok", []))
        self.assertGreater(arm["peak_force_newton"], 0)
        self.assertEqual(daemon.stop(), 0)
        self.assertEqual(daemon.final_status()["arms"][0]["force_newton"], [0, 0, 0])

    def test_check_tries_it(self):
        file = self.write("thimble.toml", self.configuration())
        result = self.thimbled("--config", file, "--check")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_one_that_cannot_be_had_is_a_mistake_of_the_configuration(self):
        self.assertIn("no such file", self.refusal(self.folder / "none.so"))
        self.assertIn("cannot be loaded", self.refusal(self.write("text.so", "no object")))
        self.plugin.chmod(0o666)
        words = self.refusal(self.plugin)
        self.assertIn("chmod go-w", words)
        self.assertEqual(words.count(str(self.plugin)), 1, words)
        self.plugin.chmod(0o644)
        file = self.write("thimble.toml", self.configuration("sample_driver.so"))
        result = self.thimbled("--config", file, "--check")
        self.assertIn("expected absolute paths", result.stderr)

    def test_its_real_arm_is_looked_at(self):
        device = self.folder / "machine/sys/class/hidraw/hidraw0/device"
        device.mkdir(parents=True)
        (device / "uevent").write_text("HID_ID=0003:0000FFF0:00006A17\nHID_UNIQ=G1\n")
        # 13 bytes in, 8 bytes out (HID 1.11, section 6.2.2)
        (device / "report_descriptor").write_bytes(bytes.fromhex("7508950d8102 95089102"))
        machine = ("--root", self.folder / "machine", "--socket", self.folder / "none")
        for command, found in (("devices", "hid:G1"), ("doctor", "node /dev/hidraw0: ")):
            self.assertNotIn(found, self.run_program("thimble", command, *machine).stdout)
            told = self.run_program("thimble", command, *machine, "--plugin", self.plugin)
            self.assertIn(found, told.stdout)
        refused = self.run_program("thimble", "doctor", "--plugin", self.folder / "none.so")
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        self.assert_one_sentence(refused.stderr, "none.so", "no such file")

    def test_devices_lists_what_it_brings(self):
        listed = self.run_program("thimble", "devices", "--plugin", self.plugin, "--json",
                                  "--socket", self.folder / "none")
        self.assertEqual((listed.returncode, listed.stderr), (0, ""))
        usable = {entry["address"]: entry["usable"] for entry in json.loads(listed.stdout)["devices"]}
        self.assertEqual(usable.get("sim:gantry"), True)
        refused = self.run_program("thimble", "devices", "--plugin", self.folder / "none.so",
                                   "--socket", self.folder / "none")
        self.assertEqual(refused.returncode, 1)
        self.assert_one_sentence(refused.stderr, "none.so", "no such file")
        for command in ("devices", "doctor"):
            refused = self.run_program("thimble", command, "--plugin", "")
            self.assertEqual(refused.returncode, 1)
            self.assert_one_sentence(refused.stderr, "--plugin: the name of a file is expected, and it is empty")

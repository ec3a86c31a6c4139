"""docs/first-arm.md: each of its configurations is good, and each of its commands is one that there is."""

import re

from rig import ROOT, ProcessTest

PAGE = (ROOT / "docs/first-arm.md").read_text()
FIRMWARE = re.compile(r"there is no firmware at '[^']*nvent_firmware\.bin'")


class FirstArm(ProcessTest):
    def configurations(self):
        world, *arms = re.findall(r"^```toml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
        self.assertIn("[[world]]", world)
        self.assertEqual(len(arms), 4, "one of each kind of arm")
        return [arm + world for arm in arms]

    def test_each_configuration_is_good_but_for_the_file_that_a_person_brings(self):
        for number, text in enumerate(self.configurations()):
            with self.subTest(text):
                file = self.write(f"{number}.toml", text)
                result = self.thimbled("--config", file, "--check")
                lines = result.stderr.splitlines()
                if "\nfirmware = " in text:
                    self.assertEqual((result.returncode, len(lines)), (2, 1), result.stderr)
                    self.assertRegex(lines[0], FIRMWARE)
                else:
                    self.assertEqual(result.returncode, 0, result.stderr)
                    # What the page has in place of an address is doubted, and nothing else is.
                    copied = re.findall(r'^device = "(\w+:(?:SERIAL|PORT))"', text, re.MULTILINE)
                    self.assertEqual(len(lines), len(copied), result.stderr)
                    for line, device in zip(lines, copied):
                        self.assertIn(f"has the device {device}, which stands in the pages", line)
                self.assertIn("activate = false", text)

    def test_each_starts_without_its_arm_and_says_that_it_is_not_there(self):
        for number, text in enumerate(self.configurations()):
            daemon = self.start(config=text, name=str(number))
            arm = daemon.status()["arms"][0]
            self.assertEqual(arm["state"], "lost")
            self.assertIn("no device at", arm["instruction"])
            self.assertEqual(daemon.stop(), 0)

    def test_each_command_of_thimble_is_one(self):
        commands = set(re.findall(r"(?:^    |`)thimble ([a-z-]+)", PAGE, re.MULTILINE))
        self.assertLessEqual({"devices", "doctor", "status", "watch", "activate", "calibrate-force"}, commands)
        listed = self.run_program("thimble", "--help").stdout.split("Subcommands:\n")[1]
        for command in commands:
            self.assertRegex(listed, rf"(?m)^  {command}\b")

"""The life of the packages on a machine: installed, upgraded, removed, purged."""

import pathlib
import re
import subprocess
import tempfile

import guest
import guest_states


CONFIGURATION = "/etc/thimble/thimble.toml"
FALCON = "usb:v0403pCB48d0600"
LATER = "9.0"
LATER_LINE = "# of a later version"
LATER_DEBS = "/run/debs/later-{}.deb"
NAMES = ("thimbled", "thimble", "libthimble-dev")


def repacked(package, to):
    """The package as it is, of a later version; where it has our configuration, with another one."""
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder, "tree")
        subprocess.run(["dpkg-deb", "-R", package, tree], check=True)
        control = tree / "DEBIAN" / "control"
        control.write_text(re.sub(r"^Version: .*$", f"Version: {LATER}", control.read_text(), flags=re.MULTILINE))
        configuration = tree / CONFIGURATION.lstrip("/")
        if configuration.exists():
            configuration.write_text(f"{configuration.read_text()}{LATER_LINE}\n")
        # Not packed: that is dear to undo.
        subprocess.run(["dpkg-deb", "--root-owner-group", "-Znone", "-b", tree, to], check=True, stdout=subprocess.DEVNULL)


class Package(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    @classmethod
    def setUpClass(cls):
        # The share has those that were built, and each of them of a later version.
        share = tempfile.TemporaryDirectory()
        cls.addClassCleanup(share.cleanup)
        pathlib.Path(share.name).chmod(0o755)
        for name in NAMES:
            deb = next(guest.DEBS.glob(f"{name}_*.deb"))
            pathlib.Path(share.name, deb.name).write_bytes(deb.read_bytes())
            repacked(deb, pathlib.Path(share.name, pathlib.Path(LATER_DEBS.format(name)).name))
        cls.guest = guest_states.start_bare(share.name)
        cls.addClassCleanup(cls.guest.close)
        cls.of_the_guest = cls.called_after_us()

    def state(self, package="thimbled"):
        return self.guest.ask(f"dpkg-query -W -f '${{db:Status-Status}}' {package}")[1]

    def dpkg(self, words):
        return self.guest.run(f"DEBIAN_FRONTEND=noninteractive dpkg {words}", timeout_s=300)

    def upgrade(self, *names):
        """To the later version, with which the daemon runs. A person who is asked something presses return."""
        words = self.dpkg(f"-i {' '.join(LATER_DEBS.format(name) for name in names)} < <(yes '')")
        self.assertEqual(self.guest.run(f"dpkg-query -W -f '${{Version}} ' {' '.join(names)}").split(), len(names) * [LATER])
        self.guest.wait_for("systemctl is-active thimbled")
        return words

    def configuration(self, suffix=""):
        return self.guest.run(f"cat {CONFIGURATION}{suffix}").splitlines()

    def of_the_hwdb(self):
        """What udev knows by our words alone: the public list has no Falcon."""
        return self.guest.run(f"systemd-hwdb query {FALCON} | grep -i falcon || true")

    @classmethod
    def called_after_us(cls):
        """All that is, on the disk and in /run."""
        return set(cls.guest.run("find / /run -xdev -iname '*thimble*'").split())

    def left(self):
        return sorted(self.called_after_us() - self.of_the_guest)

    def test_1_installation_starts_and_enables_the_service(self):
        words = self.guest.install(*NAMES)
        self.assertNotRegex(words, r"(?i)error|warning|failed")
        self.assertEqual(self.guest.run("dpkg --audit"), "")
        self.assertEqual(self.guest.run("systemctl is-enabled thimbled; systemctl is-active thimbled").split(),
                         ["enabled", "active"])
        self.assertIn("Novint Falcon", self.of_the_hwdb())

    def test_2_users_and_folders_are_those_of_the_decision(self):
        self.assertEqual(self.guest.run("stat -c '%U:%G %a' /var/lib/thimble /run/thimble /run/thimble/thimble.sock").splitlines(),
                         ["thimble:thimble-users 750", "thimble:thimble-users 750", "thimble:thimble-users 660"])
        # Whoever talks to the daemon owns no node; the daemon alone is in the group of the nodes.
        self.assertEqual(self.guest.run("getent group thimble thimble-users | cut -d: -f1,4").split(),
                         ["thimble:", "thimble-users:"])
        self.assertEqual(self.guest.run("getent passwd thimble | cut -d: -f7").strip(), "/usr/sbin/nologin")

    def test_3_what_people_read_is_there(self):
        for path in ("man1/thimble.1.gz", "man5/thimble.toml.5.gz", "man8/thimbled.8.gz"):
            self.assertIn(f"/usr/share/man/{path}", self.guest.run("dpkg -L thimble thimbled"))
        self.guest.run("test -r /usr/share/bash-completion/completions/thimble -a -r /usr/include/thimble/plugin_abi.h")
        self.guest.run("thimbled --check --config /usr/share/doc/thimble/examples/hello-voxel.toml")

    def test_4_an_upgrade_keeps_the_persons_configuration_and_starts_the_new_one(self):
        self.guest.run(f"echo '# mine' >> {CONFIGURATION}; touch /var/lib/thimble/recording")
        mine = self.configuration()
        before = self.properties("MainPID")
        words = self.upgrade(*NAMES)
        # Both differ, so dpkg asks; its own answer is to keep, and what it did not take it leaves beside.
        self.assertIn(f"Configuration file '{CONFIGURATION}'", words)
        self.assertNotRegex(words, r"(?i)error|failed|not found")
        self.assertEqual(self.configuration(), mine)
        self.assertEqual(self.configuration(".dpkg-dist"), [*mine[:-1], LATER_LINE])
        self.assertEqual(self.guest.run("ls /etc/thimble").split(), ["thimble.toml", "thimble.toml.dpkg-dist"])
        self.assertEqual(self.guest.run("dpkg --audit"), "")
        self.assertNotEqual(self.properties("MainPID"), before)

    def test_5_removal_stops_the_service_and_keeps_what_is_the_persons(self):
        self.dpkg("-r thimbled")
        self.assertEqual(self.state(), "config-files")
        self.assertEqual(self.guest.run("pgrep -c thimbled || true").strip(), "0")
        self.guest.run("test -e /etc/thimble/thimble.toml -a -e /var/lib/thimble/recording")
        self.guest.run("! ls /lib/udev/rules.d/ | grep thimble")
        # Nor does anything of it go on: no unit, no process, no socket, no word of its in udev's data base.
        self.assertEqual(self.guest.run("systemctl list-units --all --no-legend --plain 'thimble*' | grep -v ' not-found ' || true"), "")
        self.assertEqual(self.guest.run("pgrep -a thimble || true"), "")
        self.assertEqual(self.guest.run("ls -d /run/thimble* 2> /dev/null || true"), "")
        self.assertEqual(self.of_the_hwdb(), "")

    def test_6_a_purge_leaves_nothing_but_the_users(self):
        self.dpkg("-P thimbled")
        self.assertNotIn(self.state(), ("installed", "config-files"))
        self.assertEqual([path for path in self.left() if "thimbled" in path], [])
        self.guest.run("! test -e /etc/thimble -o -e /var/lib/thimble")
        self.guest.run("id thimble")

    def test_7_it_can_be_installed_anew_and_upgraded_without_the_others(self):
        self.dpkg("-P thimble libthimble-dev")
        words = self.guest.install("thimbled")
        self.guest.wait_for("systemctl is-active thimbled")
        words += self.upgrade("thimbled")
        self.assertNotRegex(words, r"(?i)error|warning|failed|not found")
        self.assertEqual(self.guest.run("dpkg --audit"), "")
        self.guest.run("! command -v thimble")
        # Who changed nothing is not asked, and has the new one.
        self.assertEqual(self.configuration()[-1], LATER_LINE)
        self.assertEqual(self.guest.run("ls /etc/thimble").split(), ["thimble.toml"])

    def test_8_it_can_be_removed_and_purged_without_them(self):
        words = self.dpkg("-r thimbled")
        self.assertEqual(self.state(), "config-files")
        words += self.dpkg("-P thimbled")
        self.assertNotIn(self.state(), ("installed", "config-files"))
        self.assertNotRegex(words, r"(?i)error|warning|failed|not found")
        # Users and groups stay, by name in files that are others'.
        self.assertEqual(self.left(), [])

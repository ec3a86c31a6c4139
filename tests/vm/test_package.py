"""The life of the packages on a machine: installed, upgraded, removed, purged."""

import pathlib
import re
import subprocess
import tempfile

import guest
import guest_states


def repacked(package, version, folder):
    """The package as it is, with another version."""
    tree = pathlib.Path(folder, "tree")
    subprocess.run(["dpkg-deb", "-R", package, tree], check=True)
    control = tree / "DEBIAN" / "control"
    control.write_text(re.sub(r"^Version: .*$", f"Version: {version}", control.read_text(), flags=re.MULTILINE))
    # Not packed: that is dear to undo.
    subprocess.run(["dpkg-deb", "--root-owner-group", "-Znone", "-b", tree, folder], check=True, stdout=subprocess.DEVNULL)


class Package(guest.GuestTest):
    """Numbered: each test goes on where the one before it ended."""

    @classmethod
    def setUpClass(cls):
        # The share has another thimbled beside those that were built: of a later version.
        share = tempfile.TemporaryDirectory()
        cls.addClassCleanup(share.cleanup)
        pathlib.Path(share.name).chmod(0o755)
        for deb in guest.DEBS.glob("*.deb"):
            pathlib.Path(share.name, deb.name).symlink_to(deb)
        later = tempfile.TemporaryDirectory()
        cls.addClassCleanup(later.cleanup)
        repacked(next(guest.DEBS.glob("thimbled_*.deb")), "9.0", later.name)
        for deb in pathlib.Path(later.name).glob("*.deb"):
            pathlib.Path(share.name, "later.deb").write_bytes(deb.read_bytes())
        for link in pathlib.Path(share.name).iterdir():
            if link.is_symlink():
                data = link.read_bytes()
                link.unlink()
                link.write_bytes(data)
        cls.guest = guest_states.start_bare(share.name)
        cls.addClassCleanup(cls.guest.close)

    def state(self, package="thimbled"):
        return self.guest.ask(f"dpkg-query -W -f '${{db:Status-Status}}' {package}")[1]

    def dpkg(self, words):
        return self.guest.run(f"DEBIAN_FRONTEND=noninteractive dpkg {words}", timeout_s=300)

    def upgrade(self):
        """Of the daemon, to the later version, with which it runs."""
        words = self.dpkg("-i /run/debs/later.deb")
        self.assertEqual(self.guest.run("dpkg-query -W -f '${Version}' thimbled"), "9.0")
        self.guest.wait_for("systemctl is-active thimbled")
        return words

    def test_1_installation_starts_and_enables_the_service(self):
        words = self.guest.install("thimbled", "thimble", "libthimble-dev")
        self.assertNotRegex(words, r"(?i)error|warning|failed")
        self.assertEqual(self.guest.run("dpkg --audit"), "")
        self.assertEqual(self.guest.run("systemctl is-enabled thimbled; systemctl is-active thimbled").split(),
                         ["enabled", "active"])

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

    def test_4_an_upgrade_keeps_the_configuration_and_starts_the_new_one(self):
        self.guest.run("echo '# mine' >> /etc/thimble/thimble.toml; touch /var/lib/thimble/recording")
        before = self.properties("MainPID")
        self.upgrade()
        self.guest.run("grep -qx '# mine' /etc/thimble/thimble.toml")
        self.assertNotEqual(self.properties("MainPID"), before)

    def test_5_removal_stops_the_service_and_keeps_what_is_the_persons(self):
        self.dpkg("-r thimbled")
        self.assertEqual(self.state(), "config-files")
        self.assertEqual(self.guest.run("pgrep -c thimbled || true").strip(), "0")
        self.guest.run("test -e /etc/thimble/thimble.toml -a -e /var/lib/thimble/recording")
        self.guest.run("! ls /lib/udev/rules.d/ | grep thimble")

    def test_6_a_purge_leaves_nothing_but_the_users(self):
        self.dpkg("-P thimbled")
        self.assertNotIn(self.state(), ("installed", "config-files"))
        left = self.guest.run("find / -xdev \\( -path /proc -o -path /sys \\) -prune -o -name '*thimbled*' -print | "
                              "grep -v -e /usr/share/doc -e /var/log -e ^/run || true")
        self.assertEqual(left.strip(), "")
        self.guest.run("! test -e /etc/thimble -o -e /var/lib/thimble")
        self.guest.run("id thimble")

    def test_7_it_can_be_installed_anew_and_upgraded_without_the_others(self):
        self.dpkg("-P thimble libthimble-dev")
        words = self.guest.install("thimbled")
        self.guest.wait_for("systemctl is-active thimbled")
        words += self.upgrade()
        self.assertNotRegex(words, r"(?i)error|warning|failed|not found")
        self.assertEqual(self.guest.run("dpkg --audit"), "")
        self.guest.run("! command -v thimble")

    def test_8_it_can_be_removed_and_purged_without_them(self):
        words = self.dpkg("-r thimbled")
        self.assertEqual(self.state(), "config-files")
        words += self.dpkg("-P thimbled")
        self.assertNotIn(self.state(), ("installed", "config-files"))
        self.assertNotRegex(words, r"(?i)error|warning|failed|not found")

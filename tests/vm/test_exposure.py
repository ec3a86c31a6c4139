"""systemd's own judgement of the service as it is installed and loaded."""

import re

import guest

MAX_EXPOSURE = 1.5


class Exposure(guest.GuestTest):
    pace = guest.COUNTED

    def exposure(self):
        text = self.guest.run("systemd-analyze security --no-pager thimbled.service")
        return float(re.search(r"Overall exposure level for thimbled\.service: ([0-9.]+)", text).group(1))

    def test_is_at_most_what_is_promised_as_shipped(self):
        self.assertLessEqual(self.exposure(), MAX_EXPOSURE)

    def test_systemd_understands_every_line_of_the_unit(self):
        self.assertEqual(self.guest.run("systemd-analyze verify --man=no thimbled.service 2>&1").strip(), "")

    def test_the_drop_in_for_other_hosts_lets_in_whom_it_names(self):
        self.guest.run("install -D -m 0644 /usr/share/doc/thimbled/examples/thimbled-lan.conf "
                       "/etc/systemd/system/thimbled.service.d/lan.conf; systemctl daemon-reload")
        allowed = self.guest.run("systemctl show thimbled -p IPAddressAllow")
        self.assertIn("192.0.2.7", allowed)
        self.assertIn("127.0.0.0/8", allowed)
        self.guest.run("rm /etc/systemd/system/thimbled.service.d/lan.conf; systemctl daemon-reload")

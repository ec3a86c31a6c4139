"""systemd's own judgement of the service as it is installed and loaded."""

import re

import guest

MAX_EXPOSURE = 1.5
OTHER_HOST = "192.0.2.7"  # the one that the drop-in names
DROP_IN = "/etc/systemd/system/thimbled.service.d/lan.conf"
INSTALL = f"install -D -m 0644 /usr/share/doc/thimbled/examples/thimbled-lan.conf {DROP_IN}; systemctl daemon-reload"
REMOVE = f"rm {DROP_IN}; systemctl daemon-reload"
PORT = 5001
ANSWER_BYTES = 13
SERVED = f"""
[[world]]
name = "served"
source = "box:3"
listen = "udp://0.0.0.0:{PORT}"
allow_unauthenticated = true
peer = "{{peer}}"
"""


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
        self.guest.run(INSTALL)
        allowed = self.guest.run("systemctl show thimbled -p IPAddressAllow")
        self.assertIn(OTHER_HOST, allowed)
        self.assertIn("127.0.0.0/8", allowed)
        self.guest.run(REMOVE)

    def answer(self, sender):
        """How many bytes a world sends back whose configuration lets that one in, and nobody else."""
        self.guest.run(f"cat > /etc/thimble/thimble.toml <<'E'\n{SERVED.format(peer=sender)}E\nsystemctl restart thimbled")
        return int(self.guest.call("ask_world", sender, "127.0.0.1", str(PORT)))

    def test_no_other_host_is_answered_before_the_drop_in_lets_it_in(self):
        self.guest.run(f"ip address add {OTHER_HOST}/32 dev lo")
        self.assertEqual(self.answer("127.0.0.1"), ANSWER_BYTES)
        self.assertEqual(self.answer(OTHER_HOST), 0)
        self.guest.run(INSTALL)
        self.assertEqual(self.answer(OTHER_HOST), ANSWER_BYTES)
        self.guest.run(REMOVE)

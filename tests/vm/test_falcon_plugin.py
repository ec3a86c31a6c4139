"""The Falcon's own driver as a shared object, which the packaged daemon loads in place of the one that it was built with: the same as in test_falcon.py and lets_go.py."""

import arms
import test_falcon
import test_guard


class FalconOfAPlugin(test_falcon.Falcon):
    way = "usb"

    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, arms.plugin(cls.guest))

    def test_0_the_daemon_has_the_object_loaded_and_complains_of_nothing(self):
        self.guest.wait_for("systemctl is-active thimbled")
        self.guest.run(f"grep -q {arms.PLUGIN} /proc/$(systemctl show thimbled -p MainPID --value)/maps")
        self.assertNotIn("plugin", self.guest.run("journalctl --no-pager --output cat -u thimbled"))


class LetGoByItsGuard(test_guard.Falcon):
    @classmethod
    def plug_in(cls):
        return arms.Falcon(cls.guest, arms.plugin(cls.guest))

"""test_boot.py, under Debian's PREEMPT_RT kernel."""

import test_boot


class BootRt(test_boot.Boot):
    kernel = "rt-amd64"

    def test_the_kernel_is_the_real_time_one(self):
        self.assertIn("PREEMPT_RT", self.guest.run("uname -v"))


del test_boot

"""test_boot.py, under Debian's PREEMPT_RT kernel."""

import test_boot


class BootRt(test_boot.Boot):
    kernel = "rt-amd64"
    # Whatever the kernel.
    test_its_sandbox_and_limits_are_what_makes_the_difference = None
    test_one_whose_configuration_is_wrong_fails_at_once_and_says_why = None

    def test_the_kernel_is_the_real_time_one(self):
        self.assertIn("PREEMPT_RT", self.guest.run("uname -v"))


del test_boot

"""The same as in test_plug_cycles.py with an arm on a serial port."""

import arms
import guest
import plugs

CYCLES = 3  # of each block


class Serial(plugs.PlugCycles, guest.GuestTest):
    def test_an_arm_on_a_serial_port(self):
        self.plug_often(arms.TextArm(self.guest), CYCLES)

"""The same as in test_plug_cycles.py with a Falcon and an arm on a serial port."""

import arms
import guest
import plugs

CYCLES = 3  # of each block


class Kinds(plugs.PlugCycles, guest.GuestTest):
    def test_a_falcon(self):
        """Pulled out while it is given its firmware."""
        self.plug_often(arms.Falcon(self.guest), CYCLES)

    def test_an_arm_on_a_serial_port(self):
        self.plug_often(arms.TextArm(self.guest), CYCLES)

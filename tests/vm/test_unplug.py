"""unplugged.py, on the USB stack, where an arm that comes has a USB device to be configured and opened, too."""

import simdev
import unplugged


class UnpluggedFromUsb(unplugged.Unplugged):
    way = "usb"

    def plug(self):
        return *super().plug(), ("run", simdev.RAISE_CARRIERS)

"""A device that plays recorded reports, one for each that it is sent, offered to the guest's kernel: tests/vm/replay."""

import simdev

PROGRAM = "/run/bin/vm_replay"
SERIAL = "VM-TAPE-1"


class Tape:
    """Use as a context manager. `arm`: phantom or falcon; `way`: uhid or usb. `address`: how it is called there, `node`: where it is."""

    def __init__(self, guest, arm, way):
        self.guest = guest
        guest.run("systemd-run --quiet --collect --unit tape "
                  "-p CPUSchedulingPolicy=fifo -p CPUSchedulingPriority=85 "
                  f"{PROGRAM} offer {arm} {way}")
        if arm == "falcon":
            guest.wait_for("grep -lx cb48 /sys/bus/usb/devices/*/idProduct")
            self.address, self.node = guest.wait_for("thimble devices | grep -o 'usb:[^ ]*'").split()[0], "-"
        else:
            found = guest.wait_for("ls -d /sys/bus/hid/devices/0003:1234:0006.*/hidraw/hidraw*").strip()
            self.address, self.node = f"hid:{SERIAL}", f"/dev/{found.rsplit('/', 1)[1]}"
        guest.run(f"{simdev.RAISE_CARRIERS}; udevadm settle")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.guest.run("systemctl stop tape")
        self.guest.wait_for("! ls /sys/bus/hid/devices /sys/bus/usb/devices/*/idProduct | grep 1234:0006; ! grep -qx cb48 /sys/bus/usb/devices/*/idProduct")

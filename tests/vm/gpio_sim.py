"""A GPIO chip of the kernel's own gpio-sim in the guest, whose driver tells edges, and what its lines are wired to: a contact to ground each, closed at first."""

LOAD = "modprobe configfs; mountpoint -q /sys/kernel/config || mount -t configfs none /sys/kernel/config; insmod /usr/lib/thimble-vm/gpio_sim.ko"
LINES = 8


def load(guest):
    """The module, which is not Debian's (decision 0517)."""
    guest.run(LOAD)


class Chip:
    def __init__(self, guest, label):
        self.guest = guest
        self.device = f"/sys/kernel/config/gpio-sim/{label}"
        guest.run(f"mkdir -p {self.device}/bank0; cd {self.device}; echo {LINES} > bank0/num_lines; echo {label} > bank0/label")
        self.folder = self.guest.run(f"cd {self.device}; echo 1 > live; echo /sys/devices/platform/$(cat dev_name)/$(cat bank0/chip_name); udevadm settle").strip()

    def opens(self, line, is_open=True):
        """For Guest.steps(): prints when."""
        return "write", f"{self.folder}/sim_gpio{line}/pull", "pull-up" if is_open else "pull-down"

    def beats(self, line, seconds=1):
        """For Guest.steps(): prints how often it changed meanwhile."""
        return "beats", f"{self.folder}/sim_gpio{line}/value", seconds

    def release(self, *lines):
        self.guest.steps(*(self.opens(line, False) for line in lines))


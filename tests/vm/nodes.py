"""Who may open a node of the guest: what its udev made of it."""


def under(guest, folder):
    """Of a device's folder of sysfs: its own node and all below it."""
    names = guest.run(f"find {folder}/ -name uevent -exec sed -n 's/^DEVNAME=//p' {{}} + | sort -u").split()
    return [f"/dev/{name}" for name in names]


def rights(guest, node):
    return guest.run(f"stat -c '%U:%G %a' {node}").strip()


def tags(guest, node):
    """Those that it ever had, too."""
    said = guest.run(f"udevadm info --query=property --property=TAGS --property=CURRENT_TAGS --value {node}")
    return {tag for line in said.split() for tag in line.strip(":").split(":")}


def is_given_to_the_seat(guest, node):
    """Whether udev has the builtin run that gives it to whoever sits there; the guest has no seat to see it by."""
    return "run: 'uaccess'" in guest.run(f"udevadm test --action=add /sys$(udevadm info --query=path {node}) 2>&1")


def assert_closed(test, guest, node):
    """For the daemon and for nobody else, as the rules have it for all that can make a force."""
    test.assertEqual(rights(guest, node), "root:thimble 660", node)
    said = tags(guest, node)
    test.assertIn("systemd", said, node)
    test.assertNotIn("uaccess", said, node)
    test.assertFalse(is_given_to_the_seat(guest, node), node)

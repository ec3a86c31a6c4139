#!/usr/bin/env python3
"""Rules of udev/: nobody but the daemon may open what makes a force, and each id that a driver knows has its rules.

udevadm of Debian 12 cannot check a file of rules; whether the kernel's events meet them is tested in the guest
(tests/vm).
"""

import pathlib
import re

import cpp_source

FOLDER = "udev/"
# Whoever sits at the machine may have these: they make no force. The sheet of facts, 3.9.
PUCKS = {("046d", product) for product in
         "c603 c605 c606 c621 c623 c625 c626 c627 c628 c629 c62b c640".split()} | {
    ("256f", product) for product in "c62e c62f c631 c632 c633 c635 c636 c638 c63a c652".split()}
# Behind 70-*.rules, which add the tag uaccess; before 73-seat-late.rules, which acts on it.
_NAME = re.compile(r"7[12]-[a-z-]+\.rules")
_TOKEN = re.compile(r'\s*([A-Z]+)(\{[^}"]+\})?\s*(==|!=|\+=|-=|:=|=)\s*"([^"]*)"\s*(,|$)')
_MATCH_KEYS = {"ACTION", "SUBSYSTEM", "SUBSYSTEMS", "KERNEL", "KERNELS", "ENV", "ATTR", "ATTRS", "TAG"}
_SET_KEYS = {"OWNER", "GROUP", "MODE", "TAG", "ENV", "ATTR", "GOTO", "LABEL"}
_HID_NAME = re.compile(r"[0-9A-F]{4}:([0-9A-F]{4}):([0-9A-F]{4})\.\*")
_ID = re.compile(r"[0-9a-f]{4}")
# Nodes that stand for no device of an id.
NO_ID = {"cpu_dma_latency"}
_WIRE_ID = re.compile(r"\bk(\w*)(Vendor|Product)Id\s*=\s*0x([0-9a-fA-F]{4})\b")


class Rule:
    """One line as lists of (key, attribute, operator, value)."""

    def __init__(self, line):
        self.tokens = []
        self.rest = line
        while self.rest:
            token = _TOKEN.match(self.rest)
            if not token:
                return
            self.tokens.append((token.group(1), (token.group(2) or "")[1:-1], token.group(3), token.group(4)))
            self.rest = self.rest[token.end():]

    def values(self, key, operators, attribute=None):
        return [value for name, of, operator, value in self.tokens
                if name == key and operator in operators and attribute in (None, of)]

    def matches(self, key, attribute=None):
        return self.values(key, ("==",), attribute)

    def sets(self, key):
        return self.values(key, ("=", ":=", "+="))

    def gives_rights(self):
        return bool(self.sets("MODE") or self.sets("GROUP") or self.sets("OWNER") or "uaccess" in self.sets("TAG"))

    def ids(self):
        """(vendor, product) pairs it matches; None where a half is missing or is a pattern."""
        vendors = self.matches("ATTR", "idVendor") + self.matches("ATTRS", "idVendor")
        products = self.matches("ATTR", "idProduct") + self.matches("ATTRS", "idProduct")
        if vendors or products:
            if len(vendors) != 1 or len(products) != 1 or not all(map(_ID.fullmatch, vendors + products)):
                return None
            return [(vendors[0], products[0])]
        names = [name for value in self.matches("KERNELS") for name in value.split("|")]
        found = [_HID_NAME.fullmatch(name) for name in names]
        if not found or not all(found):
            return None
        return [(match.group(1).lower(), match.group(2).lower()) for match in found]


def check_force_rule(rule):
    """What is wrong with a rule for what makes a force."""
    if rule.values("MODE", (":=",)) != ["0660"]:
        return 'a force device needs MODE:="0660"'
    if rule.values("GROUP", (":=",)) != ["thimble"] or rule.values("OWNER", (":=",)) != ["root"]:
        return 'a force device needs OWNER:="root", GROUP:="thimble"'
    if "uaccess" in rule.sets("TAG"):
        return "a force device with uaccess: whoever sits at the machine would go around the limiter"
    if "uaccess" not in rule.values("TAG", ("-=",)):
        return 'a force device needs TAG-="uaccess": other rules may have added it'
    if rule.matches("SUBSYSTEM") == ["usb"] and rule.values("ATTR", ("=",), "power/control") != ["on"]:
        return 'needs ATTR{power/control}="on": a suspended arm answers late'
    if rule.matches("SUBSYSTEM") == ["tty"] and rule.values("ENV", ("=",), "ID_MM_DEVICE_IGNORE") != ["1"]:
        return 'needs ENV{ID_MM_DEVICE_IGNORE}="1": ModemManager writes to ports it does not know'
    return ""


def check_rule(rule):
    """What is wrong with a rule, and the ids that it covers."""
    if rule.rest:
        return f"cannot be read from here: {rule.rest[:40]}", []
    for key, _, operator, _ in rule.tokens:
        if key not in (_MATCH_KEYS if operator in ("==", "!=") else _SET_KEYS):
            return f"{key} {operator} is not used here; check_udev.py names the keys that are", []
    for mode in rule.sets("MODE"):
        if not re.fullmatch(r"0[0-7][0-7]0", mode):
            return f"mode {mode}: others must have no right", []
    if not rule.gives_rights():
        return "", []
    if rule.matches("KERNEL") and set(rule.matches("KERNEL")) <= NO_ID:
        return "", []
    ids = rule.ids()
    if ids is None:
        return ("needs one whole id: idVendor and idProduct in lower case, or KERNELS with BUS:VENDOR:PRODUCT.* in "
                "upper case; a vendor's other devices are none of ours"), []
    if "systemd" not in rule.sets("TAG"):
        return 'needs TAG+="systemd"', []
    pucks = [pair in PUCKS for pair in ids]
    if any(pucks):
        return ("" if all(pucks) else "a puck and something else in one rule"), ids
    return check_force_rule(rule), ids


def check_file(path, text, breaches):
    """{(subsystem, vendor, product)} of a file."""
    name = pathlib.PurePosixPath(path).name
    if not _NAME.fullmatch(name):
        breaches.append(f"{path}: its name must sort behind 70-uaccess.rules and before 73-seat-late.rules: 72-thimble.rules")
    covered = set()
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        rule = Rule(line.strip())
        wrong, ids = check_rule(rule)
        if wrong:
            breaches.append(f"{path}:{number}: {wrong}")
        covered |= {(subsystem, *pair) for subsystem in rule.matches("SUBSYSTEM") for pair in ids}
    return covered


def driver_ids(root, paths):
    """{(vendor, product): file} that the drivers' facts name."""
    ids = {}
    for path in paths:
        if not re.fullmatch(r"drivers/\w+/\w+_wire\.hpp", path):
            continue
        halves = {}
        for name, half, value in _WIRE_ID.findall(cpp_source.read(root, path)):
            halves.setdefault(name, {})[half] = value.lower()
        for pair in halves.values():
            if len(pair) == 2:
                ids[(pair["Vendor"], pair["Product"])] = path
    return ids


def check(root):
    paths = cpp_source.tree_files(root)
    files = [path for path in paths if path.startswith(FOLDER) and path.endswith(".rules")]
    breaches = []
    covered = set()
    for path in files:
        covered |= check_file(path, cpp_source.read(root, path), breaches)
    for (vendor, product), path in sorted(driver_ids(root, paths).items()):
        known = {subsystem for subsystem, *pair in covered if pair == [vendor, product]}
        if not known & {"hidraw", "usb", "tty"}:
            breaches.append(f"{path}: {vendor}:{product} has no rule; add one to {FOLDER}72-thimble.rules")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

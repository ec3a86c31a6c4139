#!/usr/bin/env python3
"""Rules of udev/: nobody but the daemon may open what makes a force, and each id that a driver knows has its rules. Its hwdb: none of them sleeps.

udevadm of Debian 12 cannot check a file of rules; whether the kernel's events meet them is tested in the guest
(tests/vm).
"""

import pathlib
import re
import tomllib

import cpp_source

FOLDER = "udev/"
# Whoever sits at the machine may have these: they make no force. The sheet of facts, 3.9.
PUCKS = {("046d", product) for product in
         "c603 c605 c606 c621 c623 c625 c626 c627 c628 c629 c62b c640".split()} | {
    ("256f", product) for product in "c62e c62f c631 c632 c633 c635 c636 c638 c63a c652".split()}
# Rights come first of all files: of several ":=" the first counts. Tags are taken away just before 73-seat-late.rules
# acts on them. Attributes are written at once: the last file has the last word.
RIGHTS_FILE = "0-thimble.rules"
TAGS_FILE = "73-seat-ignores-thimble.rules"
AWAKE_FILE = "99-zz-thimble-awake.rules"
_TOKEN = re.compile(r'\s*([A-Z]+)(\{[^}"]+\})?\s*(==|!=|\+=|-=|:=|=)\s*"([^"]*)"\s*(,|$)')
_MATCH_KEYS = {"ACTION", "SUBSYSTEM", "SUBSYSTEMS", "KERNEL", "KERNELS", "ENV", "ATTR", "ATTRS", "TAG"}
_SET_KEYS = {"OWNER", "GROUP", "MODE", "TAG", "ENV", "ATTR", "GOTO", "LABEL"}
_HID_NAME = re.compile(r"\*:([0-9A-F]{4}):([0-9A-F]{4})\.\*")
_ID = re.compile(r"[0-9a-f]{4}")
# Nodes that stand for no device of an id.
NO_ID = {"cpu_dma_latency"}
# Serial over ACM, which ModemManager tries.
ACM = {("16c0", "0483")}
# After 60-autosuspend*.hwdb of systemd: of several files the last one counts.
HWDB_FILE = "61-thimble.hwdb"
_HWDB_MATCH = re.compile(r"usb:v([0-9A-F]{4})p([0-9A-F]{4})\*")
_HWDB_PROPERTY = re.compile(r" ([A-Z_]+)=(\S.*)")
_HWDB_KEYS = {"ID_AUTOSUSPEND", "ID_MODEL_FROM_DATABASE"}
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
        return bool(self.sets("MODE") or self.sets("GROUP") or self.sets("OWNER"))

    def is_way(self):
        """To the end of its file, or that end."""
        return bool(self.sets("GOTO") or self.sets("LABEL"))

    def is_awake(self):
        return self.values("ATTR", ("=",), "power/control") == ["on"]

    def parent(self):
        """The kind of the parent that has the id: usb, hid."""
        return "".join(self.matches("SUBSYSTEMS") or self.matches("SUBSYSTEM"))

    def ids(self):
        """(vendor, product) pairs it matches; None where a half is missing or is a pattern."""
        vendors = self.matches("ATTR", "idVendor") + self.matches("ATTRS", "idVendor")
        products = self.matches("ATTR", "idProduct") + self.matches("ATTRS", "idProduct")
        if vendors or products:
            products = [product for value in products for product in value.split("|")]
            if len(vendors) != 1 or not products or not all(map(_ID.fullmatch, vendors + products)):
                return None
            return [(vendors[0], product) for product in products]
        names = [name for value in self.matches("KERNELS") for name in value.split("|")]
        found = [_HID_NAME.fullmatch(name) for name in names]
        if not found or not all(found):
            return None
        return [(match.group(1).lower(), match.group(2).lower()) for match in found]


def check_force_rule(rule):
    """What is wrong with a rule for the nodes of what makes a force."""
    if rule.values("MODE", (":=",)) != ["0660"]:
        return 'a force device needs MODE:="0660"'
    if rule.values("GROUP", (":=",)) != ["thimble"] or rule.values("OWNER", (":=",)) != ["root"]:
        return 'a force device needs OWNER:="root", GROUP:="thimble"'
    if "uaccess" in rule.sets("TAG"):
        return "a force device with uaccess: whoever sits at the machine would go around the limiter"
    if rule.matches("SUBSYSTEM"):
        return f"holds for SUBSYSTEM {rule.matches('SUBSYSTEM')[0]} only: every node of a force device must be closed; SUBSYSTEMS"
    return ""


def check_awake_rule(rule, name):
    """What is wrong with a rule that sets attributes, or that stands where only such ones do."""
    if name != AWAKE_FILE:
        return f"attributes belong in {AWAKE_FILE}: a later file of another's would undo them"
    if not rule.is_awake() or rule.gives_rights() or rule.sets("TAG"):
        return 'needs ATTR{power/control}="on", and nothing else'
    if rule.matches("SUBSYSTEM") != ["usb"] or rule.matches("ENV", "DEVTYPE") != ["usb_device"]:
        return 'needs SUBSYSTEM=="usb", ENV{DEVTYPE}=="usb_device": what is suspended is the device'
    return "" if rule.ids() else "needs one whole id: a vendor's other devices may sleep"


def check_rule(rule, name):
    """What is wrong with a rule of the file of that name."""
    if rule.rest:
        return f"cannot be read from here: {rule.rest[:40]}"
    for key, _, operator, _ in rule.tokens:
        if key not in (_MATCH_KEYS if operator in ("==", "!=") else _SET_KEYS):
            return f"{key} {operator} is not used here; check_udev.py names the keys that are"
    for mode in rule.sets("MODE"):
        if not re.fullmatch(r"0[0-7][0-7]0", mode):
            return f"mode {mode}: others must have no right"
    if rule.sets("ATTR") or name == AWAKE_FILE and not rule.is_way():
        return check_awake_rule(rule, name)
    if not rule.gives_rights() and not rule.sets("TAG"):
        return ""
    if rule.matches("KERNEL") and set(rule.matches("KERNEL")) <= NO_ID:
        return ""
    ids = rule.ids()
    if ids is None:
        return ("needs one whole id: idVendor and idProduct in lower case, or KERNELS with *:VENDOR:PRODUCT.* in upper case; a "
                "vendor's other devices are none of ours")
    if rule.gives_rights() != (name == RIGHTS_FILE):
        return f"rights belong in {RIGHTS_FILE}, the end of tags in {TAGS_FILE}"
    if not rule.gives_rights():
        return "" if rule.values("TAG", ("=",)) == ["systemd"] else 'needs TAG="systemd": what "-=" takes away still matches'
    if not any(pair in PUCKS for pair in ids):
        return check_force_rule(rule)
    if not all(pair in PUCKS for pair in ids):
        return "a puck and something else in one rule"
    return "" if rule.values("TAG", ("+=",)) == ["uaccess", "systemd"] else 'a puck needs TAG+="uaccess", TAG+="systemd"'


class Covered:
    """What the rules of all files are about: sets of (kind of parent, vendor, product)."""

    def __init__(self):
        self.closed = {}  # with the place of the rule
        self.untagged = set()
        self.awake = set()
        self.unprobed = set()
        self.pucks = {}  # (vendor, product), with the place of the rule
        self.awake_pucks = set()

    def add(self, rule, place):
        pucks = [pair for pair in rule.ids() or () if pair in PUCKS]
        if rule.gives_rights():
            self.pucks.update({pair: place for pair in pucks})
        keys = [(rule.parent(), *pair) for pair in rule.ids() or () if pair not in PUCKS]
        if rule.gives_rights():
            self.closed.update({key: place for key in keys})
        if rule.values("TAG", ("=",)):
            self.untagged.update(keys)
        if rule.is_awake():
            self.awake.update(keys)
            self.awake_pucks.update(pucks)
        if rule.values("ENV", ("=",), "ID_MM_DEVICE_IGNORE") == ["1"]:
            self.unprobed.update(keys)

    def check(self, breaches):
        for key, place in sorted(self.closed.items()):
            words = " ".join(key)
            if key not in self.untagged:
                breaches.append(f"{place}: {words} is not in {TAGS_FILE}: another's rule may give it to whoever sits there (uaccess)")
            if key[0] == "usb" and key not in self.awake:
                breaches.append(f'{place}: {words} needs ATTR{{power/control}}="on" in {AWAKE_FILE}: a suspended arm answers late')
            if key[0] == "usb" and key[1:] in ACM and key not in self.unprobed:
                breaches.append(f'{place}: {words} needs ENV{{ID_MM_DEVICE_IGNORE}}="1": ModemManager writes to ports it does not know')
        for pair, place in sorted(self.pucks.items()):
            if pair not in self.awake_pucks:
                breaches.append(f'{place}: usb {" ".join(pair)} needs ATTR{{power/control}}="on" in {AWAKE_FILE}: a suspended puck loses the first touch')
        for key in sorted(self.untagged - set(self.closed)):
            breaches.append(f"{FOLDER}{TAGS_FILE}: {' '.join(key)} has no rights in {RIGHTS_FILE}")
        for pair in sorted({key[1:] for key in self.awake - set(self.closed)} | self.awake_pucks - set(self.pucks)):
            breaches.append(f"{FOLDER}{AWAKE_FILE}: {' '.join(pair)} has no rights in {RIGHTS_FILE}")


def check_file(path, text, covered, breaches):
    name = pathlib.PurePosixPath(path).name
    if name not in (RIGHTS_FILE, TAGS_FILE, AWAKE_FILE):
        breaches.append(f"{path}: would sort wrongly: {RIGHTS_FILE} comes before whatever others bring, {TAGS_FILE} just before "
                        f"73-seat-late.rules, {AWAKE_FILE} behind all")
        return
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        rule = Rule(line.strip())
        wrong = check_rule(rule, name)
        if wrong:
            breaches.append(f"{path}:{number}: {wrong}")
        else:
            covered.add(rule, f"{path}:{number}")


class Hwdb:
    """A file of properties by id, as hwdb(7) has it: matches, then properties, then an empty line."""

    def __init__(self, path, breaches):
        self.path = path
        self.breaches = breaches
        self.awake = set()  # (vendor, product) whose suspension is turned off
        self.ids = []  # of the record that is being read
        self.properties = {}

    def read(self, text):
        for number, line in enumerate(text.splitlines(), 1):
            if line.startswith("#"):
                continue
            match, said = _HWDB_MATCH.fullmatch(line), _HWDB_PROPERTY.fullmatch(line)
            if not line:
                self.end_record()
            elif match and not self.properties:
                self.ids.append((match.group(1).lower(), match.group(2).lower()))
            elif said and self.ids and said.group(1) in _HWDB_KEYS:
                self.properties[said.group(1)] = said.group(2)
            else:
                self.breaches.append(f"{self.path}:{number}: is neither usb:vVVVVpPPPP* in upper case, nor a property that is used here, nor "
                                     "the empty line before the next record")
        self.end_record()

    def end_record(self):
        if self.properties.get("ID_AUTOSUSPEND") == "0":
            self.awake.update(self.ids)
        self.ids, self.properties = [], {}


def awake_by_hwdb(root, paths, breaches):
    awake = set()
    for path in paths:
        if pathlib.PurePosixPath(path).name != HWDB_FILE:
            breaches.append(f"{path}: would sort wrongly: {HWDB_FILE} comes after systemd's 60-autosuspend")
            continue
        hwdb = Hwdb(path, breaches)
        hwdb.read(cpp_source.read(root, path))
        awake |= hwdb.awake
    return awake


def check_hwdb(covered, awake, breaches):
    closed = {key[1:] for key in covered.closed if key[0] == "usb"} | set(covered.pucks)
    for pair in sorted(closed - awake):
        breaches.append(f"{FOLDER}{HWDB_FILE}: {':'.join(pair)} needs ID_AUTOSUSPEND=0: another's entry would let it sleep")
    for pair in sorted(awake - closed):
        breaches.append(f"{FOLDER}{HWDB_FILE}: {':'.join(pair)} has no rights in {RIGHTS_FILE}")


def table_ids(text):
    """(vendor, product) of each model of a table that has them."""
    for model in tomllib.loads(text).values():
        if isinstance(model.get("vendor_id"), dict):
            yield tuple(f"{model[half]['value']:04x}" for half in ("vendor_id", "product_id"))


def driver_ids(root, paths):
    """{(vendor, product): file} that the drivers' facts name."""
    ids = {}
    for path in paths:
        if re.fullmatch(r"drivers/\w+/\w+_models\.toml", path):
            ids.update({pair: path for pair in table_ids(cpp_source.read(root, path))})
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
    covered = Covered()
    for path in files:
        check_file(path, cpp_source.read(root, path), covered, breaches)
    awake = awake_by_hwdb(root, [path for path in paths if path.startswith(FOLDER) and path.endswith(".hwdb")], breaches)
    if not breaches:  # else a rule that is wrong would be missed here, too
        covered.check(breaches)
        check_hwdb(covered, awake, breaches)
    closed = {key[1:] for key in covered.closed}
    for pair, path in sorted(driver_ids(root, paths).items()):
        if pair not in closed and pair not in covered.pucks:
            breaches.append(f"{path}: {':'.join(pair)} has no rule; add it to all files of {FOLDER}")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

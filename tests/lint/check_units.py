#!/usr/bin/env python3
"""A bare number says its unit in its name, or is listed as a number without one (units.txt).

Looked at: every double and float (also in std::array, optional, span, vector, atomic) that the headers
of the product (but hal/base) name, and the number keys of docs/configuration.md.
"""

import re

import cpp_source

# Mathematics, and the strong types that carry the units of what is built of them.
EXEMPT_FOLDERS = ("hal/base/",)
UNITS_FILE = "tests/lint/units.txt"
CONFIGURATION_PAGE = "docs/configuration.md"

_DECLARATION = re.compile(
    r"\b(?:(?:std::)?(?:optional|array|span|vector|atomic|pair)\s*<[^;{}()]*?\b(?:double|float)\b[^;{}()]*?>"
    r"|(?:double|float)\b)[\s&*]+(?P<name>[A-Za-z_]\w*)")
# A row whose third column, the values, begins with a number: "above 0 up to 1", "500 to 8000".
_KEY = re.compile(r"^\|\s*`(?P<name>[a-z0-9_.]+)`\s*\|[^|\n]*\|\s*(?:above\s+)?-?\d", re.MULTILINE)


def rules(text):
    """(units as suffixes, names that have none); each line of units.txt is `unit NAME` or `none NAME`."""
    units, unitless = set(), set()
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        if len(words) < 2 or words[0] not in ("unit", "none"):
            raise SystemExit(f"{UNITS_FILE}: not `unit NAME…` or `none NAME…`: {line}")
        (units if words[0] == "unit" else unitless).update(words[1:])
    return units, unitless


def has_unit(name, units, unitless):
    """`name` as declared: a trailing _ of a member and a leading k of a constant do not count."""
    words = re.sub(r"^k(?=[A-Z])", "", name).rstrip("_")
    words = "_" + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", words).lower()
    return any(words.endswith("_" + ending) for ending in units | unitless)


def declared_numbers(text):
    """(offset, name) of each number that a header names."""
    code = cpp_source.without_comments(text)
    for match in _DECLARATION.finditer(code):
        name = match.group("name")
        if name in ("operator", "const", "constexpr"):
            continue
        yield match.start("name"), name


def check(root):
    units, unitless = rules(cpp_source.read(root, UNITS_FILE))
    breaches = []
    mend = (f"end it in its unit (_m, _s, _hz, _newton …) or, if it has none, list it in {UNITS_FILE} "
            "with a reason")
    for path in cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS):
        if not path.endswith(".hpp") or path.startswith(EXEMPT_FOLDERS):
            continue
        text = cpp_source.read(root, path)
        for offset, name in declared_numbers(text):
            if not has_unit(name, units, unitless):
                breaches.append(f"{path}:{cpp_source.line_of(text, offset)}: the number '{name}' has no "
                                f"unit in its name; {mend}")
    if (root / CONFIGURATION_PAGE).exists():
        text = cpp_source.read(root, CONFIGURATION_PAGE)
        for match in _KEY.finditer(text):
            key = match.group("name").split(".")[-1]
            if not has_unit(key, units, unitless):
                breaches.append(f"{CONFIGURATION_PAGE}:{cpp_source.line_of(text, match.start())}: the key "
                                f"'{key}' has no unit in its name; {mend}")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

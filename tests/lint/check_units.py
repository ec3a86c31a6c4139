#!/usr/bin/env python3
"""A bare number says its unit in its name, or is listed as a number without one (units.txt).

Looked at: every double and float (also in std::array, optional, span, vector, atomic) that the headers
of the product (but hal/base) name, and the number keys of docs/configuration.md.
"""

import fnmatch
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
    """(units as suffixes, names without as suffixes, {file pattern: whole names without}); each line of units.txt
    is `unit NAME…`, `none NAME…` or `PATTERN: NAME…`."""
    units, unitless, special = set(), set(), {}
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        if len(words) >= 2 and words[0] in ("unit", "none"):
            (units if words[0] == "unit" else unitless).update(words[1:])
        elif len(words) >= 2 and words[0].endswith(":"):
            special.setdefault(words[0][:-1], set()).update(words[1:])
        else:
            raise SystemExit(f"{UNITS_FILE}: not `unit NAME…`, `none NAME…` or `PATTERN: NAME…`: {line}")
    return units, unitless, special


def plain(name):
    """`name` in small letters; a trailing _ of a member and a leading k of a constant do not count."""
    words = re.sub(r"^k(?=[A-Z])", "", name).rstrip("_")
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", words).lower()


def has_unit(name, units, unitless):
    """A unit stands behind something that has it: `a` alone is no ampere. A word for what has none may stand alone."""
    words = plain(name)
    return (any(words.endswith("_" + unit) or words == unit and "_" in unit for unit in units)
            or any(("_" + words).endswith("_" + ending) for ending in unitless))


def declared_numbers(text):
    """(offset, name) of each number that a header names."""
    code = cpp_source.without_comments(text)
    for match in _DECLARATION.finditer(code):
        name = match.group("name")
        if name in ("operator", "const", "constexpr"):
            continue
        yield match.start("name"), name


def numbers(root):
    """(path, line, kind, name) of each number that is looked at."""
    for path in cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS):
        if path.endswith(".hpp") and not path.startswith(EXEMPT_FOLDERS):
            text = cpp_source.read(root, path)
            for offset, name in declared_numbers(text):
                yield path, cpp_source.line_of(text, offset), "number", name
    if (root / CONFIGURATION_PAGE).exists():
        text = cpp_source.read(root, CONFIGURATION_PAGE)
        for match in _KEY.finditer(text):
            yield (CONFIGURATION_PAGE, cpp_source.line_of(text, match.start()), "key",
                   match.group("name").split(".")[-1])


def check(root):
    units, unitless, special = rules(cpp_source.read(root, UNITS_FILE))
    unused = {(pattern, name) for pattern, names in special.items() for name in names}
    breaches = []
    for path, line, kind, name in numbers(root):
        listed = {(pattern, plain(name)) for pattern, names in special.items()
                  if plain(name) in names and fnmatch.fnmatchcase(path, pattern)}
        unused -= listed
        if not listed and not has_unit(name, units, unitless):
            breaches.append(f"{path}:{line}: the {kind} '{name}' has no unit in its name; end it in its unit "
                            "(_m, _s, _hz, _newton …) or, if it has none, list it in "
                            f"{UNITS_FILE} with a reason")
    breaches += [f"{UNITS_FILE}: no number of {pattern} is called '{name}'; remove it from the list"
                 for pattern, name in sorted(unused)]
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

#!/usr/bin/env python3
"""No dead example: each is told of, used, and finds its files; no page names one that is not there.

That each one loads and passes `thimbled --check` is tested by running it (Examples, process.lifecycle).
"""

import pathlib
import re

import cpp_source

FOLDER = "examples/"
LIST = "examples/README.md"
# What may speak of an example by its path, and so may speak of one that is gone.
SPEAKERS = (".md", ".py", ".cpp", ".hpp", ".txt", ".1", ".5", ".8", ".toml", ".yml")
# A place where an example is put to use: the demo, a test, a page that a person follows.
USERS = ("run", "README.md", "tests/", "docs/", "bench/")

_MENTION = re.compile(r"(?<![\w/.-])examples/(?P<name>[\w.-]*\w)")


def names_in(text, names):
    return {name for name in names if re.search(rf"(?<![\w.-]){re.escape(name)}(?![\w-])", text)}


def check_listed(names, told, breaches):
    listed = {name for line in told.splitlines() if line.startswith("|")
              for name in re.findall(r"`([\w.-]+\.\w+)`", line)}
    for name in sorted(set(names) - listed):
        breaches.append(f"{FOLDER}{name}: {LIST} does not list it; add what it is for, or remove it")
    for name in sorted(listed - set(names)):
        breaches.append(f"{LIST}: {name} does not exist; remove it from the table")


def check_used(root, paths, names, breaches):
    used = set()
    for path in paths:
        if path.startswith(USERS) and not path.startswith("tests/lint/"):
            used |= names_in(cpp_source.read(root, path), names)
    configurations = [name for name in names if name.endswith(".toml")]
    for name in configurations:
        if name not in used:
            breaches.append(f"{FOLDER}{name}: dead: nothing but {FOLDER} speaks of it; test it, show it "
                            "in a page, or remove it")
    for name in set(names) - set(configurations):
        others = (cpp_source.read(root, FOLDER + other) for other in names if other != name)
        if not any(names_in(text, [name]) for text in others):
            breaches.append(f"{FOLDER}{name}: dead: no configuration needs it; remove it")


def check_mentions(root, paths, names, breaches):
    for path in paths:
        # The lints' own tests plant what is not there.
        if not (path.endswith(SPEAKERS) or path == "run") or path.startswith("tests/lint/"):
            continue
        text = cpp_source.read(root, path)
        for match in _MENTION.finditer(text):
            if match.group("name") not in names and match.group("name") != "README.md":
                breaches.append(f"{path}:{cpp_source.line_of(text, match.start())}: {match.group(0)} "
                                "does not exist; name one that does")


def check(root):
    paths = cpp_source.tree_files(root)
    names = [pathlib.PurePosixPath(path).name for path in paths
             if path.startswith(FOLDER) and path != LIST]
    if not names:
        return []
    breaches = []
    check_listed(names, cpp_source.read(root, LIST), breaches)
    check_used(root, paths, names, breaches)
    check_mentions(root, paths, names, breaches)
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

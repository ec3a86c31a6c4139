#!/usr/bin/env python3
"""What a build needs is said twice, in `run` for a checkout and in debian/control for a package: the same list.

What an installed text names is installed: programs, manual pages, units, rules, examples and the pages in debian/*.install may name
a page (docs/NAME.md) or an example only where a package brings it; pages may lead to each other only within what is installed.
"""

import fnmatch
import pathlib
import posixpath
import re

import cpp_source

# What only one of the two has to name: a compiler is there wherever packages are built; the packages' own tools.
OF_A_CHECKOUT = {"g++"}
OF_A_PACKAGE = {"debhelper-compat"}
# Whose words reach a person who has only the packages.
PROGRAMS = ("hal", "drivers", "sim", "daemon", "cli", "guard", "board")
INSTALLED = re.compile(r"(docs/man/[^/]+\.[158]|systemd/[^/]+\.(service|socket|conf)|udev/[^/]+\.(rules|hwdb)|examples/[^/]+\.toml)")
PAGE = re.compile(r"(?<![\w./-])(?:[a-z]+/)+[\w.-]+\.md\b")
EXAMPLE = re.compile(r"(?<![\w./-])examples/[\w.-]+\w")
DECISIONS = "docs/decisions"
# "decision 0498", "decisions 0493, 0494": of what those pages rest on in turn, the source has the rest.
NUMBERS = re.compile(r"\bdecisions? (\d{4}(?:(?:, | and | to )\d{4})*)")
LINK = re.compile(r"\[[^]\n]*\]\((?!https?:)([^)#\s]+)[^)\s]*\)")


def of_run(text):
    match = re.search(r"^readonly build_packages=\(([^)]*)\)", text, re.MULTILINE)
    return set(match.group(1).split()) if match else set()


def of_control(text):
    match = re.search(r"^Build-Depends:((?:.*\n)(?:[ \t].*\n)*)", text, re.MULTILINE)
    names = re.sub(r"\([^)]*\)", "", match.group(1)).split(",") if match else []
    return {name.strip().split(":")[0] for name in names if name.strip()}


def lists_of_packages(root):
    checkout = of_run(cpp_source.read(root, "run"))
    package = of_control(cpp_source.read(root, "debian/control"))
    breaches = [f"{path}: its list of packages for a build is empty or not where this lint looks"
                for path, names in (("run", checkout), ("debian/control", package)) if not names]
    if breaches:
        return breaches
    breaches += [f"run: build_packages lacks {name}, a Build-Depends of debian/control: a bare machine cannot build"
                 for name in sorted(package - checkout - OF_A_PACKAGE)]
    breaches += [f"debian/control: Build-Depends lacks {name}, of build_packages in run: a package cannot be built"
                 for name in sorted(checkout - package - OF_A_CHECKOUT)]
    return breaches


def patterns(root, files):
    """What debhelper's lists of files name, as patterns of the source."""
    return [line.split()[0] for path in files if re.fullmatch(r"debian/[\w-]+\.(install|docs|examples)", path)
            for line in cpp_source.read(root, path).splitlines() if line.strip() and not line.startswith("#")]


def is_brought(name, brought):
    return any(fnmatch.fnmatch(name, pattern) or name.startswith(pattern + "/") for pattern in brought)


def literals(text):
    """Comments blanked: what is left of a path in a C++ file stands in a string, or in an #include."""
    return re.sub(r"^\s*#\s*include.*$", "", cpp_source.without_comments(text, keep_strings=True), flags=re.MULTILINE)


def named_in(path, text):
    """(line, name in the source) of each page and example that the text names."""
    if path.endswith(".md"):
        for match in LINK.finditer(text):
            yield (cpp_source.line_of(text, match.start()),
                   posixpath.normpath(posixpath.join(posixpath.dirname(path), match.group(1))))
        text = LINK.sub("", text)  # none spans lines
    for pattern in (PAGE, EXAMPLE):
        for match in pattern.finditer(text):
            yield cpp_source.line_of(text, match.start()), match.group(0)


def texts_that_are_installed(root, files, brought):
    for path in files:
        if path.endswith(cpp_source.CPP_SUFFIXES) and path.split("/")[0] in PROGRAMS:
            yield path, literals(cpp_source.read(root, path))
        elif INSTALLED.fullmatch(path) or (path.endswith(".md") and is_brought(path, brought)):
            yield path, cpp_source.read(root, path)


def names_that_lead_nowhere(root):
    files = cpp_source.tree_files(root)
    brought = patterns(root, files)
    if not any(pattern.startswith("docs/") for pattern in brought):
        return ["debian: no package brings any page of docs, or not where this lint looks"]
    breaches = []
    for path, text in texts_that_are_installed(root, files, brought):
        for line, name in sorted(set(named_in(path, text))):
            if not pathlib.Path(root, name).exists():
                breaches.append(f"{path}:{line}: there is no {name}")
            elif not is_brought(name, brought):
                breaches.append(f"{path}:{line}: names {name}, which no package brings: list it in debian/thimbled.install, "
                                "or name what is there")
    return breaches


def decisions_that_stay_behind(root):
    """Numbers in installed pages, but in the decisions themselves."""
    files = cpp_source.tree_files(root)
    brought = patterns(root, files)
    pages = {path.rsplit("/", 1)[1][:4]: path for path in files if path.startswith(f"{DECISIONS}/")}
    for path, text in texts_that_are_installed(root, files, brought):
        if path.startswith(DECISIONS) or not path.endswith((".md", ".1", ".5", ".8")):
            continue
        for match in NUMBERS.finditer(text):
            for number in re.findall(r"\d{4}", match.group(1)):
                if not is_brought(pages.get(number, ""), brought):
                    yield (f"{path}:{cpp_source.line_of(text, match.start())}: names decision {number}, which no package brings: list it in "
                           "debian/thimbled.install, or leave the number out")


def check(root):
    return lists_of_packages(root) + names_that_lead_nowhere(root) + list(decisions_that_stay_behind(root))


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

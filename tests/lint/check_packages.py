#!/usr/bin/env python3
"""What a build needs is said twice, in `run` for a checkout and in debian/control for a package: the same list."""

import re

import cpp_source

# What only one of the two has to name: a compiler is there wherever packages are built; the packages' own tools.
OF_A_CHECKOUT = {"g++"}
OF_A_PACKAGE = {"debhelper-compat"}


def of_run(text):
    match = re.search(r"^readonly build_packages=\(([^)]*)\)", text, re.MULTILINE)
    return set(match.group(1).split()) if match else set()


def of_control(text):
    match = re.search(r"^Build-Depends:((?:.*\n)(?:[ \t].*\n)*)", text, re.MULTILINE)
    names = re.sub(r"\([^)]*\)", "", match.group(1)).split(",") if match else []
    return {name.strip().split(":")[0] for name in names if name.strip()}


def check(root):
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


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

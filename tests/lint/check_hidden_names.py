#!/usr/bin/env python3
"""A source file names no constant as a header of its namespace in its folder does.

Several files of a folder are compiled as one. There the constant of an unnamed namespace is seen by the files behind it, too, and they
silently mean that one where they want the header's.
"""

import pathlib
import re

import cpp_source

_NAMESPACE = re.compile(r"^namespace ([\w:]+)(?: =|\s*\{)", re.MULTILINE)
_CONSTANT = re.compile(r"^(?:inline |static )*(?:constexpr|const) [\w:<>, *&]*?\b(k[A-Z]\w*)\s*[{=\[]", re.MULTILINE)


def _constants(root, path):
    """The namespace of a file, and of its constants at the margin {name: line}."""
    code = cpp_source.without_comments(cpp_source.read(root, path))
    spaces = _NAMESPACE.findall(code)
    return spaces[0] if spaces else "", {match.group(1): cpp_source.line_of(code, match.start(1)) for match in _CONSTANT.finditer(code)}


def check(root):
    told, breaches = {}, []
    paths = cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS + ("tests",))
    for path in paths:
        if path.endswith(".cpp"):
            continue
        space, names = _constants(root, path)
        for name in names:
            told[str(pathlib.PurePosixPath(path).parent), space, name] = path
    for path in paths:
        if not path.endswith(".cpp"):
            continue
        space, names = _constants(root, path)
        for name, line in names.items():
            header = told.get((str(pathlib.PurePosixPath(path).parent), space, name))
            if header is not None:
                breaches.append(f"{path}:{line}: {name} is in {header}, too: a file that is compiled behind this one means this one; "
                                "name it otherwise")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

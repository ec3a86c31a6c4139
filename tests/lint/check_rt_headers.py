#!/usr/bin/env python3
"""Code that the tick runs, the `servo` files of rt_headers.txt, may include only the headers of that list.

A file that marks functions THIMBLE_RT is of them, or exempt by name.
"""

import fnmatch
import re

import cpp_source

LIST = "tests/lint/rt_headers.txt"
_INCLUDE = re.compile(r"^[ \t]*#[ \t]*include[ \t]*<([^>\n]+)>", re.MULTILINE)
_MARK = re.compile(r"^(?![ \t]*#).*\bTHIMBLE_RT(_IO)?\b", re.MULTILINE)


def rules(text):
    """({"servo" and "exempt": file patterns}, headers free everywhere, {file pattern: headers free only there})."""
    files, everywhere, special = {"servo": [], "exempt": []}, set(), {}
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if words and words[0] in files:
            files[words[0]] += words[1:]
        elif words and words[0].endswith(":"):
            special[words[0][:-1]] = set(words[1:])
        else:
            everywhere.update(words)
    return files, everywhere, special


def fits(path, patterns):
    return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)


def check(root):
    files, everywhere, special = rules(cpp_source.read(root, LIST))
    paths = cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS)
    named = files["servo"] + files["exempt"]
    breaches = [f"{LIST}: no file is {pattern}; mend or remove the pattern"
                for pattern in named + list(special) if not any(fits(path, [pattern]) for path in paths)]
    for path in paths:
        code = cpp_source.without_comments(cpp_source.read(root, path))
        if fits(path, files["servo"]):
            allowed = everywhere.union(*(headers for pattern, headers in special.items() if fits(path, [pattern])))
            breaches += _foreign_headers(path, code, allowed)
        elif not fits(path, files["exempt"]):
            breaches += _unnamed_marks(path, code)
    return breaches


def _foreign_headers(path, code, allowed):
    return [f"{path}:{cpp_source.line_of(code, match.start(1))}: <{match.group(1)}> is not allowed on the servo "
            "plane. Use hal/rt (static_vector, triple_buffer, spsc_ring) or do the work before the loop starts; "
            f"a header that is harmless there goes into {LIST} with a reason"
            for match in _INCLUDE.finditer(code) if match.group(1) not in allowed]


def _unnamed_marks(path, code):
    match = _MARK.search(code)
    if match is None:
        return []
    return [f"{path}:{cpp_source.line_of(code, match.start(0))}: THIMBLE_RT marks what a tick may run, and no "
            f"`servo` pattern of {LIST} names this file; add one, or exempt it with a reason"]


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

#!/usr/bin/env python3
"""Servo-plane code (hal/rt, daemon/servo) may include only the headers of rt_headers.txt."""

import fnmatch
import re

import cpp_source

SERVO_FOLDERS = ("hal/rt/", "daemon/servo/")
_INCLUDE = re.compile(r"^[ \t]*#[ \t]*include[ \t]*<([^>\n]+)>", re.MULTILINE)


def allowed_headers(text):
    """(headers free everywhere, {file pattern: headers free only there})."""
    everywhere, special = set(), {}
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if words and words[0].endswith(":"):
            special[words[0][:-1]] = set(words[1:])
        else:
            everywhere.update(words)
    return everywhere, special


def check(root):
    everywhere, special = allowed_headers(cpp_source.read(root, "tests/lint/rt_headers.txt"))
    breaches = []
    for path in cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS):
        if not path.startswith(SERVO_FOLDERS):
            continue
        allowed = everywhere.union(*(headers for pattern, headers in special.items()
                                     if fnmatch.fnmatch(path, pattern)))
        code = cpp_source.without_comments(cpp_source.read(root, path))
        for match in _INCLUDE.finditer(code):
            if match.group(1) not in allowed:
                breaches.append(
                    f"{path}:{cpp_source.line_of(code, match.start(1))}: <{match.group(1)}> is not "
                    "allowed on the servo plane. Use hal/rt (static_vector, triple_buffer, "
                    "spsc_ring) or do the work before the loop starts; a header that is harmless "
                    "there goes into tests/lint/rt_headers.txt with a reason")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

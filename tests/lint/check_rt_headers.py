#!/usr/bin/env python3
"""Code that the tick runs, the `servo` files of rt_headers.txt, may include only the headers of that list."""

import fnmatch
import re

import cpp_source

LIST = "tests/lint/rt_headers.txt"
_INCLUDE = re.compile(r"^[ \t]*#[ \t]*include[ \t]*<([^>\n]+)>", re.MULTILINE)


def rules(text):
    """(patterns of servo files, headers free everywhere, {file pattern: headers free only there})."""
    servo, everywhere, special = [], set(), {}
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if words and words[0] == "servo":
            servo += words[1:]
        elif words and words[0].endswith(":"):
            special[words[0][:-1]] = set(words[1:])
        else:
            everywhere.update(words)
    return servo, everywhere, special


def fits(path, patterns):
    return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)


def check(root):
    servo, everywhere, special = rules(cpp_source.read(root, LIST))
    paths = [path for path in cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS) if fits(path, servo)]
    breaches = [f"{LIST}: no file of the servo plane is {pattern}; mend or remove the pattern"
                for pattern in servo + list(special) if not any(fits(path, [pattern]) for path in paths)]
    for path in paths:
        allowed = everywhere.union(*(headers for pattern, headers in special.items() if fits(path, [pattern])))
        code = cpp_source.without_comments(cpp_source.read(root, path))
        for match in _INCLUDE.finditer(code):
            if match.group(1) not in allowed:
                breaches.append(
                    f"{path}:{cpp_source.line_of(code, match.start(1))}: <{match.group(1)}> is not "
                    "allowed on the servo plane. Use hal/rt (static_vector, triple_buffer, "
                    "spsc_ring) or do the work before the loop starts; a header that is harmless "
                    f"there goes into {LIST} with a reason")
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

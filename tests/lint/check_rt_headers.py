#!/usr/bin/env python3
"""Code that the tick runs, the `servo` files of rt_headers.txt, may include only the headers of that list.

A file that marks functions THIMBLE_RT is of them, or exempt by name.
"""

import fnmatch
import re

import cpp_source

LIST = "tests/lint/rt_headers.txt"
_INCLUDE = re.compile(r"^[ \t]*#[ \t]*include[ \t]*<([^>\n]+)>", re.MULTILINE)
_OWN_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+)"', re.MULTILINE)
_COMPUTED_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?![ \t<"])(.*)$', re.MULTILINE)
_MARK = re.compile(r"^(?![ \t]*#[ \t]*define[ \t]+THIMBLE_RT(?:_IO)?[ \t]*$).*\bTHIMBLE_RT(_IO)?\b", re.MULTILINE)


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
    reached = _reached(root, [path for path in paths if fits(path, files["servo"])], set(paths))
    for path in paths:
        code = cpp_source.without_comments(cpp_source.read(root, path), keep_strings=True)
        if path in reached:
            allowed = everywhere.union(*(headers for pattern, headers in special.items() if fits(path, [pattern])))
            breaches += _foreign_headers(path, code, allowed, reached[path])
        if not fits(path, named):
            breaches += _unnamed_marks(path, code)
    return breaches


def _reached(root, servo, known):
    """{path: the file that includes it, or None} of the servo files and of all that they include, however far."""
    reached = {path: None for path in servo}
    waiting = list(servo)
    while waiting:
        path = waiting.pop()
        code = cpp_source.without_comments(cpp_source.read(root, path), keep_strings=True)
        for name in _OWN_INCLUDE.findall(code):
            if name in known and name not in reached:
                reached[name] = path
                waiting.append(name)
    return reached


def _foreign_headers(path, code, allowed, included_by):
    through = "" if included_by is None else f" ({included_by} includes this file)"
    breaches = [f"{path}:{cpp_source.line_of(code, match.start(1))}: <{match.group(1)}> is not allowed on the servo "
                f"plane{through}. Use hal/rt (static_vector, triple_buffer, spsc_ring) or do the work before the loop "
                f"starts; a header that is harmless there goes into {LIST} with a reason"
                for match in _INCLUDE.finditer(code) if match.group(1) not in allowed]
    return breaches + [f"{path}:{cpp_source.line_of(code, match.start(1))}: an include that a macro names cannot be "
                       "read here; name the header" for match in _COMPUTED_INCLUDE.finditer(code)]


def _unnamed_marks(path, code):
    match = _MARK.search(code)
    if match is None:
        return []
    return [f"{path}:{cpp_source.line_of(code, match.start(0))}: THIMBLE_RT marks what a tick may run, and no "
            f"`servo` pattern of {LIST} names this file; add one, or exempt it with a reason"]


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

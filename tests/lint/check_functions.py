#!/usr/bin/env python3
"""Functions of at most 60 lines, files of at most 400, unless a comment says why not.

A waiver stands on the line before the function or inside it:  // lint: long-function <reason>
For a file, in its first comment:                              // lint: long-file <reason>
"""

import re

import cpp_source

MAX_FUNCTION_LINES = 60
MAX_FILE_LINES = 400
FOLDERS = cpp_source.PRODUCT_FOLDERS + ("tests",)

_NOT_A_FUNCTION = re.compile(
    r"^(?:(?:inline|export|static|constexpr|typedef|const)\s+)*(?:namespace|class|struct|union|enum|"
    r"extern\b(?!.*\))|requires|concept)\b")
_WAIVER = re.compile(r"//\s*lint: long-function[ \t]+\S")
_FILE_WAIVER = re.compile(r"(?://|#|\*)\s*lint: long-file[ \t]+\S")
_SPACE = re.compile(r"\s*")


def _without_preprocessor(code):
    return re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", lambda m: re.sub(r"[^\n]", " ", m.group(0)), code,
                  flags=re.MULTILINE)


def _is_function(head):
    head = head.strip()
    if ")" not in head or head.endswith(("=", "return", ",", "(")):
        return False
    head = re.sub(r"^(?:template\s*<[^{;]*?>\s*(?=\w))", "", head)
    return not _NOT_A_FUNCTION.match(head)


def functions(text):
    """(first line, last line) of every outermost function body; raises ValueError."""
    code = _without_preprocessor(cpp_source.without_comments(text))
    last_line, stack, boundary, inside = {}, [], 0, 0
    constructor = None  # start of a function whose braces so far may be its initialisers
    for offset, character in enumerate(code):
        if character == "{":
            head = code[boundary:offset].strip()
            start = _SPACE.match(code, boundary).end()
            if constructor is not None and (not head or head.startswith(",")):
                is_function, start = True, constructor
            else:
                is_function = not inside and _is_function(head)
            stack.append((is_function, start))
            inside += is_function
        elif character == "}":
            if not stack:
                raise ValueError(cpp_source.line_of(code, offset))
            is_function, start = stack.pop()
            inside -= is_function
            constructor = start if is_function else None
            if is_function:
                last_line[start] = offset
        elif character != ";":
            continue
        else:
            constructor = None
        boundary = offset + 1
    if stack:
        raise ValueError(cpp_source.line_of(code, len(code) - 1))
    return [(cpp_source.line_of(code, start), cpp_source.line_of(code, last))
            for start, last in last_line.items()]


def check_functions(path, text, breaches):
    lines = text.splitlines()
    try:
        found = functions(text)
    except ValueError as error:
        breaches.append(f"{path}:{error}: braces do not balance for this lint; keep whole blocks "
                        "inside each branch of an #if")
        return
    for first, last in found:
        length = last - first + 1
        nearby = "\n".join(lines[max(0, first - 2):last])
        if length > MAX_FUNCTION_LINES and not _WAIVER.search(nearby):
            breaches.append(
                f"{path}:{first}: function of {length} lines (limit {MAX_FUNCTION_LINES}); split it "
                "where its comments would start a new paragraph, or say why it must be long: "
                "// lint: long-function <reason>")


def check(root):
    breaches = []
    for path in cpp_source.cpp_files(root, FOLDERS):
        text = cpp_source.read(root, path)
        count = text.count("\n")
        if count > MAX_FILE_LINES and not _FILE_WAIVER.search("\n".join(text.splitlines()[:15])):
            breaches.append(
                f"{path}:1: file of {count} lines (limit {MAX_FILE_LINES}); split it by "
                "responsibility, or say why in its first comment: // lint: long-file <reason>")
        check_functions(path, text, breaches)
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

#!/usr/bin/env python3
"""Writes the manual page thimble.toml(5) from docs/configuration.md, which stays the one source.

Knows what that page is made of: headings, paragraphs, indented examples, tables, `code`, [links](…).
"""

import argparse
import pathlib
import re

_HEAD = '.TH THIMBLE.TOML 5 "" "Thimble" "File Formats"\n.SH NAME\nthimble.toml \\- configuration of thimbled\n'
_TAIL = ".SH SEE ALSO\n.BR thimbled (8),\n.BR thimble (1)\n"


def plain(text):
    """Text of troff: links without their targets, marks of Markdown gone, nothing taken for a request."""
    text = re.sub(r"\[([^\]]+)\]\([^)]*\)", r"\1", text)
    text = text.replace("\\", "\\e").replace("`", "").replace("-", "\\-")
    return re.sub(r"^(?=[.'])", r"\\&", text, flags=re.MULTILINE)


def row(cells):
    key, meaning, *rest = cells
    lines = [".TP", f".B {plain(key)}", plain(meaning) + "."]
    for name, cell in zip(("Values", "Default"), rest):
        lines += [".br", f"{name}: {plain(cell)}"]
    return lines


def block(text):
    """One paragraph, table, heading or example of Markdown, as lines of troff."""
    if text.startswith("#"):
        level, title = text.split(" ", 1)
        if level == "#":
            return [".SH DESCRIPTION"]
        return [(".SH " if level == "##" else ".SS ") + plain(title)]
    if text.startswith("|"):
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
        return [line for cells in rows[2:] for line in row(cells)]
    if text.startswith("    "):
        lines = [plain(line.strip()) for line in text.splitlines()]
        return [".PP", ".nf", ".RS", *lines, ".RE", ".fi"]
    return [".PP", plain(text)]


def page(markdown):
    blocks = [text.strip("\n") for text in re.split(r"\n{2,}", markdown) if text.strip()]
    return _HEAD + "\n".join(line for text in blocks for line in block(text)) + "\n" + _TAIL


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("markdown", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.output.write_text(page(arguments.markdown.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()

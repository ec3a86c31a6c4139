"""What the lints share: the files of the tree, and C++ text without comments and literals."""

import argparse
import os
import pathlib
import re
import sys

CPP_SUFFIXES = (".hpp", ".cpp", ".h")
PRODUCT_FOLDERS = ("hal", "drivers", "sim", "daemon", "cli", "guard", "lab", "bench")


def tree_files(root):
    """Every file below root, as sorted relative POSIX paths; not build/ and hidden folders."""
    found = []
    for folder, folders, names in os.walk(root):
        relative = pathlib.PurePosixPath(os.path.relpath(folder, root).replace(os.sep, "/"))
        folders[:] = sorted(
            name for name in folders
            if not name.startswith(".") and name != "__pycache__"
            and not (str(relative) == "." and name.startswith("build")))
        found += [str(relative / name) for name in names]
    return sorted(found)


def cpp_files(root, folders):
    return [path for path in tree_files(root)
            if path.endswith(CPP_SUFFIXES) and path.split("/")[0] in folders]


def read(root, path):
    return pathlib.Path(root, path).read_text(encoding="utf-8", errors="replace")


_TOKEN = re.compile(
    r'''//(?:\\\n|[^\n])*              # a line comment, with continued lines
      | /\*.*?(?:\*/|\Z)               # a block comment
      | R"(?P<tag>[^()\s\\]{0,16})\(.*?\)(?P=tag)"
      | "(?:\\.|[^"\\\n])*"
      | (?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'
    ''', re.VERBOSE | re.DOTALL)


def _blank(text):
    return re.sub(r"[^\n]", " ", text)


def without_comments(text, keep_strings=False):
    """The text with comments (and literals) blanked; every offset and line stays where it was."""
    def replace(match):
        token = match.group(0)
        if token.startswith("/"):
            return _blank(token)
        if keep_strings:
            return token
        if "\n" in token or len(token) < 2:
            return _blank(token)
        return token[0] + " " * (len(token) - 2) + token[-1]
    return _TOKEN.sub(replace, text)


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def run(check, description):
    """The main() of every lint: prints its breaches; exit status 1 when there are any."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parents[2])
    breaches = check(pathlib.Path(parser.parse_args().root))
    for breach in breaches:
        print(breach)
    if breaches:
        print(f"{len(breaches)} breach(es)")
    sys.exit(1 if breaches else 0)

"""What the lints share: the files of the tree, and C++ text without comments and literals."""

import argparse
import os
import pathlib
import re
import sys

CPP_SUFFIXES = (".hpp", ".cpp", ".h")
PRODUCT_FOLDERS = ("hal", "drivers", "sim", "daemon", "cli", "guard", "board", "lab", "bench")


def tree_files(root):
    """Every file below root, as sorted relative POSIX paths; not build/ and hidden folders. Raises OSError where a
    folder cannot be read: os.walk() alone would leave it out without a word."""
    def refuse(error):
        raise error

    found = []
    for folder, folders, names in os.walk(root, onerror=refuse):
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


def state_of(root):
    """{path: what changes when the file is written or replaced}."""
    found = {}
    for path in tree_files(root):
        info = os.lstat(pathlib.Path(root, path))
        found[path] = (info.st_mtime_ns, info.st_size, info.st_ino)
    return found


def checked(check, root):
    """The breaches of a tree that stood still: git replaces a file by removing it first, and a lint that read the
    tree meanwhile (or an editor's half of a file) would tell of what was never there."""
    try:
        before = state_of(root)
        breaches = check(root)
        after = state_of(root)
    except FileNotFoundError as error:
        return [f"{error.filename}: went away while this lint read the tree; run it again"]
    if not before:
        return [f"{root}: there is no file; name the tree with --root"]
    changed = sorted(path for path in before.keys() | after.keys() if before.get(path) != after.get(path))
    if changed:
        return [f"{changed[0]}: changed while this lint read the tree, and so did {len(changed) - 1} other file(s); "
                "run it again"]
    return breaches


def run(check, description):
    """The main() of every lint: prints its breaches; exit status 1 when there are any."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parents[2])
    breaches = checked(check, pathlib.Path(parser.parse_args().root))
    for breach in breaches:
        print(breach)
    if breaches:
        print(f"{len(breaches)} breach(es)")
    sys.exit(1 if breaches else 0)

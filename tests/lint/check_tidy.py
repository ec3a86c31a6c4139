#!/usr/bin/env python3
"""clang-tidy 14 with the tree's .clang-tidy over every product file of a compile database.

Files that are compiled together are read together: most of its time goes to the headers they share.
A file whose text, headers of this tree, flags and settings are those of an earlier clean run is
not read again: build/lint-cache holds one empty file per clean content hash.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import cpp_source

PROGRAM = "clang-tidy-14"
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+)"', re.MULTILINE)


def is_product(root, build, source):
    """Whether that is a file of the product, or one made by CMake that includes several of them."""
    place = next((place for place in (build, root) if source.is_relative_to(place)), None)
    return place is not None and source.relative_to(place).parts[0] in cpp_source.PRODUCT_FOLDERS


def product_commands(root, build):
    """(source, command line) of everything compiled of the product."""
    database = json.loads(pathlib.Path(build, "compile_commands.json").read_text(encoding="utf-8"))
    found = {}
    for entry in database:
        source = pathlib.Path(entry["directory"], entry["file"]).resolve()
        if is_product(root, build, source):
            found[os.path.relpath(source, root)] = entry["command"]
    return sorted(found.items())


def content_hash(root, build, source, command, checks=""):
    """Over the file, what it includes from this tree, the flags, the settings and the checks."""
    digest = hashlib.sha256(f"{command}\0{checks}".encode())
    digest.update(pathlib.Path(root, ".clang-tidy").read_bytes())
    waiting, seen = [source], set()
    while waiting:
        path = waiting.pop()
        if path in seen:
            continue
        seen.add(path)
        file = next((place for place in (pathlib.Path(root, path), pathlib.Path(build, path))
                     if place.is_file()), None)
        if file is None:
            continue
        text = file.read_text(encoding="utf-8", errors="replace")
        digest.update(f"{path}\0{text}\0".encode())
        waiting += sorted(_INCLUDE.findall(text))
    return digest.hexdigest()


def tidy(root, build, source, checks=""):
    """What clang-tidy says about one file; empty when it is clean."""
    only = [f"--checks=-*,{checks}"] if checks else []
    result = subprocess.run([PROGRAM, "-p", str(build), "--quiet", *only,
                             f"--config-file={root}/.clang-tidy", source], cwd=root,
                            capture_output=True, text=True, check=False)
    if result.returncode == 0:
        return ""
    said = "\n".join(line for line in result.stdout.splitlines()
                     if not line.startswith("Suppressed"))
    return said.strip() or result.stderr.strip()


def check(root, build, cache, checks=""):
    if not shutil.which(PROGRAM):
        return [f"{PROGRAM} is missing: apt-get install {PROGRAM}"]
    cache.mkdir(parents=True, exist_ok=True)
    work = []
    for source, command in product_commands(root, build):
        mark = cache / content_hash(root, build, source, command, checks)
        if not mark.exists():
            work.append((source, mark))
    breaches = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        said = pool.map(lambda item: tidy(root, build, item[0], checks), work)
        for (_, mark), words in zip(work, said):
            if words:
                breaches.append(words)
            else:
                mark.touch()
    if breaches:
        breaches.append("Mend: rename or rewrite as the check in [brackets] says (CONTRIBUTING.md, "
                        "names); only where that would be wrong: // NOLINTNEXTLINE(check): reason")
    return breaches


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parents[2])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--checks", default="", help="only these of .clang-tidy's, with commas")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    breaches = check(root, arguments.build.resolve(), root / "build" / "lint-cache",
                     arguments.checks)
    print("\n".join(breaches))
    sys.exit(1 if breaches else 0)


if __name__ == "__main__":
    main()

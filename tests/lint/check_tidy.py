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


def changed_files(root, commits):
    """What the last commits and the work after them changed; None where history does not say."""
    result = subprocess.run(["git", "diff", "--name-only", f"HEAD~{commits}"], cwd=root,
                            capture_output=True, text=True, check=False)
    return result.stdout.split() if result.returncode == 0 else None


def text_of(root, build, path):
    """Of a file of the tree, or of one that the build made; None where neither has it."""
    file = next((place for place in (pathlib.Path(root, path), pathlib.Path(build, path))
                 if place.is_file()), None)
    return file.read_text(encoding="utf-8", errors="replace") if file else None


def includes_of(root, build, path):
    found = _INCLUDE.findall(text_of(root, build, path) or "")
    return [os.path.relpath(include, root) if os.path.isabs(include) else include for include in found]


def touched(root, build, sources, changed):
    """Those of `sources` that compile what was changed: the file itself; of a header the file of
    its name, or the first that includes it where none has its name."""
    compiled = {source: {source, *(path for path in includes_of(root, build, source)
                                   if path.endswith(".cpp"))} for source in sources}
    included = {source: {header for path in paths for header in includes_of(root, build, path)}
                for source, paths in compiled.items()}
    found = set()
    for path in changed:
        own = path[:-4] + ".cpp" if path.endswith(".hpp") else path
        by_name = [source for source in sources if own in compiled[source]]
        found.update(by_name or [source for source in sources if path in included[source]][:1])
    return sorted(found)


def content_hash(root, build, source, command):
    """Over the file, what it includes from this tree, the flags and the settings."""
    digest = hashlib.sha256(command.encode())
    digest.update(pathlib.Path(root, ".clang-tidy").read_bytes())
    waiting, seen = [source], set()
    while waiting:
        path = waiting.pop()
        if path in seen:
            continue
        seen.add(path)
        text = text_of(root, build, path)
        if text is None:
            continue
        digest.update(f"{path}\0{text}\0".encode())
        waiting += sorted(_INCLUDE.findall(text))
    return digest.hexdigest()


def tidy(root, build, source):
    """What clang-tidy says about one file; empty when it is clean."""
    result = subprocess.run([PROGRAM, "-p", str(build), "--quiet",
                             f"--config-file={root}/.clang-tidy", source], cwd=root,
                            capture_output=True, text=True, check=False)
    if result.returncode == 0:
        return ""
    said = "\n".join(line for line in result.stdout.splitlines()
                     if not line.startswith("Suppressed"))
    return said.strip() or result.stderr.strip()


def check(root, build, cache, changed=None):
    """`changed`: paths under root to which the reading is limited; None: everything."""
    if not shutil.which(PROGRAM):
        return [f"{PROGRAM} is missing: apt-get install {PROGRAM}"]
    cache.mkdir(parents=True, exist_ok=True)
    commands = product_commands(root, build)
    if changed is not None:
        wanted = touched(root, build, [source for source, _ in commands], changed)
        commands = [(source, command) for source, command in commands if source in wanted]
    print(f"{len(commands)} units to read", file=sys.stderr)
    work = []
    for source, command in commands:
        mark = cache / content_hash(root, build, source, command)
        if not mark.exists():
            work.append((source, mark))
    breaches = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        said = pool.map(lambda item: tidy(root, build, item[0]), work)
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
    parser.add_argument("--commits", type=int, help="only what so many last commits changed")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    changed = changed_files(root, arguments.commits) if arguments.commits else None
    breaches = check(root, arguments.build.resolve(), root / "build" / "lint-cache", changed)
    print("\n".join(breaches))
    sys.exit(1 if breaches else 0)


if __name__ == "__main__":
    main()

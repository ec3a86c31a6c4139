#!/usr/bin/env python3
"""clang-format 14 with the tree's .clang-format over every C++ file."""

import shutil
import subprocess

import cpp_source

FOLDERS = cpp_source.PRODUCT_FOLDERS + ("tests", "examples")
PROGRAM = "clang-format-14"


def check(root):
    if not shutil.which(PROGRAM):
        return [f"{PROGRAM} is missing: apt-get install {PROGRAM}"]
    paths = cpp_source.cpp_files(root, FOLDERS)
    if not paths:
        return []
    result = subprocess.run([PROGRAM, "--dry-run", "-Werror", "-ferror-limit=1", *paths], cwd=root,
                            capture_output=True, text=True, check=False)
    if result.returncode == 0:
        return []
    named = sorted({line.split(":")[0] for line in result.stderr.splitlines()
                    if ": error:" in line})
    if not named:
        return [result.stderr.strip()]
    return [f"{path}:1: not formatted; run: {PROGRAM} -i {path}" for path in named]


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

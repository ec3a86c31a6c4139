#!/usr/bin/env python3
"""Prints what ctest's JUnit files say: failures, skips with their reason, and the totals.

usage: summarise_tests.py FOLDER    (a folder of *.xml, one for each step of ./run test)
Exit status 1 when a test failed or when there is no result at all.
"""

import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree


def skip_reason(case):
    """GoogleTest prints 'file:line: Skipped' and the reason on the next line."""
    output = case.findtext("system-out") or ""
    match = re.search(r"Skipped\s*\n(.+)", output)
    if match and match.group(1).strip():
        return match.group(1).strip()
    skipped = case.find("skipped")
    return (skipped is not None and skipped.get("message")) or "no reason given"


def skips_within(case):
    """Cases that a whole program left out, by the line that said so, each with its reason."""
    return re.findall(r"^(\S+:\d+): Skipped\n(.+)", case.findtext("system-out") or "", re.MULTILINE)


class Totals:
    def __init__(self):
        self.passed = 0
        self.failed = []
        self.skipped = []


def read_step(path, totals):
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        name = f"{path.stem}: {case.get('name')}"
        status = case.get("status")
        if status == "run":
            totals.passed += 1
            totals.skipped += [(f"{name}: {line}", reason) for line, reason in skips_within(case)]
        elif status in ("notrun", "disabled"):
            totals.skipped.append((name, skip_reason(case)))
        else:
            totals.failed.append(name)


def main(folder):
    totals = Totals()
    for path in sorted(pathlib.Path(folder).glob("*.xml")):
        read_step(path, totals)
    for name in totals.failed:
        print(f"FAILED  {name}")
    for name, reason in totals.skipped:
        print(f"skipped {name}: {reason}")
    if not totals.skipped:
        print("nothing was skipped")
    print(f"{totals.passed} passed, {len(totals.failed)} failed")
    return 1 if totals.failed or not totals.passed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))

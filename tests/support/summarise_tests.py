#!/usr/bin/env python3
"""Prints what ctest's JUnit files say: skips with their reason, failures, and the totals.

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
    """Cases that a whole program left out, each with its reason: of GoogleTest's by the line that said so, of unittest's by their names."""
    output = case.findtext("system-out") or ""
    return (re.findall(r"^(\S+:\d+): Skipped\n(.+)", output, re.MULTILINE) +
            [(name, reason) for name, _, reason in
             re.findall(r"^(test_\w+) \(.*\)(?:\n.*)? \.\.\. skipped (['\"])(.*)\2$", output, re.MULTILINE)])


TELLING = re.compile(r": Failure$|^SUMMARY: |^(FAIL|ERROR): |^[\w.]*(Error|Exception)\b|Timeout|runtime error: ")
MOST_LINES = 12


def why_it_failed(case):
    """What its output says of it, in a few lines: a log of minutes may be all that somebody has of a run."""
    lines = [line for line in (case.findtext("system-out") or "").splitlines() if line.strip()]
    telling = [at for at, line in enumerate(lines) if TELLING.search(line)]
    near = sorted({near for at in telling for near in range(at, min(at + 4, len(lines)))})
    summaries = {at for at in near if lines[at].startswith("SUMMARY: ")}  # of a sanitizer, after pages
    kept = set(near[:MOST_LINES]) | set(sorted(summaries)[:1])
    return [lines[at] for at in sorted(kept)] or lines[-MOST_LINES:]


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
            totals.failed.append((name, why_it_failed(case)))


def main(folder):
    totals = Totals()
    for path in sorted(pathlib.Path(folder).glob("*.xml")):
        read_step(path, totals)
    for name, reason in totals.skipped:
        print(f"skipped {name}: {reason}")
    if not totals.skipped:
        print("nothing was skipped")
    # Last: the end is what is kept of a long log.
    for name, why in totals.failed:
        print(f"FAILED  {name}")
        for line in why:
            print(f"    {line[:400]}")
    if len(totals.failed) > 1:
        print(f"FAILED in all: {', '.join(name for name, _ in totals.failed)}")
    print(f"{totals.passed} passed, {len(totals.failed)} failed")
    return 1 if totals.failed or not totals.passed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))

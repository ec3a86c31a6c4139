#!/usr/bin/env python3
"""Prints lines and branches that the tests of a coverage build reached, by folder and by file.

    report_coverage.py BUILD_FOLDER

A throw's branch counts only where somebody throws: gcovr leaves out the ones of the compiler's own
clean-up. Goal: 95 % of the branches in servo and safety; the fault latch and the life cycle are in
hal/device. What was measured: tests/README.md.
"""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("daemon/servo", "daemon/safety", "daemon/coupling", "daemon/world", "daemon/link", "drivers",
           "hal/device", "hal/rt", "guard")
GOAL_PERCENT = {"daemon/servo": 95, "daemon/safety": 95, "hal/device": 95}


def summary_of(build):
    filters = [f"--filter={ROOT}/{folder}/" for folder in FOLDERS]
    command = ["gcovr", "--root", str(ROOT), "--object-directory", str(build), *filters,
               "--exclude-throw-branches", "--exclude-unreachable-branches", "--json-summary",
               "--gcov-ignore-parse-errors", str(build)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def rows(summary):
    """{folder: [(file, lines, lines reached, branches, branches reached)]}"""
    found = {}
    for file in summary["files"]:
        folder = next(name for name in FOLDERS if file["filename"].startswith(name + "/"))
        found.setdefault(folder, []).append(
            (file["filename"], file["line_total"], file["line_covered"], file["branch_total"],
             file["branch_covered"]))
    return found


def percent(reached, total):
    return 100.0 if total == 0 else 100.0 * reached / total


def line(name, lines, lines_reached, branches, branches_reached):
    return (f"{name:<52} {percent(lines_reached, lines):6.1f} % of {lines:5} lines "
            f"{percent(branches_reached, branches):6.1f} % of {branches:5} branches")


def report(found):
    """Lines for a person: each folder, and below it the files that miss most branches."""
    out = []
    for folder in FOLDERS:
        files = found.get(folder)
        if not files:
            continue
        sums = [sum(column) for column in list(zip(*files))[1:]]
        goal = GOAL_PERCENT.get(folder)
        verdict = ""
        if goal is not None:
            is_met = percent(sums[3], sums[2]) >= goal
            verdict = f"  goal {goal} %: {'met' if is_met else 'MISSED'}"
        out.append(line(folder, *sums) + verdict)
        missing = sorted(files, key=lambda row: row[4] - row[3])
        out += [line("    " + row[0], *row[1:]) for row in missing if row[3] > row[4]]
    return out


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print("\n".join(report(rows(summary_of(pathlib.Path(sys.argv[1]).resolve())))))

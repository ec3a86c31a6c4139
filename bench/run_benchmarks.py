#!/usr/bin/env python3
"""Runs the benchmarks one after another and prints one table; ./run bench builds them first."""

import argparse
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(os.path.realpath(__file__)).parents[1]
ALL = ("servo_tick", "coupling_step", "ghost_step", "wakeup", "link_round_trip", "link_codec", "link_sessions", "daemon", "voxel_memory",
       "volume_load", "cam_engine", "cam_pieces", "virtual_time")
FORMAT = 1  # of the file that --json writes
DEFAULT_FILE = "build/bench.json"
MAX_FILE_BYTES = 1 << 20


class UsageError(Exception):
    pass


def number(value):
    return "-" if value is None else f"{value:.4g}"


def table_line(figure, before=None):
    """One figure for people; `before` is the same figure of an earlier run."""
    goal = figure["goal"]
    of = "ratio" if goal["of"] == "ratio" else figure["unit"]
    line = (f"{figure['name']:<38} {number(figure['value']):>10} {number(figure['reference']):>10} "
            f"{figure['unit']:<5} {number(figure['ratio']):>7}   "
            f"{'<= ' + number(goal['at_most']) + ' ' + of:<14} {'met' if figure['is_met'] else 'MISSED':<6}")
    return line + (f" {change(figure, before):>9}" if before is not None else "")


def change(figure, before):
    """New to old: of the ratios to the reference where both runs have one, so that a faster or a
    busier machine cancels out; else of the values."""
    if not before:
        return "new"
    key = "ratio" if figure["ratio"] and before["ratio"] else "value"
    if not before[key] or before["unit"] != figure["unit"]:
        return "-"
    return f"x {figure[key] / before[key]:.3f}"


def gone_lines(before, figures):
    """A line for each figure of the earlier run that this one has not, with what it was."""
    there = {figure["name"] for figure in figures}
    return [f"{table_line(figure)} {'gone':>9}" for name, figure in before.items() if name not in there]


def header(is_compared):
    line = f"{'benchmark':<38} {'value':>10} {'reference':>10} {'unit':<5} {'ratio':>7}   {'goal':<14}"
    return line + (f" {'':<6} {'new/old':>9}" if is_compared else "")


def parse_figure(line):
    """A line of a benchmark, or an entry of a file of --json; raises ValueError."""
    figure = json.loads(line) if isinstance(line, (str, bytes)) else line
    numbers = ("value", "reference", "ratio")
    if not isinstance(figure, dict) or not isinstance(figure.get("goal"), dict):
        raise ValueError("a figure is an object with a goal")
    for key in ("name", "unit"):
        if not isinstance(figure.get(key), str):
            raise ValueError(f"a figure has no '{key}'")
    for key in numbers:
        value = figure.get(key)
        if isinstance(value, bool) or not isinstance(value, (int, float, type(None))):
            raise ValueError(f"'{key}' of {figure['name']} is no number")
    if figure["value"] is None:
        raise ValueError(f"{figure['name']} has no value")
    return figure


def read_file(path):
    """{name: figure} of an earlier run."""
    try:
        with open(path, "rb") as file:
            text = file.read(MAX_FILE_BYTES + 1)
        if len(text) > MAX_FILE_BYTES:
            raise ValueError(f"longer than {MAX_FILE_BYTES} bytes")
        document = json.loads(text)
        if not isinstance(document, dict) or document.get("format") != FORMAT:
            raise ValueError(f"not format {FORMAT} of ./run bench --json")
        figures = [parse_figure(entry) for entry in document["figures"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise UsageError(f"cannot compare with {path}: {error}") from error
    return {figure["name"]: figure for figure in figures}


def run_one(name, show):
    """The figures of one benchmark, each shown as it comes; None when it failed."""
    program = ROOT / "build/release/bin" / f"bench_{name}"
    figures = []
    with subprocess.Popen([program], stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            figures.append(parse_figure(line))
            show(figures[-1])
    return figures if process.returncode == 0 else None


def write_file(path, figures):
    document = {"format": FORMAT, "machine": platform.machine(), "kernel": platform.release(),
                "processors": os.cpu_count(), "figures": figures}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document, file, indent=1)
        file.write("\n")


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(prog="./run bench", description=__doc__.split(";", maxsplit=1)[0])
    parser.add_argument("name", nargs="*", metavar="NAME", help="of: " + " ".join(ALL))
    parser.add_argument("--json", metavar="FILE", nargs="?", const=DEFAULT_FILE,
                        help=f"write the figures, for --compare; without FILE into {DEFAULT_FILE}")
    parser.add_argument("--compare", metavar="FILE",
                        help="show new to old beside each figure, and what is gone")
    chosen = parser.parse_args(arguments)
    if chosen.json in ALL:  # --json NAME: a benchmark was meant, not a file of its name
        chosen.name.append(chosen.json)
        chosen.json = DEFAULT_FILE
    for name in chosen.name:
        if name not in ALL:
            raise UsageError(f'there is no benchmark "{name}"; there are: {" ".join(ALL)}')
    return chosen


def main(arguments):
    try:
        chosen = parse_arguments(arguments)
        before = read_file(chosen.compare) if chosen.compare else None
    except UsageError as error:
        print(f"run: {error}", file=sys.stderr)
        return 2

    def show(figure):
        earlier = None if before is None else before.get(figure["name"], {})
        print(table_line(figure, earlier), flush=True)

    print(header(before is not None), flush=True)
    figures, status = [], 0
    for name in chosen.name or ALL:
        found = run_one(name, show)
        if found is None:
            print(f"run: bench_{name} failed", file=sys.stderr)
            status = 1
        figures += found or []
    if before is not None and not chosen.name:  # some benchmarks alone lack the others' figures
        for line in gone_lines(before, figures):
            print(line, flush=True)
    if chosen.json:
        try:
            write_file(chosen.json, figures)
        except OSError as error:
            print(f"run: cannot write {chosen.json}: {error}", file=sys.stderr)
            return 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

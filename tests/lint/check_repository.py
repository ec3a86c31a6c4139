#!/usr/bin/env python3
"""House rules that need no compiler: clocks, sleeps, skips, corpora, READMEs, lists of features and defects."""

import pathlib
import re

import cpp_source

CODE_FOLDERS = cpp_source.PRODUCT_FOLDERS + ("tests", "examples")

_UNFINISHED = re.compile(r"\b(?:TODO|FIXME|XXX)\b(?!\([^)]+\))")
# Clock::sleep_until() is virtual time and fine; the thread's own is not.
_SLEEP = re.compile(r"\b(?:sleep_for|this_thread\s*::\s*sleep_until|usleep|nanosleep|"
                    r"clock_nanosleep)\s*\(|(?<![\w.>])sleep\s*\(")
_CLOCK = re.compile(r"\b(?:steady_clock|system_clock|high_resolution_clock)\b|"
                    r"\b(?:clock_gettime|gettimeofday|timespec_get)\s*\(|\bstd::time\s*\(")
_SKIP = re.compile(r"\bGTEST_SKIP\s*\(\s*\)\s*(<<)?")
_TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.MULTILINE)
_PROVED_BY = re.compile(r"`ctest -R ([\w.]+)`")
_ADD_TEST = re.compile(r"add_test\(\s*NAME\s+([\w.${}]+)")
_VARIABLE = re.compile(r"\$\{\w+\}")
_FUZZ = re.compile(r"^\s*thimble_fuzz\(\s*(\w+)", re.MULTILINE)

# Where real time is the subject: the real clock, and what measures or watches real programs.
CLOCK_FOLDERS = ("hal/linux/", "bench/", "tests/rt/", "tests/vm/", "tests/unit/linux/")
# Tests that start real programs must wait for them; they poll with a bound.
SLEEP_FOLDERS = ("tests/rt/", "tests/vm/", "tests/system/")

# Folders whose charter is written one level up.
README_EXEMPT = (
    r"tests/unit/.*",   # mirrors the product's folders; tests/README.md
    r"tests/data/.+",   # data, described in tests/data/README.md
    r"tests/lint/.+",
    r"docs/decisions/.+",
)
KNOWN_PROGRAMS = ("./run", "ctest", "thimble", "thimbled", "python3", "ninja")


def check_code(path, text, breaches):
    code = cpp_source.without_comments(text)

    def report(source, pattern, words):
        for match in pattern.finditer(source):
            breaches.append(f"{path}:{cpp_source.line_of(source, match.start())}: "
                            f"{match.group(0).strip()}: {words}")

    report(text, _UNFINISHED, "finish it, or give the reason it waits in parentheses: TODO(reason)")
    if not path.startswith(CLOCK_FOLDERS):
        report(code, _CLOCK, "only hal/linux reads a clock; take a Clock& (hal/base/time.hpp), in "
                             "tests the VirtualClock")
    if path.startswith("tests/") and not path.startswith(SLEEP_FOLDERS):
        report(code, _SLEEP, "tests do not sleep; run the event queue of sim/time to the moment, or "
                             "poll with a bound")
    for match in _SKIP.finditer(code):
        if not match.group(1):
            breaches.append(f"{path}:{cpp_source.line_of(code, match.start())}: GTEST_SKIP without "
                            'a reason: write GTEST_SKIP() << "what is missing here"')


def check_corpora(root, paths, breaches):
    targets = {}
    for path in paths:
        if path.endswith("CMakeLists.txt"):
            for name in _FUZZ.findall(cpp_source.read(root, path)):
                targets[name] = path
    corpora = {path.split("/")[3] for path in paths
               if path.startswith("tests/data/corpus/") and path.count("/") >= 4}
    for name in sorted(corpora - set(targets)):
        breaches.append(f"tests/data/corpus/{name}: no fuzz target reads it; add thimble_fuzz({name} "
                        "…) to tests/fuzz/CMakeLists.txt or remove it")
    for name in sorted(set(targets) - corpora):
        breaches.append(f"{targets[name]}: fuzz target {name} has no corpus; put small seed files in "
                        f"tests/data/corpus/{name}")


def check_fuzz_table(root, paths, breaches):
    """tests/fuzz/README.md says of each target which parser it tries."""
    page = "tests/fuzz/README.md"
    makefile = "tests/fuzz/CMakeLists.txt"
    if page not in paths or makefile not in paths:
        return
    targets = set(_FUZZ.findall(cpp_source.read(root, makefile)))
    named = set()
    for number, line in enumerate(cpp_source.read(root, page).splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|") or cells[0] == "bytes of" or re.fullmatch(r"[|\s:-]+", line):
            continue
        parsers, tried_by = (re.findall(r"`([^`]+)`", cell) for cell in (cells + ["", ""])[1:3])
        if len(cells) != 3 or not parsers or not tried_by:
            breaches.append(f"{page}:{number}: a row is bytes of whom | `parser` | `target`")
        for place in parsers:
            if not pathlib.Path(root, place).exists():
                breaches.append(f"{page}:{number}: {place} does not exist; name where the parser lives now")
        for target in tried_by:
            if target not in targets:
                breaches.append(f"{page}:{number}: there is no fuzz target {target}; {makefile} lists them")
        named.update(tried_by)
    for target in sorted(targets - named):
        breaches.append(f"{page}: {target} has no row; write whose bytes it tries on which parser")


def check_readmes(paths, breaches):
    folders = {"/".join(path.split("/")[:-1]) for path in paths if "/" in path}
    for folder in sorted(folders):
        if f"{folder}/README.md" in paths:
            continue
        if any(re.fullmatch(pattern, folder) for pattern in README_EXEMPT):
            continue
        breaches.append(f"{folder}: no README.md; write four lines: charter, may use and used by, "
                        "entry header, how it is tested")


def feature_rows(text):
    """(line, cells) of the rows of docs/features.md's tables."""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.startswith("|") or re.fullmatch(r"[|\s:-]+", line):
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if cells[0].lower() != "feature":
            yield number, cells


def tests_by_name(root, paths):
    """Suite.Test of every GoogleTest case, Suite of each, and process.NAME of tests/process."""
    names = set()
    for path in paths:
        if path.startswith("tests/") and path.endswith(".cpp"):
            for suite, test in _TEST.findall(cpp_source.read(root, path)):
                names.update((suite, f"{suite}.{test}"))
        match = re.fullmatch(r"tests/process/test_(\w+)\.py", path)
        if match:
            names.add(f"process.{match.group(1)}")
    return names


def ctest_names(root, paths):
    """What `ctest -R` may find: tests_by_name() and what CMake adds. A ${variable} in a name may
    stand for any word of its file."""
    names = tests_by_name(root, paths)
    for path in paths:
        if not path.startswith("tests/") or not path.endswith("CMakeLists.txt"):
            continue
        text = cpp_source.read(root, path)
        for name in _ADD_TEST.findall(text):
            if "${" not in name:
                names.add(name)
                continue
            names.update(_VARIABLE.sub(word, name) for word in re.findall(r"\w+", text))
    return names


def read_if_there(root, path):
    return cpp_source.read(root, path) if pathlib.Path(root, path).exists() else ""


def run_commands(root):
    """What `run` takes for its first word: the branches of its case that do something."""
    choices = re.search(r"^case \$command in\n(.*?)^esac", read_if_there(root, "run"), re.MULTILINE | re.DOTALL)
    commands = set()
    for branch in re.split(r";;", choices.group(1)) if choices else ():
        pattern, end, action = branch.partition(")")
        if end and "*" not in pattern and not re.search(r"\bexit\b", action):
            commands.update(word.strip() for word in pattern.split("|"))
    return commands


def benchmarks(root):
    names = re.search(r"^ALL = \(([^)]*)\)", read_if_there(root, "bench/run_benchmarks.py"), re.MULTILINE)
    return set(re.findall(r'"(\w+)"', names.group(1))) if names else set()


def thimble_commands(root):
    """The words of each command of thimble(1), such as ("flight", "show"); arguments are in capitals."""
    headings = re.findall(r"^\.SS (.*)$", read_if_there(root, "docs/man/thimble.1"), re.MULTILINE)
    return {tuple(re.findall(r"(?<![\w\[])[a-z-]+(?!\w)", heading)) for heading in headings}


def without_options(words, takes_value):
    """The words that are no options, nor the values of those of `takes_value`."""
    return [word for before, word in zip([""] + words, words)
            if not word.startswith("-") and before not in takes_value]


def check_subcommand(root, where, words, breaches):
    """That `./run X`, `./run bench NAME` and `thimble X` exist; other programs are not looked into."""
    first = words[1] if len(words) > 1 else ""
    if words[0] == "./run" and first not in run_commands(root):
        breaches.append(f"{where}: run has no '{first}'; the case at its end lists what it has")
    elif words[0] == "./run" and first == "bench":
        for name in without_options(words[2:], ("--json", "--compare")):
            if name not in benchmarks(root):
                breaches.append(f"{where}: there is no benchmark '{name}'; bench/run_benchmarks.py lists them")
    elif words[0] == "thimble" and first not in ("-h", "--help", "--version"):
        given = without_options(words[1:], ("--socket",))
        commands = thimble_commands(root)
        if not any(command and tuple(given[:len(command)]) == command for command in commands):
            length = max((len(c) for c in commands if c and c[:1] == tuple(given[:1])), default=1)
            breaches.append(f"{where}: docs/man/thimble.1 has no '{' '.join(given[:length])}'; name a command "
                            "that it has")


def check_proof(root, where, proof, known, breaches):
    command = re.findall(r"`([^`]+)`", proof)
    if not command:
        breaches.append(f"{where}: names no `command` that proves it")
    for words in command:
        if words.split()[0] not in KNOWN_PROGRAMS:
            breaches.append(f"{where}: `{words}` starts no known program; use one of "
                            f"{', '.join(KNOWN_PROGRAMS)}")
        check_subcommand(root, where, words.split(), breaches)
        match = re.search(r"ctest .*-R '?([^\s'`]+)", words)
        if match and not any(re.search(match.group(1), name) for name in known):
            breaches.append(f"{where}: no test is called {match.group(1)}; name one that is there")


def check_features(root, paths, breaches):
    if "docs/features.md" not in paths:
        return
    known = ctest_names(root, paths)
    for number, cells in feature_rows(cpp_source.read(root, "docs/features.md")):
        where = f"docs/features.md:{number}"
        if len(cells) != 4 or cells[3] not in ("there", "not yet"):
            breaches.append(f"{where}: a row is feature | where | proof | there or not yet")
            continue
        if cells[3] == "not yet":
            continue
        for place in re.findall(r"`([^`]+)`", cells[1]):
            if not pathlib.Path(root, place).exists():
                breaches.append(f"{where}: {place} does not exist; name where the feature lives now")
        check_proof(root, where, cells[2], known, breaches)


def check_defects(root, paths, breaches):
    page = "docs/thesis-defects.md"
    if page not in paths:
        return
    known = tests_by_name(root, paths)
    named = set()
    for number, line in enumerate(cpp_source.read(root, page).splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|") or cells[0] == "defect" or re.fullmatch(r"[|\s:-]+", line):
            continue
        where = f"{page}:{number}"
        if len(cells) != 5 or cells[4] not in ("serious", "minor"):
            breaches.append(f"{where}: a row is defect | effect | here | proof | serious or minor")
            continue
        proofs = _PROVED_BY.findall(cells[3])
        named.update(proofs)
        for proof in proofs:
            if proof not in known:
                breaches.append(f"{where}: there is no test {proof}; name one that fails if the row "
                                "is untrue")
        if not proofs:
            breaches.append(f"{where}: names no test; write `ctest -R Suite.Test`")
        if cells[4] == "serious" and not any(p.startswith("ThesisDefect.") for p in proofs):
            breaches.append(f"{where}: a serious defect has a test named after it, "
                            "ThesisDefect.WhatOursDoes")
    for name in sorted(known - named):
        if name.startswith("ThesisDefect."):
            breaches.append(f"{page}: {name} has no row; write the one that it proves")


def check(root):
    breaches = []
    paths = cpp_source.tree_files(root)
    for path in cpp_source.cpp_files(root, CODE_FOLDERS):
        check_code(path, cpp_source.read(root, path), breaches)
    check_corpora(root, paths, breaches)
    check_fuzz_table(root, set(paths), breaches)
    check_readmes(set(paths), breaches)
    check_features(root, set(paths), breaches)
    check_defects(root, set(paths), breaches)
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

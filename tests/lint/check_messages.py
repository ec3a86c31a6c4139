#!/usr/bin/env python3
"""docs/messages.md lists every sentence that the daemon and its guards may say, each with its cure, and none that it cannot.

A sentence is a string literal of three or more words in hal, drivers, sim, daemon and guard, or of fewer when it stands in a
call that says it (fail, malformed, spdlog::warn …) and is no bare name of a key or a system call; adjacent literals,
and those that + joins with values, count as one, with … for the values.

Rows stand below a heading that names the folders or files that they are about; a row quotes the beginning of a
sentence, and its own … stands for anything; one that quotes a whole sentence lists that alone. No row may list more
than a few sentences, or its cure would be taken for what nobody had in mind.
"""

import re

import cpp_source

PAGE = "docs/messages.md"
FOLDERS = ("hal", "drivers", "sim", "daemon", "guard", "board")
# Where the sentences are no messages.
EXEMPT = (
    "daemon/config/load.cpp:arm = [",  # a configuration in itself, parsed to list its keys
    "sim/model/cam/rules/",  # what each rule is, for `thimble cam list`; nothing there can fail
)
# Names of C types in file headers.
_TYPE = re.compile(r"(?:(?:un)?signed|long|short|int|char)(?: (?:long|short|int|char))*")
# What --help says, which is in the manual pages.
_HELPS = re.compile(r"\badd_(?:option|flag)\s*\(")
_TITLE = re.compile(r"\bCLI::App \w+\{\s*$")
# What is called to say something: whatever stands within its parentheses.
_SAYS = re.compile(r"\b(?:fail|fail_errno|malformed|unsupported|refuse|reject|note_error|spdlog::\w+)\s*\(")
MAX_SENTENCES_OF_A_ROW = 3
_LITERAL = re.compile(r'"((?:\\.|[^"\\\n])*)"')
_RAW = re.compile(r'R"\(.*?\)"', re.DOTALL)
_NO_MESSAGE = re.compile(r"(?:\bstatic_assert\s*\(|THIMBLE_CHECK\s*\(|#include|\[\[deprecated)[^;]*$")
_WORD = re.compile(r"[A-Za-z]{2,}")
# From one literal to the next of the same sentence: nothing, or + VALUE +.
_JOINT = re.compile(r"\s*|\s*\)?\s*\+[^;{}?]*\+\s*(?:std::string\()?\s*")
_HEADING = re.compile(r"^##+ .*$", re.MULTILINE)
_ROW = re.compile(r"^\|\s*`(?P<message>[^`]+)`\s*\|(?P<cure>[^|]*)\|\s*$", re.MULTILINE)


def unescaped(text):
    return re.sub(r"\\(.)", lambda m: {"n": "\n", "r": "\n", "t": "\t"}.get(m.group(1), m.group(1)), text)


def normal(text):
    """One blank between words, and none at the ends; `|` cannot stand in a table."""
    return " ".join(text.split())


def is_sentence(text):
    return len(_WORD.findall(text)) >= 3 and " " in text and not _TYPE.fullmatch(text)


def is_within(call, statement):
    """Whether what follows `statement` is within the parentheses of such a call."""
    for match in call.finditer(statement):
        depth = 1
        for bracket in re.findall(r"[()]", _LITERAL.sub("", statement[match.end():])):
            depth += 1 if bracket == "(" else -1
            if depth == 0:
                break
        if depth > 0:
            return True
    return False


def sentences(source):
    """(offset, text) of each literal, or run of adjacent ones, that is a sentence."""
    code = cpp_source.without_comments(source, keep_strings=True)
    code = _RAW.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), code)
    found = []
    end = None
    for match in _LITERAL.finditer(code):
        between = None if end is None else code[end:match.start()]
        if between is not None and _JOINT.fullmatch(between):
            found[-1][1] += (" … " if between.strip() else "") + match.group(1)
        else:
            found.append([match.start(), match.group(1)])
        end = match.end()
    for offset, text in found:
        before = code[max(0, offset - 400):offset]
        statement = before[max(before.rfind(";"), before.rfind("{"), before.rfind("}")) + 1:]
        if is_within(_HELPS, statement) or _TITLE.search(before):
            continue
        text = normal(unescaped(text))
        is_said = _WORD.search(text) and not re.fullmatch(r"\w+", text) and is_within(_SAYS, statement)
        if (is_said or is_sentence(text)) and not _NO_MESSAGE.search(statement):
            yield offset, text


class Row:
    def __init__(self, message, cure, where, places):
        self.message = normal(message)
        self.cure = cure.strip()
        self.where = where
        self.places = places
        self.said = set()
        self.is_whole = False  # a sentence of its places is word for word its message
        parts = [re.escape(part) for part in self.message.split("…")]
        self.pattern = re.compile(".*".join(parts))

    def is_about(self, path):
        return path.startswith(tuple(self.places))

    def lists(self, text):
        return text == self.message if self.is_whole else self.pattern.match(text) is not None


def rows_of(page):
    places = {match.start(): re.findall(r"`([^`]+)`", match.group(0))
              for match in _HEADING.finditer(page)}
    for match in _ROW.finditer(page):
        above = [offset for offset in places if offset < match.start()]
        yield Row(match.group("message"), match.group("cure"),
                  f"{PAGE}:{cpp_source.line_of(page, match.start())}",
                  places[max(above)] if above else [])


def all_sentences(root):
    """(path, line, text) of each sentence of the daemon."""
    for path in cpp_source.cpp_files(root, FOLDERS):
        source = cpp_source.read(root, path)
        for offset, text in sentences(source):
            if not f"{path}:{text}".startswith(EXEMPT):
                yield path, cpp_source.line_of(source, offset), text


def check(root):
    breaches = []
    rows = list(rows_of(cpp_source.read(root, PAGE)))
    for row in rows:
        if not row.cure:
            breaches.append(f"{row.where}: `{row.message}` has no cure; say what a person does about it")
        if not _WORD.search(row.message):
            breaches.append(f"{row.where}: `{row.message}` would list everything; quote a word of it")
    found = list(all_sentences(root))
    for row in rows:
        row.is_whole = any(text == row.message and row.is_about(path) for path, _, text in found)
    for path, line, text in found:
        fitting = [row for row in rows if row.is_about(path) and row.lists(text)]
        for row in fitting:
            row.said.add(text)
        if not fitting:
            breaches.append(f"{path}:{line}: {PAGE} does not list `{text}`; add a row with its cure")
    breaches += [f"{row.where}: nothing below {', '.join(row.places) or 'no heading'} says "
                 f"`{row.message}`; remove or mend the row" for row in rows if not row.said]
    breaches += [f"{row.where}: `{row.message}` lists {len(row.said)} sentences, of at most "
                 f"{MAX_SENTENCES_OF_A_ROW}; quote more of each, with a cure that is true of it: "
                 + "; ".join(f"`{text}`" for text in sorted(row.said))
                 for row in rows if len(row.said) > MAX_SENTENCES_OF_A_ROW]
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

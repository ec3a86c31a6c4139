#!/usr/bin/env python3
"""Include-layer check: every #include and every CMake link edge against layers.txt."""

import fnmatch
import pathlib
import re

import cpp_source

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"\n]+)"|<([^>\n]+)>)', re.MULTILINE)
_LIBRARY = re.compile(r"thimble_library\(\s*([\w/]+)([^)]*)\)")
_KEYWORDS = {"SOURCES", "LINKS", "PRIVATE_LINKS", "PUBLIC", "PRIVATE", "INTERFACE"}


class Layers:
    """The table of layers.txt."""

    def __init__(self, text):
        self.groups, self.links, self.facts, self.allowed = {}, {}, [], {}
        sets = {}
        for line in text.splitlines():
            words = line.split("#", 1)[0].split()
            if not words:
                continue
            kind, name = words[0], words[1]
            if kind == "group":
                cut = words.index("links") if "links" in words else len(words)
                self.groups[name] = words[2:cut]
                self.links[name] = words[cut + 1:]
            elif kind == "facts":
                self.facts += words[1:]
            elif kind == "set":
                sets[name] = [part for entry in words[3:] for part in sets.get(entry, [entry])]
            elif kind == "layer":
                entries = words[3:]
                self.allowed[name] = [part for entry in entries
                                      for part in sets.get(entry, [entry])]
            else:
                raise ValueError(f"layers.txt: unknown line: {line}")

    def layer_of(self, path):
        """The layer of a file or folder, or None."""
        if any(fnmatch.fnmatch(path, pattern) for pattern in self.facts):
            return "drivers/facts"
        parts = path.split("/")
        for length in range(len(parts), 0, -1):
            folder = "/".join(parts[:length])
            if folder in self.allowed:
                return folder
        return None

    def group_of_header(self, header):
        return next((group for group, patterns in self.groups.items()
                     if any(fnmatch.fnmatch(header, pattern) for pattern in patterns)), None)

    def group_of_link(self, target):
        return next((group for group, patterns in self.links.items()
                     if any(fnmatch.fnmatch(target, pattern) for pattern in patterns)), None)

    def permits(self, layer, path, wanted):
        if layer == wanted:
            return True
        for entry in self.allowed[layer]:
            name, _, pattern = entry.partition("@")
            if name in ("*", wanted) and (not pattern or fnmatch.fnmatch(path, pattern)):
                return True
        return False

    def describe(self, layer):
        return ", ".join(self.allowed[layer]) or "nothing"


def is_standard(header):
    return re.fullmatch(r"[a-z_0-9]+", header) is not None


def check_file(root, path, layers, breaches):
    layer = layers.layer_of(path)
    if layer is None:
        breaches.append(f"{path}:1: its folder has no line in tests/lint/layers.txt; add one that "
                        "says whom it may use, or move the file")
        return
    code = cpp_source.without_comments(cpp_source.read(root, path), keep_strings=True)
    for match in _INCLUDE.finditer(code):
        own, outside = match.groups()
        where = f"{path}:{cpp_source.line_of(code, match.start(1 if own else 2))}"
        if own:
            wanted = layers.layer_of(own) if "/" in own else None
            if wanted is None:
                breaches.append(f'{where}: "{own}" is not a path from the root of the tree; '
                                'write it as "hal/base/time.hpp", or <…> if it is from outside')
                continue
        elif is_standard(outside):
            continue
        else:
            wanted = layers.group_of_header(outside)
            if wanted is None:
                breaches.append(f"{where}: <{outside}> belongs to no group of tests/lint/layers.txt; "
                                "a new library needs a decision record and a group line there")
                continue
        if not layers.permits(layer, path, wanted):
            breaches.append(
                f"{where}: {layer} may not include {own or '<' + outside + '>'} ({wanted}); it may "
                f"use {layers.describe(layer)}. Move the code to a folder that may, or pass the "
                "thing in through an interface; the table is tests/lint/layers.txt")


def cmake_libraries(root):
    """(CMakeLists path, line, folder, link names) of every thimble_library()."""
    for path in cpp_source.tree_files(root):
        if pathlib.PurePosixPath(path).name != "CMakeLists.txt":
            continue
        text = re.sub(r"#[^\n]*", lambda m: " " * len(m.group(0)), cpp_source.read(root, path))
        for match in _LIBRARY.finditer(text):
            words, links, is_link = match.group(2).split(), [], False
            for word in words:
                if word in _KEYWORDS:
                    is_link = word != "SOURCES"
                elif is_link:
                    links.append(word)
            yield path, cpp_source.line_of(text, match.start()), match.group(1), links


def check_links(root, layers, breaches):
    libraries = list(cmake_libraries(root))
    folder_of = {"thimble_" + folder.replace("/", "_"): folder for _, _, folder, _ in libraries}
    for path, line, folder, links in libraries:
        layer = layers.layer_of(folder)
        if layer is None:
            continue  # tests' own libraries; a product folder without a line is named above
        for target in links:
            if target in folder_of:
                wanted = layers.layer_of(folder_of[target])
            else:
                wanted = layers.group_of_link(target)
            if wanted is None and target.startswith("thimble_"):
                continue  # declared under a condition that this reader does not follow
            if wanted is None or not layers.permits(layer, folder + "/CMakeLists.txt", wanted):
                if wanted and any(entry.partition("@")[0] == wanted
                                  for entry in layers.allowed[layer]):
                    continue  # allowed for some of its files: their includes are checked
                breaches.append(
                    f"{path}:{line}: {folder} may not link {target} ({wanted or 'no group'}); it "
                    f"may use {layers.describe(layer)}. Take the edge out, or see "
                    "tests/lint/layers.txt")


def check(root):
    layers = Layers(cpp_source.read(root, "tests/lint/layers.txt"))
    breaches = []
    for path in cpp_source.cpp_files(root, cpp_source.PRODUCT_FOLDERS):
        check_file(root, path, layers, breaches)
    check_links(root, layers, breaches)
    return breaches


if __name__ == "__main__":
    cpp_source.run(check, __doc__)

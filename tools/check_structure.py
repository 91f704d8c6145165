#!/usr/bin/env python3
"""Holds the tree to what docs/architecture.md and CONTRIBUTING.md say of it.

- Includes follow the arrows drawn in docs/architecture.md (the block marked `arrows`), no two folders
  include each other by any way, and no service, door or command includes another.
- Only the folders of the block marked `messages` include gRPC, protobuf and generated messages.
- Only common/store includes SQLite and PostgreSQL.
- Headers that say "Private to this folder" are included by their folder, and its tests, alone.
- No loop goes over the columns or rows of a matrix that a call returns.
- A folder has at most 45 files, a hand-written source at most 500 lines, a function at most 60.
- Every source has its test at its mirrored path, tests/unit/<path>_test.cpp, or stands in
  tests/tested_elsewhere.txt with the test that tests it.

What is allowed to be longer stands in tools/structure_exceptions.txt, each with its reason. Entries of
both lists that are no longer needed are faults, too. Run by `./dev lint` and by the test
`structure_test`.
"""
import collections
import fnmatch
import os
import re
import subprocess
import sys

ROOTS = ("common", "services", "gateway", "hwbridge", "cli")
MOST_FILES, MOST_LINES, MOST_FUNCTION_LINES = 45, 500, 60


def tracked_files():
    listed = subprocess.check_output(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], text=True).split("\n")
    return sorted({name for name in listed if name and os.path.exists(name)})


def is_source(name):
    return name.endswith((".cpp", ".h"))


def read_block(mark):
    page = "docs/architecture.md"
    block = re.search(rf"```{mark}\n(.*?)```", open(page, encoding="utf-8").read(), re.S)
    if block is None:
        sys.exit(f"{page}: has no block marked `{mark}`")
    return block.group(1)


def read_arrows():
    """{folder of common/: set of folders of common/ it may include}."""
    arrows = {}
    for line in read_block("arrows").splitlines():
        if line.strip():
            folder, _, below = line.partition("→")
            arrows[folder.strip()] = set(below.split())
    return arrows


def group_of(folder, arrows):
    """The longest drawn folder that `folder` of common/ is or lies in."""
    while folder and folder not in arrows:
        folder = os.path.dirname(folder)
    return folder


def read_includes(sources):
    """{folder: {folder it includes: (file, header)}}, of our own files alone."""
    known = set(sources)
    edges = collections.defaultdict(dict)
    for name in sources:
        text = open(name, encoding="utf-8").read()
        for header in re.findall(r'^#include "([^"]+)"', text, re.M):
            here, there = os.path.dirname(name), os.path.dirname(header)
            if header in known and here != there:
                edges[here].setdefault(there, (name, header))
    return edges


def arrow_faults(edges, arrows):
    for here, targets in sorted(edges.items()):
        for there, (name, header) in sorted(targets.items()):
            if here.startswith("common/"):
                mine = group_of(here.removeprefix("common/"), arrows)
                if not mine:
                    yield f"{here}: docs/architecture.md draws no arrows of it"
                elif not there.startswith("common/"):
                    yield f"{name}: includes {header}, which is above common/"
                else:
                    other = group_of(there.removeprefix("common/"), arrows)
                    if other != mine and other not in arrows[mine]:
                        yield f"{name}: includes {header}, but no arrow leads from {mine} to {other}"
            elif not there.startswith("common/") and owner_of(here) != owner_of(there):
                yield f"{name}: includes {header} of another program"


def owner_of(folder):
    parts = folder.split("/")
    return "/".join(parts[:2]) if parts[0] == "services" else parts[0]


def cycle_faults(edges):
    """One line for each set of folders that include each other."""
    index, low, stack, on_stack, faults = {}, {}, [], set(), []

    def visit(folder):
        index[folder] = low[folder] = len(index)
        stack.append(folder)
        on_stack.add(folder)
        for other in edges.get(folder, {}):
            if other not in index:
                visit(other)
                low[folder] = min(low[folder], low[other])
            elif other in on_stack:
                low[folder] = min(low[folder], index[other])
        if low[folder] == index[folder]:
            members = []
            while not members or members[-1] != folder:
                members.append(stack.pop())
                on_stack.discard(members[-1])
            if len(members) > 1:
                ways = [f"{edges[a][b][0]} includes {edges[a][b][1]}"
                        for a in members for b in members if b in edges.get(a, {})]
                faults.append("folders include each other: " + "; ".join(sorted(ways)))

    for folder in sorted(edges):
        if folder not in index:
            visit(folder)
    return faults


def message_faults(sources, folders):
    for name in sources:
        text = open(name, encoding="utf-8").read()
        known = re.search(r'^#include [<"](grpc|google/(protobuf|rpc)/|mortise/v1)[^>"]*', text, re.M)
        if known and not any(fnmatch.fnmatch(os.path.dirname(name), folder) for folder in folders):
            yield f"{name}: knows messages ({known.group(0)}), which its folder should not"


def sql_faults(sources):
    for name in sources:
        text = open(name, encoding="utf-8").read()
        if os.path.dirname(name) != "common/store" and re.search(r"^#include [<\"](sqlite3|libpq)", text, re.M):
            yield f"{name}: knows SQL, which only common/store should"


def private_faults(sources):
    def says_private(name):
        first = open(name, encoding="utf-8").read().split("#pragma once")[0]
        return "Private to this folder" in re.sub(r"\n//", "", first)

    private = {name for name in sources if name.endswith(".h") and says_private(name)}
    for name in sources:
        folder = os.path.dirname(name)
        for header in re.findall(r'^#include "([^"]+)"', open(name, encoding="utf-8").read(), re.M):
            if header in private and os.path.dirname(header) != folder.removeprefix("tests/unit/"):
                yield f"{name}: includes {header}, which is private to its folder"


def dangling_faults(sources):
    """A loop over the columns of what a call returns reads what is no longer there."""
    for name in sources:
        text = open(name, encoding="utf-8").read()
        for loop in re.findall(r"for \([^;{]*?:[^;{]*?(?<!back\()(?<!front\()\)\.(?:colwise|rowwise)\(\)\)", text):
            yield f"{name}: {loop} loops over a temporary matrix; keep it in a variable first"


def long_functions(text):
    """(first line, name, lines) of each function at namespace level that is too long. The sources are
    formatted: such a function begins and ends in the first column."""
    begin = None
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("}"):
            if begin and line.rstrip() == "}" and number - begin[0] + 1 > MOST_FUNCTION_LINES:
                yield begin[0], begin[1], number - begin[0] + 1
            begin = None
        elif begin is None and re.match(r"[A-Za-z_\[]", line) and not re.match(
                r"(namespace|struct|class|enum|union|using|extern|template)\b", line):
            if line.rstrip().endswith(";"):
                continue
            called = re.search(r"([\w:~]+)\s*\(", line)
            begin = (number, called.group(1) if called else line.strip())
        elif begin and line.rstrip().endswith(");") and not line.startswith(" " * 2):
            begin = None


def size_faults(files, sources):
    counts = collections.Counter(os.path.dirname(name) for name in files
                                 if is_source(name) or name.endswith(".py"))
    for folder, count in sorted(counts.items()):
        if count > MOST_FILES:
            yield folder, f"has {count} files, more than {MOST_FILES}"
    for name in sources:
        text = open(name, encoding="utf-8").read()
        lines = text.count("\n")
        if lines > MOST_LINES:
            yield name, f"has {lines} lines, more than {MOST_LINES}"
        for _, function, length in long_functions(text):
            yield f"{name}:{function}", f"has {length} lines, more than {MOST_FUNCTION_LINES}"


def test_faults(files):
    """Of sources without a test at their mirrored path, and of the table of those tested elsewhere."""
    known = set(files) | {os.path.dirname(name) for name in files}
    elsewhere = read_table("tests/tested_elsewhere.txt")
    used = set()
    for name in files:
        if name.split("/")[0] not in ROOTS or not name.endswith(".cpp") or name.endswith("main.cpp"):
            continue
        if f"tests/unit/{name[:-4]}_test.cpp" in known:
            continue
        key = next((e for e in (name, os.path.dirname(name) + "/*") if e in elsewhere), None)
        if key is None:
            yield f"{name}: has no test at its mirrored path, and is not in tests/tested_elsewhere.txt"
        used.add(key)
    for key, test in elsewhere.items():
        if key not in used:
            yield f"tests/tested_elsewhere.txt: '{key}' is no longer needed"
        elif test not in known:
            yield f"tests/tested_elsewhere.txt: '{key}' names {test}, which there is not"


def read_table(path):
    """{place: what stands behind the bar}."""
    table = {}
    for line in open(path, encoding="utf-8"):
        place, _, reason = line.strip().partition(" | ")
        if place and not place.startswith("#"):
            table[place] = reason
    return table


def main():
    os.chdir(subprocess.check_output(["git", "rev-parse", "--show-toplevel"], text=True).strip())
    files = tracked_files()
    sources = [name for name in files if is_source(name) and name.split("/")[0] in ROOTS]
    written = [name for name in files if is_source(name)]
    arrows = read_arrows()
    edges = read_includes(sources)
    faults = list(arrow_faults(edges, arrows)) + cycle_faults(edges) + list(private_faults(written))
    faults += list(sql_faults(sources)) + list(dangling_faults(written))
    faults += list(message_faults(sources, read_block("messages").split()))
    faults += list(test_faults(files))
    exceptions = read_table("tools/structure_exceptions.txt")
    too_long = dict(size_faults(files, written))
    faults += [f"{place}: {fault}" for place, fault in too_long.items() if place not in exceptions]
    faults += [f"tools/structure_exceptions.txt: '{place}' is no longer needed" for place in exceptions
               if place not in too_long]
    for place, reason in exceptions.items():
        if place in too_long:
            print(f"{place} {too_long[place]}: {reason}", file=sys.stderr)
    for fault in faults:
        print(fault)
    print(f"{len(sources)} sources, {len(exceptions)} that may be longer, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

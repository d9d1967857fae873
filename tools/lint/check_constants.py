#!/usr/bin/env python3
"""Each numeric constant of the decoder says what it is: a law, a derivation, a choice, or no threshold at all.

Constants are `constexpr` or `const` names k... and defaults of a *Config's or *Gate's members, if a number is written in
them. The comment behind or right above one has a clause that begins with its kind:
  physical:  a property of light, sensor, geometry or number formats
  derived:   followed by the line of derivation or a citation
  chosen:    followed by `on` and the data, or by `by judgement` where nothing tells the origin
  layout:    no threshold: lanes, strides, sizes, sentinels, units, coefficients
Statements in a row without a line between them share a `chosen` or `layout` above the first; laws and derivations are
each constant's own. What is chosen stands together: in a configuration, or in chosen.hpp of its folder. --count prints
how many there are of each kind.
"""
import collections
import re
import sys
from typing import NamedTuple

from lint_common import CPP, Finding, ROOT, blank_comments_and_strings, code_files, main

HOME = "pipeline/decode/"
KINDS = ("physical", "derived", "chosen", "layout")
SHARED = ("chosen", "layout")
RULES = {"constant_kind", "constant_home"}

CLAUSE = re.compile(r"(?:^|[.;] )(" + "|".join(KINDS) + r"): (\S[^.;]*)")
ORIGIN = re.compile(r"on |by judgement\b")
CONSTANT = re.compile(r"\s*(?:inline |static )*(?:constexpr|const)\b")
MEMBER = re.compile(r"\s*(?:float|double|int|unsigned|Cost|std::size_t|std::u?int\d+_t) \w+\s*[={]")
STRUCT = re.compile(r"\s*struct \w*(?:Config|Gate)\b[^;]*\{\s*$")
NUMBER = re.compile(r"(?<![\w.])\.?\d")


class Constant(NamedTuple):
    line: int
    name: str
    kinds: list[str]  # one, if all is well
    advice: str


def declarators(statement: str):
    """(name, initialiser) of each name that a declaration gives a value."""
    depth, start, angles = 0, 0, True
    parts = []
    for i, c in enumerate(statement):
        if c in "({[" or (c == "<" and angles):
            depth += 1
        elif c in ")}]" or (c == ">" and angles):
            depth -= 1
        if c in "={" and depth <= 1:
            angles = False  # of a value they compare
        if c == "," and depth == 0:
            parts.append(statement[start:i])
            start, angles = i + 1, True
    for part in [*parts, statement[start:]]:
        head, mark, value = re.match(r"([^={]*)([={]?)(.*)", part, re.DOTALL).groups()
        name = re.search(r"(\w+)\s*(?:\[[^\]]*\])?\s*$", head)
        if mark and name and "(" not in head:
            yield name.group(1), value


def statements(code: list[str]):
    """(first line, last line, names that have a number as value) of each constant or member, by line index."""
    number, in_struct = 0, False
    while number < len(code):
        line, first = code[number], number
        if STRUCT.match(line):
            in_struct = True
        elif re.match(r"\s*\};", line):
            in_struct = False
        constant = CONSTANT.match(line)
        if constant or (in_struct and MEMBER.match(line)):
            text = line
            while not re.search(r";\s*$", text) and text.count("{") <= text.count("}") + 4 and number + 1 < len(code):
                if re.search(r"\)[^=;]*\{\s*$", text):
                    break  # a function
                number += 1
                text += "\n" + code[number]
            names = [(n, v) for n, v in declarators(text) if not constant or re.fullmatch(r"k[A-Z]\w*", n)]
            if names:
                yield first, number, [n for n, v in names if NUMBER.search(v)]
        number += 1


def is_comment(line: str) -> bool:
    return line.lstrip().startswith("//")


def words(lines: list[str]) -> str:
    return " ".join(re.sub(r"^.*?//+<?\s*", "", line).strip() for line in lines if "//" in line)


def comments_of(raw: list[str], first: int, last: int) -> tuple[str, str]:
    """What is said above a statement and behind it."""
    above, below = first, last + 1
    while above > 0 and is_comment(raw[above - 1]) and not raw[above - 1].lstrip().startswith("///<"):
        above -= 1
    while below < len(raw) and raw[below].lstrip().startswith("///<"):
        below += 1
    return words(raw[above:first]), words(raw[first:below])


def constants(text: str):
    """Every constant of a file with what it says of its kind."""
    raw, code = text.split("\n"), blank_comments_and_strings(text).split("\n")
    shared, after = "", -1  # kind of the run of statements that ended before line `after`
    for first, last, names in statements(code):
        above, behind = comments_of(raw, first, last)
        over = [m.group(1) for m in CLAUSE.finditer(above)]
        if above or first != after:
            shared = over[0] if len(over) == 1 and over[0] in SHARED else ""
        said = [(m.group(1), m.group(2)) for m in CLAUSE.finditer(behind)] or \
               [(m.group(1), m.group(2)) for m in CLAUSE.finditer(above)]
        advice = f"say what it is: {', '.join(k + ':' for k in KINDS)}"
        kinds = [kind for kind, _ in said] or ([shared] if shared and not above else [])
        if len(kinds) > 1:
            advice = f"says {len(kinds)} kinds"
        elif said and said[0][0] == "chosen" and not ORIGIN.match(said[0][1]):
            kinds, advice = [], "chosen: on which data, or by judgement"
        for name in names:
            yield Constant(first + 1, name, kinds, advice)
        after = last + 1


def check(path: str, text: str) -> list[Finding]:
    if not path.startswith(HOME):
        return []
    found = []
    in_folder = "/" in path.removeprefix(HOME)
    for c in constants(text):
        if len(c.kinds) != 1:
            found.append(Finding(path, c.line, "constant_kind", f"'{c.name}': {c.advice}"))
        elif c.kinds == ["chosen"] and re.match("k[A-Z]", c.name) and in_folder and not path.endswith("/chosen.hpp"):
            found.append(Finding(path, c.line, "constant_home", f"'{c.name}' is chosen: its place is chosen.hpp"))
    return found


def files() -> list[str]:
    return [path for path in code_files(CPP | {".h"}) if path.startswith(HOME)]


def print_count() -> int:
    counts: dict[str, collections.Counter] = collections.defaultdict(collections.Counter)
    for path in files():
        rest = path.removeprefix(HOME).split("/")
        for c in constants((ROOT / path).read_text(encoding="utf-8")):
            counts[rest[0] if len(rest) > 1 else "."][c.kinds[0] if len(c.kinds) == 1 else "untold"] += 1
    columns = [*KINDS, "untold"]
    rows = [(module, [counts[module][k] for k in columns]) for module in sorted(counts)]
    rows.append(("all", [sum(column) for column in zip(*(n for _, n in rows))]))
    print(f"{'':12}" + "".join(f"{k:>10}" for k in columns))
    for module, n in rows:
        print(f"{module:12}" + "".join(f"{k:10}" for k in n))
    return 0


if __name__ == "__main__":
    sys.exit(print_count() if sys.argv[1:] == ["--count"] else main(__doc__, "constants", RULES, files, check))

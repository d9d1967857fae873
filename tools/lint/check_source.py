#!/usr/bin/env python3
"""House rules that compilers do not know: size of files and functions, clocks, threads, randomness, units, open ends."""
import re
import sys
import tomllib

from lint_common import CPP, ROOT, Finding, blank_comments_and_strings, main

MAX_FILE_LINES = 300
MAX_FUNCTION_LINES = 60
MAX_PARAMETERS = 6
RULES = {"file_length", "function_length", "parameters", "clock", "thread", "random", "mode", "test_name", "todo", "unit",
         "pragma_once", "using_namespace"}
ALLOWED = tomllib.loads((ROOT / "tools/lint/allowed.toml").read_text(encoding="utf-8"))

UNITS = r"_(mm2?|mm3|um|nm|px|ns|us|ms|s|h|rad|deg|dn|hz|fps|c|k|v|w|a|m|voxels|per_\w+|\w+_s|ratio|share|factor|steps?)$"
DIMENSIONS = (r"length|distance|radius|diameter|width|height|depth|angle|offset|period|delay|timeout|duration|interval|time|"
              r"velocity|temperature|edge|thickness|voxel|spacing|pitch|gap|rotation|translation")

# rule, pattern on code without comments and strings, files it does not hold for, what to do
PATTERNS = [
    ("clock", r"::now\s*\(|\b(clock_gettime|gettimeofday)\s*\(|\bstd::time\s*\(|this_thread::sleep_(for|until)\b",
     r"protocol/base/clock\.cpp$|tests/", "only protocol/base/clock.cpp reads a clock or sleeps: take a Clock&"),
    ("thread", r"\bstd::(jthread|thread|async)\b(?!::)|\bpthread_create\b", r"pipeline/flow/|tests/",
     "threads live in pipeline/flow and in named I/O threads listed with a reason in tools/lint/allowed.toml"),
    ("random", r"\bstd::(random_device|mt19937(_64)?|default_random_engine|\w+_distribution|shuffle)\b|\bs?rand\s*\(",
     r"tests/", "use protocol/base/rng.hpp: the same numbers everywhere"),
    ("mode", r"\bmicro_\b|\bcoded\s*\(\s*\)|\bpatterns\s*\.\s*mode\b",
     r"calib/model/|pipeline/decode/(mode_t/|mode_m/|pattern_modes\.cpp$)|tools/twin/|tests/",
     "which pattern mode it is, is asked once, where the strategy is made (pipeline/decode/pattern_modes.cpp)"),
    ("test_name", r"^[ \t]*(?:TYPED_)?TEST(?:_[FP])?\((?!\s*[A-Z][A-Za-z0-9]*\s*,\s*[a-z0-9]+(?:_[a-z0-9]+)*\s*\))",
     r"tools/", "a suite's name is CamelCase, a test's a sentence in snake_case: TEST(Faults, lost_frame_is_told)"),
    ("using_namespace", r"^\s*using namespace\b", r".*\.cpp$", "a header must not open a namespace for everybody"),
]


def check_patterns(path: str, code: str) -> list[Finding]:
    found = []
    for rule, pattern, exempt, advice in PATTERNS:
        if re.match(exempt, path) or path.rsplit(".", 1)[0] in ALLOWED.get(rule, {}):
            continue
        for m in re.finditer(pattern, code, re.MULTILINE):
            found.append(Finding(path, code.count("\n", 0, m.start()) + 1, rule, advice))
    return found


def head_kind(head: str) -> str:
    """What a '{' outside functions opens, told by the text since the last statement: scope, function or value."""
    if head.count("(") > head.count(")"):
        return "value"
    while (bare := re.sub(r"<[^<>]*>", "", head)) != head:  # template parameters and arguments
        head = bare
    head = re.sub(r"\brequires\s*(\([^()]*\)|\w+)|\[\[[^\]]*\]\]|alignas\s*\([^()]*\)", " ", head).strip()
    head = re.sub(r"^(template|inline|static|constexpr|public:|private:|protected:|\s)+", "", head)
    if re.match(r'(namespace|class|struct|union|enum|extern)\b', head) and not re.search(r"\)\s*\w*$", head):
        return "scope"
    if re.search(r"(?<![=!<>])=(?!=)", re.sub(r"operator\s*[^\s(]+|\([^()]*\)", "", head)):
        return "value"
    if re.search(r"\)\s*(noexcept)?\s*:[^:]", head):  # constructor's initialiser list
        return "value" if re.search(r"[\w>]$", head) else "function"
    return "function" if "(" in head else "value"


def heads(code: str):
    """(kind, first line, last line, head) of what stands outside function bodies: "function" with its body's lines, and
    "statement", which ends at a semicolon: a declaration of a function among them."""
    depth = 0
    start = None  # (depth outside, line, head) of the function we are in
    head_begin = 0
    values: list[int] = []
    for m in re.finditer(r"[{};]|^[ \t]*#.*$", code, re.MULTILINE):
        c = m.group(0)
        line = code.count("\n", 0, m.start()) + 1
        head = " ".join(code[head_begin:m.start()].split())
        if c == "{":
            kind = "inside" if start is not None or values else head_kind(head)
            if kind == "function":
                start = (depth, line, head)
            if kind == "value" or (kind == "inside" and start is None):
                values.append(depth)
            elif kind == "scope":
                head_begin = m.end()
            depth += 1
        elif c == "}":
            depth -= 1
            if start is not None and start[0] == depth:
                yield "function", start[1], line, start[2]
                start = None
                head_begin = m.end()
            elif values:
                values.pop()
            elif start is None:
                head_begin = m.end()
        elif c == ";" or c.lstrip().startswith("#"):
            if start is None and not values:
                if c == ";":
                    yield "statement", line, line, head
                head_begin = m.end()


def parameters(head: str) -> int:
    """How many parameters a function's head declares; 0 of what is no function."""
    head = re.sub(r"\[\[[^\]]*\]\]|\b(?:alignas|explicit|noexcept|decltype)\s*\([^()]*\)", " ", head)
    head = re.sub(r"\boperator\s*\(\s*\)", "operator_call", head)
    m = re.match(r"[^()=]*?[\w:<>,&*\s~]*?[a-z]\w*\s*\(", head)
    if not m or re.match(r"(using|typedef|static_assert|return|friend class)\b", head):
        return 0
    depth, count, start = 0, 0, m.end()
    for i in range(m.end(), len(head)):
        c = head[i]
        if c in "([{<":
            depth += 1
        elif c in ">" and head[i - 1] == "-":
            continue
        elif c in ")]}>":
            depth -= 1
            if depth < 0:
                return count + 1 if head[start:i].strip() else count
        elif c == "," and depth == 0:
            count += 1
            start = i + 1
    return 0


def check_functions(path: str, code: str) -> list[Finding]:
    found = []
    kernel = re.search(r"_rows\.[ch]pp$|-inl\.h$|/(micro_pixel|frame_rows)\.hpp$", path)
    for kind, first, last, head in heads(code):
        if kind == "function" and last - first + 1 > MAX_FUNCTION_LINES:
            found.append(Finding(path, first, "function_length",
                                 f"{last - first + 1} lines, at most {MAX_FUNCTION_LINES}: {head[-60:]}"))
        count = 0 if kernel or path.startswith("tests/") else parameters(head)
        if count > MAX_PARAMETERS:
            found.append(Finding(path, first, "parameters",
                                 f"{count} parameters, at most {MAX_PARAMETERS}; a struct with names tells more: {head[:60]}"))
    return found


def check_units(path: str, code: str) -> list[Finding]:
    """Floating members of `struct …Config` whose name speaks of a dimension end in its unit."""
    found = []
    in_config = False
    for number, line in enumerate(code.split("\n"), 1):
        if re.match(r"\s*struct \w*Config\b[^;]*$", line):
            in_config = True
        elif re.match(r"\s*};", line):
            in_config = False
        m = re.match(r"\s*(?:float|double) (\w+)(?:\s*=[^;]*|\{[^;]*\})?;", line)
        if in_config and m and re.search(rf"(^|_)({DIMENSIONS})(_(max|min))?$", m.group(1)) and not re.search(UNITS, m.group(1)):
            found.append(Finding(path, number, "unit", f"'{m.group(1)}' needs its unit as suffix: _mm _um _ns _rad _px _dn"))
    return found


def check(path: str, text: str) -> list[Finding]:
    found = []
    lines = text.rstrip("\n").split("\n")
    if len(lines) > MAX_FILE_LINES:
        found.append(Finding(path, MAX_FILE_LINES, "file_length", f"{len(lines)} lines, at most {MAX_FILE_LINES}: split it"))
    for number, line in enumerate(lines, 1):
        if re.search(r"\b(TODO|FIXME|XXX|HACK)\b(?!\(#\d+\))", line) and not path.startswith("tools/lint/"):
            found.append(Finding(path, number, "todo", "an open end needs an issue number: TODO(#12)"))
    if not path.endswith((".cpp", ".hpp")):
        return found
    code = blank_comments_and_strings(text)
    found += check_patterns(path, code) + check_functions(path, code) + check_units(path, code)
    if path.endswith(".hpp") and not re.search(r"^#pragma once$", text, re.MULTILINE):
        found.append(Finding(path, 1, "pragma_once", "a header begins with #pragma once"))
    return found


if __name__ == "__main__":
    sys.exit(main(__doc__, "source", RULES, CPP | {".py"}, check))

#!/usr/bin/env python3
"""Makes docs/errors.md from protocol/base/error_codes.def. --check [FILE]: fail when it is not up to date."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = ROOT / "protocol/base/error_codes.def"
DOC = ROOT / "docs/errors.md"
CLASSES = {1: "usage", 2: "input or configuration", 3: "device", 4: "data loss", 5: "internal", 6: "quality gate"}


def entries(text: str) -> list[tuple[str, int, str, str, str]]:
    string = r'"((?:\\.|[^"\\])*)"'
    pattern = re.compile(rf"^ENAMEL_ERROR\((\w+),\s*(\d+),\s*{string},\s*{string},\s*{string}\)$", re.MULTILINE)
    found = [(m[1], int(m[2]), m[3], m[4], m[5]) for m in pattern.finditer(text)]
    lines = len(re.findall(r"^ENAMEL_ERROR", text, re.MULTILINE))
    if lines != len(found):
        sys.exit(f"{TABLE}: {lines} entries, {len(found)} understood: one a line, five arguments")
    numbers = [e[1] for e in found]
    if len(set(numbers)) != len(numbers):
        sys.exit(f"{TABLE}: a number is used twice")
    return found


def document(table: list[tuple[str, int, str, str, str]]) -> str:
    out = ["# Errors", "", "Made from `protocol/base/error_codes.def` by `tools/lint/gen_errors.py`; do not edit.",
           "A program's exit code is the hundreds digit."]
    for number, name in CLASSES.items():
        out += ["", f"## Exit code {number}: {name}", "", "| Code | Error | Likely cause | What to do |", "|---|---|---|---|"]
        out += [f"| {n} `{code}` | {text} | {cause} | {remedy} |" for code, n, text, cause, remedy in sorted(table, key=lambda e: e[1])
                if n // 100 == number]
    return "\n".join(out).replace('\\"', '"') + "\n"


def main() -> int:
    wanted = document(entries(TABLE.read_text(encoding="utf-8")))
    args = sys.argv[1:]
    if args[:1] != ["--check"]:
        DOC.write_text(wanted, encoding="utf-8")
        return 0
    doc = pathlib.Path(args[1]) if len(args) > 1 else DOC
    if doc.is_file() and doc.read_text(encoding="utf-8") == wanted:
        return 0
    print(f"{doc} is out of date: run tools/lint/gen_errors.py")
    return 1


if __name__ == "__main__":
    sys.exit(main())

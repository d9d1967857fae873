#!/usr/bin/env python3
"""Fills the table of refusals in docs/flashing.md from protocol/image/refusals.def. --check [FILE]: fail when it is stale."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = ROOT / "protocol/image/refusals.def"
DOC = ROOT / "docs/flashing.md"
START, END = "<!-- refusals: made by tools/lint/gen_refusals.py -->", "<!-- end of refusals -->"


def entries(text: str) -> list[tuple[str, str, str, str, str, str]]:
    string = r'"((?:\\.|[^"\\])*)"'
    pattern = re.compile(rf"^ENAMEL_REFUSAL\((\w+), (\d+), (\w+), {string}, {string}, {string}\)$", re.MULTILINE)
    found = [m.groups() for m in pattern.finditer(text)]
    lines = len(re.findall(r"^ENAMEL_REFUSAL", text, re.MULTILINE))
    if lines != len(found):
        sys.exit(f"{TABLE}: {lines} entries, {len(found)} understood: one a line, six arguments")
    return found


def table(found: list[tuple[str, str, str, str, str, str]]) -> str:
    rows = [f"| {number} | {what} | {cause} | {remedy} |" for _, number, _, what, cause, remedy in found]
    return "\n".join([START, "| Number | The tool says | Likely cause | What to do |", "|---|---|---|---|", *rows, END])


def main() -> int:
    args = sys.argv[1:]
    check = args[:1] == ["--check"]
    doc = pathlib.Path(args[1]) if check and len(args) > 1 else DOC
    text = doc.read_text(encoding="utf-8")
    head, _, rest = text.partition(START)
    _, _, tail = rest.partition(END)
    wanted = head + table(entries(TABLE.read_text(encoding="utf-8"))) + tail
    if not check:
        doc.write_text(wanted, encoding="utf-8")
        return 0
    if wanted == text:
        return 0
    print(f"{doc} is out of date: run tools/lint/gen_refusals.py")
    return 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Fills the tables of exit codes and messages in docs/flashing.md from their tables in the code. --check [FILE]: fail when stale."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOC = ROOT / "docs/flashing.md"
STRING = r'"((?:\\.|[^"\\])*)"'


def entries(path: str, macro: str, arguments: str) -> list[tuple[str, ...]]:
    text = (ROOT / path).read_text(encoding="utf-8")
    found = re.findall(rf"^{macro}\({arguments}\)$", text, re.MULTILINE)
    lines = len(re.findall(rf"^{macro}", text, re.MULTILINE))
    if lines == 0 or lines != len(found):
        sys.exit(f"{path}: {lines} entries, {len(found)} understood: one a line")
    return found


def cell(text: str) -> str:
    """A C string as a cell, without the lines that are meant to be copied."""
    return text.replace('\\"', '"').split("\\n")[0]


def to_copy(texts: list[str]) -> str:
    """What follows a line break in messages, as a block below their table."""
    lines = [line.strip() for text in texts for line in text.replace('\\"', '"').split("\\n")[1:]]
    return "\n".join(["", "", "The line to write:", "", "```", *lines, "```"]) if lines else ""


def rows(heads: str, found: list[list[str]]) -> str:
    return "\n".join([f"| {heads} |", "|" + "---|" * len(found[0]), *("| " + " | ".join(r) + " |" for r in found)])


def blocks() -> dict[str, str]:
    exits = entries("host/update/exit_codes.def", "ENAMEL_EXIT", rf"(\w+), (\d+), {STRING}")
    number = {name: n for name, n, _ in exits}
    host = entries("host/update/host_errors.def", "ENAMEL_HOST_ERROR", rf"(\w+), (\w+), {STRING}, {STRING}, {STRING}")
    probe = entries("protocol/image/refusals.def", "ENAMEL_REFUSAL", rf"\w+, (\d+), \w+, (\d+), {STRING}, {STRING}, {STRING}")
    unknown = {name for _, name, *_ in host} - set(number) | {n for _, n, *_ in probe} - set(number.values())
    if unknown:
        sys.exit(f"exit codes that host/update/exit_codes.def does not have: {', '.join(sorted(unknown))}")
    return {
        "exit codes": rows("Exit code | Meaning", [[n, cell(meaning)] for _, n, meaning in exits]),
        "messages of the tool": rows("The tool says | Likely cause | What to do | Exit code",
                                     [[*map(cell, texts), number[name]] for _, name, *texts in host])
        + to_copy([text for _, _, *texts in host for text in texts]),
        "refusals": rows("Number | The tool says | Likely cause | What to do | Exit code",
                         [[n, *map(cell, texts), code] for n, code, *texts in probe]),
    }


def filled(text: str) -> str | None:
    for name, table in blocks().items():
        start, end = f"<!-- {name}: made by tools/lint/gen_messages.py -->", f"<!-- end of {name} -->"
        if text.count(start) != 1 or text.count(end) != 1:
            return None
        head, _, rest = text.partition(start)
        text = head + start + "\n" + table + "\n" + end + rest.partition(end)[2]
    return text


def main() -> int:
    args = sys.argv[1:]
    check = args[:1] == ["--check"]
    doc = pathlib.Path(args[1]) if check and len(args) > 1 else DOC
    text = doc.read_text(encoding="utf-8")
    wanted = filled(text)
    if not check and wanted is not None:
        doc.write_text(wanted, encoding="utf-8")
        return 0
    if wanted == text:
        return 0
    print(f"{doc} is out of date or lacks the marks of a table: run tools/lint/gen_messages.py")
    return 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Documents are for readers: short cells, lines and pages, and links that lead somewhere."""
import pathlib
import posixpath
import re
import subprocess
import sys

from lint_common import CODE_DIRS, ROOT, Finding, main

MAX_CELL = 120
MAX_PROSE = 160
RULES = {"cell", "prose", "length", "link"}

# pattern of the path, lines at most
LENGTHS = [
    (r"README\.md", 150),
    (r"docs/decode\.md", 300),
    (r"docs/adr/.*\.md", 60),
    (rf"({'|'.join(CODE_DIRS)})/(.*/)?README\.md", 60),
]
ONE_LINK = re.compile(r"\s*([-*|>]\s*)?(!?\[[^\]]*\]\([^)]*\)|<?https?://\S+>?)\s*")
LINK = re.compile(r"\]\(<?([^)\s>]+)>?[^)]*\)")


def prose_lines(text: str):
    """(number, line) outside of fenced code."""
    fence = None
    for number, line in enumerate(text.rstrip("\n").split("\n"), 1):
        m = re.match(r"\s*(```+|~~~+)", line)
        if m and fence is None:
            fence = m.group(1)
        elif m and m.group(1).startswith(fence):
            fence = None
        elif fence is None:
            yield number, line


def check_widths(path: str, number: int, line: str) -> list[Finding]:
    if line.lstrip().startswith("|"):
        cells = [c.strip() for c in re.split(r"(?<!\\)\|", line.strip().strip("|"))]
        return [Finding(path, number, "cell", f"a cell of {len(c)} characters, at most {MAX_CELL}: '{c[:40]}…'")
                for c in cells if len(c) > MAX_CELL]
    if len(line) > MAX_PROSE and not ONE_LINK.fullmatch(line):
        return [Finding(path, number, "prose", f"{len(line)} characters, at most {MAX_PROSE}")]
    return []


def check_links(path: str, number: int, line: str) -> list[Finding]:
    found = []
    for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
        file = target.split("#")[0]
        if not file or re.match(r"[a-z][a-z0-9+.-]*:", file):
            continue
        place = posixpath.normpath(posixpath.join(posixpath.dirname(path), file))
        if not (ROOT / pathlib.PurePosixPath(place)).exists():
            found.append(Finding(path, number, "link", f"'{target}' leads nowhere"))
    return found


def check(path: str, text: str) -> list[Finding]:
    found = []
    lines = text.rstrip("\n").count("\n") + 1
    for pattern, most in LENGTHS:
        if re.fullmatch(pattern, path) and lines > most:
            found.append(Finding(path, most, "length", f"{lines} lines, at most {most}: link to what is told elsewhere"))
    for number, line in prose_lines(text):
        found += check_widths(path, number, line) + check_links(path, number, line)
    return found


def documents() -> list[str]:
    """Repository paths of the documents that git tracks, sorted."""
    git = ["git", "-C", str(ROOT), "-c", f"safe.directory={ROOT}"]  # the clone may be another user's
    listed = subprocess.run([*git, "ls-files", "*.md"], check=True, capture_output=True, text=True)
    return sorted(p for p in listed.stdout.splitlines() if (ROOT / p).is_file())


if __name__ == "__main__":
    sys.exit(main(__doc__, "docs", RULES, documents, check))

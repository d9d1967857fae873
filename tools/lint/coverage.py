#!/usr/bin/env python3
"""coverage.py BUILD: share of the product's lines that ran, from the counts that a coverage build left, by folder."""
import collections
import concurrent.futures
import csv
import json
import pathlib
import subprocess
import sys

from lint_common import CODE_DIRS, ROOT


def counts_of(build: pathlib.Path, gcda: pathlib.Path) -> list[tuple[str, int, int]]:
    """(repository path, line, times run) of each line that a compiled file knows."""
    out = subprocess.run(["gcov", "--json-format", "--stdout", str(gcda)], cwd=gcda.parent, check=True, capture_output=True).stdout
    rows = []
    for text in out.splitlines():
        for file in json.loads(text)["files"]:
            path = (build / file["file"]).resolve()  # compilers run in the build folder
            if path.is_relative_to(ROOT):
                name = path.relative_to(ROOT).as_posix()
                rows += [(name, line["line_number"], line["count"]) for line in file["lines"]]
    return rows


def main() -> int:
    build = pathlib.Path(sys.argv[1]).resolve()
    files: dict[str, dict[int, int]] = collections.defaultdict(lambda: collections.defaultdict(int))
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for rows in pool.map(lambda gcda: counts_of(build, gcda), sorted(build.rglob("*.gcda"))):
            for name, line, count in rows:
                files[name][line] += count
    product = {n: c for n, c in files.items() if n.split("/")[0] in CODE_DIRS and not n.startswith(("tests/", "build/"))}
    if not product:
        sys.exit(f"{build}: no counts; run tools/lint/coverage")
    folders: dict[str, list[int]] = collections.defaultdict(lambda: [0, 0])
    with open(build / "coverage.csv", "w", newline="", encoding="utf-8") as out:
        table = csv.writer(out)
        table.writerow(["file", "lines", "ran"])
        for name, lines in sorted(product.items()):
            ran = sum(1 for c in lines.values() if c > 0)
            table.writerow([name, len(lines), ran])
            for folder in {"/".join(name.split("/")[:2]), "all"}:
                folders[folder][0] += len(lines)
                folders[folder][1] += ran
    print(f"{'folder':32} {'lines':>7} {'ran':>7} {'share':>7}")
    for folder, (lines, ran) in sorted(folders.items(), key=lambda f: (f[0] == "all", f[0])):
        print(f"{folder:32} {lines:7} {ran:7} {100 * ran / lines:6.1f}%")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Shared by the house linters: which files there are, how findings print, how the samples prove that each rule can fail."""
import argparse
import pathlib
import re
import sys
from typing import Callable, NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE_DIRS = ["calib", "firmware", "host", "pipeline", "protocol", "tests", "tools", "viewer"]
CPP = {".cpp", ".hpp"}
SAMPLES = ROOT / "tools/lint/samples"


class Finding(NamedTuple):
    path: str
    line: int
    rule: str
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text} [{self.rule}]"


def code_files(suffixes: set[str]) -> list[str]:
    """Repository paths of code files, sorted."""
    found = []
    for top in CODE_DIRS:
        for p in (ROOT / top).rglob("*"):
            if p.suffix in suffixes and p.is_file() and "node_modules" not in p.parts and SAMPLES not in p.parents:
                found.append(p.relative_to(ROOT).as_posix())
    return sorted(found)


def blank_comments_and_strings(text: str) -> str:
    """Same length and lines, with the inside of comments, strings and character literals replaced by spaces."""
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|R"(?P<d>[^()\s]{0,16})\(.*?\)(?P=d)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'',
        re.DOTALL)
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)


def read_sample(file: pathlib.Path) -> tuple[str, str]:
    """A sample's first line is '// as PATH' or '// as PATH, last line N times': where it pretends to lie."""
    first, _, body = file.read_text(encoding="utf-8").partition("\n")
    m = re.fullmatch(r"// as (\S+?)(?:, last line (\d+) times)?", first.strip())
    if not m:
        sys.exit(f"{file}: the first line must be '// as PATH'")
    if m.group(2):
        lines = body.rstrip("\n").split("\n")
        body = "\n".join(lines + [lines[-1]] * (int(m.group(2)) - 1)) + "\n"
    return m.group(1), body


def self_test(folder: str, rules: set[str], check: Callable[[str, str], list[Finding]]) -> int:
    """Every sample RULE.*.sample must give RULE and nothing else, clean.*.sample nothing; every rule needs a sample."""
    failures = []
    seen = set()
    for file in sorted((SAMPLES / folder).glob("*.sample")):
        rule = file.name.split(".")[0]
        seen.add(rule)
        path, body = read_sample(file)
        got = {f.rule for f in check(path, body)}
        want = set() if rule == "clean" else {rule}
        if got != want:
            failures.append(f"{file.name}: expected {sorted(want)}, got {sorted(got)}")
    failures += [f"rule {r} has no failing sample" for r in sorted(rules - seen)]
    failures += [f"sample for unknown rule {r}" for r in sorted(seen - rules - {'clean'})]
    if "clean" not in seen:
        failures.append("no clean sample")
    for f in failures:
        print(f"self-test: {f}")
    print(f"self-test: {len(seen)} kinds of samples, {len(failures)} failures")
    return 1 if failures else 0


def main(description: str, folder: str, rules: set[str], files: set[str] | Callable[[], list[str]],
         check: Callable[[str, str], list[Finding]]) -> int:
    """files: suffixes of the code files to look at, or what lists them."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--self-test", action="store_true", help="check that every rule finds its sample")
    parser.add_argument("paths", nargs="*", help="repository paths; default: all")
    args = parser.parse_args()
    if args.self_test:
        return self_test(folder, rules, check)
    findings = []
    for path in args.paths or (files() if callable(files) else code_files(files)):
        findings += check(path, (ROOT / path).read_text(encoding="utf-8"))
    for f in findings:
        print(f)
    return 1 if findings else 0

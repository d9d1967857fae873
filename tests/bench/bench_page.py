"""What the benchmark pages share: rows with a target, the machine, and how a page is written."""
import json
import os
import platform
import re
import subprocess
import textwrap


def wrapped(text, indent=""):
    """One paragraph in lines that documents may have (tools/lint/check_docs.py)."""
    return textwrap.fill(text, 130, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


class Page:
    """Rows with a target, each either met or not, in sections."""

    def __init__(self, method=None):
        """method: the document in docs that tells it, where it is not the page's namesake."""
        self.rows, self.text, self.method = [], [], method

    def section(self, title, note=""):
        self.text += ["", f"## {title}", ""] + ([wrapped(note), ""] if note else [])
        self.text += ["| What | Target | Measured | Met |", "|---|---|---|---|"]

    def row(self, what, target, measured, met):
        """met: True, False, or None where there is no target."""
        self.rows.append({"what": what, "target": target, "measured": measured, "met": met})
        self.text.append(f"| {what} | {target} | {measured} | {'–' if met is None else 'yes' if met else '**no**'} |")

    def table(self, title, columns, targets, rows):
        """One figure a cell. rows: (name, [(text, met), …]), met as in row(); what is judged counts and stands in the head."""
        self.text += ["", f"| {title} | " + " | ".join(columns) + " |", "|---" * (1 + len(columns)) + "|"]
        if any(targets):
            self.text.append("| *target* | " + " | ".join(t or "–" for t in targets) + " |")
        for name, cells in rows:
            self.text.append(f"| {name} | " + " | ".join(f"**{text}**" if met is False else text for text, met in cells) + " |")
            self.rows += [{"what": f"{name}: {column}", "target": target, "measured": text, "met": met}
                          for column, target, (text, met) in zip(columns, targets, cells) if met is not None]

    def note(self, text):
        self.text += ["", text, ""]

    def write(self, out, name, tool, where, figures):
        """OUT/NAME.md and OUT/NAME.json: the page under its head of targets met and missed, and the figures."""
        method = self.method or f"{name}.md"
        judged = [r for r in self.rows if r["met"] is not None]
        missed = [r for r in judged if not r["met"]]
        head = [f"# {name.capitalize()} benchmark", "", f"Made by `{tool}`; do not edit. Figures: [{name}.json]({name}.json). "
                f"The method: [../{method}](../{method}).", "",
                f"{len(judged) - len(missed)} of {len(judged)} targets met. {where['cpu']}, {where['cores']} cores, load "
                f"{where['load_1min']:.1f}, commit {where['commit']}.", ""]
        if missed:
            head += ["Missed:", ""] + [wrapped(f"- {r['what']}: {r['measured']} (target {r['target']})", "  ") for r in missed]
        with open(f"{out}/{name}.md", "w", encoding="utf-8") as f:
            f.write("\n".join(head + self.text) + "\n")
        with open(f"{out}/{name}.json", "w", encoding="utf-8") as f:
            json.dump({"machine": where, "rows": self.rows, **figures}, f, indent=1,
                      default=lambda x: x.item() if hasattr(x, "item") else str(x))
            f.write("\n")

    def within(self, out, name):
        """The page OUT/NAME with this page's only section in place of its own of that title; its figures."""
        with open(f"{out}/{name}.json", encoding="utf-8") as f:
            figures = json.load(f)
        with open(f"{out}/{name}.md", encoding="utf-8") as f:
            blocks = re.split(r"(?m)^(?=## )", f.read())[1:]
        title = f"{self.text[1]}\n"
        if not any(b.startswith(title) for b in blocks):
            raise ValueError(f"{out}/{name}.md has no section '{title.strip()}': make the whole page first")
        page, own = Page(), {r["what"]: r for r in self.rows}
        page.rows = [own.get(r["what"], r) for r in figures.pop("rows")]
        mine = "\n".join(self.text[1:]) + "\n\n"
        page.text = ["", *"".join(mine if b.startswith(title) else b for b in blocks).rstrip("\n").split("\n")]
        return page, figures


def machine():
    cpu = platform.machine()
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    return {"cpu": cpu, "cores": os.cpu_count(), "kernel": platform.release(), "load_1min": os.getloadavg()[0], "commit": commit}

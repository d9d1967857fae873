#!/usr/bin/env python3
"""speed_page.py BUILD OUT CACHE [--bursts N] [--repeat R] [--check | --accept REASON]: what each stage of the pipeline costs.

Writes OUT/speed.md, speed.json and a row of speed_history.json; --check only compares with the history's last row."""
import argparse
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import graph_cores as cores  # noqa: E402
import speed_history as history  # noqa: E402
import speed_recordings as recordings  # noqa: E402
import speed_short as short  # noqa: E402
from bench_page import Page, machine, wrapped  # noqa: E402

DECODE = {True: ("decode, still bursts", 10, 9), False: ("decode, moving bursts", 16, 12)}  # still: title, target, goal


def measure(build, captures, arguments):
    """What bench_speed says of the recordings."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "speed.json")
        ran = subprocess.run([os.path.join(build, "bin/bench_speed"), *captures, *arguments, "--json", path],
                             stdout=sys.stderr, env={**os.environ, "ENAMEL_LOG": "error"}, check=False)
        if ran.returncode != 0:
            sys.exit(f"bench_speed ended with {ran.returncode}: nothing is written")
        with open(path, encoding="utf-8") as f:
            return json.load(f)


def git(*words):
    return subprocess.run(["git", *words], capture_output=True, text=True, check=False).stdout.strip()


def with_short_form(build, measured, captures):
    """The recording of the test speed_instructions as well, where the tests have rendered it."""
    small = short.CAPTURE.format(build=build)
    if not os.path.exists(small):
        print("note: no small.mcap (the test render_small makes it): the row has none for speed_instructions", file=sys.stderr)
        return measured, captures
    more = measure(build, [small], short.ARGUMENTS)
    return {**measured, "recordings": measured["recordings"] + more["recordings"]}, captures + [small]


def row_of(measured, captures, reason=""):
    prints = {os.path.splitext(os.path.basename(c))[0]: recordings.fingerprint(c) for c in captures}
    changed = "+" if git("status", "--porcelain", "--untracked-files=no", "--", "pipeline", "protocol", "host", "calib", "cmake") else ""
    return history.row_of(measured, git("rev-parse", "--short", "HEAD") + changed, git("log", "-1", "--format=%cs"), prints, reason)


def ratio(part, peer, limit=None):
    if not peer:
        return ("–", None)
    return (f"{part / peer:.2f} ×", None if limit is None else part / peer <= limit)


def beside(stage, peer, limit=None):
    """Core time beside a peer's, then instructions."""
    return [ratio(stage["ms"]["mean"], peer.get("ms"), limit), ratio(stage["instructions"], peer.get("instructions"))]


def own_cells(stage, counted):
    ms = stage["ms"]
    return [(f"{stage['instructions'] / 1e6:.1f} M" if counted else "–", None), (f"{ms['mean']:.1f}", None), (f"{ms['p50']:.1f}", None),
            (f"{ms['p99']:.1f}", None), (f"{stage['heap']['blocks']:.0f}", stage["heap"]["blocks"] == 0)]


OWN, OWN_TARGETS = ["instructions", "mean, ms", "p50, ms", "p99, ms", "heap blocks"], ["", "", "", "", "0"]


def stage_tables(page, measured):
    for still, (title, limit, goal) in DECODE.items():
        mine = [r for r in measured if recordings.is_still(r["name"]) == still]
        rows = [(f"decode, {r['name']}", own_cells(r["stages"]["decode"], not r["counter_problem"])
                 + beside(r["stages"]["decode"], r["peers"].get("phase_opencv", {}), limit)
                 + [ratio(r["stages"]["decode"]["ms"]["mean"], r["peers"]["copy"]["ms"])]) for r in mine]
        page.table(title, OWN + ["× subtract + cartToPolar", "… instructions", "× copy"],
                   OWN_TARGETS + [f"≤ {limit} × (goal {goal})", "", ""], rows)
    rows = []
    for r in measured:
        track = r["stages"]["track"]
        rows.append((f"track, {r['name']}", own_cells(track, not r["counter_problem"])
                     + [ratio(track["ms"]["p99"], track["ms"]["mean"], 2), *beside(track, r["peers"].get("icp_loop", {}), 1)]))
    page.table("track", OWN + ["p99 / mean", "× ICP loop", "… instructions"], OWN_TARGETS + ["≤ 2 ×", "≤ 1.0 ×", ""], rows)
    rows = []
    for r in measured:
        fuse, peers = r["stages"]["fuse"], r["peers"]
        rows.append((f"fuse, {r['name']}", own_cells(fuse, not r["counter_problem"]) + beside(fuse, peers.get("hash_tsdf", {}), 0.25)
                     + beside(fuse, peers.get("tsdf_loop", {}))))
    page.table("fuse", OWN + ["× HashTSDF", "… instructions", "× TSDF loop", "… instructions"], OWN_TARGETS + ["≤ 0.25 ×", "", "", ""], rows)


def whole_tables(page, measured):
    rows = []
    for r in measured:
        whole, counted = r["whole"], not r["counter_problem"]
        heap = sum(r["stages"][s]["heap"]["kib"] for s in history.JUDGED) / 1024
        rows.append((r["name"], [(str(r["bursts"]), None), (f"{r['fused']}", None),
                                 (f"{whole['instructions'] / 1e6:.0f} M" if counted else "–", None), (f"{whole['core_ms']:.0f}", None),
                                 (f"{whole['bursts_per_s']['1']:.1f}", None), (f"{whole['bursts_per_s']['2']:.1f}", None),
                                 (f"{heap:.0f}", None), (f"{r['rss_mib']['before']:.0f} … {r['rss_mib']['peak']:.0f}", None)]))
    page.table("the whole", ["bursts", "fused", "instructions", "core-ms", "bursts/s, 1 worker", "2 workers", "heap, MiB", "memory, MiB"],
               [""] * 8, rows)
    rows = []
    for r in measured:
        p, icp, tsdf = r["peers"], r["peers"].get("icp_loop", {}), r["peers"].get("tsdf_loop", {})
        rows.append((r["name"], [number(p.get("phase_opencv", {}).get("ms"), 2), number(p["copy"]["ms"], 2), number(icp.get("ms"), 1),
                                 number(icp.get("apart_um"), 0), number(tsdf.get("ms"), 1), number(tsdf.get("off_um"), 0),
                                 number(p.get("hash_tsdf", {}).get("ms"), 1)]))
    page.table("peers, ms of one core", ["subtract + cartToPolar", "copy, 12 B a pixel", "ICP loop", "… apart, um", "TSDF loop", "… off, um", "HashTSDF"],
               [""] * 7, rows)


def number(value, digits):
    return ("–" if value is None else f"{value:.{digits}f}", None)


def history_table(page, rows):
    names = sorted({name for row in rows for name in row["recordings"]})
    page.text += ["", "## History", "", wrapped("Millions of instructions a burst, decode / track / fuse. A reason stands where a loss was accepted."), "",
                  "| Commit | " + " | ".join(names) + " | Build | Why |", "|---" * (3 + len(names)) + "|"]
    for row in rows:
        cells = []
        for name in names:
            counts = row["recordings"].get(name, {}).get("instructions")
            cells.append("–" if counts is None else " / ".join(f"{counts[s] / 1e6:.1f}" for s in history.JUDGED))
        build = f"{row['build']['compiler']}, {row['build']['simd']}"
        page.text.append(f"| {row['commit']}, {row['date']} | " + " | ".join(cells) + f" | {build} | {row['reason'] or '–'} |")


def write_page(out, measured, rows):
    page = Page()
    build = measured["build"]
    page.text += ["", wrapped(f"A burst, one thread, load beside it as stated; {build['compiler']}, {build['simd']}, OpenCV {build['opencv']}. Of each "
                              f"burst the least of {measured['repeat']} runs; heap blocks over the second half of a recording. Instructions do not change "
                              "with the load of the machine; times do, and ratios to what was measured in the same minute less so. SIMULATED recordings."), ""]
    problems = sorted({r["counter_problem"] for r in measured["recordings"] if r["counter_problem"]})
    page.text += [wrapped(f"**{p}**") for p in problems]
    stage_tables(page, measured["recordings"])
    whole_tables(page, measured["recordings"])
    page.table("bursts/s by workers, simulated from the times above", [str(w) for w in cores.WORKERS] + ["ends at, bursts/s"],
               [""] * (len(cores.WORKERS) + 1), cores.rows_of(measured["recordings"]))
    history_table(page, rows)
    page.write(out, "speed", "tools/bench-speed", machine(), measured)
    print(f"{out}/speed.md")


def judge(row, rows):
    """Prints what there is to say; the losses."""
    if not rows:
        print("no history to compare with", file=sys.stderr)
        return []
    losses, notes = history.compare(row, rows[-1])
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    for loss in losses:
        print(f"LOSS: {loss}", file=sys.stderr)
    if not losses and history.judged(row, rows[-1]):
        print(f"no stage of {history.judged(row, rows[-1])} lost more than {100 * history.LIMIT:.0f} % since {rows[-1]['commit']}", file=sys.stderr)
    return losses


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", help="folder of bin")
    parser.add_argument("out")
    parser.add_argument("cache", help="folder of the recordings")
    parser.add_argument("--bursts", type=int)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--accept", metavar="REASON", default="")
    return parser.parse_args()


def main():
    given = parse()
    path = os.path.join(given.out, "speed_history.json")
    captures = recordings.make(os.path.join(given.build, "bin"), given.cache)
    some = ["--bursts", str(given.bursts)] if given.bursts else []
    rows = history.read(path)
    if given.check:
        sys.exit(1 if judge(row_of(measure(given.build, captures, [*some, "--quick", "--repeat", "1"]), captures), rows) else 0)
    measured = measure(given.build, captures, [*some, "--repeat", str(given.repeat)])
    row = row_of(*with_short_form(given.build, measured, captures), given.accept)
    losses = judge(row, rows)
    if not given.bursts and row["recordings"] and (given.accept or not losses):
        rows = history.with_row(rows, row)
        history.write(path, rows)
    write_page(given.out, measured, rows)
    if losses and not given.accept:
        sys.exit('no row was written: mend it, or say why it is worth it with --accept "REASON"')


if __name__ == "__main__":
    main()

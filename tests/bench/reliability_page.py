#!/usr/bin/env python3
"""reliability_page.py BUILD OUT [--kills N] …: OUT/reliability.md and reliability.json, what faults do to scans. SIMULATED.

With --soak MINUTES OUT/soak.md and soak.json instead: one long scan that nothing happens to."""
import argparse
import os
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bench_page import Page, machine  # noqa: E402
from reliability_faults import calm, kill, probe_killed, stop, trials  # noqa: E402
from reliability_files import Damage, FullDisk, PowerCut  # noqa: E402
from reliability_soak import rows as soak_rows, soak  # noqa: E402

COUNTS = ("kills", "probes", "stops", "power", "full", "damage", "seed")
KEPT = 100  # trials of a kind whose facts stay in the JSON; the rows are of all
HERE = os.path.dirname(os.path.abspath(__file__))


def share(page, what, facts, good):
    """A row: how many of the trials are good; all must be."""
    if facts:
        n = sum(bool(good(f)) for f in facts)
        page.row(what, "all", f"{n} of {len(facts)}", n == len(facts))


def kills(page, facts):
    page.section("Host killed", "SIGKILL at a random instant of a scan, then `enamel scan --resume` and a replay of the whole. Not in "
                 "the recording: bursts that the probe had sent in whole before the kill (bytes sent, by a shim), neither recorded "
                 "nor noted as shed.")
    hit = [f for f in facts if not f["ended_before"]]
    kept, again = [f for f in hit if "missing" in f], [f for f in hit if f.get("fresh") is False]
    if kept:
        worst = max(f["missing"] for f in kept)
        page.row(f"not in the recording, worst of {len(kept)}", "≤ 1", str(worst), worst <= 1)
    share(page, "recording not corrupt", kept, lambda f: not f["corrupt"])
    share(page, "nothing recorded yet: scanned afresh", [f for f in hit if f.get("fresh")], lambda f: f["fresh_ok"])
    share(page, "resumed", again, lambda f: f["resumed"])
    share(page, "result is the replay's", again, lambda f: f["same_hash"])
    share(page, "accounting balanced", again, lambda f: f["balanced"])
    share(page, "captured = played by the probe", again, lambda f: f["captured"] == f["played"])
    back = sorted(f["back_s"] for f in again if f["back_s"] is not None)
    if back:
        page.row("from --resume to the first new burst, worst", "–", f"{back[-1]:.1f} s", None)


def probes_killed(page, facts):
    page.section("Probe killed", "SIGKILL of the probe, and another of the same serial up to 2 s later.")
    for name, key in (("scan ends by itself", "ended"), ("accounting balanced", "balanced"),
                      ("nothing counted twice", "counted_once"), ("result is the replay's", "same_hash")):
        share(page, name, facts, lambda f, key=key: f[key])


def stops(page, facts, longest):
    hit = [f for f in facts if not f["came_too_late"]]
    page.section("Stopped for a while", f"SIGSTOP of host or probe for 0.1 to {longest:g} s.")
    share(page, "goes on and ends by itself", hit, lambda f: f["went_on"])
    share(page, "captured = begun by the probe", hit, lambda f: f["captured"] == f["begun"])
    share(page, "accounting balanced", hit, lambda f: f["balanced"])


def power_cuts(page, facts):
    page.section("Power cut", "Images of a live recording with writes after the last fdatasync lost in part: by page, by length.")
    worst = max(f["lost_s"] for f in facts)
    page.row(f"scan lost, worst of {len(facts)}", "≤ 1 s", f"{worst:.2f} s", worst <= 1)
    share(page, "opens, where older than 1 s", facts, lambda f: not f["cannot_open"])


def damages(page, facts, bursts):
    flips = [f for f in facts if f["flip"]]
    page.section("Damage", f"A live recording of {bursts} bursts: one bit flipped, or cut off, anywhere; `enamel capture repair`.")
    share(page, "no crash", facts, lambda f: not f["crashed"])
    share(page, "bit flipped: one burst missing at most", flips, lambda f: f["bursts"] >= bursts - 1)
    share(page, "bit flipped: bursts + missing = all", flips, lambda f: f["bursts"] + f["missing"] == bursts)


def full_disks(page, facts):
    page.section("Disk full", "A tmpfs of 1 to 90 % of what the command writes.")
    share(page, "told, exit code not 0", facts, lambda f: f["told"] and f["code"] != 0)
    share(page, "nothing half-written", facts, lambda f: not f["half_written"])


def experiments(given, folder, reference, rng):
    """name, how many trials, one by its number, what the page says of the facts."""
    session = reference["live"].session
    recording = os.path.join(session, "capture.mcap")
    if given.power:
        cut = PowerCut(recording, reference["live"].path("host.shim"))
        yield "power", given.power, lambda _: cut.trial(given, folder, rng), power_cuts
    if given.damage:
        harm = Damage(given, folder, recording)
        yield "damage", given.damage, lambda n: harm.trial(n % 2 == 0, rng), lambda page, facts: damages(page, facts, harm.bursts)
    if given.full:
        full = FullDisk(given, folder, session)
        names = list(full.commands)
        yield "full", given.full, lambda n: full.trial(names[n % len(names)], rng) or {"skipped": "no tmpfs"}, full_disks
    yield "kills", given.kills, lambda _: kill(given, folder, reference, rng), kills
    yield "probes", given.probes, lambda _: probe_killed(given, folder, reference, rng), probes_killed
    yield "stops", given.stops, lambda _: stop(given, folder, reference, rng), lambda page, facts: stops(page, facts, given.longest)


def options():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", help="folder of bin and fixtures")
    parser.add_argument("out")
    for name, count in zip(COUNTS, (3, 1, 2, 40, 14, 100, 1), strict=True):
        parser.add_argument(f"--{name}", type=int, default=count)
    parser.add_argument("--longest", type=float, default=8.0, help="seconds that a process is stopped at most")
    parser.add_argument("--soak", type=float, default=0.0, help="minutes of one long scan, and nothing else; 0: none")
    return parser.parse_args()


def soak_alone(given, folder):
    page = Page("reliability.md")
    facts = soak(given, folder)
    soak_rows(page, facts)
    page.write(given.out, "soak", "tools/bench-reliability --soak", machine(), {"soak": facts})
    print(f"{given.out}/soak.md")


def main():
    given = options()
    given.program = lambda name: os.path.join(given.build, "bin", name)
    given.recording = os.path.join(given.build, "fixtures/small.mcap")
    given.loops, given.speed, given.settings, given.damage_bursts, given.keep = 2, 0.25, [], 20, True
    page, rng = Page(), random.Random(given.seed)
    with tempfile.TemporaryDirectory() as folder:
        given.shim, given.scratch = os.path.join(folder, "shim.so"), os.path.join(folder, "scratch")
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", given.shim, f"{HERE}/reliability_shim.c", "-ldl"], check=True)
        reference = calm(given, folder)
        given.keep = False
        if given.soak > 0:
            soak_alone(given, folder)
            return
        figures = {"counts": {k: getattr(given, k) for k in COUNTS + ("longest",)}}
        for name, count, one, rows in experiments(given, folder, reference, rng):
            facts = [f for f in trials(name, count, one) if "skipped" not in f]
            figures[name] = facts[:KEPT]
            if facts:
                rows(page, facts)
            # After each: hours of trials are not lost with the one that hangs.
            page.write(given.out, "reliability", "tools/bench-reliability", machine(), figures)
    print(f"{given.out}/reliability.md")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""reliability_page.py BUILD OUT [--kills N] …: OUT/reliability.md and reliability.json, what faults do to scans. SIMULATED."""
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


def live(page, given, folder, reference, rng):
    figures = {"kills": trials("kill", given.kills, lambda _: kill(given, folder, reference, rng))}
    if given.kills:
        kills(page, figures["kills"])
    figures["probes"] = trials("probe", given.probes, lambda _: probe_killed(given, folder, reference, rng))
    if given.probes:
        page.section("Probe killed", "SIGKILL of the probe, and another of the same serial up to 2 s later.")
        for name, key in (("scan ends by itself", "ended"), ("accounting balanced", "balanced"),
                          ("nothing counted twice", "counted_once"), ("result is the replay's", "same_hash")):
            share(page, name, figures["probes"], lambda f, key=key: f[key])
    figures["stops"] = trials("stop", given.stops, lambda _: stop(given, folder, reference, rng))
    hit = [f for f in figures["stops"] if not f["came_too_late"]]
    if hit:
        page.section("Stopped for a while", f"SIGSTOP of host or probe for 0.1 to {given.longest:g} s.")
        share(page, "goes on and ends by itself", hit, lambda f: f["went_on"])
        share(page, "captured = begun by the probe", hit, lambda f: f["captured"] == f["begun"])
        share(page, "accounting balanced", hit, lambda f: f["balanced"])
    return figures


def files(page, given, folder, reference, rng):
    session = reference["live"].session
    recording = os.path.join(session, "capture.mcap")
    cut = PowerCut(recording, reference["live"].path("host.shim"))
    figures = {"power": trials("power", given.power, lambda _: cut.trial(given, folder, rng))}
    if given.power:
        page.section("Power cut", "Images of a live recording with writes after the last fdatasync lost in part: by page, by length.")
        worst = max(f["lost_s"] for f in figures["power"])
        page.row(f"scan lost, worst of {given.power}", "≤ 1 s", f"{worst:.2f} s", worst <= 1)
        share(page, "opens, where older than 1 s", figures["power"], lambda f: not f["cannot_open"])
    harm = Damage(given, folder, recording)
    figures["damage"] = trials("damage", given.damage, lambda n: harm.trial(n % 2 == 0, rng))
    flips = [f for f in figures["damage"] if f["flip"]]
    if flips:
        page.section("Damage", f"A live recording of {harm.bursts} bursts: one bit flipped, or cut off, anywhere; `enamel capture repair`.")
        share(page, "no crash", figures["damage"], lambda f: not f["crashed"])
        share(page, "bit flipped: one burst missing at most", flips, lambda f: f["bursts"] >= harm.bursts - 1)
        share(page, "bit flipped: bursts + missing = all", flips, lambda f: f["bursts"] + f["missing"] == harm.bursts)
    full = FullDisk(given, folder, session) if given.full else None
    names = list(full.commands) if full else []
    tried = trials("full", given.full, lambda n: full.trial(names[n % len(names)], rng) or {"skipped": "no tmpfs"})
    figures["full"] = [f for f in tried if "skipped" not in f]
    if figures["full"]:
        page.section("Disk full", "A tmpfs of 1 to 90 % of what the command writes.")
        share(page, "told, exit code not 0", figures["full"], lambda f: f["told"] and f["code"] != 0)
        share(page, "nothing half-written", figures["full"], lambda f: not f["half_written"])
    return figures


def options():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", help="folder of bin and fixtures")
    parser.add_argument("out")
    for name, count in (("kills", 3), ("probes", 1), ("stops", 2), ("power", 40), ("full", 14), ("damage", 100), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=count)
    parser.add_argument("--longest", type=float, default=8.0, help="seconds that a process is stopped at most")
    return parser.parse_args()


def main():
    given = options()
    given.program = lambda name: os.path.join(given.build, "bin", name)
    given.recording = os.path.join(given.build, "fixtures/small.mcap")
    given.loops, given.speed, given.settings, given.damage_bursts, given.keep = 2, 0.25, [], 20, True
    page, rng = Page("recording-format.md"), random.Random(given.seed)
    with tempfile.TemporaryDirectory() as folder:
        given.shim, given.scratch = os.path.join(folder, "shim.so"), os.path.join(folder, "scratch")
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", given.shim, f"{HERE}/reliability_shim.c", "-ldl"], check=True)
        reference = calm(given, folder)
        given.keep = False
        figures = files(page, given, folder, reference, rng)
        figures.update(live(page, given, folder, reference, rng))
    figures["counts"] = {k: getattr(given, k) for k in ("kills", "probes", "stops", "power", "full", "damage", "seed", "longest")}
    page.write(given.out, "reliability", "tools/bench-reliability", machine(), figures)
    print(f"{given.out}/reliability.md")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""decode_page.py WORK OUT ENAMEL [--rendered]: gathers what tools/bench measured, adds peers, writes OUT/decode.json, decode.md,
PNGs. --rendered: only the section of rendered bursts, into the page that is there."""
import json
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import decode_peers as peers  # noqa: E402
import decode_pictures as pictures  # noqa: E402
import order_sections as orders  # noqa: E402
from bench_page import Page, machine  # noqa: E402

SHARED = os.environ.get("ENAMEL_SHARED", "../shared")


def worst(rows, key):
    return max(abs(r[key]) for r in rows if key in r)


def medians(report):
    return {b["run_name"]: b for b in report["benchmarks"] if b.get("aggregate_name") == "median"}


def phase_rows(page, study, phase):
    page.section("Phase of four frames")
    for r in study["phase_noise"]:
        for name in ("four_frames", "three_frames"):
            page.row(f"std / predicted (Cramér–Rao), {name.replace('_', ' ')}, B = {r['modulation_dn']:g} DN", "1 ± 0.05",
                     f"{r[name]:.3f}", abs(r[name] - 1) <= 0.05)
    ours, every = (phase[f"{k}/bursts:1"]["ns_per_px"] for k in ("ours", "copy_all_our_maps"))
    page.row("time: phase, modulation, mean, C, S, D, sigma and mask (33 B/px)", "≤ 1 ms VGA (3.3 ns/px)",
             f"{ours:.2f} ns/px = {ours * 0.3072:.2f} ms", ours * 0.3072 <= 1)
    page.row("… beside copying as much", "–", f"{every:.2f} ns/px: {ours / every:.1f} times", None)
    for bursts, where in ((32, "32 bursts, from memory"), (1, "one burst, in the cache")):
        alone, polar, copy = (phase[f"{k}/bursts:{bursts}"]["ns_per_px"] for k in
                              ("textbook", "opencv_cart_to_polar", "copy_phase_and_modulation"))
        judge = bursts > 1  # what a burst fresh from the network meets
        page.row(f"phase and modulation alone (`four_step`, 12 B/px), {where}: beside copying as much", "≤ 1.2 times",
                 f"{alone:.2f} ns/px, copy {copy:.2f}: {alone / copy:.2f} times", alone <= 1.2 * copy if judge else None)
        page.row(f"… beside OpenCV subtract + cartToPolar, {where}", "≥ 3 times as fast",
                 f"OpenCV {polar:.2f} ns/px: {polar / alone:.2f} times as fast (a copy {polar / copy:.2f} times)", polar >= 3 * alone if judge else None)


def ripple_rows(page, study):
    page.section("Ripple of a projector's gamma, rad rms", "sigma/B = 0.02, errors averaged in 64 bins of phase. One term "
                 "is a1 sin 4phi; four are `phase_ripple.hpp`, which `BurstDecoder` subtracts from every burst by its own moments.")
    for r in study["gamma_ripple"]:
        ten, one = r["ours_10_bursts"], r["ours_1_burst"]
        page.row(f"gamma {r['gamma']}: four terms from 10 bursts (uncorrected {r['four_step']:.4f}, one term {r['one_term']:.5f})",
                 f"≤ 1/9 of double three-step = {r['double_three_step'] / 9:.5f}",
                 f"{ten:.5f}: 1/{r['double_three_step'] / ten:.0f}", ten <= r["double_three_step"] / 9)
        limit = max(r["four_step_1_burst"] / 9, 1e-3)
        page.row(f"gamma {r['gamma']}: four terms from one burst", f"≤ {limit:.5f}", f"{one:.5f}", one <= limit)


def scene_rows(page, scenes, work, noise):
    """The scenes drawn by number: mean, median and worst share of wrong orders, ours and the peers'."""
    for k, row in enumerate(scenes, 1):
        row["skimage"] = peers.skimage_unwrapping(work, f"s{noise}_{k}", 1)
    means = {}
    for key, label in (("ours", "least cuts"), ("opencv_histogram", "OpenCV"), ("skimage", "scikit-image"),
                       ("links_and_flood", "links + flood")):
        wrong = [row[key]["wrong_pct"] for row in scenes if row.get(key)]
        if wrong:
            means[key] = (label, wrong, float(np.median([row[key]["ms"] for row in scenes])))
    best = min((np.mean(means[k][1]) for k in ("opencv_histogram", "skimage") if k in means), default=None)
    for key, (label, wrong, ms) in means.items():
        ours = key == "ours" and best is not None
        page.row(f"{len(wrong)} scenes, sigma {noise} DN, {label}: wrong orders, mean",
                 f"≤ best peer's mean = {best:.3g} %" if ours else "–",
                 f"{np.mean(wrong):.3g} %; median {np.median(wrong):.3g} %, worst {max(wrong):.3g} %, "
                 f"{sum(w <= 0.05 for w in wrong)} scenes up to 0.05 %; {ms:.1f} ms",
                 bool(np.mean(wrong) <= best) if ours else None)


def unwrap_rows(page, study, work):
    page.section("Unwrapping 640x480: crowns with a cliff, shadow, wet spot",
                 "Same phase and mask for all, one setting for both noises; every region of the mask may be off as a whole. "
                 "*Least cuts* is what a burst without a code can be unwrapped with; it knows sigma and the carrier, which the peers "
                 "cannot be told, and bridges its way over pixels masked for noise. *Links + flood* is what the decoder's code works "
                 "on. Neighbours alone cannot see a jump of a whole fringe: the rows *with the code* show the whole decoder on the "
                 "same shape. OpenCV and scikit-image: processor time of one thread. *Scenes*: twenty others, drawn by number.")
    for name, noise in (("s2", 2), ("s6", 6)):
        u = study["unwrapping"][name]
        peer = {"OpenCV HistogramPhaseUnwrapping": u.get("opencv_histogram"),
                "scikit-image unwrap_phase": peers.skimage_unwrapping(work, name)}
        u["skimage"] = peer["scikit-image unwrap_phase"]
        found = [p for p in peer.values() if p]
        ours, best, quick = u["ours"], min((p["wrong_pct"] for p in found), default=None), min((p["ms"] for p in found), default=None)
        page.row(f"least cuts, sigma {noise} DN: wrong orders",
                 "≤ best peer" + (f" = {best:.3g} %" if found else " (none here)"),
                 f"{ours['wrong_pct']:.3g} %, {ours['left_out_pct']:.2g} % left out", ours["wrong_pct"] <= best if found else None)
        page.row(f"least cuts, sigma {noise} DN: time", "≤ 8 ms",
                 f"{ours['ms']:.1f} ms" + (f": 1/{quick / ours['ms']:.0f} of the quickest peer" if found else ""), ours["ms"] <= 8)
        for label, p in peer.items():
            page.row(f"{label}, sigma {noise} DN", "–",
                     f"{p['wrong_pct']:.3g} % wrong, {p['ms']:.0f} ms" if p else "not installed: no figure", None)
        flood = u["links_and_flood"]
        page.row(f"links + flood, sigma {noise} DN", "–",
                 f"{flood['wrong_pct']:.3g} % wrong, {flood['left_out_pct']:.2g} % left out, {flood['ms']:.1f} ms", None)
        scene_rows(page, u["scenes"], work, noise)
        marker = u["marker_only"]
        page.row(f"single marker found by B4 - B3 (the dissertation's), sigma {noise} DN: wrong orders", "–",
                 f"{marker['wrong_pct']:.3g} %, {marker['left_out_pct']:.2g} % left out", None)
        code = u["ours_with_code"]
        page.row(f"whole decoder with the code, sigma {noise} DN: wrong orders", "≤ 0.05 %",
                 f"{code['wrong_pct']:.3g} %, {code['left_out_pct']:.2g} % left out", code["wrong_pct"] <= 0.05)


def captured_rows(page, study, out, work):
    page.section("Captured fringes (other people's projectors and cameras)",
                 "plaster_eye: four of twelve frames against all twelve, about a constant phase. *As they are* and *one term*: "
                 "against the raw twelve-frame phase. That phase has frame errors itself (its modulation shows them): *corrected* is "
                 "held against it as it is, and against it less those errors, found by the same method as the burst's.")
    rows = (study["captured"] or {}).get("plaster_eye")
    if not rows:
        page.row("plaster_eye, blocks", "–", f"skipped: {SHARED}/data/fringe is absent", None)
        return
    for r in rows:
        b = r["burst"]
        page.row(f"burst {b} as it is: rms; repeating part", "–", f"{r['raw']['rms_rad']:.4f}; {r['raw']['repeating_rad']:.4f} rad", None)
        page.row(f"burst {b}, one term", "–",
                 f"{r['one_term']['rms_rad']:.4f}; {r['one_term']['repeating_rad']:.4f} rad", None)
        for against, key in (("the corrected twelve", "ours"), ("the raw twelve, ripple and all", "ours_against_raw")):
            e = r[key]
            page.row(f"burst {b} corrected, against {against}: rms", "≤ 0.031 rad", f"{e['rms_rad']:.5f} rad", e["rms_rad"] <= 0.031)
            page.row(f"burst {b} corrected, against {against}: repeating part", "≤ 0.005 rad", f"{e['repeating_rad']:.4f} rad",
                     e["repeating_rad"] <= 0.005)
        page.row(f"burst {b}: constant phase that remains", "–", f"{r['ours']['constant_rad']:.4f} rad", None)
        page.row(f"burst {b}: orders equal to the Gray code's", "≥ 99.8 %",
                 f"{r['orders_equal_pct']:.2f} % of {r['solved_px']} px ({100 * r['solved_px'] / r['reference_px']:.1f} % of "
                 f"those with amplitude > 20); {r['orders_equal_literal_pct']:.2f} % where noise at a fringe's border counts",
                 r["orders_equal_pct"] >= 99.8)
        page.row(f"burst {b}: depth, 1 to 99 %", "750 … 846 mm", f"{r['near_mm']:.1f} … {r['far_mm']:.1f} mm",
                 round(r["near_mm"]) >= 750 and round(r["far_mm"]) <= 846)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        apart = []
        for key in ("raw_curve_rad", "curve_rad"):
            a, b = (np.array(rows[k][key]) - np.mean(rows[k][key]) for k in (i, j))
            apart.append(float(np.sqrt(np.mean((a - b) ** 2))))
        page.row(f"bursts {i} and {j}, no frame in common, against each other: repeating part, as they are → corrected", "–",
                 f"{apart[0]:.4f} → {apart[1]:.4f} rad", None)
    if "blocks" in study["captured"]:
        k = study["captured"]["blocks"]
        page.row("blocks (three-step, gamma left in): ripple found, before → after", "–",
                 f"{k['ripple_before_rad']:.3f} → {k['ripple_after_rad']:.3f} rad", None)
        page.row("blocks: links whose ends lie in different fringes by the Gray code", "≤ 0.05 %", f"{k['links_torn_pct']:.3f} %",
                 k["links_torn_pct"] <= 0.05)
        page.row("blocks: orders, one shift a piece and no code (leaks move whole blocks)", "–",
                 f"{k['orders_equal_pct']:.1f} % equal of {k['solved_px']} px", None)
    pictures.plaster(work, out, rows)
    page.note("![maps of burst 0](plaster-eye.png)\n\n![ripple before and after](plaster-ripple.png)")


def oracle_section(page, rows, out, work, when=""):
    page.section("Rendered bursts with exact truth (`enamel decode`, judged by their own scorer)",
                 f"SIMULATED. Worst burst of each set; *floor* is the scorer's noise floor of that burst.{when}")
    if rows is None:
        page.row("plane, spheres, steps, sweep", "–", f"skipped: {SHARED}/data/oracle or {SHARED}/score is absent", None)
        return
    ratio = max(r["plane_rms_5x5_um"] / (r["noise_floor_um"] / 5) for r in rows["plane-01"])
    page.row("plane-01: RMS after a 5x5 mean / (floor/5)", "≤ 1.4",
             f"{ratio:.2f} ({worst(rows['plane-01'], 'plane_rms_5x5_um'):.2f} µm worst)", ratio <= 1.4)
    for name, part, limit in (("static", rows["spheres-01"][:2], 2.5), ("moving 10 mm/s", rows["spheres-01"][2:], 4)):
        d = max(worst(part, "sphere1_diameter_error_um"), worst(part, "sphere2_diameter_error_um"))
        c = worst(part, "centre_distance_error_um")
        page.row(f"spheres-01, {name}: diameter error", f"≤ {limit} µm", f"{d:.2f} µm", d <= limit)
        page.row(f"spheres-01, {name}: centre distance error", f"≤ {limit} µm", f"{c:.2f} µm", c <= limit)
    wrong, cover = worst(rows["steps-01"], "wrong_order_pct"), min(r["coverage_pct"] for r in rows["steps-01"])
    page.row("steps-01: wrong orders", "≤ 0.1 %", f"{wrong:.3f} %", wrong <= 0.1)
    page.row("steps-01: coverage of what is lit", "≥ 88 %", f"{cover:.1f} %", cover >= 88)
    sweep = rows["sweep-01"]
    ratio = max(r["depth_mad_sigma_um"] / r["noise_floor_um"] for r in sweep)
    wrong, cover = worst(sweep, "wrong_order_pct"), min(r["coverage_pct"] for r in sweep)
    page.row("sweep-01: MAD sigma of depth / floor", "≤ 1.1", f"{ratio:.2f}", ratio <= 1.1)
    page.row("sweep-01: wrong orders", "≤ 0.05 %", f"{wrong:.4f} %", wrong <= 0.05)
    page.row("sweep-01: coverage of what is lit", "≥ 98 %", f"{cover:.1f} %", cover >= 98)
    for name, burst in (("sweep-01", 5), ("steps-01", 0)):
        pictures.oracle_maps(SHARED, work, out, name, burst)
        page.note(f"`{name}`, burst {burst}:\n\n![maps of {name}]({name}.png)")


def title(name):
    """Of a benchmark's counters: `decode_burst/plane` is a rendered set, `decode_twin/plane_M` a burst of the twin."""
    which, scene = name.split("/")
    if which != "decode_twin":
        return scene
    scene, mode = scene.rsplit("_", 1)
    return f"twin, {scene}, mode {mode}"


def time_rows(page, decode, ruler_ns):
    page.section("Whole decode of one VGA burst, one core", "Processor time of one thread, median of 5 repetitions; other load "
                 "on the machine slows it through shared caches. How fast this machine is: OpenCV's subtract + cartToPolar took "
                 f"{ruler_ns:.1f} ns/px of 32 bursts from memory; 1.8 where the limit of 9 ms was set.")
    if not decode:
        page.row("plane, spheres, steps, sweep", "–", "skipped: no rendered bursts here", None)
        return
    budget = {"phase": 0.3, "unwrap": 4, "order": 2.5, "surface": 2}
    steps = ["phase", "wave", "links", "unwrap", "order", "polarity", "closure", "harmonic", "motion", "refit", "surface", "rest"]
    totals = {name: sum(b[s] for s in steps if s in b) for name, b in decode.items()}
    for name in decode:
        in_t = totals.get(name[:-1] + "T") if name.endswith("_M") else None
        beside = f", {totals[name] / in_t:.2f} times mode T" if in_t else ""
        page.row(title(name), "≤ 9 ms", f"{totals[name]:.1f} ms{beside}", totals[name] <= 9)
    lines = ["Step by step, ms:", "", "| Burst | " + " | ".join(steps) + " |", "|---|" + "---|" * len(steps),
             "| budget | " + " | ".join(f"{budget[s]:g}" if s in budget else "–" for s in steps) + " |"]
    for name, b in decode.items():
        lines.append(f"| {title(name)} | " + " | ".join(f"{b[s]:.1f}" if s in b else "–" for s in steps) + " |")
    page.note("\n".join(lines))


def renew_rendered(work, out, program):
    page, rows = Page(), peers.oracle_rows(SHARED, program, work)
    if rows is None:
        sys.exit(f"error: {SHARED}/data/oracle or {SHARED}/score is absent; set ENAMEL_SHARED")
    oracle_section(page, rows, out, work, f" Measured at commit {machine()['commit']}, after the rest of this page.")
    page, figures = page.within(out, "decode")
    where = figures.pop("machine")
    page.write(out, "decode", "tools/bench", where, {**figures, "oracle": rows})


def main(work, out, program):
    def load(name):
        return json.load(open(f"{work}/{name}.json", encoding="utf-8"))

    study, phase = load("study"), medians(load("phase"))
    decode = {k: v for k, v in medians(load("decode")).items() if "phase" in v} if os.path.exists(f"{work}/decode.json") else {}
    where, page = machine(), Page()
    phase_rows(page, study, phase)
    ripple_rows(page, study)
    unwrap_rows(page, study, work)
    page.section("Triangulation")
    t = study["triangulation"]
    page.row(f"baked cubic against iteration, {t['points']} points over the whole volume", "≤ 0.1 µm", f"{t['worst_um']:.3f} µm",
             t["worst_um"] <= 0.1)
    orders.orders_section(page, study)
    orders.modes_section(page, study)
    orders.twin_section(page, study)
    captured_rows(page, study, out, work)
    oracle = peers.oracle_rows(SHARED, program, work)
    oracle_section(page, oracle, out, work)
    time_rows(page, decode, phase["opencv_cart_to_polar/bursts:32"]["ns_per_px"])
    page.write(out, "decode", "tools/bench", where, {
        "study": study, "oracle": oracle, "phase_ns_per_px": {k: v["ns_per_px"] for k, v in phase.items()},
        "decode_ms": {k: {s: x for s, x in v.items() if isinstance(x, float)} for k, v in decode.items()}})


if __name__ == "__main__":
    if len(sys.argv) == 5 and sys.argv[4] == "--rendered":
        renew_rendered(*sys.argv[1:4])
    elif len(sys.argv) == 4:
        main(*sys.argv[1:])
    else:
        sys.exit(__doc__)

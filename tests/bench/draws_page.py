#!/usr/bin/env python3
"""draws_page.py WORK OUT ENAMEL COUNT SEED: OUT/draws.md and draws.json from WORK/draws.json and scans.json, which decode_draws
wrote, and from rendered sets of random units where they are there."""
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import draw_sets  # noqa: E402
from bench_page import Page, machine, wrapped  # noqa: E402

SHARED = os.environ.get("ENAMEL_SHARED", "../shared")
MODES = ("M", "T")
WRONG_PCT = {"M": 0.05, "T": 0.15}
LARGE_PX = 100  # a wrong region above this is one too many
MISLED = 0.01  # of the pixels away from edges
NARROW = ("balls", "boxes")
CLASSES = {"response": ("linear", "gamma 1-1.4", "gamma 1.4-2", "gamma 2-2.8", "S"),
           "scene": ("plane", "balls", "boxes", "teeth", "gum"),
           "motion": ("static", "0-10 mm/s", "10-20 mm/s", "20-30 mm/s"),
           "albedo": ("albedo <0.2", "albedo 0.2-0.5", "albedo >0.5")}
FAULTS = ("stale", "repeated", "permuted", "foreign", "darker", "brighter")
FAULT_PCT = {"repeated": 0, "permuted": 0}


def percent(part, whole):
    return 100 * part / whole if whole else None


def shown(value, form, unit=""):
    return "–" if value is None else format(value, form) + unit


def met(value, low=None, high=None):
    """None where nothing was measured."""
    if value is None:
        return None
    return bool((low is None or value >= low) and (high is None or value <= high))


def most(limit):
    return f"≤ {limit:g}" if limit else "0"


def tally(rows):
    """Figures of many drawn bursts; pixels of all of them together. A rejected burst covers nothing."""
    accepted = [r for r in rows if r["verdict"] == "accepted"]
    z = [r["z_count_rms_median_mean"]["smooth"] for r in accepted]
    pixels = sum(count for count, *_ in z)

    def total(of, key):
        return sum(r[key] for r in of)

    return {"bursts": len(rows), "rejected": len(rows) - len(accepted), "rejected_pct": percent(len(rows) - len(accepted), len(rows)),
            "wrong_pct": percent(total(accepted, "wrong"), total(accepted, "placed")),
            "wrong_regions": sum(r["largest_wrong"] > LARGE_PX for r in accepted),
            "largest_wrong_px": max((r["largest_wrong"] for r in accepted), default=0),
            "rms_z": (sum(count * rms**2 for count, rms, *_ in z) / pixels)**0.5 if pixels else None,
            "coverage_pct": percent(total(rows, "sure_covered"), total(rows, "sure")),
            "below_plain": sum(not r["holds_beside_plain"] for r in rows)}


def mode_rows(page, mode, rows):
    t = tally(rows)
    page.row(f"mode {mode}: bursts", "–", f"{t['bursts']}", None)
    page.row(f"mode {mode}: rejected", "≤ 0.1 %", shown(t["rejected_pct"], ".2f", " %"), met(t["rejected_pct"], high=0.1))
    limit = WRONG_PCT[mode]
    page.row(f"mode {mode}: wrong orders among accepted", f"≤ {limit} %", shown(t["wrong_pct"], ".4f", " %"),
             met(t["wrong_pct"], high=limit))
    page.row(f"mode {mode}: bursts with a wrong region > {LARGE_PX} px", "0" if mode == "M" else "–", f"{t['wrong_regions']}",
             t["wrong_regions"] == 0 if mode == "M" else None)
    page.row(f"mode {mode}: largest wrong region", "–", f"{t['largest_wrong_px']} px", None)
    page.row(f"mode {mode}: rms of error over predicted sigma, away from edges", "0.9 … 1.15", shown(t["rms_z"], ".3f"),
             met(t["rms_z"], 0.9, 1.15))
    for what, low, part in (("planes, teeth, gum", 97, [r for r in rows if r["scene"] not in NARROW]),
                            ("balls, boxes", 95, [r for r in rows if r["scene"] in NARROW])):
        cover = tally(part)["coverage_pct"]
        page.row(f"mode {mode}: coverage of sure pixels, {what}", f"≥ {low} %", shown(cover, ".2f", " %"), met(cover, low))
    page.row(f"mode {mode}: bursts below the plain floor", "0", f"{t['below_plain']}", t["below_plain"] == 0)
    return t


def class_tables(page, true):
    """{kind: {"class, mode": figures}}"""
    columns = ("bursts", "rejected, %", "wrong orders, %", f"regions > {LARGE_PX} px", "coverage, %", "rms z", "below plain")
    figures = {}
    for kind, classes in CLASSES.items():
        page.text += ["", f"## By {kind}"]
        figures[kind] = {f"{c}, {m}": tally([r for r in true if r[kind] == c and r["mode"] == m]) for c in classes for m in MODES}
        rows = [(name, [(text, None) for text in (
            f"{t['bursts']}", shown(t["rejected_pct"], ".1f"), shown(t["wrong_pct"], ".4f"), f"{t['wrong_regions']}",
            shown(t["coverage_pct"], ".2f"), shown(t["rms_z"], ".3f"), f"{t['below_plain']}")]) for name, t in figures[kind].items()]
        page.table(f"{kind.capitalize()}, mode", columns, [""] * len(columns), rows)
    return figures


def scan_table(page, true, taught):
    """Bursts of projectors that are not linear, alone and once more after others of their unit."""
    page.text += ["", "## In a scan", "",
                  wrapped("The first of these bursts once more, each after eight others of its unit before other scenes, in which the "
                          "projector's waveform is learned. Responses other than linear.")]
    figures, rows = {}, []
    for mode in MODES:
        alone = {r["seed"]: r for r in true if r["mode"] == mode and r["response"] != "linear"}
        learned = [r for r in taught if r["mode"] == mode and r["seed"] in alone]
        for name, t in (("alone", tally([alone[r["seed"]] for r in learned])), ("in a scan", tally(learned))):
            figures[f"{mode}, {name}"] = t
            rows.append((f"{mode}, {name}", [(text, None) for text in (
                f"{t['bursts']}", shown(t["rejected_pct"], ".1f"), shown(t["wrong_pct"], ".4f"), shown(t["coverage_pct"], ".2f"),
                shown(t["rms_z"], ".3f"))]))
    page.table("Mode, burst", ("bursts", "rejected, %", "wrong orders, %", "coverage, %", "rms z"), [""] * 5, rows)
    return figures


def misleads(row, fault):
    """Whether the fault brought errors that its burst has not without it."""
    own = row["misled"] / row["smooth"] if row["smooth"] else 0
    return fault["verdict"] == "accepted" and fault["misled_share"] > MISLED >= own


def fault_table(page, true):
    page.text += ["", "## Frames that do not belong", "",
                  wrapped("Each true burst that is accepted as it is, once more with one frame spoilt. *Misled*: accepted, and more than "
                          f"{100 * MISLED:g} % of the pixels away from edges off by more than 3 sigma and 50 µm, which they are not "
                          "without the fault.")]
    figures, rows = {}, []
    for kind in FAULTS:
        for mode in MODES:
            tried = [(r, f) for r in true if r["mode"] == mode for f in r["faults"] if f["fault"] == kind]
            rejected, misled = sum(f["verdict"] != "accepted" for _, f in tried), sum(misleads(r, f) for r, f in tried)
            figures[f"{kind}, {mode}"] = {"bursts": len(tried), "rejected": rejected, "misled": misled}
            share, limit = percent(misled, len(tried)), FAULT_PCT.get(kind, 0.1)
            rows.append((f"{kind}, {mode}", [(f"{len(tried)}", None), (shown(percent(rejected, len(tried)), ".1f"), None),
                                             (most(limit), None), (shown(share, ".2f"), met(share, high=limit))]))
    # The target differs from row to row, so it has a column; the head tells it, too.
    judged = len(page.rows)
    page.table("Fault, mode", ("bursts", "rejected, %", "target, %", "accepted and misled, %"), ("", "", "", ""), rows)
    for row in page.rows[judged:]:
        row["target"] = most(FAULT_PCT.get(row["what"].split(",")[0], 0.1))
    return figures


def worst(values, key=abs):
    return max((v for v in values if v is not None), key=key, default=None)


def set_cells(of):
    bursts, limit = of["bursts"], WRONG_PCT[of["mode"]]
    accepted = sum(b["verdict"] == "accepted" for b in bursts)
    wrong = worst(b.get("wrong_pct") for b in bursts)
    ratio = worst(b["plane_5x5_um"] / (b["floor_um"] / 5) for b in bursts if b.get("plane_5x5_um") and b.get("floor_um"))
    still, moving = (worst(d for b in part for d in b.get("diameter_error_um", ())) for part in (bursts[:1], bursts[1:]))
    size = [None if d is None else abs(d) for d in (still, moving)]
    return [(of["mode"], None), (f"{len(bursts)}", None), (f"{accepted}", accepted == len(bursts)),
            (shown(min(b["coverage_pct"] for b in bursts), ".1f"), None), (shown(wrong, ".3f"), met(wrong, high=limit)),
            (shown(ratio, ".2f"), met(ratio, high=2)), (shown(still, "+.2f"), met(size[0], high=4)),
            (shown(moving, "+.2f"), met(size[1], high=6))]


def set_table(page, sets):
    page.text += ["", "## Rendered sets of random units"]
    if not sets:
        page.note(f"Skipped: {SHARED}/data/oracle holds none of `gamma*-02`, `spheres-*-02`, `steps-*-02`.")
        return
    page.text += ["", wrapped(
        "SIMULATED, by another program, a unit of its own a set; `enamel decode` of each burst against its truth maps, the worst burst "
        "of the set. Coverage: of what is lit and in range. Planes: rms of the 5×5 means over a fifth of the noise that the sensor alone "
        "would leave in a pixel. Balls: error of the diameter, the first burst static, the others at 8 to 25 mm/s.")]
    columns = ("mode", "bursts", "accepted", "coverage, %", "wrong orders, %", "5×5 rms / (floor/5)", "static ball's diameter, µm",
               "moving ball's diameter, µm")
    targets = ("", "", "all", "", f"≤ {WRONG_PCT['M']} M, {WRONG_PCT['T']} T", "≤ 2", "≤ 4", "≤ 6")
    page.table("Set", columns, targets, [(name, set_cells(of)) for name, of in sets.items()])


def notable(true):
    """What an engineer looks at, by seed: `decode_draws --dump` writes it."""
    out = []
    for r in true:
        why = [] if r["verdict"] == "accepted" else [f"rejected: {r['verdict']}"]
        why += [f"wrong region of {r['largest_wrong']} px"] if r["largest_wrong"] > LARGE_PX else []
        why += [] if r["holds_beside_plain"] else ["below the plain floor"]
        why += [f"misled by {f['fault']}, {f['what']}" for f in r["faults"] if misleads(r, f)]
        if why:
            out.append({"seed": r["seed"], "mode": r["mode"], "why": why, "conditions": r["conditions"]})
    return out


def main(work, out, program, count, seed):
    with open(f"{work}/draws.json", encoding="utf-8") as f:
        drawn = json.load(f)
    true, where, page = [r for r in drawn if r["true_burst"]], machine(), Page("decode.md")
    page.section("Drawn bursts", f"SIMULATED. {count} seeds from {seed} on, each in both modes: `tools/bench-draws --count {count} "
                 f"--seed {seed}`. Unit, scene, paint and motion are drawn at random. {len(drawn) - len(true)} of {len(drawn)} bursts "
                 "move too fast or are too dark for any decoder to have to take them and are left out below. *Sure*: lit, in range, "
                 "true phase noise below 0.15 rad. A rejected burst covers nothing. *Plain floor*: a plain decoder's depths of the "
                 "same burst where hardly any is wrong; below it is one that covers clearly less or has more wrong.")
    modes = {m: mode_rows(page, m, [r for r in true if r["mode"] == m]) for m in MODES}
    classes = class_tables(page, true)
    with open(f"{work}/scans.json", encoding="utf-8") as f:
        scans = scan_table(page, true, json.load(f))
    faults = fault_table(page, true)
    sets = draw_sets.set_rows(SHARED, program, work)
    set_table(page, sets)
    page.write(out, "draws", "tools/bench-draws", where, {
        "count": int(count), "first_seed": int(seed), "modes": modes, "classes": classes, "scans": scans, "faults": faults, "sets": sets,
        "notable": notable(true)})


if __name__ == "__main__":
    if len(sys.argv) != 6:
        sys.exit(__doc__)
    main(*sys.argv[1:])

#!/usr/bin/env python3
"""map_page.py BIN OUT [--arches N] [--returns N] [--ridges N] [--whole N] [--seed N]: OUT/map.md and map.json, how scans of
drawn hands and jaws hang together. SIMULATED.

Renders scenes at drawn seeds into a temporary folder, replays them live (--fast) and with the map, and compares with the truth."""
import argparse
import json
import os
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bench_page import Page, machine  # noqa: E402
from twin_bench import CONFIG, Bench, bursts_of, poses  # noqa: E402

QUICK = ["render.samples_grid=1"]  # a quarter of the rays: edges are rougher, nothing else
PASS_APART = 30  # bursts between two passes over the same teeth, at least
SAME_PLACE_MM = 1.5
RIDGE_HALF_MM = 16


def scene_of(rig, target, hand, passes):
    """A scene file's text: what is scanned (target), how (hand) and along which passes, as tables of its settings."""
    def lines(settings):
        return [f"{name} = {json.dumps(value)}" for name, value in settings.items()]

    text = [f'rig = "{CONFIG}/rigs/{rig}.json"']
    for table, settings in {**target, "path": {"type": "arch", **hand}}.items():
        text += [f"[{table}]", *lines(settings)]
    for settings in passes:
        text += ["[[path.pass]]", *lines(settings)]
    return "\n".join(text) + "\n"


def jaw_of(side, from_mm, to_mm, burst_rate_hz):
    """The target: a jaw's teeth within a margin of the stretch that is scanned."""
    jaw = {"type": "jaw", "jaw.both_sides": True, "jaw.side": side,
           "jaw.from_mm": round(from_mm - 14, 1), "jaw.to_mm": round(to_mm + 14, 1)}
    return {"object": jaw, "timing": {"burst_rate_hz": burst_rate_hz}}


def stretch(from_mm, to_mm, height_mm, **more):
    return {"from_mm": round(from_mm, 1), "to_mm": round(to_mm, 1), "height_mm": height_mm, **more}


def drawn_arch(rng):
    """A scene: a stretch of a jaw there and back, on another side, with a hand, a pattern and a unit of its own."""
    start = rng.uniform(-45, 0)
    end = start + rng.uniform(30, 45)
    side, roll = rng.choice(["lower", "upper"]), rng.choice([-1, 1]) * rng.uniform(25, 48)
    rig = rng.choice(["probe", "probe_t"])
    rate = round(rng.uniform(12, 30), 1)
    hand = {"speed_mm_s": round(rng.uniform(10, 25), 1), "surge_mm_s": round(rng.uniform(0, 5), 1),
            "turn_s": round(rng.uniform(0.6, 1.0), 2), "tremor_um": round(rng.uniform(20, 120))}
    passes = [stretch(start, end, 5.0), stretch(end, start, 3.5, roll_deg=round(roll, 1))]
    text = scene_of(rig, jaw_of(side, start, end, rate), hand, passes)
    mode = "T" if rig.endswith("_t") else "M"
    return {"from_mm": start, "to_mm": end, "side": side, "roll_deg": roll, "mode": mode, "text": text}


def drawn_return(rng):
    """A stretch of a jaw; the probe is lifted and comes back over a part of it from another side."""
    start = rng.uniform(-40, 15)
    end, back = start + rng.uniform(18, 25), start + rng.uniform(3, 8)
    roll = rng.choice([-1, 1]) * rng.uniform(30, 45)
    rig, side = rng.choice(["probe", "probe_t"]), rng.choice(["lower", "upper"])
    hand = {"speed_mm_s": round(rng.uniform(10, 18), 1), "turn_s": 0.9}
    pause = {"after": "pause", "pause_s": round(rng.uniform(0.9, 2), 2)}
    passes = [stretch(start, end, 5.0), stretch(back, back + 8, 3.5, roll_deg=round(roll, 1), **pause)]
    return scene_of(rig, jaw_of(side, start, end, 15.0), hand, passes)


def drawn_ridge(rng):
    middle = rng.uniform(-15, 15)
    low, high = middle - RIDGE_HALF_MM, middle + RIDGE_HALF_MM
    ridge = {"object": {"type": "ridge", "ridge.relief_um": 30.0},
             "texture": {"pattern": "vessels", "amplitude": 0.15, "scale_mm": 1.6}, "timing": {"burst_rate_hz": 15.0}}
    hand = {"speed_mm_s": round(rng.uniform(10, 16), 1), "turn_s": 0.9}
    passes = [stretch(low, high, -1.0), stretch(high, low, -5.0, roll_deg=-35.0, offset_mm=-7.0)]
    return scene_of("probe", ridge, hand, passes)


class Scan:
    """A folder of bursts that was replayed, beside its truth: laid on it by its first pose."""

    def __init__(self, folder, out, report):
        self.report, self.bursts = report, len(bursts_of(folder))
        truth, found = poses(f"{folder}/truth/poses.csv"), poses(f"{out}/poses.csv")
        with open(f"{folder}/rig.json", encoding="utf-8") as f:
            near, far = json.load(f)["depth_range_mm"]
        self.work, self.truth, self.found = np.array([0, 0, (near + far) / 2, 1]), truth, found
        self.numbers = sorted(set(truth) & set(found))
        first = self.numbers[0]
        self.T_truth_model = truth[first] @ np.linalg.inv(found[first])

    def placed_share(self):
        return self.report["bursts"]["fused"] / self.bursts

    def errors_um(self):
        """What each burst is off by, at the point that it looks at."""
        return {n: 1e3 * ((self.T_truth_model @ self.found[n] - self.truth[n]) @ self.work)[:3] for n in self.numbers}

    def passes_apart_um(self):
        """Of bursts of two passes that look at the same place: how differently they are off."""
        errors, looked_at = self.errors_um(), np.array([(self.truth[n] @ self.work)[:3] for n in self.numbers])
        out = []
        for i, n in enumerate(self.numbers):
            near = np.linalg.norm(looked_at - looked_at[i], axis=1) < SAME_PLACE_MM
            out += [np.linalg.norm(errors[n] - errors[m]) for j, m in enumerate(self.numbers) if near[j] and m >= n + PASS_APART]
        return out

    def distances_um(self):
        """(error, sigma) of each distance between stations, and last that from end to end."""
        stations = self.report["map"]["stations"]
        true = []
        for at in stations["at"]:
            p = np.append(at["p_model_mm"], 1)
            true.append((self.truth[at["burst"]] @ np.linalg.inv(self.found[at["burst"]]) @ p)[:3])
        out = [(1e3 * (d["mm"] - np.linalg.norm(true[d["a"]] - true[d["b"]])), d["sigma_um"], d["a"] == 0 and d["b"] == len(true) - 1)
               for d in stations["distances"]]
        return [(error, sigma) for error, sigma, _ in sorted(out, key=lambda d: d[2])]


def write_scene(bench, name, text):
    path = os.path.join(bench.folder, name)
    with open(path + ".toml", "w", encoding="utf-8") as f:
        f.write(text)
    return path


def scan_of(bench, scene, seed, settings=(), options=()):
    folder = bench.render(scene, seed, [*QUICK, *settings])
    return folder, Scan(folder, *bench.replay(folder, *options))


def short_arches(page, bench, rng, count):
    page.section("Stretches of jaws", f"{count} stretches of 30 to 45 mm, there and back on another side: jaw, pattern, hand, rates drawn. Laid on the truth "
                 "by the first pose. Passes: bursts of two passes that look at the same place, and how differently they are off.")
    rows, off, distances, passes, live_off, shares, seconds = [], [], [], [], [], [], []
    for n in range(count):
        drawn = drawn_arch(rng)
        folder, scan = scan_of(bench, write_scene(bench, f"arch{n}", drawn.pop("text")), int(rng.integers(1 << 31)))
        live = Scan(folder, *bench.replay(folder, "--fast"))
        ends = scan.distances_um()
        off.append(np.mean([np.linalg.norm(e) for e in scan.errors_um().values()]))
        live_off.append(np.mean([np.linalg.norm(e) for e in live.errors_um().values()]))
        distances += ends
        passes += scan.passes_apart_um()
        shares.append(scan.placed_share())
        seconds.append(1e3 * scan.report["map"]["seconds"] / scan.bursts)
        rows.append({**drawn, "bursts": scan.bursts, "placed": shares[-1], "off_um": off[-1], "live_off_um": live_off[-1],
                     "end_to_end_um": ends[-1] if ends else None})
    errors, sigmas = np.array(distances).T
    within = int(np.sum(np.abs(errors) <= 2 * sigmas))
    page.row("bursts in the model or in a segment, least", "≥ 99.5 %", f"{100 * min(shares):.1f} %", min(shares) >= 0.995)
    p95 = float(np.percentile(np.abs(errors), 95))
    page.row(f"{len(errors)} distances between stations, 95 % off by", "≤ 15 um", f"{p95:.1f} um", p95 <= 15)
    page.row("distances within 2 sigma", "≥ 90 %", f"{within} of {len(errors)}", within >= 0.9 * len(errors))
    page.row("rms of error over sigma", "–", f"{np.sqrt(np.mean((errors / sigmas) ** 2)):.2f}", None)
    apart = float(np.percentile(passes, 95))
    page.row(f"passes at the same place ({len(passes)} pairs of bursts), 95 % apart by", "≤ 4 um", f"{apart:.1f} um", apart <= 4)
    page.row("poses off by, mean of a scan: median; worst", "–", f"{np.median(off):.1f}; {max(off):.1f} um", None)
    page.row("the same live, before the map", "–", f"{np.median(live_off):.1f}; {max(live_off):.1f} um", None)
    page.row("map and fusing anew, a burst", "–", f"{np.median(seconds):.0f} ms", None)
    return {"arches": rows, "distances_um": distances}


def returns(page, bench, rng, count):
    page.section("A pause, and back from another side", f"{count} stretches of 18 to 25 mm; the probe comes back at a drawn place, at 30 to 45 degrees. "
                 "A burst that is placed at once joins no segment.")
    joined, shares, worst = [], [], []
    for n in range(count):
        _, scan = scan_of(bench, write_scene(bench, f"return{n}", drawn_return(rng)), int(rng.integers(1 << 31)))
        worst.append(max(np.linalg.norm(e) for e in scan.errors_um().values()))
        shares.append(len(scan.found) / scan.bursts)
        for segment in scan.report["segments"]:
            if "joined_at" in segment:  # or "end": found after the last burst
                at = segment["joined_at"] if segment["joined_at"] != "end" else segment["last_burst"] + 1
                joined.append(at - segment["first_burst"] + 1)
    page.row("bursts in the model at the end, least", "≥ 99.5 %", f"{100 * min(shares):.1f} %", min(shares) >= 0.995)
    if joined:
        page.row(f"segments joined by their burst number, worst of {len(joined)}", "≤ 3", f"{max(joined)}", max(joined) <= 3)
    page.row("false joins: scans with a burst off by more than 0.2 mm", "0", f"{sum(w > 200 for w in worst)}", max(worst) <= 200)
    page.row("poses off by at most, worst", "–", f"{max(worst):.1f} um", None)
    return {"joined_by": joined, "worst_off_um": worst, "placed": shares}


def ridges(page, bench, rng, count):
    page.section("Without teeth", f"{count} ridges with vessels and relief, {2 * RIDGE_HALF_MM} mm there and back; and the first one smooth and even.")
    median, most, shares, told = [], [], [], []
    for n in range(count):
        scene, seed = write_scene(bench, f"ridge{n}", drawn_ridge(rng)), int(rng.integers(1 << 31))
        _, scan = scan_of(bench, scene, seed)
        off = [np.linalg.norm(e) for e in scan.errors_um().values()]
        median.append(np.median(off))
        most.append(max(off))
        shares.append(scan.placed_share())
        if n == 0:
            _, smooth = scan_of(bench, scene, seed, ["object.ridge.relief_um=0", "texture.amplitude=0"])
            told.append(smooth.report["undetermined"]["bursts"] / smooth.bursts)
    page.row("bursts placed, least", "≥ 98 %", f"{100 * min(shares):.1f} %", min(shares) >= 0.98)
    page.row("poses off by, median of a scan, worst", "≤ 40 um", f"{max(median):.1f} um", max(median) <= 40)
    page.row("poses off by at most, worst", "≤ 100 um", f"{max(most):.1f} um", max(most) <= 100)
    page.row("smooth: bursts told to be undetermined", "≥ 95 %", f"{100 * told[0]:.0f} %", told[0] >= 0.95)
    return {"median_um": median, "most_um": most}


def whole_arches(page, bench, rng, count):
    if count == 0:
        return {}
    page.section("Whole arches", f"{count} of `arch.toml`, three passes and a pause, the jaw drawn.")
    cross, mean, seconds, per = [], [], [], []
    for _ in range(count):
        _, scan = scan_of(bench, "arch", int(rng.integers(1 << 31)))
        off = scan.errors_um()
        cross.append(abs(scan.distances_um()[-1][0]))
        mean.append(scan.report["accuracy"]["mean_abs_um"])
        seconds.append(scan.report["map"]["seconds"])
        per.append(max(np.linalg.norm(e) for e in off.values()))
    page.row("end to end, worst", "≤ 10 um", f"{max(cross):.1f} um", max(cross) <= 10)
    page.row("mean deviation, laid on by the first pose, worst", "–", f"{max(mean):.1f} um", None)
    page.row("poses off by at most, worst", "–", f"{max(per):.1f} um", None)
    page.row("map and fusing anew after the last burst, worst", "≤ 12 s", f"{max(seconds):.1f} s", max(seconds) <= 12)
    return {"end_to_end_um": cross, "mean_um": mean, "seconds": seconds}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("programs")
    parser.add_argument("out")
    for name, default in (("arches", 12), ("returns", 6), ("ridges", 3), ("whole", 1), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=default)
    options = parser.parse_args()
    page, where, rng = Page("registration.md"), machine(), np.random.default_rng(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options.programs, folder)
        figures = {"arches": short_arches(page, bench, rng, options.arches), "returns": returns(page, bench, rng, options.returns),
                   "ridges": ridges(page, bench, rng, options.ridges), "whole": whole_arches(page, bench, rng, options.whole)}
    page.write(options.out, "map", "tools/bench-map", where, {"seed": options.seed, **figures})
    return 0


if __name__ == "__main__":
    sys.exit(main())

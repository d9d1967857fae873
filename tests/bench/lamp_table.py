#!/usr/bin/env python3
"""Bursts under a lamp that flickers, drawn at random, against the same bursts under a steady one.

usage: lamp_table.py BUILD FOLDER [--draws N] [--seed S]      (BUILD: build/release; FOLDER: for what is rendered)

One line for each mode, object, frequency and brightness: the ripple of 5 x 5 means that the flicker left (median and largest, um), sigma
of a pixel, and how many bursts were rejected, by reason. Maps of the lamp, its course and its phase are drawn; half of the lamps light as
the surface does, half evenly. Needs numpy and OpenCV. Everything is SIMULATED."""
import argparse
import collections
import json
import pathlib
import re
import shutil
import subprocess

import cv2
import numpy as np

PATHS = {
    "plane": '[object]\ntype = "plane"\n[path]\ntype = "views"\n[[path.view]]\ndistance_mm = 48.0\n[[path.view]]\ntilt_x_deg = 30.0\n',
    "teeth": '[object]\ntype = "jaw"\n[timing]\nbursts = 2\nburst_rate_hz = 0.4\n[path]\ntype = "arch"\nspeed_mm_s = 0.5\ntremor_um = 0.0\n'
             'tremor_deg = 0.0\nwander_mm = 0.0\nwander_deg = 0.0\n[[path.pass]]\nfrom_mm = 28.0\nto_mm = 43.0\n',
    "teeth, moving": '[object]\ntype = "jaw"\n[timing]\nbursts = 4\n[path]\ntype = "arch"\n[[path.pass]]\nfrom_mm = 28.0\nto_mm = 43.0\n',
}
SWING = 0.3
PHASE_FRAMES = {"M": (0, 2, 3), "T": (0, 2)}  # whose mean shows no fringes


def pfm(path):
    with open(path, "rb") as f:
        f.readline()
        width, height = map(int, f.readline().split())
        f.readline()
        return np.frombuffer(f.read(), "<f4").reshape(height, width)[::-1].astype(float)


def frames_of(folder, burst):
    return [cv2.imread(str(folder / f"frames/{burst:06d}_{k}.png"), -1).astype(float) for k in range(4)]


def draw_lamp(rng, frames, mode, black, mean_dn):
    light = np.mean([frames[k] for k in PHASE_FRAMES[mode]], 0) - black
    y, x = np.mgrid[0:light.shape[0], 0:light.shape[1]]
    at, spread = rng.uniform(0, (light.shape[1], light.shape[0])), rng.uniform((300, 250), (900, 700))
    lamp = np.exp(-(((x - at[0]) / spread[0]) ** 2 + ((y - at[1]) / spread[1]) ** 2))
    if rng.random() < 0.5:
        lamp *= cv2.GaussianBlur(light, (0, 0), 1)
    return lamp * mean_dn / lamp[light > 10].mean()


def put(source, burst, target, lamp, swing, rng):
    """swing: of the lamp in each frame."""
    shutil.rmtree(target, ignore_errors=True)
    (target / "frames").mkdir(parents=True)
    head, *rows = (source / "bursts.csv").read_text().strip().splitlines()
    (target / "bursts.csv").write_text("\n".join([head] + [r for r in rows if int(r.split(",")[0]) == burst]) + "\n")
    shutil.copy(source / "rig.json", target)
    electrons = json.loads((source / "rig.json").read_text())["noise"]["gain_e_per_dn"]
    for k, frame in enumerate(frames_of(source, burst)):
        add = lamp * swing[k]
        lit = frame + add + rng.normal(0, 1, frame.shape) * np.sqrt(add / electrons)
        cv2.imwrite(str(target / f"frames/{burst:06d}_{k}.png"), np.clip(np.rint(lit), 0, 255).astype(np.uint8))


def decode(enamel, folder, burst, out):
    ran = subprocess.run([enamel, "decode", folder, "--burst", str(burst), "--out", out], capture_output=True, text=True, check=False)
    if ran.returncode:
        return json.loads((out / "decode.json").read_text())["verdict"]
    return pfm(out / "depth.pfm"), pfm(out / "sigma.pfm")


def ripple_um(off):
    known = np.isfinite(off)
    share = cv2.blur(known.astype(float), (5, 5))
    means = np.where(share > 0.99, cv2.blur(np.where(known, off, 0), (5, 5)) / np.maximum(share, 1e-9), np.nan)
    return 1e3 * np.sqrt(np.nanmean((means - np.nanmedian(means)) ** 2))


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("build", type=pathlib.Path)
    ask.add_argument("folder", type=pathlib.Path)
    ask.add_argument("--draws", type=int, default=4)
    ask.add_argument("--seed", type=int, default=1)
    given = ask.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    rigs = pathlib.Path(__file__).resolve().parents[2] / "config/rigs"
    rng = np.random.default_rng(given.seed)
    print("| Mode | Object | Hz | DN | Ripple µm, median, largest | σ µm | Rejected |\n|---|---|---|---|---|---|---|")
    for mode, rig in (("M", "probe.json"), ("T", "probe_t.json")):
        for name, scene in PATHS.items():
            source = given.folder / re.sub(r"\W+", "-", f"{mode}-{name}")
            if not source.exists():
                (given.folder / "scene.toml").write_text(f'rig = "{rigs / rig}"\nseed = {given.seed}\n' + scene)
                subprocess.run([given.build / "bin/enamel-twin", "render", given.folder / "scene.toml", "--out", source], check=True,
                               capture_output=True)
            rows = [r.split(",") for r in (source / "bursts.csv").read_text().strip().splitlines()[1:]]
            black = json.loads((source / "rig.json").read_text())["noise"].get("black_dn", 0)
            for hz in (100, 120):
                for mean_dn in (10, 20):
                    ripples, sigmas, rejected = [], [], collections.Counter()
                    for _ in range(given.draws):
                        row = rows[rng.integers(len(rows))]
                        burst, phase = int(row[0]), rng.uniform(0, 2 * np.pi)
                        lamp = draw_lamp(rng, frames_of(source, burst), mode, black, mean_dn)
                        course = [1 + SWING * np.cos(2e-9 * np.pi * hz * (int(t) - int(row[1])) + phase) for t in row[1:5]]
                        put(source, burst, given.folder / "steady", lamp, [1] * 4, rng)
                        put(source, burst, given.folder / "swings", lamp, course, rng)
                        steady = decode(given.build / "bin/enamel", given.folder / "steady", burst, given.folder / "o1")
                        swings = decode(given.build / "bin/enamel", given.folder / "swings", burst, given.folder / "o2")
                        if isinstance(swings, str) or isinstance(steady, str):
                            rejected[swings if isinstance(swings, str) else f"steady: {steady}"] += 1
                            continue
                        ripples.append(ripple_um(swings[0] - steady[0]))
                        sigmas.append(1e3 * np.nanmedian(swings[1]))
                    told = f"{np.median(ripples):.1f}, {max(ripples):.1f} | {np.median(sigmas):.1f}" if ripples else "– | –"
                    why = ", ".join(f"{n} {r}" for r, n in rejected.items()) or "–"
                    print(f"| {mode} | {name} | {hz} | {mean_dn} | {told} | {why} |", flush=True)


if __name__ == "__main__":
    main()

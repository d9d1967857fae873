#!/usr/bin/env python3
"""mouth_page.py BIN OUT [--seeds N] [--bursts N]: OUT/mouth.md and mouth.json, what light, saliva and metal do to a scan. SIMULATED.

Renders scenes of config/scenes at drawn seeds into a temporary folder, decodes and replays them, and compares with the truth."""
import argparse
import json
import os
import sys
import tempfile

import numpy as np
from scipy.spatial import cKDTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bench_page import Page, machine  # noqa: E402
from twin_bench import Bench, bursts_of, poses  # noqa: E402

DRY = ["effects.film=false"]
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4"}
LEAST_POOL_MM = 0.05
WRONG_ORDER_UM = 400  # half a fringe is some mm; what is nearer is an error of depth


def read_pfm(path):
    with open(path, "rb") as f:
        f.readline()
        width, height = map(int, f.readline().split())
        f.readline()
        return np.frombuffer(f.read(), "<f4").reshape(height, width)[::-1]


def read_ply(path):
    """Its header as text, all of it, and where the header ends."""
    with open(path, "rb") as f:
        data = f.read()
    end = data.index(b"end_header") + len(b"end_header\n")
    return data[:end].decode(), data, end


def read_vertices(path):
    header, data, end = read_ply(path)
    head = header.split("element face")[0].splitlines()
    count = next(int(line.split()[2]) for line in head if line.startswith("element vertex"))
    kind = np.dtype([(line.split()[2], PLY_TYPES[line.split()[1]]) for line in head if line.startswith("property")])
    return np.frombuffer(data, kind, count, end)


def xyz(vertices):
    return np.stack([vertices[k] for k in "xyz"], 1).astype(float)


def read_normals(path, points):
    """Of the vertices of a mesh of triangles: mean of its faces, by area."""
    head, data, _ = read_ply(path)
    faces = int(head.split("element face ")[1].split()[0])
    kind = np.dtype([("n", "u1"), ("corner", "<i4", 3)])
    corner = np.frombuffer(data, kind, faces, len(data) - faces * kind.itemsize)["corner"]
    a, b, c = (points[corner[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    out = np.zeros_like(points)
    for axis in range(3):
        for k in range(3):
            out[:, axis] += np.bincount(corner[:, k], normal[:, axis], len(points))
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)


def errors_of(bench, folder, burst, settings, of="material", surface_of=None):
    """Depth less the truth, um, and what the vertices of a truth (its own) have of each pixel."""
    out, _ = bench.decode(folder, burst, settings)
    truth = read_pfm(f"{folder}/truth/depth_{burst:06d}.pfm")
    depth = read_pfm(f"{out}/depth.pfm")
    with open(f"{folder}/rig.json", encoding="utf-8") as f:
        camera = json.load(f)["camera"]
    both = np.isfinite(depth) & np.isfinite(truth)
    v, u = np.nonzero(both)
    z = truth[both]
    # The lens moves a pixel by less than the mesh's edge: enough to know the material.
    points = np.stack([(u - camera["cx"]) / camera["fx"] * z, (v - camera["cy"]) / camera["fy"] * z, z], 1)
    T_model_cam = poses(f"{folder}/truth/poses.csv")[burst]
    surface = read_vertices(f"{surface_of or folder}/truth/surface.ply")
    _, nearest = cKDTree(xyz(surface)).query(points @ T_model_cam[:3, :3].T + T_model_cam[:3, 3])
    error = 1e3 * (depth - truth)[both]
    near = np.abs(error) < WRONG_ORDER_UM
    return error[near], surface[of][nearest][near]


def light_inside(page, bench, seeds):
    page.section("Light from inside", "Dry mouths, single bursts: median of measured less true depth over the pixels of a material, um. "
                 "Per pixel there is noise of some 30 um, which medians do not see.")
    figures = {}
    for mode, rig in (("M", []), ("T", ["rig=../rigs/probe_t.json"])):
        off, on = {}, {}
        for seed in seeds:
            folder = bench.render("mouth", seed, [*DRY, *rig, "timing.bursts=2", "path.from_s=0.5"], maps=True)
            with open(f"{folder}/truth/scene.json", encoding="utf-8") as f:
                names = {m["number"]: name for name, m in json.load(f)["materials"].items()}
            for burst in bursts_of(folder):
                for into, settings in ((off, ["decode.correct_translucency=false"]), (on, [])):
                    error, material = errors_of(bench, folder, burst, settings)
                    for number in np.unique(material):
                        into.setdefault(names[number], []).append(error[material == number])
        for name in ("enamel", "stained", "gum"):
            if name not in on:
                continue
            before, after = (float(np.median(np.concatenate(x[name]))) for x in (off, on))
            figures[f"{mode} {name}"] = {"uncorrected_um": before, "corrected_um": after}
            page.row(f"mode {mode}, {name}: bias; without the correction {before:.1f} um", "≤ 15 um", f"{after:.1f} um", abs(after) <= 15)
    return figures


def wet_pits(page, bench, seeds):
    """The same bursts wet and dry: what stands in a pit lifts its bottom."""
    page.section("Wet pits", "Two molars under saliva, the same bursts wet and dry: median of measured less true depth where 0.05 mm or more "
                 "stand over the surface, the wet one's above the dry one's. Higher is towards the probe.")
    wet, dry, filling = [], [], []
    for seed in seeds:
        settings = ["timing.bursts=2", "path.from_s=0.3"]
        pair = [bench.render("mouth_wet", seed, [*settings, *more], maps=True) for more in ([], DRY)]
        for burst in bursts_of(pair[0]):
            error, film = errors_of(bench, pair[0], burst, [], "film_mm")
            wet.append(error[film >= LEAST_POOL_MM])
            filling.append(film[film >= LEAST_POOL_MM])
            error, film = errors_of(bench, pair[1], burst, [], "film_mm", surface_of=pair[0])
            dry.append(error[film >= LEAST_POOL_MM])
    lift = float(np.median(np.concatenate(dry)) - np.median(np.concatenate(wet)))
    depth_um = 1e3 * float(np.median(np.concatenate(filling)))
    page.row(f"bottoms of pits under {depth_um:.0f} um of saliva (median) lifted by", "≤ 10 um", f"{lift:.1f} um", lift <= 10)
    return {"lift_um": lift, "filling_um": depth_um, "pixels": int(sum(len(x) for x in wet))}


def told(bench, folder):
    """Bursts by the trouble that is told of them."""
    count = {}
    for burst in bursts_of(folder):
        _, report = bench.decode(folder, burst)
        trouble = report["sight"]["trouble"]
        count[trouble] = count.get(trouble, 0) + 1
    return count


def sight(page, bench, seeds, bursts):
    page.section("What is in the way", "Share of single bursts of which the scene's trouble is told; of sound scenes, of which any is.")
    few = [f"timing.bursts={bursts}", "path.from_s=0.5"]
    faulty = {"fog": ("mouth_fog", ["path.from_s=1.5"]), "lamp": ("mouth_lamp", ["lamp.strength=0.3", "lamp.flicker=0.3"]),
              "metal": ("mouth_metal", [*DRY, "path.from_s=0.1"]), "glare": ("mouth_wet", [])}
    sound = {"plaster": ("quadrant", []), "dry mouth": ("mouth", [*DRY, "mouth.amalgam=[]"])}
    figures = {}
    for name, (scene, settings) in {**faulty, **sound}.items():
        count = {}
        for seed in seeds:
            for trouble, n in told(bench, bench.render(scene, seed, [*few, *settings])).items():
                count[trouble] = count.get(trouble, 0) + n
        total = sum(count.values())
        figures[name] = count
        if name in faulty:
            share = count.get(name, 0) / total
            page.row(f"{name}: told", "≥ 95 %", f"{100 * share:.0f} % of {total}", share >= 0.95)
        else:
            share = 1 - count.get("none", 0) / total
            page.row(f"{name}: anything told", "≤ 1 %", f"{100 * share:.0f} % of {total}", share <= 0.01)
    return figures


def metal(page, bench, seeds):
    page.section("Metal", "A crown between teeth; every second burst exposed so many times shorter. Covered: of the crown's surface "
                 "that three bursts see, within 0.2 mm of the fused mesh. Saliva lies on the crown, too, and is taken for its surface: "
                 "the same without it shows what metal does.")
    figures = {}
    for ratio, film, more in ((1, "", []), (4, "", []), (4, ", dry", DRY)):
        covered, apart = [], []
        for seed in seeds:
            folder = bench.render("mouth_metal", seed, [f"timing.exposure_ratio={ratio}", *more])
            out, _ = bench.replay(folder)
            truth = read_vertices(f"{folder}/truth/surface.ply")
            with open(f"{folder}/truth/scene.json", encoding="utf-8") as f:
                number = json.load(f)["materials"]["metal"]["number"]
            ours, true = poses(f"{out}/poses.csv"), poses(f"{folder}/truth/poses.csv")
            first = min(ours)
            T_true_ours = true[first] @ np.linalg.inv(ours[first])
            mesh = xyz(read_vertices(f"{out}/mesh.ply")) @ T_true_ours[:3, :3].T + T_true_ours[:3, 3]
            every = xyz(truth)
            crown = every[(truth["material"] == number) & (truth["seen"] >= 3)]
            distance, _ = cKDTree(mesh).query(crown)
            covered.append(float(np.mean(distance < 0.2)))
            _, nearest = cKDTree(every).query(mesh)
            own = truth["material"][nearest] == number
            normal = read_normals(f"{folder}/truth/surface.ply", every)[nearest[own]]
            off = 1e3 * np.sum((mesh[own] - every[nearest[own]]) * normal, 1)
            apart.append(float(np.sqrt(np.mean(off[np.abs(off) < 200] ** 2))))
        share, rms = float(np.mean(covered)), float(np.mean(apart))
        figures[f"ratio {ratio}{film}"] = {"covered": covered, "rms_um": apart}
        page.row(f"crown covered, exposures 1 : {ratio}{film}", "≥ 90 %" if ratio > 1 else "–", f"{100 * share:.0f} %",
                 share >= 0.9 if ratio > 1 else None)
        page.row(f"… its surface off the truth, rms, 1 : {ratio}{film}", "≤ 20 um" if ratio > 1 else "–", f"{rms:.1f} um",
                 rms <= 20 if ratio > 1 else None)
    return figures


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", help="folder of enamel and enamel-twin")
    parser.add_argument("out")
    parser.add_argument("--seeds", type=int, default=2, help="of each scene")
    parser.add_argument("--bursts", type=int, default=6, help="of each scene of trouble")
    parser.add_argument("--first-seed", type=int, default=901)
    given = parser.parse_args()
    seeds = range(given.first_seed, given.first_seed + given.seeds)
    page = Page()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(given.programs, folder)
        figures = {"light_inside": light_inside(page, bench, seeds), "sight": sight(page, bench, seeds, given.bursts),
                   "wet_pits": wet_pits(page, bench, seeds), "metal": metal(page, bench, seeds), "seeds": list(seeds)}
    page.write(given.out, "mouth", "tools/bench-mouth", machine(), figures)
    print(f"{given.out}/mouth.md")


if __name__ == "__main__":
    main()

"""Rendered sets of randomly drawn units, `*-02`: what `enamel decode` makes of each burst, against the folder's truth maps."""
import glob
import json
import os
import re
import subprocess
import sys

import cv2
import numpy as np
from decode_peers import read_pfm

KINDS = ("gamma", "spheres", "steps")
STEEPEST_DEG = 55  # of a ball's surface that its diameter is fitted to
CLEAR_OF_ROD = 0.75  # cosine between a ball's surface and the rod's axis


class Unit:
    """Camera, projector and sensor of rig.json, by OpenCV's lens."""

    def __init__(self, rig):
        self.rig, self.period = rig, rig["patterns"]["period_px"]
        self.pose = np.array(rig["T_proj_cam"])
        width, height = rig["camera"]["width"], rig["camera"]["height"]
        v, u = np.mgrid[:height, :width]
        pixels = np.stack([u, v], -1).reshape(-1, 1, 2).astype(float)
        ideal = cv2.undistortPointsIter(pixels, *self._lens("camera"), None, None, (cv2.TERM_CRITERIA_COUNT, 60, 0))
        self.rays = np.concatenate([ideal.reshape(height, width, 2), np.ones((height, width, 1))], -1)

    def _lens(self, which):
        o = self.rig[which]
        return np.array([[o["fx"], 0, o["cx"]], [0, o["fy"], o["cy"]], [0, 0, 1.0]]), np.array(o["dist"])

    def column(self, depth):
        """Of the projector, px, that lights each pixel at this camera z; NaN where there is none."""
        out, has = np.full(depth.shape, np.nan), np.isfinite(depth)
        if has.any():
            turn, _ = cv2.Rodrigues(self.pose[:3, :3])
            points = self.rays[has] * depth[has][:, None].astype(float)
            out[has] = cv2.projectPoints(points, turn, self.pose[:3, 3], *self._lens("projector"))[0][:, 0, 0]
        return out

    def phase_noise(self, frames):
        """Of each pixel, rad, as shot, read and rounding noise leave it: three 120-degree frames, or four of 90."""
        n, micro = self.rig["noise"], self.rig["patterns"]["mode"] == "M"
        if micro:
            three = np.stack([frames[0], frames[2], frames[3]])
            mean = three.mean(0)
            half = 2 / 3 * np.abs(np.tensordot(np.exp(2j * np.pi / 3 * np.arange(3)), three, 1))
        else:
            mean = (frames[0] + frames[2]) / 2
            half = np.abs((frames[0] - frames[2]) / 2 + 1j * (frames[1] - mean))
        gain = n["gain_e_per_dn"]
        variance = np.maximum(mean - n["black_dn"], 0) / gain + (n["read_noise_e"] / gain) ** 2 + 1 / 12
        return np.sqrt((2 / 3 if micro else 1 / 2) * variance) / np.maximum(half, 1e-9)


class Burst:
    """Truth of one burst of a folder beside a depth map, camera z in mm, NaN where there is none."""

    def __init__(self, folder, burst, unit, depth):
        self.unit, self.depth, self.has = unit, depth, np.isfinite(depth)
        self.truth = read_pfm(f"{folder}/truth/depth_{burst:06d}.pfm").astype(float)
        self.lit = cv2.imread(f"{folder}/truth/lit_{burst:06d}.png", cv2.IMREAD_UNCHANGED) > 0
        self.frames = [cv2.imread(f"{folder}/frames/{burst:06d}_{k}.png", cv2.IMREAD_UNCHANGED).astype(float) for k in range(4)]
        near, far = unit.rig["depth_range_mm"]
        self.inside = np.isfinite(self.truth) & (np.nan_to_num(self.truth) >= near) & (np.nan_to_num(self.truth) <= far)
        self.true_column = unit.column(self.truth)
        placed = self.has & self.inside
        self.wrong = placed & (np.abs(np.nan_to_num(unit.column(depth) - self.true_column, nan=np.inf)) > unit.period / 2)
        self.right = placed & ~self.wrong

    def figures(self):
        target, placed = self.lit & self.inside, self.has & self.inside
        return {"coverage_pct": 100 * float((self.has & target).sum() / max(1, target.sum())),
                "wrong_pct": 100 * float(self.wrong.sum() / max(1, placed.sum()))}

    def floor_um(self):
        """Root of the mean square of the depth noise that the sensor alone would leave where the order is right."""
        step = 0.01
        column_per_mm = (self.unit.column(self.truth + step) - self.true_column) / step
        mm = self.unit.period / (2 * np.pi) / column_per_mm * self.unit.phase_noise(self.frames)
        return 1e3 * float(np.sqrt(np.mean(mm[self.right] ** 2)))

    def plane_um(self):
        """Rms distance of the 5x5 means from their best plane; windows with a gap are left out."""
        means = cv2.boxFilter(np.where(self.has, self.depth, 0).astype(float), -1, (5, 5), borderType=cv2.BORDER_CONSTANT)
        full = cv2.erode(self.has.astype(np.uint8), np.ones((5, 5), np.uint8), borderType=cv2.BORDER_CONSTANT, borderValue=0) > 0
        points = self.unit.rays[full] * means[full][:, None]
        if len(points) < 100:
            return None
        spread = np.linalg.eigvalsh(np.cov(points.T))  # the least is along the plane's normal
        return 1e3 * float(np.sqrt(max(0.0, spread[0])))

    def diameters_um(self, balls, pose):
        """Errors of the balls' fitted diameters, in the order of scene.json; None for a ball hardly seen."""
        centres = [pose[:3, :3].T @ (np.array(b["centre"]) - pose[:3, 3]) for b in balls]
        true, out = self.unit.rays * self.truth[..., None], []
        view = self.unit.rays / np.linalg.norm(self.unit.rays, axis=-1, keepdims=True)
        for k, (ball, centre) in enumerate(zip(balls, centres)):
            normal = (true - centre) / ball["radius"]
            on = self.right & (np.abs(np.linalg.norm(normal, axis=-1) - 1) < 0.01)
            on &= -np.sum(normal * view, -1) > np.cos(np.radians(STEEPEST_DEG))
            for other in centres[:k] + centres[k + 1:]:
                on &= normal @ ((other - centre) / np.linalg.norm(other - centre)) < CLEAR_OF_ROD
            seen = on.sum() >= 500
            out.append(2e3 * (fitted_radius(self.unit.rays[on], self.depth[on], centre, ball["radius"]) - ball["radius"]) if seen else None)
        return out


def fitted_radius(rays, depth, centre, radius):
    """Of the sphere that leaves the least squared distances, those beyond 3.5 sigma left out. Normals are the sphere's where each
    ray meets it, not those of the measured points, whose noise along the ray would make every ball smaller."""
    centre, square = np.array(centre, float), np.sum(rays**2, axis=1)
    for _ in range(12):
        along = rays @ centre
        meet = (along - np.sqrt(np.maximum(along**2 - square * (centre @ centre - radius**2), 0))) / square
        normal = (rays * meet[:, None] - centre) / radius
        off = (depth - meet) * np.sum(normal * rays, axis=1)
        apart = np.abs(off - np.median(off))
        keep = apart < max(3.5 * 1.4826 * np.median(apart), 0.01)
        step, *_ = np.linalg.lstsq(np.column_stack([normal, np.ones(len(off))])[keep], off[keep], rcond=None)
        centre, radius = centre + step[:3], radius + step[3]
    return float(radius)


def poses(folder):
    """burst: 4x4, camera to model coordinates."""
    out = {}
    for burst, _, *t, x, y, z, w in np.atleast_2d(np.loadtxt(f"{folder}/truth/poses.csv", delimiter=",", skiprows=1)):
        axis = np.array([x, y, z])
        length = np.linalg.norm(axis)
        out[int(burst)] = np.eye(4)
        if length > 0:
            out[int(burst)][:3, :3] = cv2.Rodrigues(axis / length * 2 * np.arctan2(length, w))[0]
        out[int(burst)][:3, 3] = t
    return out


def decoded(program, folder, burst, out):
    """Verdict and depth map; nothing has a depth where the burst is not accepted."""
    ran = subprocess.run([program, "decode", folder, "--burst", str(burst), "--out", out], stdout=subprocess.DEVNULL,
                         stderr=subprocess.PIPE, text=True)
    if not os.path.exists(f"{out}/decode.json"):
        raise RuntimeError(f"{program} decode {folder} --burst {burst}: {ran.stderr.strip()}")
    with open(f"{out}/decode.json", encoding="utf-8") as f:
        verdict = json.load(f)["verdict"]
    return verdict, read_pfm(f"{out}/depth.pfm") if verdict == "accepted" else None


def burst_row(program, folder, burst, unit, work):
    verdict, depth = decoded(program, folder, burst, f"{work}/{os.path.basename(folder)}-{burst}")
    row = {"burst": burst, "verdict": verdict}
    if depth is None:
        return row | {"coverage_pct": 0.0}
    one = Burst(folder, burst, unit, depth)
    row |= one.figures()
    with open(f"{folder}/truth/scene.json", encoding="utf-8") as f:
        objects = json.load(f)["objects"]
    if {o["type"] for o in objects} == {"plane"}:
        row |= {"plane_5x5_um": one.plane_um(), "floor_um": one.floor_um()}
    balls = [o for o in objects if o["type"] == "sphere"]
    if balls:
        row["diameter_error_um"] = one.diameters_um(balls, poses(folder)[burst])
    return row


def set_rows(shared, program, work):
    """{set: {"mode": …, "bursts": [figures of one burst, …]}}; empty when no set is there."""
    rows = {}
    for folder in sorted(glob.glob(f"{shared}/data/oracle/*-02")):
        name = os.path.basename(folder)
        if not name.startswith(KINDS):
            continue
        print(f"bench: {name} ...", file=sys.stderr)
        with open(f"{folder}/rig.json", encoding="utf-8") as f:
            unit = Unit(json.load(f))
        numbers = sorted(int(m[1]) for p in os.listdir(f"{folder}/truth") if (m := re.fullmatch(r"depth_(\d{6})\.pfm", p)))
        rows[name] = {"mode": unit.rig["patterns"]["mode"],
                      "bursts": [burst_row(program, folder, b, unit, work) for b in numbers]}
    return rows

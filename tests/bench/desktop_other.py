#!/usr/bin/env python3
"""A plaster model on the desktop scanner's table, rendered by other_renderer.py, scanned by `enamel replay`, compared with its surface.

usage: desktop_other.py PROGRAMS FOLDER SEED SURFACE.ply... [--turns DEG,...]

The surfaces are in one frame, mm, outward winding. Unit, pattern mode, projector's response, mount and its calibration errors are
drawn from the seed. Prints one JSON object."""
import argparse
import json
import os
import subprocess
import sys

import cv2
import numpy as np

from other_renderer import Head

SWINGS_DEG = (-20.0, 0.0, 20.0)
TURNS_DEG = tuple(range(0, 360, 15))
RING_AT_MM = 27.0  # from the rotation axis to the middle of the field: docs/desktop.md
FIELD_Z_MM = 48.0
BURSTS_A_STOP = 2
STOP_RMS_DEG, RUN_OUT_MM = 0.01, 0.003
CALIBRATED_DEG, CALIBRATED_MM = 0.001, 0.001  # sigma of a solved line in each direction
ALBEDO = 0.8
SLIPPED = 3  # exit code of a scan whose table was not where it said


def read_ply(path):
    with open(path, "rb") as f:
        data = f.read()
    head, body = data.split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    counts = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    if "format binary_little_endian 1.0" not in lines or lines.count("property float x") != 1:
        raise SystemExit(f"{path}: a binary little-endian PLY with float vertices is needed")
    points = np.frombuffer(body, "<f4", 3 * counts["vertex"]).reshape(-1, 3).astype(float)
    rows = np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<i4", 3)]), counts["face"], 12 * counts["vertex"])
    if not (rows["n"] == 3).all():
        raise SystemExit(f"{path}: triangles are needed")
    return points, rows["v"].astype(np.int64)


def write_ply(path, points, faces):
    head = f"ply\nformat binary_little_endian 1.0\ncomment units mm\nelement vertex {len(points)}\nproperty float x\nproperty float y\n" \
           f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = np.zeros(len(faces), np.dtype([("n", "u1"), ("v", "<i4", 3)]))
    rows["n"], rows["v"] = 3, faces
    with open(path, "wb") as f:
        f.write(head.encode() + points.astype("<f4").tobytes() + rows.tobytes())


def turn(direction, angle):
    """Rodrigues."""
    d = direction / np.linalg.norm(direction)
    k = np.array([[0, -d[2], d[1]], [d[2], 0, -d[0]], [-d[1], d[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def drawn_rig(rng):
    def lens(width, f, spread):
        return {"width": width, "height": 480, "fx": f * (1 + rng.normal(0, 0.01)), "fy": f * (1 + rng.normal(0, 0.01)),
                "cx": width / 2 + rng.normal(0, spread), "cy": 240 + rng.normal(0, spread),
                "dist": [rng.normal(-0.035, 0.01), rng.normal(0.02, 0.01), rng.normal(0, 2e-4), rng.normal(0, 2e-4), 0.0]}
    angle = np.arctan2(11.0, FIELD_Z_MM) + rng.normal(0, 0.004)
    R = turn(np.array([0, 1.0, 0]), angle) @ turn(rng.normal(size=3), rng.normal(0, 0.005))
    centre = np.array([rng.uniform(10.2, 11.8), rng.normal(0, 0.1), rng.normal(0, 0.1)])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, -R @ centre
    mode = "M" if rng.random() < 0.5 else "T"
    patterns = {"mode": mode, "axis": "u", "period_px": float(rng.integers(22, 29)), "mean": rng.uniform(118, 128),
                "amplitude": rng.uniform(105, 117), "steps": 3 if mode == "M" else 4}
    if mode == "M":
        patterns["code_ratio"] = float(rng.integers(9, 12))
    else:
        patterns |= {"polarity_code": "-++++-+---++---+", "first_cell": int(rng.integers(0, 16))}
    return {"format": "rig/1", "units": "mm", "depth_range_mm": [40.0, 56.0], "camera": lens(640, 1750, 4), "projector": lens(854, 1610, 5),
            "T_proj_cam": T.tolist(), "patterns": patterns,
            "noise": {"bits": 8, "black_dn": float(rng.integers(1, 6)), "full_well_e": 1e4, "gain_e_per_dn": 39.5, "read_noise_e": rng.uniform(4, 7)}}


def pattern_levels(patterns, columns):
    phase = 2 * np.pi * np.arange(columns) / patterns["period_px"]
    if patterns["mode"] == "M":
        third = 2 * np.pi / 3
        waves = [np.cos(phase), np.cos(phase * (1 + 1 / patterns["code_ratio"])), np.cos(phase + third), np.cos(phase + 2 * third)]
    else:
        cell = np.floor(phase / np.pi + 1e-9).astype(int) + patterns["first_cell"]
        sign = np.array([1 if c == "+" else -1 for c in patterns["polarity_code"]])[cell % 16]
        waves = [np.cos(phase + k * np.pi / 2) for k in range(3)] + [sign * np.sin(phase)]
    return [patterns["mean"] + patterns["amplitude"] * w for w in waves]


def drawn_mount(rng):
    def line(direction, point):
        tilt = turn(rng.normal(size=3), np.radians(rng.uniform(0, 2)))
        return {"direction": tilt @ direction, "point": np.array(point) + rng.normal(0, 0.2, 3), "harmonic": rng.normal(0, 0.01, 2)}
    return {"rotation": line(np.array([0, 0, -1.0]), [RING_AT_MM, 0, FIELD_Z_MM]), "swing": line(np.array([0, 1.0, 0]), [0, 0, FIELD_Z_MM])}


def mount_json(mount, rng):
    """What a calibration would have told: the lines with its errors."""
    out = {"format": "enamel-mount-truth", "schema": 1, "serial": "OTHER"}
    for name, axis in mount.items():
        direction = axis["direction"] + rng.normal(0, np.radians(CALIBRATED_DEG), 3)
        out[name] = {"direction": (direction / np.linalg.norm(direction)).tolist(),
                     "point_mm": (axis["point"] + rng.normal(0, CALIBRATED_MM, 3)).tolist(),
                     "harmonic_deg": axis["harmonic"].tolist(), "backlash_deg": 0.0, "approach": "positive"}
    return out


def true_motion(mount, rotation_deg, swing_deg, run_out):
    R, t = np.eye(3), np.zeros(3)
    for name, degrees in (("rotation", rotation_deg), ("swing", swing_deg)):
        axis, a = mount[name], np.radians(degrees)
        h = np.radians(axis["harmonic"])
        turned = turn(axis["direction"], a + h[0] * (np.cos(a) - 1) + h[1] * np.sin(a))
        R, t = turned @ R, turned @ (t - axis["point"]) + axis["point"]
    return R, t + run_out


def on_table(mount, points, teeth):
    """The model's vertices in the camera's frame with both axes at zero: its ring about the axis, its top near the field's middle."""
    up = 1.0 if points[:teeth, 1].mean() > points[teeth:, 1].mean() else -1.0
    lying = np.stack([points[:, 0], -up * points[:, 2], up * points[:, 1]], 1)  # +z up, right-handed
    crowns = lying[:teeth]
    middle = np.append((crowns[:, :2].min(0) + crowns[:, :2].max(0)) / 2, np.median(crowns[:, 2]))
    z = mount["rotation"]["direction"]
    x = np.cross([0, 1.0, 0], z)
    x /= np.linalg.norm(x)
    return (lying - middle) @ np.stack([x, np.cross(z, x), z]) + mount["rotation"]["point"]


def render(folder, rng, points, faces, teeth, turns):
    rig, mount, gamma = drawn_rig(rng), drawn_mount(rng), rng.uniform(1.0, 1.6)
    points = on_table(mount, points, teeth)
    head = Head(rig, [np.asarray(l) for l in pattern_levels(rig["patterns"], rig["projector"]["width"])], gamma)
    os.makedirs(os.path.join(folder, "frames"), exist_ok=True)
    write_ply(os.path.join(folder, "surface.ply"), points, faces)
    axes, bursts = ["burst_id,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg"], ["burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c"]
    plan = [(r, s) for s in SWINGS_DEG for r in turns]
    for stop, (rotation, swing) in enumerate(plan):
        print(f"\rrendering stop {stop + 1} of {len(plan)} ", end="", file=sys.stderr)
        stands = np.array([rotation, swing]) + rng.normal(0, STOP_RMS_DEG, 2)
        R, t = true_motion(mount, *stands, rng.normal(0, RUN_OUT_MM, 3) / np.sqrt(3))
        light = head.light(points @ R.T + t, faces, ALBEDO)
        for k in range(BURSTS_A_STOP):
            burst = stop * BURSTS_A_STOP + k
            start = 1_000_000_000 + stop * 800_000_000 + k * 66_666_667
            bursts.append(",".join(str(v) for v in [burst, *(start + 4_004_000 * j for j in range(4)), 3700, "32.00"]))
            axes.append(f"{burst},{rotation:.6f},{swing:.6f},nan,nan")
            for j, frame in enumerate(light):
                cv2.imwrite(os.path.join(folder, f"frames/{burst:06d}_{j}.png"), head.expose(frame, rng))
    print(file=sys.stderr)
    for name, text in (("rig.json", json.dumps(rig, indent=1)), ("mount.json", json.dumps(mount_json(mount, rng), indent=1)),
                       ("axes.csv", "\n".join(axes) + "\n"), ("bursts.csv", "\n".join(bursts) + "\n")):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as f:
            f.write(text)
    return {"mode": rig["patterns"]["mode"], "gamma": gamma}


def measured(programs, folder, seed, surfaces, turns):
    """Renders the set, scans it, compares it with its surface. RuntimeError: what the program said."""
    meshes = [read_ply(path) for path in surfaces]
    starts = np.cumsum([0] + [len(p) for p, _ in meshes])
    points = np.concatenate([p for p, _ in meshes])
    faces = np.concatenate([f + s for (_, f), s in zip(meshes, starts)])
    drawn = render(folder, np.random.default_rng(seed), points, faces, len(meshes[0][0]), turns)
    enamel, out = os.path.join(programs, "enamel"), os.path.join(folder, "out")
    ran = subprocess.run([enamel, "replay", folder, "--out", out, "--headless", "--mount", os.path.join(folder, "mount.json")],
                         capture_output=True, text=True, check=False)
    if ran.returncode not in (0, SLIPPED):
        raise RuntimeError(f"enamel replay: exit {ran.returncode}\n{ran.stdout[-1500:]}{ran.stderr[-1500:]}")
    compared = subprocess.run([enamel, "desktop", "accuracy", out, "--reference", os.path.join(folder, "surface.ply"), "--json"],
                              capture_output=True, text=True, check=True)
    with open(os.path.join(out, "report.json"), encoding="utf-8") as f:
        desktop = json.load(f)["desktop"]
    run = json.loads(compared.stdout)["trueness"]["runs"][0]
    return {"seed": seed, **drawn, "slipped": ran.returncode == SLIPPED, "stops": len(desktop["stops"]),
            **{k: desktop[k] for k in ("by_axes_rms_um", "fine_rms_um")}, **{k: run[k] for k in ("mean_abs_um", "p95_um", "half_80_um")}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("folder")
    parser.add_argument("seed", type=int)
    parser.add_argument("surfaces", nargs="+", help="teeth first, then what they stand in")
    parser.add_argument("--turns", default=",".join(map(str, TURNS_DEG)), help="rotations of each of the three swings, degrees")
    given = parser.parse_args()
    try:
        told = measured(given.programs, given.folder, given.seed, given.surfaces, [float(a) for a in given.turns.split(",")])
    except RuntimeError as error:
        raise SystemExit(str(error)) from error
    print(json.dumps(told, indent=1))


if __name__ == "__main__":
    main()

"""What is measured outside our own programs: scikit-image's unwrapping, and rendered bursts judged by their own scorer."""
import json
import os
import subprocess
import sys
import time

import numpy as np

# Bursts with truth maps.
ORACLE = {"plane-01": range(6), "spheres-01": range(4), "steps-01": range(3), "sweep-01": range(0, 30, 5)}


def read_pfm(path):
    with open(path, "rb") as f:
        f.readline()
        width, height = map(int, f.readline().split())
        f.readline()
        return np.frombuffer(f.read(), "<f4").reshape(height, width)[::-1].copy()


def skimage_unwrapping(work, name, repeats=5):
    """None when scikit-image is not installed. Scored as ours is: every region of the mask may be off as a whole."""
    try:
        from skimage.restoration import unwrap_phase
    except ImportError:
        return None
    import cv2

    wrapped = read_pfm(f"{work}/unwrap_{name}_wrapped.pfm")
    truth = read_pfm(f"{work}/unwrap_{name}_truth.pfm")
    mask = np.isfinite(wrapped)
    given = np.ma.array(np.where(mask, wrapped, 0), mask=~mask)
    times = []
    for _ in range(repeats):
        start = time.process_time()
        unwrapped = np.asarray(unwrap_phase(given, seed=1))
        times.append(1e3 * (time.process_time() - start))
    off = np.round((unwrapped - truth) / (2 * np.pi))
    count, region = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    right = 0
    for r in range(1, count):
        right += np.unique(off[region == r], return_counts=True)[1].max()
    return {"wrong_pct": float(100 * (1 - right / mask.sum())), "left_out_pct": 0.0, "ms": float(np.median(times))}


def oracle_rows(shared, program, work):
    """{set: [figures of one burst, …]}, or None when the sets or the scorer are absent."""
    scorer = f"{shared}/score/score.py"
    if not os.path.exists(scorer) or not os.path.isdir(f"{shared}/data/oracle"):
        return None
    rows = {}
    for name, bursts in ORACLE.items():
        print(f"bench: {name} ...", file=sys.stderr)
        folder = f"{shared}/data/oracle/{name}"
        rows[name] = []
        for burst in bursts:
            out = f"{work}/{name}-{burst}"
            subprocess.run([program, "decode", folder, "--burst", str(burst), "--out", out], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            scored = subprocess.run(["/usr/bin/python3", scorer, "depth", folder, str(burst), f"{out}/depth.pfm", "--json"],
                                    check=True, capture_output=True, text=True)
            rows[name].append({"burst": burst} | json.loads(scored.stdout))
    return rows

"""What pages share that render scenes by the twin, decode and replay them, and know the truth. SIMULATED."""
import csv
import json
import os
import subprocess
import sys

import numpy as np
from scipy.spatial.transform import Rotation

CONFIG = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config"))
SCENES = os.path.join(CONFIG, "scenes")


class Bench:
    def __init__(self, programs, folder):
        self.programs, self.folder, self.made = programs, folder, 0

    def run(self, program, *arguments):
        return subprocess.run([os.path.join(self.programs, program), *arguments], capture_output=True, text=True, check=False)

    def render(self, scene, seed, settings, maps=False):
        """An exchange folder. scene: of config/scenes, or a path, without .toml; settings: "key=value"."""
        self.made += 1
        out = os.path.join(self.folder, f"{self.made:03d}")
        sets = [word for setting in settings for word in ("--set", setting)]
        ran = self.run("enamel-twin", "render", os.path.join(SCENES, scene + ".toml"), "--seed", str(seed), *sets, "--out", out,
                       *(["--truth-maps"] if maps else []))
        if ran.returncode != 0:
            raise RuntimeError(f"{scene}: {ran.stderr}")
        print(f"rendered {os.path.basename(scene)} seed {seed} {' '.join(settings)}", file=sys.stderr)
        return out

    def decode(self, folder, burst, settings=()):
        out = os.path.join(self.folder, "decoded")
        sets = [word for setting in settings for word in ("--set", setting)]
        self.run("enamel", "decode", folder, "--burst", str(burst), "--out", out, *sets)
        with open(os.path.join(out, "decode.json"), encoding="utf-8") as f:
            return out, json.load(f)

    def replay(self, folder, *options):
        out = folder + ".replayed" + "".join(options)
        self.run("enamel", "replay", folder, "--out", out, "--headless", *options)
        with open(os.path.join(out, "report.json"), encoding="utf-8") as f:
            return out, json.load(f)


def bursts_of(folder):
    with open(os.path.join(folder, "bursts.csv"), encoding="utf-8") as f:
        return [int(row["burst_id"]) for row in csv.DictReader(f)]


def pose(row):
    out = np.eye(4)
    out[:3, :3] = Rotation.from_quat([float(row[k]) for k in ("qx", "qy", "qz", "qw")]).as_matrix()
    out[:3, 3] = [float(row[k]) for k in ("tx", "ty", "tz")]
    return out


def poses(path):
    with open(path, encoding="utf-8") as f:
        return {int(row["burst_id"]): pose(row) for row in csv.DictReader(f)}

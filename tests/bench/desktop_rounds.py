"""Runs units of the desktop scanner on the twin: calibrates each, scans a ball bar and an arch, asks the programs for figures.

Renderings are kept in the folder given, by seed and name, and made again when what they are rendered with has changed."""
import json
import math
import os
import subprocess
import sys

import numpy as np

from desktop_other import TURNS_DEG, measured

SCENES = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config/scenes"))
POINT = "mount.rotation.point_mm=[27.0,0.0,48.0]"  # of every scene: one mount.json serves them all
FULL = {"rig": [], "bar": [], "arch": ["--set", "mount.bursts=2"]}  # two at a stop, as a scan takes them
SHORT = {"rig": ["--poses", "14"], "bar": ["--set", "mount.swing_deg=[-15.0,15.0]"], "arch": ["--set", "mount.swing_deg=[-20.0,20.0]"]}
SLIPPED = 3  # exit code of a scan whose table was not where it said


def read_json(path):
    with open(path, encoding="utf-8") as f:
        return json.load(f)


def certificate_error_um(capture):
    """Certified less true distance of the bar's balls: the certificate's own error, drawn with 2.5 um, is not the scanner's."""
    certified = read_json(os.path.join(capture, "artefact.json"))["distances_mm"][0][2]
    balls = [o["centre"] for o in read_json(os.path.join(capture, "truth/scene.json"))["objects"] if o["type"] == "sphere"]
    return 1e3 * (certified - math.dist(balls[0], balls[1]))


class Rounds:
    def __init__(self, programs, folder, short):
        self.programs, self.folder, self.sets = os.path.abspath(programs), os.path.abspath(folder), SHORT if short else FULL

    def run(self, program, *arguments, may_slip=False):
        ran = subprocess.run([os.path.join(self.programs, program), *arguments], capture_output=True, text=True, check=False)
        if ran.returncode != 0 and not (may_slip and ran.returncode == SLIPPED):
            raise RuntimeError(f"{program} {' '.join(arguments)}: exit {ran.returncode}\n{ran.stdout[-2000:]}{ran.stderr[-2000:]}")
        return ran

    def rendered(self, name, seed, what, scene, *arguments):
        out = os.path.join(self.folder, f"seed_{seed}", name)
        words = [what, os.path.join(SCENES, scene + ".toml"), "--seed", str(seed), *arguments]
        mark = out + ".made"
        if os.path.exists(mark):
            with open(mark, encoding="utf-8") as f:
                if f.read() == "\n".join(words):
                    return out
        subprocess.run(["rm", "-rf", out, mark], check=True)
        os.makedirs(os.path.dirname(out), exist_ok=True)
        print(f"rendering {name} of seed {seed} ...", file=sys.stderr)
        self.run("enamel-twin", *words, "--out", out)
        with open(mark, "w", encoding="utf-8") as f:
            f.write("\n".join(words))
        return out

    def calibrated(self, seed):
        """Paths: the unit's solved rig.json and mount.json, the axes solved with the true rig as control, and the truth."""
        poses = self.rendered("rigset", seed, "calibrate", "quadrant", *self.sets["rig"])
        board = self.rendered("board", seed, "calibrate", "desktop_board", "--set", "calibration.fringes=false", "--set", POINT)
        home = os.path.dirname(board)
        rig, mount = os.path.join(home, "rig.json"), os.path.join(home, "mount.json")
        print(f"calibrating seed {seed} ...", file=sys.stderr)
        self.run("enamel", "calibrate", "solve", poses, "--out", rig)
        true_rig, control = os.path.join(SCENES, "../rigs/probe.json"), os.path.join(home, "mount_control.json")
        for by, out in ((rig, mount), (true_rig, control)):
            self.run("enamel", "calibrate", "axes", board, "--rig", by, "--out", out)
        return {"rig": rig, "mount": mount, "control_mount": control, "true_rig": true_rig,
                "true_mount": os.path.join(board, "truth/mount_true.json")}

    def axes(self, unit):
        """Errors of the solved lines: angles, distances near the field, and components in their own sigmas."""
        figures = {}
        for way, mount in (("solved", unit["mount"]), ("true", unit["control_mount"])):
            figures[way] = json.loads(self.run("enamel", "calibrate", "compare", mount, unit["true_mount"]).stdout)
            figures[way]["in_sigmas"] = in_sigmas(read_json(mount), read_json(unit["true_mount"]))
        return figures

    def replayed(self, capture, name, rig, mount):
        """Folder of the results, and their report."""
        out = capture + "." + name
        print(f"scanning {os.path.relpath(out, self.folder)} ...", file=sys.stderr)
        ran = self.run("enamel", "replay", capture, "--out", out, "--headless", "--rig", rig, "--mount", mount, may_slip=True)
        report = read_json(os.path.join(out, "report.json"))
        desktop = report["desktop"]
        return out, {"slipped": ran.returncode == SLIPPED, "stops": len(desktop["stops"]), "coverage_pct": report["accuracy"]["coverage_pct"],
                     **{k: desktop[k] for k in ("by_axes_rms_um", "fine_rms_um", "circles", "seconds")}}

    def accuracy(self, runs, *arguments):
        return json.loads(self.run("enamel", "desktop", "accuracy", *runs, *arguments, "--json").stdout)

    def both_ways(self, capture, unit, measure):
        """The scan laid with what was calibrated, and with the truth as control."""
        figures = {}
        for name, rig, mount in (("solved", unit["rig"], unit["mount"]), ("true", unit["true_rig"], unit["true_mount"])):
            out, report = self.replayed(capture, name, rig, mount)
            figures[name] = {**report, **measure(out)}
        return figures

    def bar(self, seed, unit):
        capture = self.rendered("bar", seed, "render", "desktop_bar", *self.sets["bar"], "--set", POINT)
        certificate_um = certificate_error_um(capture)

        def measure(out):
            told = self.accuracy([out], "--artefact", os.path.join(capture, "artefact.json"))["artefact"]
            return {"distance_um": told["distances"][0]["error_um"]["mean"] + certificate_um, "certificate_um": certificate_um,
                    "form_um": max(b["form_um"]["mean"] for b in told["balls"]),
                    "size_um": max((b["size_um"]["mean"] for b in told["balls"]), key=abs)}
        return self.both_ways(capture, unit, measure)

    def arch(self, seed, unit):
        capture = self.rendered("arch", seed, "render", "desktop_arch", *self.sets["arch"], "--set", POINT)

        def measure(out):
            told = self.accuracy([out], "--reference", os.path.join(capture, "truth/surface.ply"))["trueness"]["runs"][0]
            return {k: told[k] for k in ("mean_abs_um", "mean_um", "rms_um", "p95_um", "half_80_um")}
        return self.both_ways(capture, unit, measure)

    def other(self, seed, surfaces):
        """A unit drawn and rendered by another program."""
        print(f"rendering and scanning another program's set {seed} ...", file=sys.stderr)
        return measured(self.programs, os.path.join(self.folder, f"other_{seed}"), seed, surfaces, TURNS_DEG)

    def repeats(self, seed, unit, count):
        """Further scans of the unit's arch: noise, stop errors and phase of the wobble drawn anew."""
        mould = os.path.join(self.folder, f"seed_{seed}/arch/truth/surface.ply")
        captures = [self.rendered(f"repeat_{k}", 1000 * seed + k, "render", "desktop_arch", *self.sets["arch"],
                                  *as_stated(read_json(unit["true_mount"]), mould)) for k in range(count)]
        runs = [self.replayed(capture, "solved", unit["rig"], unit["mount"])[0] for capture in captures]
        told = self.accuracy(runs)["precision"]
        return {"scans": count, "pairs": len(told["pairs"]), **told["over_pairs"]}


def as_stated(mount, mould):
    """--set of a unit whose drawn errors are stated instead, and of the model as a file: both are then free of the seed."""
    words = ["mount.draw=false", f"mount.wobble_um={mount['wobble_um']}"]
    for axis in ("rotation", "swing"):
        line = mount[axis]
        words += [f"mount.{axis}.{k}={json.dumps(line[k])}" for k in ("direction", "harmonic_deg", "backlash_deg")]
    # The table's frame has its origin in the stated point, which lies on the axis drawn.
    words += [POINT, f"mount.swing.point_mm={json.dumps(mount['swing']['point_mm'])}"]
    words += ['object.type="file"', f'object.file.path="{mould}"', "object.file.max_edge_mm=0.0"]
    return [word for setting in words for word in ("--set", setting)]


def nearest_to_origin(direction, point):
    return point - direction * (direction @ point)


def in_sigmas(solved, true):
    """Errors of the lines along the axes of their own covariance, in sigmas: two of each direction, two of each place."""
    names, matrix = solved["covariance"]["parameters"], np.array(solved["covariance"]["matrix"])
    out = {}
    for axis in ("rotation", "swing"):
        ours, theirs = (np.array(m[axis]["direction"]) for m in (solved, true))
        places = [nearest_to_origin(np.array(m[axis]["direction"]), np.array(m[axis]["point_mm"])) for m in (solved, true)]
        for part, error in (("direction", ours - theirs), ("point_mm", places[0] - places[1])):
            rows = [i for i, name in enumerate(names) if name.startswith(f"{axis}.{part}.")]
            variances, along = np.linalg.eigh(matrix[np.ix_(rows, rows)])
            out[f"{axis} {part}"] = [float(error @ along[:, k] / np.sqrt(variances[k])) for k in (1, 2)]
    return out

"""The recordings that bench_speed plays: rendered once into a folder, again when their recipe changes. SIMULATED."""
import hashlib
import json
import os
import subprocess
import sys

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config/scenes")
MOLARS = ["path.from_s=1.4"]  # past the premolars, a molar and the turn behind it
QUICK = ["render.samples_grid=1"]  # a quarter of the rays: edges are rougher, nothing else
STILL, MODE_T = ["effects.motion=false"], ["rig=../rigs/probe_t.json"]
# name: (settings, still). Still: the probe rests during a burst, and moves between two.
RECIPES = {"molars_m": (MOLARS + QUICK + ["timing.bursts=32"], False),
           "molars_t": (MODE_T + MOLARS + QUICK + ["timing.bursts=40"], False),
           "still_m": (STILL + MOLARS + QUICK + ["timing.bursts=16"], True),
           "still_t": (MODE_T + STILL + MOLARS + QUICK + ["timing.bursts=16"], True)}


def fingerprint(path):
    digest = hashlib.sha256()
    with open(path, "rb") as f:
        for block in iter(lambda: f.read(1 << 20), b""):
            digest.update(block)
    return digest.hexdigest()[:12]


def is_still(name):
    return name in RECIPES and RECIPES[name][1]


def make(programs, folder):
    """Paths of all recordings, rendered where they are not there yet."""
    os.makedirs(folder, exist_ok=True)
    return [render(programs, folder, name, settings) for name, (settings, _) in RECIPES.items()]


def render(programs, folder, name, settings):
    capture, recipe = os.path.join(folder, f"{name}.mcap"), os.path.join(folder, f"{name}.json")
    wanted = json.dumps(["quadrant", *settings])
    if os.path.exists(capture) and os.path.exists(recipe):
        with open(recipe, encoding="utf-8") as f:
            if f.read() == wanted:
                return capture
    print(f"bench: rendering {name} ...", file=sys.stderr)
    part = os.path.join(folder, f"{name}.part.mcap")
    sets = [word for setting in settings for word in ("--set", setting)]
    ran = subprocess.run([os.path.join(programs, "enamel-twin"), "render", os.path.join(SCENES, "quadrant.toml"), *sets,
                          "--out", part], stderr=subprocess.PIPE, text=True, check=False)
    if ran.returncode != 0:
        sys.exit(f"{name} was not rendered: enamel-twin ended with {ran.returncode}\n{ran.stderr}")
    os.replace(part, capture)
    with open(recipe, "w", encoding="utf-8") as f:
        f.write(wanted)
    return capture

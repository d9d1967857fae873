#!/usr/bin/env python3
"""Who may include whom: layers, forbidden neighbours, homes of third-party libraries. Reads #include lines only."""
import re
import sys

from lint_common import CPP, ROOT, Finding, main

BASE = ["protocol/base"]
IMAGE = BASE + ["protocol/image"]
PROTOCOL = BASE + ["protocol/types", "protocol/idl", "protocol/dds", "protocol/mcap", "protocol/capture"]
DEVICE = ["firmware/device", "firmware/device/sim", "firmware/device/linux/camera", "firmware/device/linux/libcamera",
          "firmware/device/linux/projector", "firmware/device/linux/dlpc347x", "firmware/device/linux/dlpc350",
          "firmware/device/linux/lines", "firmware/device/linux/board"]
FIRMWARE = ["firmware/hal", "firmware/acquire", "firmware/check", "firmware/publish", "firmware/control"] + DEVICE
HOST = ["host/ingest", "host/record", "host/report", "host/update", "host/session"]
DECODE = ["pipeline/decode/" + room for room in ("phase", "unwrap", "triangulate", "motion", "steps", "mode_t", "mode_m")]
REGISTER = ["pipeline/register/" + room for room in ("icp", "feature", "track", "map", "stops")]
MODEL = ["pipeline/model/" + room for room in ("fuse", "mesh", "guide", "segments")]
SHARED = BASE + ["calib/model", "pipeline/types"]
ALGORITHMS = ["pipeline/types", "pipeline/tissue", "pipeline/decode"] + DECODE + REGISTER + MODEL

# module: (layer, what it may include besides itself; None = everything on its layer and below)
MODULES: dict[str, tuple[int, list[str] | None]] = {
    "protocol/base": (0, []),
    "protocol/types": (1, BASE),
    "protocol/idl": (1, []),
    "protocol/dds": (1, BASE + ["protocol/types", "protocol/idl"]),
    "protocol/mcap": (1, BASE + ["protocol/types"]),
    "protocol/capture": (1, BASE + ["protocol/types", "protocol/mcap", "calib/model"]),
    "protocol/image": (1, BASE),
    "calib/model": (1, BASE),
    "pipeline/types": (2, BASE + ["calib/model"]),
    "pipeline/flow": (2, BASE),
    # A burst's way: each room sees those before it, and neither mode the other.
    "pipeline/decode/phase": (2, SHARED),
    "pipeline/decode/unwrap": (2, SHARED + DECODE[:1]),
    "pipeline/decode/triangulate": (2, SHARED + DECODE[:1]),
    "pipeline/decode/motion": (2, SHARED + DECODE[:3]),
    "pipeline/decode/steps": (2, SHARED + DECODE[:4]),
    "pipeline/decode/mode_t": (2, SHARED + DECODE[:5]),
    "pipeline/decode/mode_m": (2, SHARED + DECODE[:5]),
    "pipeline/decode": (2, SHARED + DECODE),
    "pipeline/tissue": (2, SHARED),
    "pipeline/register/icp": (2, SHARED),
    "pipeline/register/feature": (2, SHARED),
    "pipeline/register/track": (2, SHARED + REGISTER[:2]),
    "pipeline/register/map": (2, SHARED + REGISTER[:1]),
    "pipeline/register/stops": (2, SHARED + ["pipeline/register/icp", "pipeline/register/map"]),
    "pipeline/model/fuse": (2, SHARED),
    "pipeline/model/mesh": (2, SHARED + ["pipeline/model/fuse"]),
    "pipeline/model/guide": (2, SHARED + ["pipeline/decode/phase", "pipeline/decode/triangulate", "pipeline/register/icp"]),
    "pipeline/model/segments": (2, SHARED + ["pipeline/decode/phase", "pipeline/decode/triangulate", "pipeline/model/fuse"]),
    "pipeline/stages": (3, BASE + ["protocol/types", "calib/model", "pipeline/flow"] + ALGORITHMS),
    **{m: (3, PROTOCOL + FIRMWARE + ["calib/model"]) for m in FIRMWARE},
    "firmware/boot": (3, IMAGE + ["firmware/hal"]),
    "firmware/update": (3, IMAGE + ["firmware/hal", "firmware/boot"]),
    "firmware/keys": (3, IMAGE),
    "firmware/storage": (3, BASE + ["firmware/hal"]),
    "firmware/gadget": (3, IMAGE + ["firmware/hal", "firmware/boot", "firmware/update"]),
    "firmware/updater": (5, IMAGE + ["firmware/hal", "firmware/boot", "firmware/update", "firmware/storage",
                                     "firmware/gadget", "firmware/keys"]),
    "calib/target": (4, BASE + ["calib/model", "pipeline/types"]),
    "calib/fringe": (4, BASE + ["calib/model", "calib/target", "pipeline/types"]),
    "calib/io": (4, BASE + ["calib/model", "calib/target", "calib/fringe", "pipeline/types"]),
    "calib/solve": (4, BASE + ["calib/model", "calib/target", "calib/fringe", "calib/io"] + ALGORITHMS),
    "calib/mount": (4, BASE + ["protocol/types", "calib/model", "calib/target", "calib/fringe", "calib/io", "calib/solve"] +
                    ALGORITHMS),
    "calib/judge": (4, BASE + ["calib/model", "calib/target", "calib/fringe", "calib/io", "calib/solve"] + ALGORITHMS),
    "calib/report": (4, BASE + ["calib/model", "calib/target", "calib/fringe", "calib/io", "calib/solve", "calib/judge"] +
                     ALGORITHMS),
    "calib/guide": (4, BASE + ["calib/model", "calib/target", "calib/fringe", "calib/io", "calib/solve"] + ALGORITHMS),
    # Readers of mesh files are no algorithm that the twin has to be a second opinion on.
    "tools/twin": (4, PROTOCOL + FIRMWARE + ["calib/model", "host/mesh_files", "tools/twin/axes"]),
    "tools/twin/axes": (4, BASE),
    "viewer/scene": (4, BASE + ["pipeline/types"]),
    "viewer/gl": (4, BASE + ["pipeline/types", "viewer/scene"]),
    "host/ingest": (4, PROTOCOL + ["pipeline/flow", "calib/model", "host/report"]),
    "host/record": (4, PROTOCOL + ["pipeline/flow", "calib/model", "host/report"]),
    "host/report": (4, BASE + ["protocol/types"]),
    "host/mesh_files": (4, BASE + ["pipeline/types"]),
    "host/mesh_base": (4, BASE + ["pipeline/types", "host/mesh_files"]),
    "host/compare": (4, BASE + ["pipeline/types", "host/mesh_files"]),
    "host/defects": (4, BASE + ["pipeline/types", "calib/model", "host/mesh_files", "host/compare"]),
    "host/cases": (4, SHARED + REGISTER[:3] + ["host/mesh_files", "host/compare"]),
    "host/accuracy": (4, BASE + ["pipeline/types", "pipeline/register/map", "host/mesh_files", "host/compare"]),
    "host/motion": (4, BASE),
    "host/update": (4, IMAGE),
    "host/flash": (5, IMAGE + ["host/update"]),
    "tools/sign": (5, IMAGE),
    "host/session": (4, PROTOCOL + ["calib/model", "pipeline/flow", "pipeline/stages"] + ALGORITHMS + HOST +
                     ["host/defects"]),
    "host/desktop": (4, PROTOCOL + ["calib/model", "pipeline/flow", "pipeline/stages", "host/motion"] + ALGORITHMS + HOST),
    "host/app": (5, None),
    "firmware/app": (5, PROTOCOL + FIRMWARE + ["firmware/storage", "calib/model", "tools/twin"]),
    # The program, not the renderer, writes exchange folders with the recorder's code.
    "tools/twin/app": (5, PROTOCOL + FIRMWARE + ["calib/model", "tools/twin", "host/record"]),
    "tests": (6, None),
}

# header: modules it must not be seen in, although the module that owns it is allowed
WITHHELD = {
    **{m: r"protocol/base/(clock|log|progress|spsc_ring|latest_slot|pool|metrics|config)\.hpp" for m in ALGORITHMS},
    "tools/twin": r"calib/model/(?!(rig|pattern)\.hpp)",
}

# third-party include: where it may appear
HOMES = [
    (r"(GL|GLFW|epoxy|KHR|EGL)/|imgui|imgui_impl", r"viewer/gl/|tests/unit/viewer/", "GL, GLFW and ImGui"),
    (r"dds/|scanner\.h$", r"protocol/dds/|protocol/idl/|tests/", "Cyclone DDS"),
    (r"embree[34]/", r"tools/twin/([a-z_]+/)*embree_\w+\.cpp$", "Embree"),
    (r"ceres/", r"calib/(solve|mount)/|tests/unit/calib/", "Ceres"),
    (r"libusb", r"host/update/transport_usb\.cpp$", "libusb"),
    (r"libcamera", r"firmware/device/linux/libcamera/[a-z_]*\.[ch]pp$", "libcamera"),
    (r"opencv2/", r".*\.cpp$|tests/", "OpenCV (sources, not headers)"),
    (r"spdlog/|toml\+\+/|sodium|zstd|lz4", r".*\.cpp$|tests/", "this library (sources, not headers)"),
]
RULES = {"layer", "neighbour", "home", "unknown", "tests"}


def module_of(path: str) -> str | None:
    fits = [m for m in MODULES if path.startswith(m + "/")]
    return max(fits, key=len) if fits else None


def check_own(path: str, line: int, target: str) -> list[Finding]:
    module = module_of(path)
    other = module_of(target)
    if other is None or not (ROOT / target).is_file():
        # A header beside the test that includes it, or of the code generator, has no repository path.
        if (ROOT / path).parent.joinpath(target).is_file():
            return [Finding(path, line, "unknown", f'write the repository path of "{target}"')]
        return [Finding(path, line, "unknown", f'"{target}" is no file of this repository')]
    if module == other:
        return []
    if other == "tests":
        return [Finding(path, line, "tests", f'nothing but tests may include "{target}"')]
    layer, allowed = MODULES[module]
    if MODULES[other][0] > layer:
        return [Finding(path, line, "layer",
                        f'{module} (layer {layer}) may not include "{target}" (layer {MODULES[other][0]})')]
    withheld = WITHHELD.get(module)
    if (allowed is not None and other not in allowed) or (withheld and re.match(withheld, target)):
        return [Finding(path, line, "neighbour", f'{module} may not see "{target}"')]
    return []


def check_foreign(path: str, line: int, target: str) -> list[Finding]:
    if module_of(path) in ALGORITHMS and target in ("thread", "mutex", "condition_variable", "future"):
        return [Finding(path, line, "neighbour", f"algorithms have no threads of their own: <{target}>")]
    for pattern, home, name in HOMES:
        if re.match(pattern, target) and not re.match(home, path):
            return [Finding(path, line, "home", f"<{target}>: {name} may not be included here")]
    return []


def check(path: str, text: str) -> list[Finding]:
    if module_of(path) is None:
        return [Finding(path, 1, "unknown", "lies in no module: give its folder a layer in tools/lint/check_layers.py")]
    found = []
    for number, line in enumerate(text.split("\n"), 1):
        m = re.match(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', line)
        if m and m.group(1):
            found += check_own(path, number, m.group(1))
        elif m:
            found += check_foreign(path, number, m.group(2))
    return found


if __name__ == "__main__":
    sys.exit(main(__doc__, "layers", RULES, CPP, check))

#!/usr/bin/env python3
"""usb_speed.py BIN_FOLDER [--runs 5] [--bytes 16777216]: one image by enamel-flash and by dfu-util into the same emulated probe.

Prints JSON: for both the median time and processor time of the transfer (first block to the end of the download, seen from the
device) and the processor time of the whole program, and the ratios enamel-flash / dfu-util. Runs alternate, so that other load on
the machine meets both. enamel-flash's whole program also checks the image, waits for the restart and for the confirmation;
dfu-util's does not. SIMULATION: umockdev stands where the kernel and the cable are.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

WRAPPER = "/usr/bin/umockdev-wrapper"


def once(bench, image, folder, command):
    report = folder / "report.json"
    report.unlink(missing_ok=True)
    ran = subprocess.run([WRAPPER, bench, "--report", report, "--", *command], capture_output=True, text=True, check=False)
    if ran.returncode != 0 or not report.is_file():
        sys.exit(f"{command[0]} failed with {ran.returncode}:\n{ran.stdout}{ran.stderr}")
    told = json.loads(report.read_text(encoding="utf-8"))
    probe = told["probes"][0]
    if probe["major"][1] != 2:
        sys.exit(f"{command[0]} said success, but {image.name} is not on the probe")
    return {"transfer_s": probe["transfer_ms"] / 1e3, "transfer_cpu_s": probe["transfer_cpu_ms"] / 1e3, "cpu_s": told["cpu_ms"] / 1e3}


def medians(runs):
    return {key: round(statistics.median(r[key] for r in runs), 4) for key in runs[0]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--bytes", type=int, default=16 << 20)
    args = parser.parse_args()
    bench, flash = args.bin / "usb_bench", args.bin / "enamel-flash"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        image = folder / "speed.enfw"
        subprocess.run([WRAPPER, bench, "--image", image, "--image-bytes", str(args.bytes), "--", "true"], check=True)
        commands = {"dfu_util": ["dfu-util", "-d", "1209:0001", "-D", image], "enamel_flash": [flash, "flash", image]}
        runs = {who: [] for who in commands}
        for _ in range(args.runs):
            for who, command in commands.items():
                runs[who].append(once(bench, image, folder, command))
    told = {who: medians(r) for who, r in runs.items()}
    ratio = {f"{key}_ratio": round(told["enamel_flash"][key] / told["dfu_util"][key], 3) for key in told["dfu_util"]}
    print(json.dumps({"bytes": args.bytes, "runs": args.runs, **told, **ratio, "each": runs}, indent=1))


if __name__ == "__main__":
    main()

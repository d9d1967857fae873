#!/usr/bin/env python3
"""link_page.py BUILD OUT [--seconds N]: OUT/link.md and link.json, bursts over a cable that loses frames. Needs root and nft."""
import argparse
import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bench_page import Page, machine  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
RATE = 30
# loss in permille: (share that must arrive, %, p99 of the latency, ms)
TARGETS = {0: (100.0, 60.0), 10: (99.5, 60.0), 30: (99.0, 100.0)}


# name: link, bursts, rate, Mbit/s of the cable (0: all it can), pixels, p50 of the latency at most, ms
CLEAN = {"loopback, VGA": ("loopback", 900, 30, 0, (640, 480), 15.0),
         "300 Mbit/s, VGA": ("usb", 600, 20, 300, (640, 480), 45.0),
         "10⁵ short bursts": ("usb", 100000, 1000, 0, (64, 48), None)}


def run(given, link, permille, rate=RATE, seconds=None, mbit=0, pixels=(640, 480)):
    command = [f"{HERE}/../link/lossy_link", f"{given.build}/bin", link, permille, seconds or given.seconds, rate, mbit, *pixels]
    command = [str(part) for part in command]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def cells(facts, offered, target):
    arrived = 100.0 * facts["distinct"] / offered
    share, p99 = target or (None, None)
    latency = facts["latency_ms"]
    return [(f"{arrived:.1f} %", None if share is None else arrived >= share), (str(facts["shed"]), None),
            (str(facts["damaged"]), facts["damaged"] == 0), (f"{latency['p50']:.0f} ms", None),
            (f"{latency['p99']:.0f} ms", None if p99 is None else latency["p99"] <= p99)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", help="folder of bin")
    parser.add_argument("out")
    parser.add_argument("--seconds", type=int, default=60)
    given = parser.parse_args()
    offered = given.seconds * RATE
    page, figures = Page(), {"seconds": given.seconds, "rate": RATE, "runs": []}
    page.text += ["", f"{offered} bursts of 1.23 MB at {RATE} a second between two network name spaces, MTU 1500; the cable loses whole",
                  "frames at random, both ways. Latency: from before the write to the callback. *Shed*: the sender's queue was full.", ""]
    rows, defaults = [], []
    for permille, target in TARGETS.items():
        for link, to in (("usb", rows), ("defaults", defaults)):
            facts = run(given, link, permille)
            figures["runs"].append({"link": link, "loss_permille": permille, **facts})
            print(f"{link}, {permille / 10:g} %: {facts}", file=sys.stderr)
            to.append((f"{permille / 10:g} % lost", cells(facts, offered, target if link == "usb" else None)))
    columns = ["arrived", "shed", "damaged", "p50", "p99"]
    page.table("`--link usb`", columns, ["≥ 99.5, 99.0 %", "", "0", "", "≤ 60, 100 ms"], rows)
    page.table("Cyclone's own settings", columns, [""] * 5, defaults)
    clean = []
    for name, (link, bursts, rate, mbit, pixels, p50) in CLEAN.items():
        facts = run(given, link, 0, rate, bursts / rate, mbit, pixels)
        figures["runs"].append({"link": link, "loss_permille": 0, "rate": rate, "mbit": mbit, **facts})
        print(f"{name}: {facts}", file=sys.stderr)
        found = cells(facts, bursts, (100.0, None))
        found[3] = (found[3][0], None if p50 is None else facts["latency_ms"]["p50"] <= p50)
        clean.append((f"{name}, {rate} a second", found))
    page.table("no frame lost", columns, ["100 %", "", "0", "≤ 15, 45 ms", ""], clean)
    page.write(given.out, "link", "tools/bench-link", machine(), figures)
    print(f"{given.out}/link.md")


if __name__ == "__main__":
    main()

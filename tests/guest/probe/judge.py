#!/usr/bin/env python3
"""judge.py WORK: what the host got of the guest's probe. WORK/sent, got: exchange folders; scan, again: results."""
import hashlib
import json
import os
import sys

WANTED = 40


def bursts(folder):
    """SHA-256 of the four frames of each burst, by number."""
    found = {}
    for name in sorted(os.listdir(f"{folder}/frames")):
        with open(f"{folder}/frames/{name}", "rb") as f:
            found.setdefault(name.rsplit("_", 1)[0], hashlib.sha256()).update(f.read())
    return {k: v.hexdigest() for k, v in found.items()}


def main():
    work = sys.argv[1]
    sent, got = bursts(f"{work}/sent"), bursts(f"{work}/got")
    strangers = [k for k, v in got.items() if v not in set(sent.values())]
    with open(f"{work}/scan/report.json", encoding="utf-8") as f:
        live = json.load(f)
    with open(f"{work}/again/report.json", encoding="utf-8") as f:
        again = json.load(f)
    print(f"captured {live['bursts']}; {len(got)} recorded of {len(sent)} that the sensor saw, {len(strangers)} altered")
    checks = {
        f"at least {WANTED} bursts fused": live["bursts"].get("fused", 0) >= WANTED,
        "no burst altered on its way": not strangers,
        "the replay has the same bits": live["hash"] == again["hash"],
    }
    for what, good in checks.items():
        print(f"{'ok     ' if good else 'FAILED '} {what}")
    sys.exit(0 if all(checks.values()) else 1)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""speed_short.py BUILD HISTORY: the test speed_instructions, some seconds of the small recording beside the history's last row.

Ends with 1 where a stage lost, and where a loss would not be seen; with 77 (skipped) where nothing can be judged."""
import copy
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import speed_history as history  # noqa: E402
import speed_recordings as recordings  # noqa: E402

CAPTURE = "{build}/fixtures/small.mcap"
ARGUMENTS = ["--bursts", "8", "--repeat", "1", "--quick"]
SKIPPED = 77


def loss_is_seen(row):
    """Against a history in which every stage took less by a little more than what counts as a loss, each must be told."""
    before = copy.deepcopy(row)
    for recording in before["recordings"].values():
        recording["instructions"] = {s: count / (1.01 + history.LIMIT) for s, count in recording["instructions"].items()}
    return len(history.compare(row, before)[0]) == history.judged(row, before) > 0


def main():
    build, path = sys.argv[1:3]
    capture = CAPTURE.format(build=build)
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "speed.json")
        subprocess.run([os.path.join(build, "bin/bench_speed"), capture, *ARGUMENTS, "--json", out], check=True)
        with open(out, encoding="utf-8") as f:
            measured = json.load(f)
    row = history.row_of(measured, "this", "", {"small": recordings.fingerprint(capture)})
    rows = history.read(path)
    if not row["recordings"] or not rows:
        print("skipped:", measured["recordings"][0]["counter_problem"] or f"{path} has no row")
        sys.exit(SKIPPED)
    if not loss_is_seen(row):
        sys.exit("a loss would not be seen")
    losses, notes = history.compare(row, rows[-1])
    print("\n".join(notes + losses))
    if losses:
        sys.exit('mend it, or say why it is worth it: tools/bench-speed --accept "REASON"')
    sys.exit(0 if history.judged(row, rows[-1]) else SKIPPED)


if __name__ == "__main__":
    main()

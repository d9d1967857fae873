#!/usr/bin/env python3
"""Makes a target.json of type coded_dots: every 4 x 4 window of dots and rings, in each of its four turns, occurs once.

A seeded greedy search, row by row: a bit that completes a window which is there already, or which looks like its own
turn, is the other one; a row that meets neither is drawn anew. The same arguments give the same file.
"""
import argparse
import json
import random
import sys

WINDOW = 4
TRIES_A_ROW = 2000


def turns(window: list[str]) -> list[str]:
    """The window's bits, row by row, in its four quarter turns."""
    out = []
    for _ in range(4):
        out.append("".join(window))
        window = ["".join(column) for column in zip(*window[::-1])]
    return out


def windows(rows: list[str]):
    for r in range(len(rows) - WINDOW + 1):
        for c in range(len(rows[0]) - WINDOW + 1):
            yield r, c, [row[c:c + WINDOW] for row in rows[r:r + WINDOW]]


def new_row(rows: list[str], cols: int, seen: set[str], draw: random.Random) -> tuple[str, set[str]] | None:
    row, fresh = "", set()
    above = rows[-(WINDOW - 1):]
    for c in range(cols):
        for bit in draw.sample("01", 2):
            if len(above) < WINDOW - 1 or c < WINDOW - 1:
                break
            first = c - WINDOW + 1
            four = turns([r[first:c + 1] for r in above] + [row[first:] + bit])
            if len(set(four)) == 4 and not any(f in seen or f in fresh for f in four):
                fresh.update(four)
                break
        else:
            return None
        row += bit
    return row, fresh


def search(cols: int, rows: int, seed: int) -> list[str] | None:
    draw = random.Random(seed)
    out, seen = [], set()
    while len(out) < rows:
        for _ in range(TRIES_A_ROW):
            if found := new_row(out, cols, seen, draw):
                break
        else:
            return None
        out.append(found[0])
        seen |= found[1]
    return out


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", help="file to write")
    parser.add_argument("--cols", type=int, default=40)
    parser.add_argument("--rows", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pitch-mm", type=float, default=1.6)
    parser.add_argument("--radius-mm", type=float, default=0.4)
    parser.add_argument("--ring-inner-mm", type=float, default=0.2)
    args = parser.parse_args()
    if min(args.cols, args.rows) < WINDOW:
        parser.error(f"--cols and --rows are at least {WINDOW}: a window must fit")
    rings = search(args.cols, args.rows, args.seed)
    if rings is None:
        print(f"no map of {args.cols} x {args.rows} with seed {args.seed}: try another seed or fewer dots",
              file=sys.stderr)
        return 1
    target = {"type": "coded_dots", "cols": args.cols, "rows": args.rows, "pitch_mm": args.pitch_mm,
              "radius_mm": args.radius_mm, "ring_inner_mm": args.ring_inner_mm, "circles": "white on dark",
              "rings": rings}
    with open(args.out, "w", encoding="utf-8") as file:
        file.write(json.dumps(target, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

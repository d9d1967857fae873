#!/usr/bin/env python3
"""graph_cores.py SPEED_JSON: bursts a second of the scan's graph on 1 to 16 workers, and what ends the growth.

Simulates the stages' order, rings and delay edges (host/session/scan_pipeline.cpp) by the times that bench_speed measured of each
stage on one thread. Workers are taken to share nothing: no memory bandwidth, no cache, no clock that falls under load."""
import heapq
import json
import math
import random
import statistics
import sys

DECODERS, MOST_DECODERS = 2, 4  # layout: as kDecoders, kMostDecoders
VIEW_DELAY = 2  # layout: as graph.feedback_delay
WAVE_DELAY = 4  # layout: as kWaveDelay
WORKERS = (1, 2, 4, 8, 16)
STAGES = ("decode", "track", "fuse")


def decoders_for(workers):
    return DECODERS if workers < MOST_DECODERS else MOST_DECODERS


def drawn(stage, bursts, rng):
    """Times whose mean and p99 beside p50 are the stage's: log-normal, as stages' times are."""
    sigma = math.log(max(stage["p99"] / stage["p50"], 1)) / 2.326 if stage["p50"] > 0 else 0
    times = [math.exp(rng.gauss(0, sigma)) for _ in range(bursts)]
    scale = stage["mean"] / statistics.fmean(times)
    return [t * scale for t in times]


def needs(stage, n, decoders, view_delay):
    """Steps that must have ended, and steps that must have begun (they empty the ring of one item), before this one begins."""
    if stage == "decode":
        return [("decode", n - decoders), ("decode", n - WAVE_DELAY)], [("track", n - decoders)]
    if stage == "track":
        return [("decode", n), ("track", n - 1), ("fuse", n - view_delay)], [("fuse", n - 1)]
    return [("track", n), ("fuse", n - 1)], []


def simulate(times, workers, decoders=None, view_delay=VIEW_DELAY):
    """Bursts a second. times: of each stage, ms of each burst. A free worker takes the oldest burst's ready step."""
    decoders = decoders or decoders_for(workers)
    bursts = len(times["decode"])
    began, ended, running, now = set(), set(), [], 0.0

    def ready(step):
        if step in began or step[1] >= bursts:
            return False
        done, taken = needs(*step, decoders, view_delay)
        return all(s in ended or s[1] < 0 for s in done) and all(s in began or s[1] < 0 for s in taken)

    first = {stage: 0 for stage in STAGES}  # the oldest burst that the stage has not begun
    while len(ended) < 3 * bursts:
        while len(running) < workers:
            open_steps = [(n, stage) for stage in STAGES for n in range(first[stage], first[stage] + (decoders if stage == "decode" else 1))
                          if ready((stage, n))]
            if not open_steps:
                break
            n, stage = min(open_steps)
            began.add((stage, n))
            while (stage, first[stage]) in began:
                first[stage] += 1
            heapq.heappush(running, (now + times[stage][n], stage, n))
        now, stage, n = heapq.heappop(running)
        ended.add((stage, n))
    return 1000 * bursts / now


def limits(mean, decoders=MOST_DECODERS, view_delay=VIEW_DELAY):
    """Bursts a second that each serial part allows however many workers there are."""
    return {f"decode on {decoders}": 1000 * decoders / mean["decode"], "track": 1000 / mean["track"], "fuse": 1000 / mean["fuse"],
            f"track and fuse every {view_delay}": 1000 * view_delay / (mean["track"] + mean["fuse"])}


def scaling(stages, bursts=400, seed=1):
    """Rate by workers, then the name and the rate of the part that ends the growth."""
    rng = random.Random(seed)
    times = {s: drawn(stages[s]["ms"], bursts, rng) for s in STAGES}
    bound = limits({s: stages[s]["ms"]["mean"] for s in STAGES})
    name = min(bound, key=bound.get)
    return {w: simulate(times, w) for w in WORKERS}, name, bound[name]


def rows_of(recordings):
    """For Page.table: a recording a row."""
    rows = []
    for r in recordings:
        rates, name, bound = scaling(r["stages"])
        rows.append((r["name"], [(f"{rates[w]:.1f}", None) for w in WORKERS] + [(f"{name}: {bound:.1f}", None)]))
    return rows


def main():
    with open(sys.argv[1], encoding="utf-8") as f:
        recordings = json.load(f)["recordings"]
    for name, cells in rows_of(recordings):
        print(name, *(text for text, _ in cells), sep="\t")


if __name__ == "__main__":
    main()

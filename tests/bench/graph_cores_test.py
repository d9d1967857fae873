#!/usr/bin/env python3
"""The simulated graph against what arithmetic says of it."""
import os
import random
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import graph_cores as cores  # noqa: E402


def even(decode, track, fuse, bursts=400):
    return {"decode": [decode] * bursts, "track": [track] * bursts, "fuse": [fuse] * bursts}


class Simulation(unittest.TestCase):
    def test_one_worker_does_the_sum(self):
        rng = random.Random(3)
        for _ in range(5):
            d, t, f = (rng.uniform(2, 60) for _ in range(3))
            self.assertAlmostEqual(cores.simulate(even(d, t, f), 1), 1000 / (d + t + f), places=6)

    def test_two_workers_at_most_double(self):
        self.assertLessEqual(cores.simulate(even(60, 25, 23), 2), 2000 / 108 + 1e-6)
        self.assertGreater(cores.simulate(even(60, 25, 23), 2), 1.8 * 1000 / 108)

    def test_many_workers_reach_the_serial_part_and_no_more(self):
        for times in ((60, 10, 10), (10, 40, 10), (10, 10, 40), (5, 20, 20)):
            bound = min(cores.limits(dict(zip(cores.STAGES, times))).values())
            rate = cores.simulate(even(*times), 16)
            self.assertLessEqual(rate, 1.01 * bound)
            self.assertGreater(rate, 0.9 * bound)

    def test_what_binds_is_what_helps(self):
        decode_binds, track_binds = even(60, 10, 10), even(5, 40, 10)
        self.assertGreater(cores.simulate(decode_binds, 16), 1.5 * cores.simulate(decode_binds, 16, decoders=2))
        self.assertLess(cores.simulate(track_binds, 16), 1.02 * cores.simulate(track_binds, 16, decoders=2))  # control
        self.assertLess(cores.simulate(even(5, 20, 20), 16, view_delay=1), 0.6 * cores.simulate(even(5, 20, 20), 16))

    def test_more_workers_are_never_slower(self):
        rng = random.Random(7)
        ms = {s: {"mean": rng.uniform(10, 60), "p50": 20, "p99": 45} for s in cores.STAGES}
        rates, name, bound = cores.scaling({s: {"ms": ms[s]} for s in cores.STAGES})
        ordered = [rates[w] for w in cores.WORKERS]
        for before, after in zip(ordered, ordered[1:]):
            self.assertGreaterEqual(after, 0.99 * before)
        self.assertLessEqual(ordered[-1], 1.02 * bound)
        self.assertIn(name, cores.limits({s: ms[s]["mean"] for s in cores.STAGES}))


if __name__ == "__main__":
    unittest.main()

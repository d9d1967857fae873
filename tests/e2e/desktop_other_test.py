#!/usr/bin/env python3
"""Stops of the desktop scanner rendered by a program that shares no code with the twin: a row of bumps on a ridge, drawn."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

BENCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../bench")
sys.path.insert(0, BENCH)
import desktop_other as other  # noqa: E402

PROGRAMS = sys.argv.pop(1)
SEED = int(os.environ.get("ENAMEL_SEED", "5"))
# Twice the worst of twelve drawn sets; no unit, mode or response may cost more.
MEAN_UM = 3.0


def faces_of(rows, columns):
    """Triangles of a grid of vertices."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    quads = np.stack([a, a + 1, a + columns + 1, a + columns], 1)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def bumps(rng):
    """A ring of bumps on a sloping ring, as teeth on their gum: radius 20 to 34 mm, heights to 4 mm; two surfaces, y up."""
    angle, radius = np.meshgrid(np.linspace(-np.pi, np.pi, 640), np.linspace(19, 34, 64), indexing="ij")
    x, z = radius * np.cos(angle), radius * np.sin(angle)
    y = np.zeros_like(x)
    for at in np.arange(-np.pi + 0.13, np.pi, 0.26):
        centre = at + rng.uniform(-0.03, 0.03)
        r, across = rng.uniform(26, 28), rng.uniform(2.6, 3.4)
        y += rng.uniform(2.5, 4) * np.exp(-(((angle - centre) * 27 / 2.4) ** 2) - ((radius - r) / across) ** 2)
    rough = rng.normal(size=(14, 8))
    y += 0.2 * sum(rough[i, j] * np.cos(2 * i * angle + i) * np.cos(0.35 * j * radius + j) / (1 + i + j) for i in range(14) for j in range(8))
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], 1)
    faces = faces_of(*x.shape)
    a, b, c = (points[faces[:, k]] for k in range(3))
    if np.cross(b - a, c - a)[:, 1].mean() < 0:
        faces = faces[:, ::-1]
    return points, faces


class AnotherRenderer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        rng = np.random.default_rng(SEED)
        teeth = os.path.join(cls.place.name, "teeth.ply")
        base = os.path.join(cls.place.name, "base.ply")
        points, faces = bumps(rng)
        other.write_ply(teeth, points, faces)
        other.write_ply(base, *floor(points))
        cls.folder = os.path.join(cls.place.name, "set")
        ran = subprocess.run([sys.executable, os.path.join(BENCH, "desktop_other.py"), PROGRAMS, cls.folder, str(SEED), teeth, base,
                              "--turns", "0,15"], capture_output=True, text=True, check=False)
        cls.said = f"seed {SEED}\n{ran.stdout}{ran.stderr[-2000:]}"
        cls.told = json.loads(ran.stdout) if ran.returncode == 0 else None

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def test_every_stop_is_laid_and_the_surface_is_true(self):
        self.assertIsNotNone(self.told, self.said)
        self.assertEqual(self.told["stops"], 6, self.said)
        self.assertFalse(self.told["slipped"], self.said)
        self.assertLess(self.told["mean_abs_um"], MEAN_UM, self.said)

    def test_control_a_surface_four_permille_larger_is_not_it(self):
        self.assertIsNotNone(self.told, self.said)
        points, faces = other.read_ply(os.path.join(self.folder, "surface.ply"))
        larger = os.path.join(self.place.name, "larger.ply")
        middle = points.mean(0)
        other.write_ply(larger, (points - middle) * 1.004 + middle, faces)
        compared = subprocess.run([os.path.join(PROGRAMS, "enamel"), "desktop", "accuracy", os.path.join(self.folder, "out"), "--reference", larger,
                                   "--json"], capture_output=True, text=True, check=True)
        self.assertGreater(json.loads(compared.stdout)["trueness"]["runs"][0]["mean_abs_um"], MEAN_UM, self.said)


def floor(points):
    """A plate below: what the bumps stand in."""
    low, high = points.min(0) - 0.5, points.max(0) + 0.5
    y = low[1] - 1
    corners = np.array([[low[0], y, low[2]], [high[0], y, low[2]], [high[0], y, high[2]], [low[0], y, high[2]]])
    return corners, np.array([[0, 2, 1], [0, 3, 2]])


if __name__ == "__main__":
    unittest.main()

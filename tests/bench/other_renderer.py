"""Renders bursts of meshes by numpy alone. It shares no code with the twin: what both get wrong alike is physics, not a program.

Pixel centres lie at whole coordinates, lenses and files as docs/recording-format.md has them. Light: Lambert, cos^4 of both
lenses, 1/r^2 from the projector, hard shadows from a depth map, 1 % of ambient. A pixel is the mean of 3 x 3 samples."""
import numpy as np

SAMPLES = 3  # a side of a pixel
SHADOW_SAMPLES = 2  # a side of a projector pixel
SHADOW_BIAS_MM = 0.06
CHUNK = 1 << 20  # pairs of triangle and sample that are worked on at once
BLUR_STEP_PX = 0.05  # spacing of the blurs that the pattern is kept for
PATTERN_FINE = 8  # places a projector pixel at which the blurred pattern is kept
AMBIENT = 0.01
BLACK_EMISSION = 0.002


def distorted(lens, x, y):
    k1, k2, p1, p2, k3 = lens["dist"]
    r2 = x * x + y * y
    g = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (lens["fx"] * (x * g + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + lens["cx"],
            lens["fy"] * (y * g + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + lens["cy"])


def undistorted(lens, u, v):
    """Rays (x, y, 1) of pixels, by fixed-point iteration."""
    x0, y0 = (u - lens["cx"]) / lens["fx"], (v - lens["cy"]) / lens["fy"]
    x, y = x0.copy(), y0.copy()
    for _ in range(20):
        du, dv = distorted(lens, x, y)
        x, y = x - (du - u) / lens["fx"], y - (dv - v) / lens["fy"]
    return x, y


class Raster:
    """Rays of a lens at `samples` x `samples` places of each pixel, and which triangle each meets first."""

    def __init__(self, lens, samples):
        self.lens, self.samples = lens, samples
        self.width, self.height = lens["width"] * samples, lens["height"] * samples
        u = (np.arange(self.width) + 0.5) / samples - 0.5
        v = (np.arange(self.height) + 0.5) / samples - 0.5
        uu, vv = np.meshgrid(u, v)
        self.x, self.y = (a.ravel() for a in undistorted(lens, uu, vv))

    def seen(self, points, faces):
        """Depth along z and face of each sample (inf and -1: none). points: in the lens' frame."""
        depth, face = np.full(self.x.size, np.inf), np.full(self.x.size, -1, np.int64)
        u, v = distorted(self.lens, points[:, 0] / points[:, 2], points[:, 1] / points[:, 2])
        column, row = (u + 0.5) * self.samples - 0.5, (v + 0.5) * self.samples - 0.5
        # A straight edge bends between its ends by less than this, a triangle being small.
        left = np.clip(np.floor(column[faces].min(1) - 0.1), 0, self.width).astype(np.int64)
        right = np.clip(np.ceil(column[faces].max(1) + 0.1), -1, self.width - 1).astype(np.int64)
        top = np.clip(np.floor(row[faces].min(1) - 0.1), 0, self.height).astype(np.int64)
        bottom = np.clip(np.ceil(row[faces].max(1) + 0.1), -1, self.height - 1).astype(np.int64)
        a = points[faces[:, 0]]
        normal = np.cross(points[faces[:, 1]] - a, points[faces[:, 2]] - a)
        wide, high = right - left + 1, bottom - top + 1
        use = np.flatnonzero((wide > 0) & (high > 0) & (np.einsum("ij,ij->i", normal, a) < 0))
        ends = np.cumsum(wide[use] * high[use])
        start = 0
        while start < use.size:
            before = ends[start - 1] if start else 0
            stop = max(start + 1, int(np.searchsorted(ends, before + CHUNK)))
            self._hit(points, faces, use[start:stop], (left, top, wide, high), normal, depth, face)
            start = stop
        return depth, face

    def _hit(self, points, faces, some, box, normal, depth, face):
        left, top, wide, high = (b[some] for b in box)
        count = wide * high
        which = np.repeat(np.arange(some.size), count)
        place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        sample = (top[which] + place // wide[which]) * self.width + left[which] + place % wide[which]
        ray = np.stack([self.x[sample], self.y[sample], np.ones(sample.size)], 1)
        inside = np.ones(sample.size, bool)
        corners = [points[faces[some, k]] for k in range(3)]
        for k in range(3):  # the ray passes the same side of all three edges
            side = np.cross(corners[k], corners[(k + 1) % 3])
            inside &= np.einsum("ij,ij->i", side[which], ray) <= 0
        n = normal[some]
        z = np.einsum("ij,ij->i", n, corners[0])[which] / np.einsum("ij,ij->i", n[which], ray)
        keep = np.flatnonzero(inside & (z > 0))
        keep = keep[np.argsort(-z[keep], kind="stable")]  # the nearest is written last
        sample, z, which = sample[keep], z[keep], which[keep]
        nearest = np.full(depth.size, -1, np.int64)
        nearest[sample] = np.arange(sample.size)
        at = np.flatnonzero(nearest >= 0)
        won = z[nearest[at]] < depth[at]
        at, by = at[won], nearest[at][won]
        depth[at], face[at] = z[by], some[which[by]]


def emission(levels, gamma):
    return BLACK_EMISSION + (1 - BLACK_EMISSION) * (levels / 255.0) ** gamma


class Pattern:
    """Emission of one frame along u, blurred by Gaussians of many widths."""

    def __init__(self, levels, gamma, widest_px):
        self.count = levels.size
        fine = np.repeat(emission(np.round(levels), gamma), PATTERN_FINE)
        frequency = np.fft.rfftfreq(fine.size, 1 / PATTERN_FINE)
        spectrum = np.fft.rfft(fine)
        blurs = np.arange(0, widest_px + 2 * BLUR_STEP_PX, BLUR_STEP_PX)
        self.table = np.stack([np.fft.irfft(spectrum * np.exp(-2 * (np.pi * frequency * s) ** 2), fine.size) for s in blurs])

    def at(self, u, blur_px):
        b = blur_px / BLUR_STEP_PX
        x = np.clip((u + 0.5) * PATTERN_FINE - 0.5, 0, self.table.shape[1] - 1.001)
        i, j = b.astype(int), x.astype(int)
        fb, fx = b - i, x - j
        t = self.table
        return (1 - fb) * ((1 - fx) * t[i, j] + fx * t[i, j + 1]) + fb * ((1 - fx) * t[i + 1, j] + fx * t[i + 1, j + 1])


class Head:
    """Camera and projector of rig.json, the patterns' emission, and the sensor."""

    def __init__(self, rig, levels, gamma):
        self.rig = rig
        self.camera = Raster(rig["camera"], SAMPLES)
        self.shadow = Raster(rig["projector"], SHADOW_SAMPLES)
        self.T_proj_cam = np.array(rig["T_proj_cam"])
        self.patterns = [Pattern(row, gamma, 3.0) for row in levels]

    def light(self, points, faces, albedo):
        """Mean light of each pixel and frame. points: camera frame, mm."""
        z, face = self.camera.seen(points, faces)
        in_projector = points @ self.T_proj_cam[:3, :3].T + self.T_proj_cam[:3, 3]
        near, _ = self.shadow.seen(in_projector, faces)
        hit = np.flatnonzero(face >= 0)
        p = np.stack([self.camera.x[hit], self.camera.y[hit], np.ones(hit.size)], 1) * z[hit, None]
        q = p @ self.T_proj_cam[:3, :3].T + self.T_proj_cam[:3, 3]
        edges = points[faces]
        normal = np.cross(edges[:, 1] - edges[:, 0], edges[:, 2] - edges[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        to_projector = -self.T_proj_cam[:3, :3].T @ self.T_proj_cam[:3, 3] - p
        r = np.linalg.norm(to_projector, axis=1)
        cosine = np.maximum(np.einsum("ij,ij->i", normal[face[hit]], to_projector) / r, 0)
        lens = self.rig["projector"]
        u, v = distorted(lens, q[:, 0] / q[:, 2], q[:, 1] / q[:, 2])
        column = np.round((u + 0.5) * SHADOW_SAMPLES - 0.5).astype(int)
        row = np.round((v + 0.5) * SHADOW_SAMPLES - 0.5).astype(int)
        inside = (column >= 0) & (column < self.shadow.width) & (row >= 0) & (row < self.shadow.height)
        lit = np.zeros(hit.size, bool)
        lit[inside] = q[inside, 2] < near[row[inside] * self.shadow.width + column[inside]] + SHADOW_BIAS_MM
        fall = (q[:, 2] / np.linalg.norm(q, axis=1)) ** 4 * (p[:, 2] / np.linalg.norm(p, axis=1)) ** 4 / r**2
        beam = np.where(lit, albedo * cosine * fall, 0)
        blur = np.sqrt(0.7**2 + (0.25 * np.clip(q[:, 2] - 49, -9, 9)) ** 2)
        frames = []
        for pattern in self.patterns:
            light = np.full(z.size, 0.0)
            light[hit] = beam * pattern.at(u, np.minimum(blur, 3.0)) + AMBIENT * albedo / 44**2
            frames.append(self._pixels(light))
        return frames

    def _pixels(self, light):
        c = self.rig["camera"]
        return light.reshape(c["height"], SAMPLES, c["width"], SAMPLES).mean((1, 3))

    def expose(self, light, rng):
        """8-bit pixels: level 255 on albedo 0.8, facing at 44 mm, is 80 % of full well."""
        noise = self.rig["noise"]
        well = noise["full_well_e"]
        mean = light / (0.8 / 44**2) * 0.8 * well
        kernel = np.exp(-0.5 * (np.arange(-2, 3) / 0.6) ** 2)
        kernel /= kernel.sum()
        for axis in (0, 1):
            padded = np.pad(mean, [(2, 2) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
            mean = sum(w * np.take(padded, np.arange(k, k + mean.shape[axis]), axis) for k, w in enumerate(kernel))
        electrons = np.minimum(rng.poisson(mean), well) + rng.normal(0, noise["read_noise_e"], mean.shape)
        return np.clip(np.round(noise["black_dn"] + electrons / noise["gain_e_per_dn"]), 0, 255).astype(np.uint8)

"""S22: a bumped plane that runs to the horizon under a distant lamp, with 256 highlights a pixel.

It is the reference for highlights by roughness.

A sample's highlight is Trowbridge and Reitz's about the bumped normal of level 0:

    (1 + |t|^2 / s^2)^-2,   t = (h.e_1, h.e_2) / h.n - f

Source: Schilling 1997, section 9 and appendix A; pass sequences A-S22 and A-S29 of the catalogue.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.samples import rays, sample_places
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (Variant(("S22", "S29"), "by 256 highlights a pixel, over a plane"),)

# Samples along a pixel's edge.
SIDE = 16


@dataclass(frozen=True, eq=False)
class Ground:
    """The plane y = 0 in front of an eye above the origin: e_1 to the right, e_2 = -z, away from it.

    eye     how high the eye is
    far     where the plane ends, world units from the eye's foot
    period  of the bump map, world units
    light   the direction to the lamp: float64 [3]
    lobe    s: the deviation of slopes that level 0 has without bumps
    """

    eye: float
    far: float
    period: float
    light: np.ndarray
    lobe: float

    def half_slopes(self, points):
        """(h.e_1, h.e_2) / h.n at points [..., 3]: float64 [..., 2]."""
        half = self.light + normalize(np.array([0.0, self.eye, 0.0]) - points)
        return np.stack([half[..., 0], -half[..., 2]], axis=-1) / half[..., 1:2]

    def surface(self, columns, rows, near, half_width):
        """The plane as a Surface, cells longer the farther they are: from ``near`` to ``far``, as wide as
        the distance times ``half_width`` to either side.
        """
        surface = plane(columns, rows)
        s, t = surface.texture_coordinates.T
        # A distance whose inverse goes straight is one whose place in the picture does.
        away = 1.0 / ((1.0 - t) / near + t / self.far)
        positions = np.stack([(2.0 * s - 1.0) * half_width * away, 0.0 * s, -away], axis=-1)
        frames = [np.tile(row, (len(s), 1)) for row in ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0))]
        coordinates = np.stack([positions[:, 0], away], axis=-1) / self.period
        return type(surface)(positions, *frames, coordinates, surface.triangles)


def lamp(elevation):
    """The direction to a lamp ahead, ``elevation`` degrees high: float64 [3]."""
    radians = np.radians(elevation)
    return np.array([0.0, float(sine(radians)), -float(cosine(radians))])


def ripples(edge, cells, across, along):
    """Offsets of a rippled ground that repeats, their deviations along e_1 and e_2: float64 [edge, edge,
    2].
    """
    s, t = height_fields.texel_centers(edge, edge)
    heights = height_fields.gradient_noise(s, t, cells, 3)
    slopes = np.stack(height_fields.slopes(heights), axis=-1)
    deviation = np.sqrt((slopes * slopes).mean(axis=(0, 1)))
    return -slopes / deviation * np.array([across, along])


@kernel("void(f8[:,::1],f8[::1],f8[::1],f8[::1],f8[:,:,::1],f8[:,:,::1],i8,i8,i8,f8[:,:,::1])")
def _sampled(ray, eye, light, numbers, offsets, jitter, side, first, last, out):
    """Rows ``first`` to ``last``: sums of highlights and of samples that meet the plane. ``numbers``: far,
    period, 1 / s^2.
    """
    rows, columns = offsets.shape[0], offsets.shape[1]
    mask = jitter.shape[0] - 1
    for y in range(first, last):
        for x in range(out.shape[1]):
            total, met = 0.0, 0
            for number in range(side * side):
                px, py = x * side + number % side, y * side + number // side
                wx = x + (number % side + jitter[py & mask, px & mask, 0]) / side
                wy = y + (number // side + jitter[py & mask, px & mask, 1]) / side
                dx = ray[0, 0] + wx * ray[1, 0] + wy * ray[2, 0]
                dy = ray[0, 1] + wx * ray[1, 1] + wy * ray[2, 1]
                dz = ray[0, 2] + wx * ray[1, 2] + wy * ray[2, 2]
                if dy >= 0.0:
                    continue
                along = -eye[1] / dy
                away, aside = -(eye[2] + along * dz), eye[0] + along * dx
                if away > numbers[0]:
                    continue
                met += 1
                length = np.sqrt((dx * dx + dy * dy) + dz * dz)
                hy = light[1] - dy / length
                s1, s2 = (light[0] - dx / length) / hy, -(light[2] - dz / length) / hy
                s, t = aside / numbers[1], away / numbers[1]
                at_s, at_t = (s - np.floor(s)) * columns - 0.5, (t - np.floor(t)) * rows - 0.5
                low_s, low_t = np.floor(at_s), np.floor(at_t)
                a, b = at_s - low_s, at_t - low_t
                i0, j0 = int(low_s) % columns, int(low_t) % rows
                i1, j1 = (i0 + 1) % columns, (j0 + 1) % rows
                for c in range(2):
                    lower = offsets[j0, i0, c] + a * (offsets[j0, i1, c] - offsets[j0, i0, c])
                    upper = offsets[j1, i0, c] + a * (offsets[j1, i1, c] - offsets[j1, i0, c])
                    f = lower + b * (upper - lower)
                    if c == 0:
                        s1 -= f
                    else:
                        s2 -= f
                q = 1.0 / (1.0 + (s1 * s1 + s2 * s2) * numbers[2])
                total += q * q
            out[y, x, 0], out[y, x, 1] = total / (side * side), met / (side * side)


@computed_once
def supersampled(view, ground, offsets, side=SIDE, threads=None):
    """The reference by ``side`` squared samples a pixel: float64 [height, width, 2], bottom row first: the
    highlight's mean over the pixel, and the plane's share of it.

    Raises ValueError for a bump map of another shape or numbers that are not finite.
    """
    offsets = np.ascontiguousarray(offsets, np.float64)
    if offsets.ndim != 3 or offsets.shape[2] != 2 or not offsets.size or not np.isfinite(offsets).all():
        raise ValueError(f"The bump map has shape {offsets.shape}; give finite offsets [rows, columns, 2].")
    height, width, threads = view.panel.height, view.panel.width, threads or default_threads()
    out, places, eye = np.empty((height, width, 2)), sample_places(side), np.array([0.0, ground.eye, 0.0])
    numbers = np.array([ground.far, ground.period, 1.0 / (ground.lobe * ground.lobe)])
    ray, light = rays(view), np.ascontiguousarray(ground.light, np.float64)

    def share(number):
        first, last = (height * k // threads for k in (number, number + 1))
        _sampled(ray, eye, light, numbers, offsets, places, side, first, last, out)
        return 0

    Threads(threads).run(share)
    return out


def pyramid(offsets, ground):
    """Both pyramids of the ground's bumps: a tuple of roughness_pyramids.Level; beneath level 0 is its
    lobe.
    """
    square = ground.lobe * ground.lobe
    return rough.pyramid(offsets, (square, 0.0, square))

"""An engine block as a density volume of the project's own: H39 renders it in place of a scanned one.

The paper's figure 7 shows a scanned engine block, but its data are not available. This one consists of
solids: a block with four bored cylinders and pistons at different heights, a deck with bolt holes and coolant
passages, ports with flanged pipes that meet in a manifold, an oil filter, bosses and ribs, a timing cover
with crankshaft and bolt holes, a bell housing, and an oil pan on a bolted flange. No such engine exists.

Solids are signed distances d, or bounds of them. The minimum joins them, for cast ones with a fillet (a
polynomial minimum). The maximum with a negative distance drills them. Density is 1/2 at the surface and falls
from one to zero within ``RAMP`` voxels on either side, 1/2 - d / (2 RAMP). So each voxel there has one of
several grey levels, and central differences of the bytes give smooth gradients. Densities are bytes, as in
scanners' data.

The module uses elementwise float64 sums, products, quotients, roots, minima and maxima, and rounded cosines
of angles. So its bits are the same everywhere.

Source: Heidrich 2001, figure 7, for the subject.
"""

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np

from fixedpipe.effects.geometry.vectors import cosine, sine

# The volume's half extents: x along the crankshaft, y up, z towards the side with the manifold.
HALF_EXTENTS = (1.0, 0.5, 0.5)
# Voxels from the surface to where the density is zero, and to where it is one.  Assumed: two, the fewest for
# which a central difference beside the surface sees nothing but the ramp.
RAMP = 2.0
CYLINDERS = (-0.60, -0.22, 0.16, 0.54)
_PISTONS = (0.29, 0.12, 0.03, 0.24)  # the pistons' crowns
_BORE, _DECK, _CRANK = 0.148, 0.345, -0.17
_FRONT, _REAR, _SIDE = 0.76, -0.82, 0.25


class _Field:
    """Distances on a grid of voxels, changed where a solid may reach alone."""

    def __init__(self, rows):
        self.rows = rows
        self.reach = 2.0 * RAMP / rows
        # Voxel centres, n + 1/2 steps from the lower corner.
        self.axes = tuple(
            (2.0 * np.arange(count) + 1.0) / count * half - half
            for count, half in zip((2 * rows, rows, rows), HALF_EXTENTS, strict=True)
        )
        self.distances = np.full((rows, rows, 2 * rows), 1.0)

    def _part(self, low, high, margin):
        """Coordinates x, y, z, ready to be broadcast, of the voxels within a margin of a box; their place."""
        places = []
        for axis, least, most in zip(self.axes, low, high, strict=True):
            inside = np.nonzero((axis >= least - margin) & (axis <= most + margin))[0]
            places.append(slice(inside[0], inside[-1] + 1) if len(inside) else slice(0, 0))
        x, y, z = (axis[place] for axis, place in zip(self.axes, places, strict=True))
        return (x[None, None, :], y[None, :, None], z[:, None, None]), tuple(reversed(places))

    def add(self, solid, fillet=0.0):
        """Join a solid, (function of x, y, z, low corner, high corner); ``fillet``: its radius."""
        distance, low, high = solid
        at, place = self._part(low, high, self.reach + fillet)
        there, new = self.distances[place], distance(*at)
        if fillet:
            h = np.maximum(fillet - np.abs(there - new), 0.0) / fillet
            self.distances[place] = np.minimum(there, new) - h * h * (0.25 * fillet)
        else:
            self.distances[place] = np.minimum(there, new)

    def cut(self, *solids):
        """Drill solids out of what is there."""
        for distance, low, high in solids:
            at, place = self._part(low, high, self.reach)
            self.distances[place] = np.maximum(self.distances[place], -distance(*at))


def _box(center, half, radius=0.0):
    """A box with edges rounded by ``radius``."""

    def distance(x, y, z):
        across, up, along = (
            np.abs(v - c) - (h - radius) for v, c, h in zip((x, y, z), center, half, strict=True)
        )
        outside = np.sqrt(
            (np.maximum(across, 0.0) ** 2 + np.maximum(up, 0.0) ** 2) + np.maximum(along, 0.0) ** 2
        )
        return (outside + np.minimum(np.maximum(np.maximum(across, up), along), 0.0)) - radius

    corners = (tuple(c + s * h for c, h in zip(center, half, strict=True)) for s in (-1.0, 1.0))
    return distance, *corners


def _cylinder(axis, center, radius, half, rounded=0.0):
    """A cylinder along an axis, 0 to 2; ``half``: of its length."""
    i, j = (k for k in range(3) if k != axis)

    def distance(*at):
        a, b = at[i] - center[i], at[j] - center[j]
        side = np.sqrt(a * a + b * b) - (radius - rounded)
        end = np.abs(at[axis] - center[axis]) - (half - rounded)
        outside = np.sqrt(np.maximum(side, 0.0) ** 2 + np.maximum(end, 0.0) ** 2)
        return (outside + np.minimum(np.maximum(side, end), 0.0)) - rounded

    reach = [half if k == axis else radius for k in range(3)]
    corners = (tuple(c + s * h for c, h in zip(center, reach, strict=True)) for s in (-1.0, 1.0))
    return distance, *corners


def _elbow(center, ring, radius):
    """The lower front quarter of a ring about the x axis through ``center``: a pipe from +z to -y."""

    def distance(x, y, z):
        up, along = y - center[1], z - center[2]
        round_it = np.sqrt(up * up + along * along) - ring
        across = x - center[0]
        tube = np.sqrt(round_it * round_it + across * across) - radius
        return np.maximum(tube, np.maximum(-up, -along))

    reach = ring + radius
    low = (center[0] - radius, center[1], center[2])
    return distance, low, (center[0] + radius, center[1] + reach, center[2] + reach)


def _on_circle(count, radius, first=0.0):
    """Points (cosine, sine) on a circle."""
    for k in range(count):
        angle = 2.0 * math.pi * (k + first) / count
        yield radius * float(cosine(angle)), radius * float(sine(angle))


def _casting(f):
    """The block, its deck, skirt, ribs, ends and bosses."""
    f.add(_box((-0.02, 0.06, 0.0), (0.76, 0.27, 0.22), 0.03))
    f.add(_box((-0.02, -0.15, 0.0), (0.76, 0.14, _SIDE), 0.03), 0.06)
    # Each cylinder's barrel swells out of the wall.
    for x in CYLINDERS:
        f.add(_cylinder(1, (x, 0.06, 0.0), 0.238, 0.24, 0.02), 0.05)
    f.add(_box((-0.03, 0.31, 0.0), (0.80, 0.035, 0.285), 0.012), 0.02)
    # Ribs on the skirt, the pan's flange, the housing at the rear, the cover in front.
    for x in (-0.70, -0.41, -0.03, 0.35):
        f.add(_box((x, -0.10, 0.235), (0.018, 0.17, 0.045), 0.012), 0.04)
    f.add(_box((-0.02, -0.295, 0.0), (0.79, 0.022, 0.315), 0.01), 0.02)
    f.add(_cylinder(0, (_REAR, -0.02, 0.0), 0.40, 0.035, 0.012), 0.02)
    f.add(_box((_REAR, -0.20, 0.0), (0.035, 0.20, 0.37), 0.012), 0.02)
    f.add(_box((_FRONT, 0.03, 0.0), (0.025, 0.29, 0.20), 0.012), 0.02)
    f.add(_cylinder(0, (_FRONT + 0.02, _CRANK, 0.0), 0.235, 0.045, 0.02), 0.03)
    f.add(_cylinder(0, (_FRONT + 0.02, 0.17, -0.03), 0.12, 0.055, 0.02), 0.03)
    # The oil filter on its boss, and the mounting bracket.
    f.add(_cylinder(2, (0.56, -0.145, 0.27), 0.10, 0.05, 0.01), 0.04)
    f.add(_cylinder(2, (0.56, -0.145, 0.38), 0.115, 0.09, 0.03))
    f.add(_cylinder(2, (0.56, -0.145, 0.455), 0.04, 0.015, 0.01))
    for x in (-0.60, -0.16, 0.16):
        f.add(_cylinder(2, (x, -0.20, 0.26), 0.045, 0.04, 0.01), 0.03)


def _manifold(f):
    """A flange and a pipe for each cylinder, and what they meet in."""
    for x in CYLINDERS:
        f.add(_box((x, 0.15, 0.262), (0.115, 0.062, 0.022), 0.02), 0.015)
        f.add(_cylinder(2, (x, 0.15, 0.31), 0.056, 0.06))
        for side in (-0.085, 0.085):
            f.add(_cylinder(2, (x + side, 0.15, 0.29), 0.022, 0.018, 0.005))
        f.add(_elbow((x, 0.075, 0.33), 0.075, 0.056), 0.01)
    f.add(_cylinder(0, (-0.09, 0.045, 0.405), 0.066, 0.71, 0.03), 0.03)
    f.add(_cylinder(0, (-0.80, 0.045, 0.37), 0.095, 0.018, 0.01))


def _drilling(f):
    """Bores, bolt holes, passages, the crank's tunnel."""
    for x, crown in zip(CYLINDERS, _PISTONS, strict=True):
        f.add(_cylinder(1, (x, 0.30, 0.0), _BORE + 0.022, 0.062, 0.014))
        f.cut(_cylinder(1, (x, 0.30, 0.0), _BORE, 0.40))
        f.add(_cylinder(1, (x, crown - 0.2, 0.0), _BORE - 0.004, 0.2, 0.012))
        f.cut(_cylinder(1, (x, crown, 0.0), 0.075, 0.018, 0.01))
    between = [(a + b) / 2.0 for a, b in pairwise(CYLINDERS)]
    for x in (-0.79, *between, 0.73):
        for z in (-0.235, 0.235):
            f.cut(_cylinder(1, (x, 0.30, z), 0.030, 0.13))
    for x in CYLINDERS:
        for z in (-0.222, 0.222):
            for along in (-0.055, 0.055):
                f.cut(_cylinder(1, (x + along, 0.33, z), 0.019, 0.06))
    # In front: holes round the crank, in the cover's corners, in the water pump's seat.
    f.cut(_cylinder(0, (_FRONT + 0.05, _CRANK, 0.0), 0.135, 0.10))
    f.add(_cylinder(0, (_FRONT + 0.02, _CRANK, 0.0), 0.062, 0.13, 0.01))
    f.add(_cylinder(0, (_FRONT - 0.03, _CRANK, 0.0), 0.135, 0.03))
    for y, z in _on_circle(8, 0.186, 0.5):
        f.cut(_cylinder(0, (_FRONT + 0.06, _CRANK + y, z), 0.022, 0.06))
    for y, z in _on_circle(4, 0.09, 0.5):
        f.cut(_cylinder(0, (_FRONT + 0.06, 0.17 + y, z - 0.03), 0.017, 0.06))
    f.cut(_cylinder(0, (_FRONT + 0.06, 0.17, -0.03), 0.055, 0.09))
    for z in (-0.165, 0.165):
        f.cut(_cylinder(0, (_FRONT + 0.03, 0.275, z), 0.022, 0.08))
    # The rear's holes, the manifold's end, the bosses on the skirt.
    for y, z in _on_circle(16, 0.358, 0.5):
        if y > -0.1:
            f.cut(_cylinder(0, (_REAR, y - 0.02, z), 0.022, 0.05))
    f.cut(_cylinder(0, (-0.80, 0.045, 0.405), 0.045, 0.12))
    for x in (-0.60, -0.16, 0.16):
        f.cut(_cylinder(2, (x, -0.20, 0.29), 0.022, 0.06))


def _pan(f):
    """The oil pan, which hangs from a bolted flange."""
    f.add(_box((-0.02, -0.335, 0.0), (0.79, 0.014, 0.315), 0.008))
    f.add(_box((0.26, -0.37, 0.0), (0.44, 0.055, 0.22), 0.035), 0.03)
    f.add(_box((-0.38, -0.40, 0.0), (0.34, 0.075, 0.23), 0.035), 0.03)
    for k in range(9):
        for z in (-0.288, 0.288):
            f.add(_cylinder(1, (-0.74 + 0.18 * k, -0.27, z), 0.024, 0.018, 0.005))


@lru_cache(maxsize=4)
def engine_block(rows=128):
    """The engine's densities: uint8 [rows layers, rows, 2 rows columns], 255 inside, 0 outside, read-only.

    ``rows``: voxels of its height and depth, a power of two from 8 on; its length has twice as many. The
    surface is at density 1/2. Below 64 rows bolt holes close and thin plates become faint.
    """
    if rows < 8 or rows & (rows - 1):
        raise ValueError(f"The engine block has {rows} rows; give a power of two, 8 or more.")
    f = _Field(rows)
    for part in (_casting, _manifold, _drilling, _pan):
        part(f)
    unit = np.clip(0.5 - f.distances * (rows / (2.0 * RAMP)), 0.0, 1.0)
    density = np.floor(255.0 * unit + 0.5).astype(np.uint8)
    density.setflags(write=False)
    return density

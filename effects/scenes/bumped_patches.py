"""Patches for offset vectors: surfaces with the derivatives of their points by a bump map's coordinates.

A patch may have its vectors at few corners, and many points and triangles. The picture then shows the
interpolation of vectors, and the outline stays round. Every cell of the coarse grid is cut into two
triangles; each vertex knows the three corners of its triangle and their weights.

The module uses float64 + - * / and square roots. Sines, cosines, exponentials and logarithms are rounded to
multiples of 2**-20 at once.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.surfaces import Surface, plane, sphere_frames, torus
from fixedpipe.effects.geometry.vectors import TRIGONOMETRY_STEP, cosine, cross, normalize, sine


@dataclass(frozen=True, eq=False)
class Patch:
    """A surface whose texture coordinates are its bump map's.

    surface   the Surface
    p_u, p_v  float64 [n, 3]: derivatives of the vertices' positions by those coordinates
    """

    surface: Surface
    p_u: np.ndarray
    p_v: np.ndarray

    def with_repeats(self, u, v):
        """The same with the map u by v times as often: points move less for each step of its coordinates."""
        return replace(
            self, surface=self.surface.with_repeats(u, v), p_u=self.p_u / float(u), p_v=self.p_v / float(v)
        )

    def rotated(self, matrix):
        """The patch turned by a 3x3 rotation about the origin."""
        turned = (rotate(matrix, v) for v in (self.p_u, self.p_v))
        return Patch(self.surface.rotated(matrix), *turned)


@dataclass(frozen=True, eq=False)
class Corners:
    """The corners of a coarse grid from which the vertices of a fine one interpolate.

    numbers  int64 [n, 3]: corners, row by row
    weights  float64 [n, 3], from zero on, their sum one
    """

    numbers: np.ndarray
    weights: np.ndarray


def corners_of_grid(columns, rows, divided):
    """The Corners of a grid of ``columns`` x ``rows`` cells, each divided ``divided`` times along both edges:
    vertices row by row, (columns divided + 1) x (rows divided + 1) of them.
    """
    for count, what in ((columns, "columns"), (rows, "rows"), (divided, "parts of a cell's edge")):
        if count < 1:
            raise ValueError(f"The grid has {count} {what}; give at least one.")
    i, j = np.meshgrid(np.arange(columns * divided + 1), np.arange(rows * divided + 1))
    column, row = np.minimum(i // divided, columns - 1), np.minimum(j // divided, rows - 1)
    x, y = (i - column * divided) / divided, (j - row * divided) / divided
    a = row * (columns + 1) + column
    # Under the diagonal from a to c lies b, above it d.
    below = x >= y
    other = np.where(below, a + 1, a + columns + 1)
    numbers = np.stack([a, other, a + columns + 2], axis=-1)
    weights = np.stack([1.0 - np.where(below, x, y), np.abs(x - y), np.where(below, y, x)], axis=-1)
    return Corners(numbers.reshape(-1, 3), weights.reshape(-1, 3))


def _rounded(numbers):
    """Exponentials and logarithms as multiples of 2**-20, which are the same on every processor."""
    return np.floor(numbers / TRIGONOMETRY_STEP + 0.5) * TRIGONOMETRY_STEP


def horn(columns, rows, *, turn=500.0, taper=0.13, width=0.76):
    """A horn that winds about the z axis: a Patch of ``columns`` x ``rows`` cells, its side towards +z alone.

    turn   degrees from the mouth, u = 0, to the tip, u = 1, counter-clockwise from straight down
    taper  how many times as large the horn is a whole turn nearer to its tip, above 0 and at most 1
    width  the tube's diameter over the mouth's greatest distance from the axis, above 0 and below 1

    A turn's horn is the last one's, smaller: p = e^(ku) R(u) q(v), so p_u = k p + the turn's part, and all
    lengths fall alike. The mouth reaches a distance of one. v goes across, from the outer to the inner rim.
    """
    if not (0.0 < taper <= 1.0 and 0.0 < width < 1.0):
        raise ValueError(f"A horn has no taper {taper!r} and width {width!r}; give numbers from 0 to 1.")
    radians = math.radians(turn)
    shrinks = _rounded(math.log(taper)) * radians / (2.0 * math.pi)
    u, v = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows)
    u, v = u.ravel(), v.ravel()
    size, angle, across = _rounded(np.exp(shrinks * u)), radians * u - math.pi / 2.0, math.pi * v
    tube = 0.5 * width
    away, up = (1.0 - tube) + tube * cosine(across), tube * sine(across)
    outward = np.stack([cosine(angle), sine(angle), 0.0 * u], axis=-1)
    along = np.stack([-outward[:, 1], outward[:, 0], 0.0 * u], axis=-1)
    rising = np.array([0.0, 0.0, 1.0])
    positions = size[:, None] * (away[:, None] * outward + up[:, None] * rising)
    p_u = shrinks * positions + (radians * size * away)[:, None] * along
    slopes = (-up)[:, None] * outward + (tube * cosine(across))[:, None] * rising
    # Counter-clockwise seen from +z, u turns that way and v goes inward: p_u x p_v points out of the horn.
    p_v = (math.pi * size)[:, None] * slopes
    normals = normalize(cross(p_u, p_v))
    tangents = normalize(p_u)
    grid = plane(columns, rows)
    surface = Surface(
        positions,
        normals,
        tangents,
        cross(normals, tangents),
        np.stack([u, v], axis=-1),
        grid.triangles,
    )
    return Patch(surface, p_u, p_v)


def ring(around, across, radius=0.7, tube_radius=0.3):
    """The torus of ``surfaces.torus`` as a Patch."""
    surface = torus(around, across, radius, tube_radius)
    x, z = surface.positions[:, 0], surface.positions[:, 2]
    away = np.sqrt(x * x + z * z)
    return Patch(
        surface,
        (2.0 * math.pi * away)[:, None] * surface.tangents,
        2.0 * math.pi * tube_radius * surface.binormals,
    )


def globe(columns, rows):
    """The unit sphere with its poles on the y axis as a Patch of ``columns`` x ``rows`` cells of longitude
    and latitude; those at the poles have an edge without length. u is 1/2 towards +z.
    """
    grid = plane(columns, rows)
    s, t = grid.texture_coordinates[:, 0], grid.texture_coordinates[:, 1]
    normals, east, north = sphere_frames(s, t)
    away = cosine(math.pi * (t - 0.5))
    surface = Surface(normals, normals, east, north, grid.texture_coordinates, grid.triangles)
    return Patch(surface, (2.0 * math.pi * away)[:, None] * east, math.pi * north)


def sheared_sheet(columns, rows, *, shear=1.0, half_width=1.0, half_height=1.0, bulge=0.35):
    """A rectangle, bulged towards +z, whose map's v runs aslant: a Patch.

    shear  how far a line of constant u leads to the right from the lower to the upper edge, in widths; the
           map repeats across the sheet
    bulge  how far the middle stands above the corners
    """
    flat = plane(columns, rows, half_width, half_height)
    x, y = flat.positions[:, 0] / half_width, flat.positions[:, 1] / half_height
    z = bulge * (1.0 - 0.5 * (x * x + y * y))
    s, t = flat.texture_coordinates[:, 0], flat.texture_coordinates[:, 1]
    positions = np.stack([flat.positions[:, 0], flat.positions[:, 1], z], axis=-1)
    zero = 0.0 * x
    along_x = np.stack([zero + 2.0 * half_width, zero, -2.0 * bulge * x], axis=-1)
    along_y = np.stack([zero, zero + 2.0 * half_height, -2.0 * bulge * y], axis=-1)
    # u = s - shear (t - 1/2): a step of v at one u goes along t and, by the shear, along s.
    p_u, p_v = along_x, along_y + shear * along_x
    normals, tangents = normalize(cross(p_u, p_v)), normalize(p_u)
    coordinates = np.stack([s - shear * (t - 0.5), t], axis=-1)
    surface = Surface(positions, normals, tangents, cross(normals, tangents), coordinates, flat.triangles)
    return Patch(surface, p_u, p_v)

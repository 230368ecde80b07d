"""Functions of direction as two discs: parabolic maps, of which a projective texture matrix makes
coordinates.

A paraboloid mirror that is seen along its axis shows one hemisphere without a singularity, two show all. The
first disc has the directions with z <= 0, those that a viewer looking along -z has before him, at (x, y)/(1 -
z); the second those with z > 0, at (x, y)/(1 + z). The discs' edge is the circle of radius one; beyond it a
map's texels go on with what the other hemisphere has, so that filters at the edge find what they need.

Source: Heidrich, Seidel 1998, View-independent environment maps; Heidrich 2001, section 1.3 (H21 of the
catalogue; pass sequence A-H21). The second disc is mirrored against what a viewer who turns round sees.
"""

import numpy as np

from fixedpipe.effects.geometry.cube_maps import size_of


def directions(size):
    """Unit vectors of texel centres, ``size`` along an edge: float64 [2, size, size, 3], t from -1 first."""
    edge = 2.0 * (np.arange(size_of(size, "The parabolic map's size")) + 0.5) / size - 1.0
    return of_places(*np.meshgrid(edge, edge))


def of_places(s, t):
    """Unit vectors of places on the discs, s and t in [-1, 1] of one shape: float64 [2, *shape, 3]."""
    square = s * s + t * t
    scale = 1.0 + square
    z = (square - 1.0) / scale
    x, y = 2.0 * s / scale, 2.0 * t / scale
    return np.stack([np.stack([x, y, z], axis=-1), np.stack([x, y, -z], axis=-1)])


def solid_angles(size):
    """Solid angles of texels by the density at their centres, 4/(1 + s^2 + t^2)^2, in steradians: float64
    [size, size], both discs' alike; texels beyond the discs' edge are counted by the other disc as well.
    """
    edge = 2.0 * (np.arange(size_of(size, "The parabolic map's size")) + 0.5) / size - 1.0
    s, t = np.meshgrid(edge, edge)
    scale = 1.0 + (s * s + t * t)
    return 16.0 / (scale * scale * size * size)


def inside(size):
    """Which texels have their centres in the disc: bool [size, size]."""
    edge = 2.0 * (np.arange(size_of(size, "The parabolic map's size")) + 0.5) / size - 1.0
    s, t = np.meshgrid(edge, edge)
    return s * s + t * t <= 1.0


def coordinates(vectors):
    """Where directions lie: discs, int64 [...] of 0 and 1, and places, float64 [..., 2] in [0, 1].

    ``vectors``: float64 [..., 3], not zero, of any length.
    """
    vectors = np.asarray(vectors, np.float64)
    x, y, z = (vectors[..., k] for k in range(3))
    length = np.sqrt((x * x + y * y) + z * z)
    disc = (z > 0.0).astype(np.int64)
    reach = 2.0 * (length + np.abs(z))
    return disc, np.stack([x / reach + 0.5, y / reach + 0.5], axis=-1)


def look_up(discs, vectors):
    """What a parabolic map [2, n, n, c] holds along directions [..., 3], bilinear: float64 [..., c]."""
    discs = np.asarray(discs, np.float64)
    size = discs.shape[1]
    disc, st = coordinates(vectors)
    at = np.clip(st * size - 0.5, 0.0, size - 1.0)
    low = np.minimum(np.floor(at).astype(np.int64), max(size - 2, 0))
    high = np.minimum(low + 1, size - 1)
    (s0, t0), (s1, t1) = (np.moveaxis(each, -1, 0) for each in (low, high))
    u, v = (at - low)[..., 0, None], (at - low)[..., 1, None]
    lower = discs[disc, t0, s0] + u * (discs[disc, t0, s1] - discs[disc, t0, s0])
    upper = discs[disc, t1, s0] + u * (discs[disc, t1, s1] - discs[disc, t1, s0])
    return lower + v * (upper - lower)

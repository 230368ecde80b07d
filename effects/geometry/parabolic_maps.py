"""Functions of direction as two discs: parabolic maps, addressed through a projective texture matrix.

A paraboloid mirror that is seen along its axis shows one hemisphere without a singularity; two mirrors show
all directions. The first disc has the directions with z <= 0, in front of a viewer who looks along -z, at (x,
y)/(1 - z). The second has those with z > 0, at (x, y)/(1 + z). The edge of a disc is the circle of radius
one. Beyond it a map's texels continue with the other hemisphere, so that filters at the edge find the right
texels.

``reach`` is the disc's radius in half edges of the map. It is one if the disc touches the map's edges, and
less if texels remain around the disc (``margin``).

Source: Heidrich, Seidel 1998, View-independent environment maps; Heidrich 2001, section 1.3 (H21 of the
catalogue; pass sequence A-H21). The second disc is the mirror image of the view backwards.
"""

import numpy as np

from fixedpipe.effects.geometry.cube_maps import size_of


def _texels(size, reach):
    """s and t of texel centres, from -1/``reach`` to 1/``reach``: two float64 [size, size]."""
    edge = (2.0 * (np.arange(size_of(size, "The parabolic map's size")) + 0.5) / size - 1.0) / reach
    return np.meshgrid(edge, edge)


def margin(size, texels=2):
    """The ``reach`` of a disc that leaves so many texels to each edge of its map; it is at least half the
    map.
    """
    return max(1.0 - 2.0 * texels / size_of(size, "The parabolic map's size"), 0.5)


def directions(size, reach=1.0):
    """Unit vectors of texel centres, ``size`` along an edge: float64 [2, size, size, 3], t from -1 first."""
    return of_places(*_texels(size, reach))


def of_places(s, t):
    """Unit vectors of places on the discs, s and t in [-1, 1] of one shape: float64 [2, *shape, 3]."""
    square = s * s + t * t
    scale = 1.0 + square
    z = (square - 1.0) / scale
    x, y = 2.0 * s / scale, 2.0 * t / scale
    return np.stack([np.stack([x, y, z], axis=-1), np.stack([x, y, -z], axis=-1)])


def solid_angles(size, reach=1.0):
    """Solid angles of texels by the density at their centres, 4/(1 + s^2 + t^2)^2, in steradians: float64
    [size, size], both discs' alike; texels beyond the discs' edge are counted by the other disc as well.
    """
    s, t = _texels(size, reach)
    scale = (1.0 + (s * s + t * t)) * (size * reach)
    return 16.0 / (scale * scale)


def inside(size, reach=1.0):
    """Which texels have their centres in the disc: bool [size, size]."""
    s, t = _texels(size, reach)
    return s * s + t * t <= 1.0


def coordinates(vectors, reach=1.0):
    """Where directions lie: discs, int64 [...] of 0 and 1, and places, float64 [..., 2] in [0, 1].

    ``vectors``: float64 [..., 3], not zero, of any length.
    """
    vectors = np.asarray(vectors, np.float64)
    x, y, z = (vectors[..., k] for k in range(3))
    length = np.sqrt((x * x + y * y) + z * z)
    disc = (z > 0.0).astype(np.int64)
    scale = 0.5 * reach / (length + np.abs(z))
    return disc, np.stack([x * scale + 0.5, y * scale + 0.5], axis=-1)


def look_up(discs, vectors, reach=1.0):
    """The values of a parabolic map [2, n, n, c] along directions [..., 3], bilinear: float64 [..., c]."""
    discs = np.asarray(discs, np.float64)
    size = discs.shape[1]
    disc, st = coordinates(vectors, reach)
    at = np.clip(st * size - 0.5, 0.0, size - 1.0)
    low = np.minimum(np.floor(at).astype(np.int64), max(size - 2, 0))
    high = np.minimum(low + 1, size - 1)
    (s0, t0), (s1, t1) = (np.moveaxis(each, -1, 0) for each in (low, high))
    u, v = (at - low)[..., 0, None], (at - low)[..., 1, None]
    lower = discs[disc, t0, s0] + u * (discs[disc, t0, s1] - discs[disc, t0, s0])
    upper = discs[disc, t1, s0] + u * (discs[disc, t1, s1] - discs[disc, t1, s0])
    return lower + v * (upper - lower)


def matrix(disc, reach=1.0):
    """The 4x4 texture matrix that takes a unit vector (x, y, z, 1) to a disc's (s, t, 0, q); disc 0 is the
    first. s/q and t/q are those of ``coordinates``; directions of the other hemisphere lie beyond the disc.
    """
    sign = (-1.0, 1.0)[disc]
    half = 0.5 * float(reach)
    return (
        (half, 0.0, 0.5 * sign, 0.5),
        (0.0, half, 0.5 * sign, 0.5),
        (0.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, sign, 1.0),
    )

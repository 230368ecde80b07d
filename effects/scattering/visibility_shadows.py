"""G12 and G13: shadows of bumps from S_i.

The direction nearest to the light decides, or the three directions around it.

G12: a texel is lit if it sees nothing along the nearest direction. G13: the light lies between three
directions with three weights. A texel's share of light, from 0 to 1, is the sum of the weights of those that
see nothing, as if the light had the size of a triangle of directions.

A direction from which the texel faces away (BACK) does not say whether anything blocks it. It may count as
shadowed, or take no part. In the latter case, a nearest direction leaves the light to its cosine, and the
other two of three share its weight (erratum E002.9).

The field has one light, or each texel has its own: for a lamp nearby, or on a curved base.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 4; pass sequences A-G12 and A-G13.
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, dot
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering.visibility import BACK, FREE
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("G12", "a texel is in shadow if it sees another along the direction nearest to the light", "4"),
    Technique("G13", "shadows interpolated between the three directions around the light", "4"),
)

# Of lights of their own, so many texels at once: each is compared with every triangle.
_TEXELS_AT_ONCE = 4096
_NO_WEIGHT = 2.0**-30


def _lights(visibility, light):
    """The light as unit vectors [3] or [rows, columns, 3]. Raises ValueError for another shape, and for
    vectors that are zero or not finite.
    """
    vectors = np.asarray(light, np.float64)
    field = visibility.seen.shape[1:]
    if vectors.shape not in ((3,), (*field, 3)):
        raise ValueError(f"The light has shape {vectors.shape}; give [3], or {(*field, 3)} for each texel.")
    if not np.isfinite(vectors).all() or not vectors.any(axis=-1).all():
        raise ValueError("The light's direction is zero, NaN or infinite somewhere; give finite ones.")
    return sphere.checked(vectors.reshape(-1, 3)).reshape(vectors.shape)


def _seen_along(visibility, number):
    """What is seen along the direction of a number, one or one for each texel: int32 [rows, columns]."""
    if np.ndim(number) == 0:
        return visibility.seen[number]
    return np.take_along_axis(visibility.seen, number[None], axis=0)[0]


def nearest_free(visibility, light, turned_away_counts=False):
    """G12: which texels see nothing along the direction nearest to the light, bool [rows, columns].

    light               a direction [3], or [rows, columns, 3]
    turned_away_counts  whether a direction from which a texel is turned away is shadowed

    Raises ValueError for another shape, and for a light that is no direction.
    """
    vectors = _lights(visibility, light)
    seen = _seen_along(visibility, sphere.nearest(visibility.directions, vectors))
    return seen == FREE if turned_away_counts else seen < 0


def surroundings(directions, triangles, vectors):
    """The three directions around each of some vectors [k, 3]: int64 [k, 3], and their weights, float64
    [k, 3], as ``directions.surrounding`` has them for one.
    """
    vectors = np.asarray(vectors, np.float64)
    a, b, c = (directions[triangles[:, k]] for k in range(3))
    sides, volume = [cross(b, c), cross(c, a), cross(a, b)], dot(a, cross(b, c))
    numbers, weights = np.empty((len(vectors), 3), np.int64), np.empty((len(vectors), 3))
    for first in range(0, len(vectors), _TEXELS_AT_ONCE):
        part = vectors[first : first + _TEXELS_AT_ONCE, None]
        parts = np.stack([dot(side, part) for side in sides], axis=-1)
        found = np.argmax((parts / volume[:, None]).min(axis=-1), axis=-1)
        own = np.maximum(np.take_along_axis(parts, found[:, None, None], axis=1)[:, 0], 0.0)
        total = (own[:, 0] + own[:, 1]) + own[:, 2]
        numbers[first : first + _TEXELS_AT_ONCE] = triangles[found]
        weights[first : first + _TEXELS_AT_ONCE] = own / total[:, None]
    return numbers, weights


def free_share(visibility, light, triangles=None, turned_away_counts=False):
    """G13: the share of the light, float64 [rows, columns] from 0 to 1, between the three directions around
    it.

    triangles  of the directions (``directions.triangulated``); None: they are made

    Other arguments and exceptions as for ``nearest_free``; also ValueError if the directions do not surround
    the origin.
    """
    vectors = _lights(visibility, light)
    if triangles is None:
        triangles = sphere.triangulated(visibility.directions)
    field = visibility.seen.shape[1:]
    numbers, weights = surroundings(visibility.directions, triangles, vectors.reshape(-1, 3))
    total, counted = np.zeros(field), np.zeros(field)
    for k in range(3):
        if vectors.ndim == 1:
            seen, weight = visibility.seen[numbers[0, k]], weights[0, k]
        else:
            seen = _seen_along(visibility, numbers[:, k].reshape(field))
            weight = weights[:, k].reshape(field)
        total = total + weight * (seen == FREE)
        counted = counted + weight * (turned_away_counts | (seen != BACK))
    # Where all three are turned away, but for a weight that rounding left, the cosine says the rest.
    some = counted > _NO_WEIGHT
    return np.where(some, total / np.where(some, counted, 1.0), 1.0)

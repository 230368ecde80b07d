"""Directions spread evenly over the sphere, and the triangles between them.

Visibility is computed along these directions (``visibility``). The triangles tell which three of them
surround another direction, and each direction's share of the sphere.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3 (the set D), 4 and 5 (its triangulation). Assumed:
points of a spiral; the paper says only that they are uniform. The whole sphere and not its upper half:
erratum E002.2 of the catalogue.
"""

import math

import numpy as np

from fixedpipe.effects.geometry.vectors import cosine, cross, dot, normalize, sine

# Turns of the spiral from a point to the next: the golden section, so that neighbours keep apart.
_GOLDEN = (3.0 - math.sqrt(5.0)) / 2.0
# Numbers whose squares are far from where floats end.
_SHORTEST = 1e-100
# Solid angles are rounded to a multiple of this: arc tangents differ in their last bit between processors.
_SOLID_ANGLE_STEP = 2.0**-30


def spiral(count):
    """``count`` unit vectors spread evenly over the sphere, from the zenith (+z) down: float64 [count, 3].

    Every direction is the middle of a belt of the same area. Raises ValueError for fewer than one.
    """
    if isinstance(count, bool) or not 1 <= count < math.inf or int(count) != count:
        raise ValueError(f"The number of directions is {count!r}; give a whole number from 1 on.")
    i = np.arange(int(count))
    z = 1.0 - (2.0 * i + 1.0) / count
    turn = i * _GOLDEN
    angle = 2.0 * math.pi * (turn - np.floor(turn))
    around = np.sqrt(1.0 - z * z)
    return normalize(np.stack([around * cosine(angle), around * sine(angle), z], axis=-1))


def checked(directions):
    """Directions as float64 [n, 3] of length one.

    Raises ValueError for another shape, no vectors, NaN or infinity, and for a vector that is zero, or so
    long or short that the square of its length is not a positive number.
    """
    array = np.asarray(directions, np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ValueError(f"The directions have shape {array.shape}; give [n, 3], at least one.")
    if not np.isfinite(array).all() or not array.any(axis=1).all():
        raise ValueError("The directions hold NaN, infinity or a zero vector; give finite ones.")
    longest = np.abs(array).max(axis=1)
    if not ((longest > _SHORTEST) & (longest < 1.0 / _SHORTEST)).all():
        raise ValueError(
            "The directions hold a vector too long or too short to have a length; give unit vectors."
        )
    return normalize(np.ascontiguousarray(array))


def finite(vector, what):
    """One vector, not normalized, float64 [3]. Raises ValueError, naming ``what``, for another shape, NaN or
    infinity.
    """
    array = np.asarray(vector, np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{what} is {array.tolist()!r}; give three finite numbers.")
    return array


def nearest(directions, vector):
    """The number of the direction that is nearest to a vector [..., 3]: int64 [...]; of two as near, the
    first.
    """
    vector = np.asarray(vector, np.float64)
    return np.argmax(dot(directions, vector[..., None, :]), axis=-1)


def triangulated(directions):
    """The convex hull of the directions: int64 [k, 3], each triangle counter-clockwise seen from outside and
    its lowest number first, the triangles in order. It is their Delaunay triangulation on the sphere.

    Raises ValueError if they enclose nothing: fewer than four, or all in one half of the sphere.
    """
    from scipy.spatial import ConvexHull, QhullError

    directions = checked(directions)
    try:
        hull = ConvexHull(directions)
        # n.x + offset <= 0 inside: the origin is inside where every offset is negative.
        surround = bool((hull.equations[:, 3] < 0.0).all())
    except (QhullError, ValueError):
        surround = False
    if not surround:
        raise ValueError(
            f"The {len(directions)} directions do not surround the origin, so they have no triangles; give "
            "directions over the whole sphere."
        )
    triangles = hull.simplices.astype(np.int64)
    a, b, c = (directions[triangles[:, k]] for k in range(3))
    outward = cross(b - a, c - a)
    flipped = dot(outward, a + b + c) < 0.0
    triangles[flipped] = triangles[flipped][:, ::-1]
    first = np.argmin(triangles, axis=1)[:, None]
    triangles = np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)
    return triangles[np.lexsort(triangles.T[::-1])]


def solid_angles(a, b, c):
    """Solid angles of spherical triangles whose corners are unit vectors [..., 3], in steradians: positive
    where the corners are counter-clockwise seen from outside.

    Source: Van Oosterom, Strackee 1983.
    """
    volume = dot(a, cross(b, c))
    around = 1.0 + dot(a, b) + dot(b, c) + dot(c, a)
    angle = 2.0 * np.arctan2(volume, around)
    return np.floor(angle / _SOLID_ANGLE_STEP + 0.5) * _SOLID_ANGLE_STEP


def fan_areas(directions, triangles):
    """Each direction's part of the sphere, float64 [..., n] in steradians, for directions [..., n, 3].

    It consists of the parts of the surrounding triangles that are nearer to this corner than to the other
    two. The parts sum to 4 pi. Source: section 5, figure 8: the area of the fan. Inferred: the nearer parts.
    So nothing counts twice, and a direction with five neighbours has the same weight as one with seven. With
    thirds of the triangles, the areas of a hundred even directions differ by half.
    """
    directions = np.asarray(directions, np.float64)
    corners = [directions[..., triangles[:, k], :] for k in range(3)]
    a, b, c = corners
    center = normalize(cross(b - a, c - a))
    middles = [normalize(corners[k] + corners[(k + 1) % 3]) for k in range(3)]
    out = np.zeros(directions.shape[:-1])
    for k in range(3):
        part = solid_angles(corners[k], middles[k], center) + solid_angles(corners[k], center, middles[k - 1])
        # Each triangle after the other: a direction has several.
        np.add.at(out, (..., triangles[:, k]), part)
    return out


def surrounding(directions, triangles, vector):
    """The three directions around one vector [3], and their weights: int64 [3] and float64 [3], which sum to
    one.

    The weights are barycentric where the vector meets the plane of the three.
    """
    vector = normalize(np.asarray(vector, np.float64))
    a, b, c = (directions[triangles[:, k]] for k in range(3))
    parts = np.stack([dot(cross(b, c), vector), dot(cross(c, a), vector), dot(cross(a, b), vector)], axis=-1)
    # Inside where no part is negative; a vector on an edge may miss both neighbours by rounding.
    triangle = int(np.argmax((parts / dot(a, cross(b, c))[:, None]).min(axis=1)))
    weights = np.maximum(parts[triangle], 0.0)
    return triangles[triangle], weights / weights.sum()

"""Clipping of filled triangles, one after the other.

``fixedpipe.pipeline.vertices.clip`` does the same in NumPy on all at once. That costs the same few hundred
microseconds for one triangle as for a thousand, and mostly it is a few.
"""

from numba import int32, int64, types

from fixedpipe.raster import codes as C
from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.primitives.vertices import (
    HALF_X,
    HALF_Y,
    HIGH_X,
    HIGH_Y,
    LOW_X,
    LOW_Y,
    UNUSUAL_W,
    is_unusual,
    to_window,
)

_PLANES = 6
# A plane leaves a polygon of n vertices at most 3 n / 2, where every second edge begins inside: from 3 four,
# then 6, 9, 13, 19, 28. Only distances that are no numbers go that far; a convex polygon ends with 9.
MOST_VERTICES = 28
_INFINITY = float("inf")


@kernel
def _distance(v, plane, parameters):
    """From clip coordinates to a plane, by its number (``codes.PLANE_NEAR`` and what follows)."""
    if plane == C.PLANE_NEAR:
        return v[2] + v[3]
    if plane == C.PLANE_FAR:
        return v[3] - v[2]
    if plane == C.PLANE_LEFT:
        return v[0] * parameters[HALF_X] + parameters[LOW_X] * v[3]
    if plane == C.PLANE_RIGHT:
        return parameters[HIGH_X] * v[3] - v[0] * parameters[HALF_X]
    if plane == C.PLANE_BOTTOM:
        return v[1] * parameters[HALF_Y] + parameters[LOW_Y] * v[3]
    return parameters[HIGH_Y] * v[3] - v[1] * parameters[HALF_Y]  # PLANE_TOP


@kernel
def _clip_polygon(polygon, n, plane, parameters, result):
    """Clip n vertices, the first rows of ``polygon``, against a plane; how many rows of ``result`` follow."""
    emitted = int64(0)
    for i in range(n):
        here, there = polygon[i], polygon[i + 1 if i + 1 < n else 0]
        d, e = _distance(here, plane, parameters), _distance(there, plane, parameters)
        if d >= 0.0:
            for k in range(here.shape[0]):
                result[emitted, k] = here[k]
            emitted += 1
        if (d >= 0.0) != (e >= 0.0):
            if not d >= 0.0:
                here, there, d, e = there, here, e, d
            t = d / (d - e)
            for k in range(here.shape[0]):
                result[emitted, k] = here[k] + t * (there[k] - here[k])
            emitted += 1
    return emitted


@kernel("i8(i4[:,::1],f8[::1],i4[::1])")
def find_clipped(triangles, inverse_w, found):
    """Into ``found`` the numbers of the triangles with a vertex whose 1/w is 0; returns how many. Afterwards
    those 1/w are 1.
    """
    n = int64(0)
    for i in range(triangles.shape[0]):
        a, b, c = triangles[i, 0], triangles[i, 1], triangles[i, 2]
        if (inverse_w[a] == 0.0) | (inverse_w[b] == 0.0) | (inverse_w[c] == 0.0):
            found[n] = i
            n += 1
    for i in range(inverse_w.shape[0]):
        inverse_w[i] = 1.0 if inverse_w[i] == 0.0 else inverse_w[i]
    return n


_INTS, _FLOATS, _TRIANGLES = types.int32[::1], types.float64[::1], types.int32[:, ::1]
_COLUMNS = types.float64[:, ::1]
_MADE = types.Tuple((_COLUMNS, _INTS, _INTS, _FLOATS, _FLOATS))
_CLIPPED = types.UniTuple(int64, 4)


@kernel(_CLIPPED(_TRIANGLES, _INTS, _COLUMNS, _FLOATS, int64, types.float64[:, :, ::1], _MADE, _TRIANGLES))
def clip_triangles(triangles, chosen, corners, parameters, vertex_count, scratch, new, result):
    """Triangles with those that cross a clipping plane clipped, in draw order.

    triangles     int32[k, 4]: three vertices and the provoking vertex
    chosen        int32[j], ascending: the triangles that are clipped, or dropped; each has a vertex outside a
                  plane or without usable window coordinates
    corners       float64[3 * j, a]: the chosen triangles' vertices: clip coordinates, and what else is
                  interpolated
    parameters    float64[PARAMETERS] of ``fixedpipe.raster.primitives.vertices``
    vertex_count  the number of the first vertex that is made
    scratch       float64[2, MOST_VERTICES, a]
    new           (values, x, y, z, inverse_w), which receive the vertices that are made:
                  float64[MOST_VERTICES * j, a], as ``corners``;
                  [MOST_VERTICES * j] each: their window coordinates, as ``transform_vertices`` makes them;
                  where there are none, 1/w is 1
    result        int32[k + MOST_VERTICES * j, 4]: receives the triangles

    Returns how many triangles there are and how many vertices were made, how many of the chosen were dropped
    because a position is not usable, and the bit UNUSUAL_W as ``transform_vertices`` does.
    """
    values, x, y, z, inverse_w = new
    count, made, dropped, bits = int64(0), int64(0), int64(0), int64(0)
    unclipped = int64(0)
    for j in range(chosen.shape[0]):
        while unclipped < chosen[j]:
            for k in range(4):
                result[count, k] = triangles[unclipped, k]
            count += 1
            unclipped += 1
        unclipped += 1

        finite, touched, hidden = True, int64(0), False
        for i in range(3):
            for k in range(4):
                finite &= abs(corners[3 * j + i, k]) < _INFINITY
        for plane in range(_PLANES):
            outside = int64(0)
            for i in range(3):
                outside += 0 if _distance(corners[3 * j + i], plane, parameters) >= 0.0 else 1
            touched |= int64(1) << plane if outside else int64(0)
            hidden |= outside == 3
        # What no plane touches has no usable window coordinates.
        if (not finite) | (touched == 0):
            dropped += 1
            continue
        if hidden:
            continue

        n, at = int64(3), int64(0)
        for i in range(3):
            for k in range(corners.shape[1]):
                scratch[0, i, k] = corners[3 * j + i, k]
        for plane in range(_PLANES):
            if touched >> plane & 1:
                n = _clip_polygon(scratch[at], n, plane, parameters, scratch[1 - at])
                at = 1 - at

        usable = True
        for i in range(n):
            v, number = scratch[at, i], made + i
            for k in range(corners.shape[1]):
                values[number, k] = v[k]
            x[number], y[number], z[number], w, drawable = to_window(v[0], v[1], v[2], v[3], parameters)
            usable &= drawable
            inverse_w[number] = w if drawable else 1.0
            bits |= int64(UNUSUAL_W) if drawable and is_unusual(w) else int64(0)
        if n >= 3 and usable:
            for i in range(n - 2):
                result[count, 0] = int32(vertex_count + made)
                result[count, 1] = int32(vertex_count + made + i + 1)
                result[count, 2] = int32(vertex_count + made + i + 2)
                result[count, 3] = triangles[chosen[j], 3]
                count += 1
        elif n >= 3:
            dropped += 1
        made += n
    while unclipped < triangles.shape[0]:
        for k in range(4):
            result[count, k] = triangles[unclipped, k]
        count += 1
        unclipped += 1
    return count, made, dropped, bits

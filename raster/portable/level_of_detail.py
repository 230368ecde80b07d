"""Lambda: one value per 2x2 block of device pixels (docs/numbers.md, section 7)."""

from typing import NamedTuple

import numpy as np
from numba import float64, int32, int64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS
from fixedpipe.raster.floats import LEAST_Q
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.arrays import PASS, SCRATCH
from fixedpipe.raster.portable.sample import FAR, log2_q7, major_axis, on_face
from fixedpipe.raster.primitives.strokes import along_line
from fixedpipe.raster.primitives.triangle import Corners, corners_of


@kernel
def edge_functions(corners, px, py):
    """The edge functions n0, n1, n2 of pixel (px, py)'s sample, int64, in 1/256 square pixel, turned so that
    the area is positive.
    """
    x0, y0, x1, y1, x2, y2 = corners
    sx, sy = px * 16 + 8, py * 16 + 8
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    n1 = (sx - x0) * (y2 - y0) - (x2 - x0) * (sy - y0)
    n2 = (x1 - x0) * (sy - y0) - (sx - x0) * (y1 - y0)
    if area < 0:
        area, n1, n2 = -area, -n1, -n2
    return area - n1 - n2, n1, n2


class Iterated(NamedTuple):
    """What a primitive's texture coordinates are iterated from.

    inverse_w   of its three vertices; 1 where they are equal
    s, t, r, q  each: vertex 1's, and what vertices 0 and 2 have more
    """

    corners: Corners
    inverse_w: tuple
    s: tuple
    t: tuple
    r: tuple
    q: tuple


@kernel
def differences(coordinates, v0, v1, v2, unit, k):
    """A coordinate of vertex 1, and what vertices 0 and 2 have more."""
    middle = coordinates[v1, unit, k]
    return middle, coordinates[v0, unit, k] - middle, coordinates[v2, unit, k] - middle


@kernel
def iterated(vertices, v0, v1, v2, unit):
    """What a unit's coordinates are iterated from between three vertices.

    Found once a run: handed on for each block, the vertices' arrays cost more than lambda's arithmetic.
    Measured: trilinear minification takes 1.7 times as long (AMD EPYC).
    """
    w0, w1, w2 = vertices.inverse_w[v0], vertices.inverse_w[v1], vertices.inverse_w[v2]
    if w0 == w1 and w1 == w2:
        w0 = w1 = w2 = 1.0
    return Iterated(
        corners_of(vertices, v0, v1, v2),
        (w0, w1, w2),
        differences(vertices.coordinates, v0, v1, v2, unit, 0),
        differences(vertices.coordinates, v0, v1, v2, unit, 1),
        differences(vertices.coordinates, v0, v1, v2, unit, 2),
        differences(vertices.coordinates, v0, v1, v2, unit, 3),
    )


@kernel
def weighted(b0, b2, terms):
    """A coordinate where vertices 0 and 2 have these weights."""
    return (terms[0] + b0 * terms[1]) + b2 * terms[2]


@kernel
def coordinates_at(draw, kind, source, projective, px, py):
    """(whether D > 0, s, t, r) of a pixel, inside a primitive or not; divided by q if projective.

    ``kind``: codes.PRIMITIVE_...; ``source``: what they are iterated from.
    """
    if kind == C.PRIMITIVE_LINE:
        x0, y0, x1, y1, _x2, _y2 = source.corners
        n0, n2 = along_line(draw, x0, y0, x1, y1, int64(px) * 16 + 8, int64(py) * 16 + 8)
        n1 = int64(0)
    else:
        n0, n1, n2 = edge_functions(source.corners, int64(px), int64(py))
    w0, w1, w2 = source.inverse_w
    e0, e1, e2 = float64(n0) * w0, float64(n1) * w1, float64(n2) * w2
    total = (e0 + e1) + e2
    if not total > 0.0:
        return False, 0.0, 0.0, 0.0
    inverse = 1.0 / total
    b0, b2 = e0 * inverse, e2 * inverse
    s, t, r = weighted(b0, b2, source.s), weighted(b0, b2, source.t), weighted(b0, b2, source.r)
    if projective:
        q = weighted(b0, b2, source.q)
        q = q if q != 0.0 else LEAST_Q
        s, t, r = s / q, t / q, r / q
    return True, s, t, r


@kernel
def block_lambda(draw, kind, source, row, sizes, bx, by):
    """Lambda with 8 fraction bits, without bias, of the block whose origin is (bx, by).

    ``sizes``: width, height and depth of level 0.
    """
    divided, (width, height, depth) = row[R.PROJECTIVE], sizes
    ok0, s0, t0, r0 = coordinates_at(draw, kind, source, divided, bx, by)
    ok1, s1, t1, r1 = coordinates_at(draw, kind, source, divided, bx + 1, by)
    ok2, s2, t2, r2 = coordinates_at(draw, kind, source, divided, bx, by + 1)
    if not (ok0 and ok1 and ok2):
        return FAR
    if row[R.TARGET] == C.TARGET_CUBE_MAP:
        face = major_axis(s0, t0, r0)
        half = 0.5 * width
        sc0, tc0, ma0 = on_face(face, s0, t0, r0)
        sc1, tc1, ma1 = on_face(face, s1, t1, r1)
        sc2, tc2, ma2 = on_face(face, s2, t2, r2)
        if not (ma0 > 0.0 and ma1 > 0.0 and ma2 > 0.0):
            return FAR
        s0, t0 = (sc0 / ma0 + 1.0) * half, (tc0 / ma0 + 1.0) * half
        s1, t1 = (sc1 / ma1 + 1.0) * half, (tc1 / ma1 + 1.0) * half
        s2, t2 = (sc2 / ma2 + 1.0) * half, (tc2 / ma2 + 1.0) * half
    else:
        s0, s1, s2 = s0 * width, s1 * width, s2 * width
        t0, t1, t2 = t0 * height, t1 * height, t2 * height
        if row[R.TARGET] == C.TARGET_1D:
            t0 = t1 = t2 = 0.0
    dsx, dtx, dsy, dty = s1 - s0, t1 - t0, s2 - s0, t2 - t0
    dx2, dy2 = dsx * dsx + dtx * dtx, dsy * dsy + dty * dty
    if row[R.TARGET] == C.TARGET_3D:
        drx, dry = r1 * depth - r0 * depth, r2 * depth - r0 * depth
        dx2, dy2 = dx2 + drx * drx, dy2 + dry * dry
    if not (dx2 < np.inf and dy2 < np.inf):  # infinite, or not a number, which max may lose
        return FAR
    rho2 = max(dx2, dy2)
    if rho2 == 0.0:
        return int32(-FAR)
    return log2_q7(rho2)


@kernel(inlined=True)
def primitive_of(p, scratch, run):
    """(row of ``triangles``, codes.PRIMITIVE_...) of the primitive that a run is of."""
    t, kind = scratch.ints[R.OWNER, run], int64(C.PRIMITIVE_TRIANGLE)
    if p.state.draw[R.STROKES]:
        kind = int64(p.strokes[t, 0])
    return t, kind


@kernel(inlined=True)
def iterated_of(p, t, unit):
    """What a unit's coordinates are iterated from in primitive t."""
    return iterated(p.vertices, p.triangles[t, 0], p.triangles[t, 1], p.triangles[t, 2], unit)


@kernel(void(PASS, int64, RUNS, SCRATCH))
def level_of_detail(p, unit, runs, scratch):
    """Lambda plus bias of every fragment, limited, 8 fraction bits, into LOD.

    Measured: one value per 2x2 block (Texture_anisotropy), axis steps (LODBias 61440 of 61440).
    """
    separate_function()
    draw, row, levels, ints = p.state.draw, p.textures.units[unit], p.textures.levels[unit], scratch.ints
    width, height, depth = float64(levels[0, 1]), float64(levels[0, 2]), float64(row[R.LAYERS])
    if row[R.TARGET] == C.TARGET_RECTANGLE:  # coordinates that count texels already
        width = height = 1.0
    sizes = width, height, depth
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    for k in range(runs.count):
        t, kind = primitive_of(p, scratch, k)
        source = iterated_of(p, t, unit)
        block, value = int64(-1), int32(0)
        px = int64(runs.x[k])
        by = int64(runs.y[k]) & ~1
        for i in range(runs.starts[k], runs.starts[k + 1]):
            if px & ~1 != block:
                block = px & ~1
                value = block_lambda(draw, kind, source, row, sizes, block, by)
            ints[R.LOD, i] = min(max(int32(value + bias), low), high)
            px += 1

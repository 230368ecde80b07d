"""Lambda: one value per 2x2 block of device pixels (docs/numbers.md, section 7)."""

import numpy as np
from numba import float64, int32, int64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS, VERTICES
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.sample import FAR, log2_q7, major_axis, on_face
from fixedpipe.raster.primitives.strokes import along_line
from fixedpipe.raster.primitives.triangle import corners_of


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


@kernel
def coordinates_at(draw, kind, indices, vertices, unit, projective, px, py):
    """(whether D > 0, s, t, r) of a pixel, inside a primitive or not; divided by q if projective.

    ``kind``: codes.PRIMITIVE_...; ``indices``: of its three vertices.
    """
    (v0, v1, v2), inverse_w, coordinates = indices, vertices.inverse_w, vertices.coordinates
    corners = corners_of(vertices, v0, v1, v2)
    if kind == C.PRIMITIVE_LINE:
        x0, y0, x1, y1, _x2, _y2 = corners
        n0, n2 = along_line(draw, x0, y0, x1, y1, int64(px) * 16 + 8, int64(py) * 16 + 8)
        n1 = int64(0)
    else:
        n0, n1, n2 = edge_functions(corners, int64(px), int64(py))
    w0, w1, w2 = inverse_w[v0], inverse_w[v1], inverse_w[v2]
    if w0 == w1 and w1 == w2:
        w0 = w1 = w2 = 1.0
    e0, e1, e2 = float64(n0) * w0, float64(n1) * w1, float64(n2) * w2
    total = (e0 + e1) + e2
    if not total > 0.0:
        return False, 0.0, 0.0, 0.0
    inverse = 1.0 / total
    b0, b2 = e0 * inverse, e2 * inverse
    s1, t1, r1 = coordinates[v1, unit, 0], coordinates[v1, unit, 1], coordinates[v1, unit, 2]
    s = (s1 + b0 * (coordinates[v0, unit, 0] - s1)) + b2 * (coordinates[v2, unit, 0] - s1)
    t = (t1 + b0 * (coordinates[v0, unit, 1] - t1)) + b2 * (coordinates[v2, unit, 1] - t1)
    r = (r1 + b0 * (coordinates[v0, unit, 2] - r1)) + b2 * (coordinates[v2, unit, 2] - r1)
    if projective:
        q1 = coordinates[v1, unit, 3]
        q = (q1 + b0 * (coordinates[v0, unit, 3] - q1)) + b2 * (coordinates[v2, unit, 3] - q1)
        q = q if q != 0.0 else 1.0
        s, t, r = s / q, t / q, r / q
    return True, s, t, r


@kernel
def block_lambda(draw, kind, indices, vertices, unit, row, sizes, bx, by):
    """Lambda with 8 fraction bits, without bias, of the block whose origin is (bx, by).

    ``sizes``: width, height and depth of level 0.
    """
    divided, (width, height, depth) = row[R.PROJECTIVE], sizes
    ok0, s0, t0, r0 = coordinates_at(draw, kind, indices, vertices, unit, divided, bx, by)
    ok1, s1, t1, r1 = coordinates_at(draw, kind, indices, vertices, unit, divided, bx + 1, by)
    ok2, s2, t2, r2 = coordinates_at(draw, kind, indices, vertices, unit, divided, bx, by + 1)
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


@kernel(
    void(
        int64[::1], RUNS, int32[:, ::1], int32[:, ::1], VERTICES, int64, int64[::1], int32[:, ::1],
        int32[:, ::1],
    )
)  # fmt: skip
def level_of_detail(draw, runs, triangles, strokes, vertices, unit, row, levels, ints):
    """Lambda plus bias of every fragment, limited, 8 fraction bits, into LOD. A run is of one primitive,
    which is in OWNER.

    Measured: one value per 2x2 block (Texture_anisotropy), axis steps (LODBias 61440 of 61440).
    """
    separate_function()
    width, height, depth = float64(levels[0, 1]), float64(levels[0, 2]), float64(row[R.LAYERS])
    if row[R.TARGET] == C.TARGET_RECTANGLE:  # coordinates that count texels already
        width = height = 1.0
    sizes = width, height, depth
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    for k in range(runs.count):
        t = ints[R.OWNER, k]
        kind = int64(strokes[t, 0]) if draw[R.STROKES] else int64(C.PRIMITIVE_TRIANGLE)
        indices = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        block, value = int64(-1), int32(0)
        px = int64(runs.x[k])
        by = int64(runs.y[k]) & ~1
        for i in range(runs.starts[k], runs.starts[k + 1]):
            if px & ~1 != block:
                block = px & ~1
                value = block_lambda(draw, kind, indices, vertices, unit, row, sizes, block, by)
            ints[R.LOD, i] = min(max(int32(value + bias), low), high)
            px += 1

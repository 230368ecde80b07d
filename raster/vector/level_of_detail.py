"""Lambda by vectors: eight of the 2x2 blocks that a run crosses at a time (docs/numbers.md, section 7).

The arithmetic is that of raster/portable/level_of_detail.py in the same order, so the bits are the same.
"""

import numpy as np
from numba import float64, int32, int64, types, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS, VERTICES
from fixedpipe.raster.floats import EXPONENT_BIAS, FRACTION, FRACTION_BITS, LEAST_Q
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.level_of_detail import iterated, weighted
from fixedpipe.raster.portable.sample import FAR, POWERS_OF_TWO
from fixedpipe.raster.vector.lanes import (
    bits_of_lanes,
    f64x8,
    i32x8,
    i64x8,
    load_each_i64x8,
    load_f64x8,
    maximum,
    minimum,
    narrow_i32,
    next_lanes,
    ramp_f64x8,
    select,
    store,
    twice,
)


def _logarithm_cells():
    """For each of 256 parts of a mantissa's range what makes 128 log2 of it, cut, when added to the mantissa
    and shifted right by 52.

    A part holds at most one of the 127 thresholds: they lie at least 2**(1/128) - 1 > 1/256 apart. So the
    result is that of the part's first number, or one more from the next threshold on.
    """
    thresholds = [int(power * 2**52) - 2**52 for power in POWERS_OF_TWO] + [2**52]
    cells = np.empty(256, np.int64)
    for k in range(256):
        below = sum(threshold <= k << 44 for threshold in thresholds) - 1
        cells[k] = ((below + 1) << FRACTION_BITS) - thresholds[below + 1]
    return cells


CELLS = _logarithm_cells()


@kernel
def linear_edge(xa, ya, xb, yb, px, py, sign):
    """(value at pixel (px, py)'s sample, step to the right, step down) of the edge from a to b, in 1/256
    square pixel, times ``sign``; float64 holds them exactly.
    """
    value = (xb - xa) * (py * 16 + 8 - ya) - (px * 16 + 8 - xa) * (yb - ya)
    return float64(sign * value), float64(sign * (ya - yb) * 16), float64(sign * (xb - xa) * 16)


@kernel
def _coordinates(n, inverse_w, s, t, q, projective):
    """(whether D > 0, s, t) at eight points; s, t, q: vertex 1's and the differences of 0 and 2 to it."""
    e0, e1, e2 = n[0] * inverse_w[0], n[1] * inverse_w[1], n[2] * inverse_w[2]
    total = (e0 + e1) + e2
    inverse = 1.0 / total
    b0, b2 = e0 * inverse, e2 * inverse
    at_s, at_t = weighted(b0, b2, s), weighted(b0, b2, t)
    if projective:
        at_q = weighted(b0, b2, q)
        at_q = select(at_q != 0.0, at_q, f64x8(LEAST_Q))
        at_s, at_t = at_s / at_q, at_t / at_q
    return total > 0.0, at_s, at_t


@kernel
def _scale_factors(source, sizes, modes, px, py, blocks, rho2, cells):
    """The squared scale factor of each block from the one at (px, py) on to the right, infinite where it has
    none, and the part of ``CELLS`` that its mantissa lies in. ``source``: what coordinates are iterated from.
    """
    (x0, y0, x1, y1, x2, y2), inverse_w, s, t, _r, q = source
    (width, height), (flat, projective) = sizes, modes
    sign = int64(-1 if (x1 - x0) * (y2 - y0) < (x2 - x0) * (y1 - y0) else 1)
    n0, right0, down0 = linear_edge(x1, y1, x2, y2, px, py, sign)
    n1, right1, down1 = linear_edge(x2, y2, x0, y0, px, py, sign)
    n2, right2, down2 = linear_edge(x0, y0, x1, y1, px, py, sign)
    if flat:
        t = (0.0, 0.0, 0.0)
    for at in range(0, blocks, 8):
        step = (ramp_f64x8() + float64(at)) * 2.0
        m0, m1, m2 = n0 + step * right0, n1 + step * right1, n2 + step * right2
        ok0, s0, t0 = _coordinates((m0, m1, m2), inverse_w, s, t, q, projective)
        beside = m0 + right0, m1 + right1, m2 + right2
        ok1, s1, t1 = _coordinates(beside, inverse_w, s, t, q, projective)
        below = m0 + down0, m1 + down1, m2 + down2
        ok2, s2, t2 = _coordinates(below, inverse_w, s, t, q, projective)
        s0, s1, s2 = s0 * width, s1 * width, s2 * width
        t0, t1, t2 = t0 * height, t1 * height, t2 * height
        dsx, dtx, dsy, dty = s1 - s0, t1 - t0, s2 - s0, t2 - t0
        dx2, dy2 = dsx * dsx + dtx * dtx, dsy * dsy + dty * dty
        finite = (dx2 < np.inf) & (dy2 < np.inf)  # not where one is not a number, which maximum may lose
        found = select(ok0 & ok1 & ok2 & finite, maximum(dx2, dy2), f64x8(np.inf))
        store(rho2, at, found)
        store(cells, at, narrow_i32(bits_of_lanes(found) >> int64(44)) & int32(255))
    store(cells, (blocks + 7) & ~7, i32x8(int32(0)))  # a later run may read one vector further


@kernel
def lambdas(rho2, cells, first, blocks, row, lod, start, odd):
    """LOD of a run's fragments from ``start`` on, the first in its block's second column if ``odd``.

    ``first``: where ``blocks`` squared scale factors begin; as many as fill vectors are read, with ``cells``
    in range.
    """
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    for at in range(0, blocks, 8):
        value = load_f64x8(rho2, first + at)
        bits = bits_of_lanes(value)
        part = load_each_i64x8(CELLS, cells, first + at)
        logarithm = (((bits & int64(FRACTION)) + part) >> int64(FRACTION_BITS)) + (
            (bits >> int64(FRACTION_BITS)) - int64(EXPONENT_BIAS)
        ) * int64(128)
        logarithm = select(value == 0.0, i64x8(int64(-FAR)), logarithm)
        logarithm = select(value == np.inf, i64x8(int64(FAR)), logarithm)
        both = twice(minimum(maximum(narrow_i32(logarithm) + bias, low), high))
        if odd and at == 0:
            store(lod, start, next_lanes(both))
        else:
            store(lod, start + 2 * at - odd, both)


_ROOM = types.Tuple((float64[::1], int32[::1]))


@kernel(void(RUNS, int32[:, ::1], VERTICES, int64, int64[::1], int32[:, ::1], int32[:, ::1], _ROOM))
def level_of_detail(runs, triangles, vertices, unit, row, levels, ints, room):
    """As the portable engine's ``level_of_detail``, of triangles; no cube maps and no 3D textures.

    ``room``: scratch, each at least half a batch and 24 more. Up to 15 fragments past the last run's end lose
    their LOD.
    """
    separate_function()
    rho2, cells = room
    width, height = float64(levels[0, 1]), float64(levels[0, 2])
    if row[R.TARGET] == C.TARGET_RECTANGLE:  # coordinates that count texels already
        width = height = 1.0
    sizes, modes = (width, height), (row[R.TARGET] == C.TARGET_1D, row[R.PROJECTIVE] != 0)
    lod = ints[R.LOD]
    # A block's value serves both of its rows. One block more is computed at either end of a run where that
    # costs no further vector, or a small part: the next row's run often reaches there.
    last_owner, last_y, from_x, to_x = int64(-1), int64(0), int64(0), int64(0)
    for k in range(runs.count):
        owner = int64(ints[R.OWNER, k])
        start, end = int64(runs.starts[k]), int64(runs.starts[k + 1])
        px, py = int64(runs.x[k]), int64(runs.y[k]) & ~1
        odd = px & 1
        blocks = (end - start + odd + 1) >> 1
        begin = px - odd
        if owner != last_owner or py != last_y or begin < from_x or begin + 2 * blocks > to_x:
            more = 1 if blocks >= 32 or 0 < blocks & 7 < 7 else 0
            last_owner, last_y, from_x, to_x = owner, py, begin - 2 * more, begin + 2 * (blocks + more)
            v0, v1, v2 = triangles[owner, 0], triangles[owner, 1], triangles[owner, 2]
            source = iterated(vertices, v0, v1, v2, unit)
            _scale_factors(source, sizes, modes, from_x, py, blocks + 2 * more, rho2, cells)
        lambdas(rho2, cells, (begin - from_x) >> 1, blocks, row, lod, start, odd)

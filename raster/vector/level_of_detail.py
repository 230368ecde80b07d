"""Lambda by vectors: eight of the 2x2 blocks that a run crosses at a time (docs/numbers.md, section 7).

The arithmetic is that of raster/portable/level_of_detail.py in the same order, so the bits are the same.
"""

import numpy as np
from numba import float64, int32, int64, types, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS, VERTICES
from fixedpipe.raster.floats import EXPONENT_BIAS, FRACTION, FRACTION_BITS, LEAST_Q
from fixedpipe.raster.kernel import bits_of, kernel, separate_function
from fixedpipe.raster.portable.level_of_detail import iterated, weighted
from fixedpipe.raster.portable.sample import FAR, POWERS_OF_TWO
from fixedpipe.raster.vector.lanes import (
    all_lanes,
    bits_of_lanes,
    f64x8,
    i64x8,
    load_each_i32x8,
    load_each_i64x8,
    load_f64x8,
    load_i32x8,
    maximum,
    minimum,
    narrow_i32,
    next_lanes,
    ramp_f64x8,
    select,
    shift_right,
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
# The same of a mantissa's upper 20 bits. No threshold is nearer than NEAR to a part's first number, but 1.
NEAR_CELLS = (CELLS >> 32).astype(np.int32)
NEAR = 8
_UPPER, _LARGEST = 20, 0x7FE << 20  # bits of a mantissa in a float64's upper half; 2**1023 there
_TAME = 4.0  # how large a weight, and how far apart the sums of a block's points, may be
_SMALLEST_PART = 2.0**-20  # of a coordinate's extent
_EXACT_PRODUCT = 2.0**52
# Of sums D, and of what _SMALLEST_PART is of coordinates: no product or square then leaves float64's range.
_LEAST_SUM, _MOST_SUM, _LEAST_STEP, _MOST_STEP = 2.0**-80, 2.0**120, 2.0**-150, 2.0**150


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
def _is_tame(n, right, down):
    """Whether all weights at a block's three points are small, and their sums much the same.

    ``n``, ``right``, ``down``: edge functions and their steps, divided by w.
    """
    (e0, e1, e2), (r0, r1, r2), (q0, q1, q2) = n, right, down
    largest = max(abs(e0), max(abs(e1), abs(e2)))
    beside = max(abs(e0 + r0), max(abs(e1 + r1), abs(e2 + r2)))
    below = max(abs(e0 + q0), max(abs(e1 + q1), abs(e2 + q2)))
    total = (e0 + e1) + e2
    total1, total2 = total + ((r0 + r1) + r2), total + ((q0 + q1) + q2)
    least, most = min(total, min(total1, total2)), max(total, max(total1, total2))
    in_range = least >= _LEAST_SUM and most <= _MOST_SUM
    return in_range and most <= _TAME * least and max(largest, max(beside, below)) <= _TAME * least


@kernel
def _extent(terms, size):
    """How far a coordinate may be from 0 in texels, within a triangle, and more."""
    return ((abs(terms[0]) + abs(terms[1])) + abs(terms[2])) * size


@kernel
def _near_logarithms(square, least, cells, at):
    """(whether, 128 log2) of eight squares that are known to a part in 2**18: whether they are above
    ``least``, the upper half of a float64, and on the known side of every threshold. ``cells``: room.
    """
    upper = narrow_i32(shift_right(bits_of_lanes(square), int64(32)))
    fraction = upper & int32((1 << _UPPER) - 1)
    store(cells, at, fraction >> int32(_UPPER - 8))
    sum_ = fraction + load_each_i32x8(NEAR_CELLS, cells, at)
    above = sum_ & int32((1 << _UPPER) - 1)
    sure = (minimum(above, fraction) >= int32(NEAR)) & (above < int32((1 << _UPPER) - NEAR))
    sure = sure & (upper > least) & (upper < int32(_LARGEST))
    whole = (upper >> int32(_UPPER)) - int32(EXPONENT_BIAS)
    return sure, (sum_ >> int32(_UPPER)) + (whole << int32(7))


@kernel
def _logarithms(square, cells, at):
    """128 log2 of eight squares, cut; FAR of infinity and -FAR of 0. ``cells``: room."""
    bits = bits_of_lanes(square)
    store(cells, at, narrow_i32(bits >> int64(44)) & int32(255))
    part = load_each_i64x8(CELLS, cells, at)
    logarithm = (((bits & int64(FRACTION)) + part) >> int64(FRACTION_BITS)) + (
        (bits >> int64(FRACTION_BITS)) - int64(EXPONENT_BIAS)
    ) * int64(128)
    logarithm = select(square == 0.0, i64x8(int64(-FAR)), logarithm)
    return narrow_i32(select(square == np.inf, i64x8(int64(FAR)), logarithm))


@kernel
def _squares(e, right, down, along, terms):
    """The larger squared step, in texels, of eight blocks that are ``_is_tame``, but for rounding.

    With D the sum of the edge functions over w, a step changes a weight by (e' D - e D') / (D D'). To the
    right that has one numerator in the whole row, of which ``along`` is made; ``terms``: of s and of t, in
    texels.
    """
    (e0, e1, e2), (q0, q1, q2), (s, t) = e, down, terms
    total = (e0 + e1) + e2
    right_total, down_total = (right[0] + right[1]) + right[2], (q0 + q1) + q2
    by_right, by_down = total * (total + right_total), total * (total + down_total)
    u0, u2 = total * q0 - e0 * down_total, total * q2 - e2 * down_total
    down_s, down_t = u0 * s[1] + u2 * s[2], u0 * t[1] + u2 * t[2]
    across = f64x8(along) / (by_right * by_right)
    return maximum(across, (down_s * down_s + down_t * down_t) / (by_down * by_down))


@kernel
def _numerator(n, right, inverse_w, terms):
    """What a step to the right changes a coordinate by in a row, squared, of s and t together; times D D'."""
    (n0, n1, n2), (r0, r1, r2), (w0, w1, w2), (s, t) = n, right, inverse_w, terms
    c01, c02, c21 = r0 * n1 - n0 * r1, r0 * n2 - n0 * r2, r2 * n1 - n2 * r1
    k0, k2 = w0 * (w1 * c01 + w2 * c02), w2 * (w1 * c21 - w0 * c02)
    along_s, along_t = k0 * s[1] + k2 * s[2], k0 * t[1] + k2 * t[2]
    return along_s * along_s + along_t * along_t


@kernel
def _scaled(terms, size):
    """A coordinate's terms in texels."""
    return terms[0] * size, terms[1] * size, terms[2] * size


@kernel
def _divided(n, inverse_w):
    """Edge functions by w."""
    return n[0] * inverse_w[0], n[1] * inverse_w[1], n[2] * inverse_w[2]


@kernel
def _scale_factors(source, sizes, modes, px, py, blocks, logs, cells):
    """128 log2 of the squared scale factor of each block from the one at (px, py) on to the right, as
    ``_logarithms`` has it; ``cells``: room. ``source``: what coordinates are iterated from.

    Where weights are tame, a formula with one division by D for each step tells the logarithm. It and the
    rule's own steps both err by less than 2**-42 of the coordinates' extent. So a scale factor of 2**-20 of
    this or more is known to a part in 2**21, and its square to 2**20. Where that does not tell the logarithm,
    the rule's own steps do.
    """
    (x0, y0, x1, y1, x2, y2), inverse_w, s, t, _r, q = source
    (width, height), (flat, projective) = sizes, modes
    sign = int64(-1 if (x1 - x0) * (y2 - y0) < (x2 - x0) * (y1 - y0) else 1)
    n0, right0, down0 = linear_edge(x1, y1, x2, y2, px, py, sign)
    n1, right1, down1 = linear_edge(x2, y2, x0, y0, px, py, sign)
    n2, right2, down2 = linear_edge(x0, y0, x1, y1, px, py, sign)
    if flat:
        t = (0.0, 0.0, 0.0)
    n, right, down = (n0, n1, n2), (right0, right1, right2), (down0, down1, down2)
    right_over_w, down_over_w = _divided(right, inverse_w), _divided(down, inverse_w)
    far = 2.0 * float64(blocks - 1)
    last = n0 + far * right0, n1 + far * right1, n2 + far * right2
    steepest = max(abs(right0), max(abs(right1), abs(right2)))
    near = not projective and max(abs(n0), max(abs(n1), abs(n2))) * steepest < _EXACT_PRODUCT
    near = near and _is_tame(_divided(n, inverse_w), right_over_w, down_over_w)
    near = near and _is_tame(_divided(last, inverse_w), right_over_w, down_over_w)
    texels = _scaled(s, width), _scaled(t, height)
    along = _numerator(n, right, inverse_w, texels)
    smallest = (_extent(s, width) + _extent(t, height)) * _SMALLEST_PART
    near = near and _LEAST_STEP <= smallest <= _MOST_STEP
    least = int32(bits_of(smallest * smallest) >> int64(32))
    one_sum = inverse_w[0] == inverse_w[1] and inverse_w[1] == inverse_w[2]
    for at in range(0, blocks, 8):
        step = (ramp_f64x8() + float64(at)) * 2.0
        m0, m1, m2 = n0 + step * right0, n1 + step * right1, n2 + step * right2
        if near:
            e = m0 * inverse_w[0], m1 * inverse_w[1], m2 * inverse_w[2]
            square = _squares(e, right_over_w, down_over_w, along, texels)
            sure, found = _near_logarithms(square, least, cells, at)
            if all_lanes(sure):
                store(logs, at, found)
                continue
            near = not one_sum  # else the next ones will not tell either
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
        square = select(ok0 & ok1 & ok2 & finite, maximum(dx2, dy2), f64x8(np.inf))
        store(logs, at, _logarithms(square, cells, at))


@kernel
def logarithms(squares, blocks, logs, cells):
    """128 log2 of the squared scale factors of blocks, as ``_logarithms`` has it; whole vectors are read."""
    for at in range(0, blocks, 8):
        store(logs, at, _logarithms(load_f64x8(squares, at), cells, at))


@kernel
def lambdas(logs, first, blocks, row, lod, start, odd):
    """LOD of a run's fragments from ``start`` on, the first in its block's second column if ``odd``.

    ``first``: where the logarithms of ``blocks`` scale factors begin; as many as fill vectors are read.
    """
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    for at in range(0, blocks, 8):
        both = twice(minimum(maximum(load_i32x8(logs, first + at) + bias, low), high))
        if odd and at == 0:
            store(lod, start, next_lanes(both))
        else:
            store(lod, start + 2 * at - odd, both)


_ROOM = types.UniTuple(int32[::1], 2)


@kernel(void(RUNS, int32[:, ::1], VERTICES, int64, int64[::1], int32[:, ::1], int32[:, ::1], _ROOM))
def level_of_detail(runs, triangles, vertices, unit, row, levels, ints, room):
    """As the portable engine's ``level_of_detail``, of triangles; no cube maps and no 3D textures.

    ``room``: scratch, each at least half a batch and 24 more. Up to 15 fragments past the last run's end lose
    their LOD.
    """
    separate_function()
    logs, cells = room
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
            _scale_factors(source, sizes, modes, from_x, py, blocks + 2 * more, logs, cells)
        lambdas(logs, (begin - from_x) >> 1, blocks, row, lod, start, odd)

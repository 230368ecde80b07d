"""Weights of fragments and everything iterated with them, on vectors: the values of
``fixedpipe.raster.portable.interpolate``.

A batch is made of segments. All fragments of most segments belong to one triangle, whose numbers are then the
same in every lane. Small triangles share *mixed* segments (owner -1), whose fragments carry their triangle's
numbers in columns (``rows.N0`` and the next ones). Both kinds compute what docs/numbers.md, sections 4 to 6,
specifies, with the same functions on vectors.

Columns are longer than a batch (``rows.SLACK``), so loops take whole vectors. Behind a segment they overwrite
the columns of the next one, which is therefore computed later.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int32, int64, types, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import THREE, type_of
from fixedpipe.raster.fixed import (
    EXPONENT,
    HALF_OF_12,
    HALF_OF_14,
    HALF_OF_15,
    KEEP_12,
    KEEP_14,
    KEEP_15,
    KEEP_24,
    KEEP_29,
    REST_OF_24,
    REST_OF_29,
    reciprocal_24,
    reciprocal_29,
    seed_29,
)
from fixedpipe.raster.floats import EXPONENT_BIAS, FRACTION_BITS, REST_STEP, REST_STEPS, SMALLEST
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.portable.interpolate import TINY, coordinate_difference, depth_difference
from fixedpipe.raster.vector.lanes import (
    absolute,
    all_lanes,
    any_lane,
    bits_of_lanes,
    f64x8,
    f64x16,
    floats_of_lanes,
    floored,
    load_f64x16,
    maximum,
    minimum,
    ramp_f64x16,
    select,
    store,
    to_int32,
    truncated,
)

EXACT_FROM = 2.0**-30  # a coordinate whose largest term is not below this wraps without rounding
_BIT_23 = int64((EXPONENT_BIAS + 23) << FRACTION_BITS)  # the exponent of 2**23 to 2**24
LARGEST_COORDINATE = 512.0  # then 256 times the largest texture, twice, is an int32
LARGEST_REPEATED = 11  # log2 of the largest texture
LARGEST_FLOAT = 2.0**100  # of any coordinate: none of its terms overflows


@kernel
def keep_24(value):
    """24 significant bits of each lane."""
    return floats_of_lanes(bits_of_lanes(value) & KEEP_24)


@kernel
def power_of(value):
    """The largest power of two that is not above each lane."""
    return floats_of_lanes(bits_of_lanes(value) & EXPONENT)


@kernel
def weight_class(q):
    """1/2, 1/4 or 1/8: how ``interpolate.weight_class`` orders weights."""
    return minimum(maximum(power_of(q), 0.125), 0.5)


@kernel
def rest_of(a, b):
    """What two weights leave of one (``interpolate.rest_of``)."""
    return keep_24((1.0 - truncated(a * REST_STEPS) * REST_STEP) - truncated(b * REST_STEPS) * REST_STEP)


@kernel
def rest_to_largest(q0, q1, q2):
    """Weights of vertices 0 and 2, where the vertex with the largest one takes what the others leave
    (``interpolate.emit_iteration_weights``).
    """
    # Most vectors lie wholly beside one vertex, whose weight is above one half: no need to compare classes.
    if all_lanes(q1 > 0.5):
        return q0, q2
    if all_lanes(q0 > 0.5):
        return rest_of(q1, q2), q2
    if all_lanes(q2 > 0.5):
        return q0, rest_of(q0, q1)
    c0, c1, c2 = weight_class(q0), weight_class(q1), weight_class(q2)
    first = (c0 >= c1) & (c0 > c2)
    last = (c2 >= c0) & ((c2 > c1) | ((c2 == c1) & (c0 == c1)))
    return select(first, rest_of(q1, q2), q0), select(last, rest_of(q0, q1), q2)


@kernel
def keep_29(x):
    """Lanes cut to 29 significant bits."""
    return floats_of_lanes(bits_of_lanes(x) & KEEP_29)


@kernel
def newton_steps(total, x, last):
    """``fixed.newton_step`` of each lane."""
    rest = (1.0 - total * x) * (1.0 / last)
    return x + x * (select(rest > 0.0, 0.0 - floored(0.5 - rest), floored(rest + 0.5)) * last)


@kernel
def reciprocals_24(total):
    """``fixed.reciprocal_24`` of each lane."""
    near = floats_of_lanes((bits_of_lanes(total) + HALF_OF_15) & KEEP_15)
    x = floats_of_lanes((bits_of_lanes(1.0 / near) + HALF_OF_12) & KEEP_12)
    return keep_24(newton_steps(total, x, REST_OF_24))


@kernel
def reciprocals_29_from(total, seed):
    """``fixed.reciprocal_29`` of each lane from its seed."""
    total = keep_29(total)
    return keep_29(newton_steps(total, seed, REST_OF_29))


@kernel
def reciprocals_29(total):
    """``fixed.reciprocal_29`` of each lane."""
    seed = floats_of_lanes((bits_of_lanes(1.0 / keep_29(total)) + HALF_OF_14) & KEEP_14)
    return reciprocals_29_from(total, seed)


@kernel
def weight_sum(e0, e1, e2):
    """``interpolate.weight_sum`` of lanes inside a triangle: none is negative, and one is not 0."""
    exponent = bits_of_lanes(maximum(maximum(e0, e1), e2)) & EXPONENT
    unit = floats_of_lanes(exponent - int64(24 << 52))
    units = floats_of_lanes(int64(2070 << 52) - exponent)  # 1 / unit
    return keep_24(((truncated(e0 * units) + truncated(e1 * units)) + truncated(e2 * units)) * unit)


@kernel
def weights_of(a0, a1, a2, f0, f1, f2):
    """Weights of vertices 0 and 2 from edge functions and their factors
    (``interpolate.emit_iteration_weights``).
    """
    e0, e1, e2 = keep_24(keep_24(a0) * f0), keep_24(keep_24(a1) * f1), keep_24(keep_24(a2) * f2)
    reciprocal = reciprocals_24(weight_sum(e0, e1, e2))
    return rest_to_largest(keep_24(e0 * reciprocal), keep_24(e1 * reciprocal), keep_24(e2 * reciprocal))


@kernel
def are_exact(n, right, area):
    """Whether edge functions have 24 bits at every pixel of a run, so that their sum is the area.

    They do where the area has: each of them is a multiple, up to the area, of the power of two that divides
    them and their steps.
    """
    (n0, n1, n2), (right0, right1, right2) = n, right
    bits = (int64(n0) | int64(n1) | int64(n2)) | (int64(right0) | int64(right1) | int64(right2))
    return area < 2.0**24 * float64(bits & -bits)


@kernel
def area_weights(a0, a1, a2, reciprocal):
    """``weights_of`` for a triangle without perspective whose edge functions ``are_exact``."""
    return rest_to_largest(keep_24(a0 * reciprocal), keep_24(a1 * reciprocal), keep_24(a2 * reciprocal))


@kernel(void(float64[:, ::1], int64, int64, THREE, THREE, THREE))
def run_weights(floats, position, count, n, right, factors):
    """Q0 and Q2 of ``count`` pixels to the right of the one whose edge functions are ``n``."""
    separate_loop()
    (n0, n1, n2), (right0, right1, right2), (f0, f1, f2) = n, right, factors
    out0, out2 = floats[R.Q0], floats[R.Q2]
    ramp = ramp_f64x16()
    a0, a1, a2 = ramp * right0 + n0, ramp * right1 + n1, ramp * right2 + n2  # exact: integers below 2**53
    step0, step1, step2 = right0 * 16.0, right1 * 16.0, right2 * 16.0
    area = (n0 + n1) + n2
    if f0 == 1.0 and f1 == 1.0 and f2 == 1.0 and are_exact(n, right, area):
        reciprocal = f64x16(reciprocal_24(area))
        for i in range(0, count, 16):
            w0, w2 = area_weights(a0, a1, a2, reciprocal)
            store(out0, position + i, w0)
            store(out2, position + i, w2)
            a0, a1, a2 = a0 + step0, a1 + step1, a2 + step2
        return
    for i in range(0, count, 16):
        w0, w2 = weights_of(a0, a1, a2, f0, f1, f2)
        store(out0, position + i, w0)
        store(out2, position + i, w2)
        a0, a1, a2 = a0 + step0, a1 + step1, a2 + step2


@kernel(void(float64[:, ::1], int64, int64, THREE, float64))
def triangle_weights(floats, position, count, factors, area):
    """Q0 and Q2 of a triangle's fragments, which carry their edge functions in columns; its area is below
    2**24.
    """
    separate_loop()
    f0, f1, f2 = factors
    n0, n1, n2 = floats[R.N0], floats[R.N1], floats[R.N2]
    out0, out2 = floats[R.Q0], floats[R.Q2]
    perspective = not (f0 == 1.0 and f1 == 1.0 and f2 == 1.0)
    reciprocal = f64x16(reciprocal_24(area))
    for i in range(position, position + count, 16):
        a0, a1, a2 = load_f64x16(n0, i), load_f64x16(n1, i), load_f64x16(n2, i)
        if perspective:
            w0, w2 = weights_of(a0, a1, a2, f0, f1, f2)
        else:
            w0, w2 = area_weights(a0, a1, a2, reciprocal)
        store(out0, i, w0)
        store(out2, i, w2)


@kernel("void(f8[:,::1],i8,i8,i8)")
def mixed_weights(floats, start, end, perspective):
    """Q0 and Q2 of fragments that carry their edge functions and their factors, or the area's reciprocal."""
    separate_loop()
    n0, n1, n2 = floats[R.N0], floats[R.N1], floats[R.N2]
    f0, f1, f2 = floats[R.WEIGHT_FACTOR0], floats[R.WEIGHT_FACTOR1], floats[R.WEIGHT_FACTOR2]
    out0, out2 = floats[R.Q0], floats[R.Q2]
    for i in range(start, end, 16):
        a0, a1, a2 = load_f64x16(n0, i), load_f64x16(n1, i), load_f64x16(n2, i)
        if perspective:
            w0, w2 = weights_of(a0, a1, a2, load_f64x16(f0, i), load_f64x16(f1, i), load_f64x16(f2, i))
        else:
            w0, w2 = area_weights(a0, a1, a2, load_f64x16(f0, i))
        store(out0, i, w0)
        store(out2, i, w2)


@kernel
def depth_sum(base, a, b):
    """A vertex's depth plus what the two others add, each with 29 bits from the largest term's highest."""
    largest = maximum(maximum(absolute(base), TINY), maximum(absolute(a), absolute(b)))
    exponent = bits_of_lanes(largest) & EXPONENT
    unit = floats_of_lanes(exponent - int64(28 << 52))
    scale = floats_of_lanes(int64(2074 << 52) - exponent)  # 1 / unit
    return (base + truncated(a * scale) * unit) + truncated(b * scale) * unit


@kernel
def depth_of(edges, reciprocal, depths, differences):
    """``interpolate.emit_depth`` for edge functions of 24 significant bits and their sum's reciprocal of 29.

    ``depths``: z0, z1, z2; ``differences``: z1 - z0, z2 - z0, z2 - z1; the opposite ones are their negatives.
    """
    (e0, e1, e2), (z0, z1, z2), (z10, z20, z21) = edges, depths, differences
    q0, q1, q2 = keep_24(e0 * reciprocal), keep_24(e1 * reciprocal), keep_24(e2 * reciprocal)
    p0, p1, p2 = power_of(e0), power_of(e1), power_of(e2)
    first = (p0 > p1) & (p0 >= p2)
    last = (p2 > p1) & (p2 > p0)
    # Most vectors lie wholly beside one vertex.
    if all_lanes(first):
        return depth_sum(z0, q1 * z10, q2 * z20)
    if all_lanes(last):
        return depth_sum(z2, 0.0 - q0 * z20, 0.0 - q1 * z21)
    if not any_lane(first | last):
        return depth_sum(z1, 0.0 - q0 * z10, q2 * z21)
    base = select(first, z0, select(last, z2, z1))
    a = select(first, q1, q0) * select(first, z10, select(last, 0.0 - z20, 0.0 - z10))
    b = select(last, q1, q2) * select(first, z20, select(last, 0.0 - z21, z21))
    return depth_sum(base, a, b)


@kernel
def fixed_depth(z, offset, low, high):
    """A fixed depth buffer's word: 24 bits and the offset, limited, then the floor."""
    return to_int32(minimum(maximum(keep_24(z) + offset, low), high))


@kernel
def shared_seed(area):
    """(``seed_29`` of an area, whether it is that of all sums of its edge functions).

    A sum of three integers, each cut to 24 bits, lies below their area by less than 2**-23 of it; cut to 29
    bits, by less than 2**-22. The seed never grows with the sum.
    """
    seed = seed_29(area)
    return seed, seed_29(area - area * 2.0**-22) == seed


class Depths(NamedTuple):
    """A triangle's depths, in units: its vertices', what is added, and the limits of the sum."""

    vertices: tuple
    offset: float
    low: float
    high: float


DEPTHS = type_of(Depths, THREE, float64, float64, float64)


@kernel(inlined=True)
def vertex_depths(depths):
    """(the vertices' depths, their differences, as ``depth_of`` takes them), the same in every lane."""
    z0, z1, z2 = depths.vertices
    z10, z20, z21 = depth_difference(z1, z0), depth_difference(z2, z0), depth_difference(z2, z1)
    return (f64x16(z0), f64x16(z1), f64x16(z2)), (f64x16(z10), f64x16(z20), f64x16(z21))


@kernel(void(int32[::1], int64, int64, THREE, THREE, DEPTHS))
def run_depth(words, position, count, n, right, depths):
    """Depth words of ``count`` pixels to the right of the one whose edge functions are ``n``."""
    separate_loop()
    (n0, n1, n2), (right0, right1, right2) = n, right
    (z0, z1, z2), offset, low, high = depths
    if z0 == z1 and z1 == z2:  # differences of zero: whatever the weights, the depth is the base
        word = fixed_depth(f64x16(z0), offset, low, high)
        for i in range(0, count, 16):
            store(words, position + i, word)
        return
    ramp = ramp_f64x16()
    a0, a1, a2 = ramp * right0 + n0, ramp * right1 + n1, ramp * right2 + n2
    step0, step1, step2 = right0 * 16.0, right1 * 16.0, right2 * 16.0
    of_vertices, differences = vertex_depths(depths)
    area = (n0 + n1) + n2
    if area < 2.0**24:  # then every edge function has 24 bits, and their sum is the area
        reciprocal = f64x16(reciprocal_29(area))
        for i in range(0, count, 16):
            z = depth_of((a0, a1, a2), reciprocal, of_vertices, differences)
            store(words, position + i, fixed_depth(z, offset, low, high))
            a0, a1, a2 = a0 + step0, a1 + step1, a2 + step2
        return
    seed, shared = shared_seed(area)
    for i in range(0, count, 16):
        e0, e1, e2 = keep_24(a0), keep_24(a1), keep_24(a2)
        total = (e0 + e1) + e2
        reciprocal = reciprocals_29_from(total, f64x16(seed)) if shared else reciprocals_29(total)
        z = depth_of((e0, e1, e2), reciprocal, of_vertices, differences)
        store(words, position + i, fixed_depth(z, offset, low, high))
        a0, a1, a2 = a0 + step0, a1 + step1, a2 + step2


@kernel(void(float64[:, ::1], int32[::1], int64, int64, DEPTHS, float64))
def triangle_depth(floats, words, position, count, depths, area):
    """Depth words of a triangle's fragments, which carry their edge functions; its area is below 2**24."""
    separate_loop()
    _vertices, offset, low, high = depths
    n0, n1, n2 = floats[R.N0], floats[R.N1], floats[R.N2]
    reciprocal = f64x16(reciprocal_29(area))
    of_vertices, differences = vertex_depths(depths)
    for i in range(position, position + count, 16):
        edges = load_f64x16(n0, i), load_f64x16(n1, i), load_f64x16(n2, i)
        z = depth_of(edges, reciprocal, of_vertices, differences)
        store(words, i, fixed_depth(z, offset, low, high))


@kernel("void(f8[:,::1],i4[::1],i8,i8,f8,f8)")
def mixed_depth(floats, words, start, end, low, high):
    """Depth words of fragments that carry their triangle's numbers; areas below 2**24."""
    separate_loop()
    n0, n1, n2, reciprocal = floats[R.N0], floats[R.N1], floats[R.N2], floats[R.Z_RECIPROCAL]
    z0, z1, z2, offset = floats[R.Z0], floats[R.Z1], floats[R.Z2], floats[R.Z_OFFSET]
    z10, z20, z21 = floats[R.Z10], floats[R.Z20], floats[R.Z21]
    for i in range(start, end, 16):
        edges = load_f64x16(n0, i), load_f64x16(n1, i), load_f64x16(n2, i)
        depths = load_f64x16(z0, i), load_f64x16(z1, i), load_f64x16(z2, i)
        differences = load_f64x16(z10, i), load_f64x16(z20, i), load_f64x16(z21, i)
        z = depth_of(edges, load_f64x16(reciprocal, i), depths, differences)
        store(words, i, fixed_depth(z, load_f64x16(offset, i), low, high))


@kernel
def spread(column, position, count, value):
    """A triangle's number to the column of its ``count`` fragments, and up to seven more."""
    for i in range(position, position + count, 8):
        store(column, i, f64x8(value))


@kernel(void(float64[:, ::1], int64, int64, DEPTHS, float64))
def spread_depth(floats, position, count, depths, area):
    """A small triangle's numbers for ``mixed_depth``."""
    separate_function()
    (z0, z1, z2), offset, _low, _high = depths
    spread(floats[R.Z_RECIPROCAL], position, count, reciprocal_29(area))
    spread(floats[R.Z0], position, count, z0)
    spread(floats[R.Z1], position, count, z1)
    spread(floats[R.Z2], position, count, z2)
    spread(floats[R.Z10], position, count, depth_difference(z1, z0))
    spread(floats[R.Z20], position, count, depth_difference(z2, z0))
    spread(floats[R.Z21], position, count, depth_difference(z2, z1))
    spread(floats[R.Z_OFFSET], position, count, offset)


class Listed(NamedTuple):
    """A batch's segments: the first ``count`` of rows STARTS, OWNERS and BACKS of ``lists``.

    One array, because a call with three takes longer. Measured: one bilinear texture, 4 per cent (AMD EPYC).
    """

    lists: np.ndarray
    count: int


LISTED = type_of(Listed, int32[:, ::1], int64)


@kernel
def terms_of(q0, q2, v1, d0, d2):
    """(the largest product of factors' highest bits, its exponent in place, the terms' sum to 24 bits) of a
    coordinate, in units of 2**-23 of the first (``interpolate.product_sum``).
    """
    of_products = maximum(power_of(q0) * power_of(d0), power_of(q2) * power_of(d2))
    largest = maximum(maximum(of_products, power_of(v1)), SMALLEST)
    exponent = bits_of_lanes(largest) & EXPONENT
    steps = floats_of_lanes(int64(2069 << 52) - exponent)
    total = (truncated(v1 * steps) + truncated(q0 * d0 * steps)) + truncated(q2 * d2 * steps)
    return largest, exponent, keep_24(total)


@kernel
def sum_beside(q0, q2, own, d0, d2):
    """Whether a guess of how many units of ``terms_of`` make one is right for sixteen fragments; if so, the
    sum of their cut terms.

    own, d0, d2: the vertices' numbers times the guess, ``own`` cut. A guess is a power of two, so q d times
    the guess has the bits of ``terms_of``'s term. The largest product of highest bits is 2**23 exactly where
    the guess is right.
    """
    of_products = maximum(power_of(q0) * power_of(d0), power_of(q2) * power_of(d2))
    holds = all_lanes(maximum(of_products, power_of(own)) == 2.0**23)
    return holds, keep_24((own + truncated(q0 * d0)) + truncated(q2 * d2))


@kernel
def float_of_terms(largest, exponent, total):
    """A coordinate itself."""
    return total * floats_of_lanes(exponent - int64(23 << 52))


@kernel(void(float64[:, ::1], int64, int64, float64[:, :, ::1], int64, int64, types.UniTuple(int32, 3)))
def spread_coordinates(floats, position, count, coordinates, unit, components, vertices):
    """A small triangle's numbers for the mixed segments of ``iterate_texels`` and ``iterate_floats``;
    ``components``: bits 1, 2, 4, 8 for s, t, r, q.
    """
    separate_function()
    i0, i1, i2 = vertices
    for component in range(4):
        if not (components >> component) & 1:
            continue
        at = R.TERMS + 12 * unit + 3 * component
        v1 = coordinates[i1, unit, component]
        spread(floats[at], position, count, v1)
        d0 = coordinate_difference(coordinates[i0, unit, component], v1)
        d2 = coordinate_difference(coordinates[i2, unit, component], v1)
        spread(floats[at + 1], position, count, d0)
        spread(floats[at + 2], position, count, d2)

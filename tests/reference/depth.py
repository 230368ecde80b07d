"""Depth: what a fragment takes from its triangle's vertices, and the word that keeps it."""

import math

from fixedpipe.pipeline.enums import ComparisonFunction, DepthFormat
from tests.reference import fixed

OFFSET_LIMIT = 2**30  # Assumed: far above any depth unit
LARGEST_SINGLE = (2 - 2**-23) * 2.0**127  # Source: IEEE 754
SMALLEST_SINGLE = 2.0**-126  # Source: IEEE 754, the smallest normal number
WEIGHT_BITS = 24  # Measured: DepthFmt_z24 captures
SEED_BITS, REST_BITS, RECIPROCAL_BITS = 14, 30, 29  # Measured: W_buffering and Depth_buffer captures
SUM_BITS = 29  # Measured: DepthFmt_z24 captures, 28 or 30 lose hundreds of pixels


def farthest(depth_format):
    """The depth of the largest word. Measured: DepthFmt captures."""
    return {
        DepthFormat.FIXED_16: 65535.0,
        DepthFormat.FIXED_23: 8388607.0,
        DepthFormat.FIXED_24: 16777215.0,
        DepthFormat.FLOAT_16: 511.9375,
        DepthFormat.FLOAT_24: (2 - 2**-16) * 2.0**127,
    }[depth_format]


def full_scale(depth_format):
    """The largest word of that width. Source: OpenGL 1.2.1 section 2.10.1."""
    return 2 ** abs(depth_format) - 1


def depth_to_units(depth, depth_format):
    """A Clear's word. Source: OpenGL 1.2.1 sections 4.2.3 and 2.13.9 (to nearest); Measured: words of float
    formats are cleared to as they are (DepthFmt FZy captures).
    """
    return math.floor(fixed.clamp(depth, 0.0, 1.0) * full_scale(depth_format) + 0.5)


def flushed(value):
    """0 for what is smaller than a single's smallest normal number. Measured: DepthFmt_z24 FZy captures."""
    return value if abs(value) >= SMALLEST_SINGLE else 0.0


def single(value):
    """A vertex's depth as the chip holds it. Assumed: to nearest, an overflow to the largest."""
    limited = fixed.clamp(value, -LARGEST_SINGLE, LARGEST_SINGLE)
    return flushed(fixed.round_significant_bits(limited, 24))


def vertex_depths(primitives, vertices, state, depth_format, programmed):
    """The three vertices' depths in depth units.

    Source: OpenGL 1.2.1 section 2.10.1, NV_depth_buffer_float; with W buffering clip w (Measured: Depth_Clamp
    captures).
    """
    if state.w_buffering:
        return [single(1.0 / primitives.inverse_w[v]) for v in vertices]
    is_float = depth_format in (DepthFormat.FLOAT_16, DepthFormat.FLOAT_24)
    scale = 1.0 if programmed or is_float else farthest(depth_format)
    return [single(primitives.z[v] * scale) for v in vertices]


def polygon_offset(vertices, area, values, factor):
    """The factor's part of the offset, from depths, which are linear on the screen.

    Measured: for slopes along an axis; Inferred: the maximum norm of others, one of the two that
    OpenGL 1.2.1 allows (equation 3.6).
    """
    if area == 0:  # a polygon that is drawn as lines or points; Assumed: it has no slope
        return 0.0
    (x0, y0), (x1, y1), (x2, y2) = vertices
    v0, v1, v2 = values
    along_x = ((v1 - v0) * float(y2 - y0) - (v2 - v0) * float(y1 - y0)) * 16.0 / float(area)
    along_y = ((v2 - v0) * float(x1 - x0) - (v1 - v0) * float(x2 - x0)) * 16.0 / float(area)
    return factor * max(abs(along_x), abs(along_y))


def limited_offset(offset):
    """Assumed: the limit, far beyond every depth."""
    return fixed.clamp(offset, -(2.0**128), 2.0**128)


def primitive_offset(triangle, depths, polygon, depth_format, fraction):
    """What is added to every depth of a polygon. ``fraction``: whether a fixed format's keeps its own.

    Measured: that the NV2A's does (11 ZBuf captures).
    """
    steep = polygon_offset(triangle.vertices, triangle.area, depths, polygon.offset_factor)
    offset = limited_offset(polygon.offset_units + steep)
    if depth_format > 0 and not fraction:
        offset = float(math.trunc(fixed.clamp(offset, -OFFSET_LIMIT, OFFSET_LIMIT)))
    return offset


def base_vertex(e):
    """The vertex of the largest exponent; of equal ones 1 before 0 before 2.

    Measured: 12 squares whose depths are one vertex's (DepthFmt_z24 FZy captures).
    """
    exponents = [math.frexp(e_i)[1] if e_i else -10000 for e_i in e]
    return max((1, 0, 2), key=lambda i: exponents[i])


def matters(state):
    """Whether a state's fragments have depths. Source: OpenGL 1.2.1 section 4.1.5."""
    test, limits = state.depth_test, state.depth_clamp
    tests = test is not None and (test.function != ComparisonFunction.ALWAYS or test.write)
    return tests or (limits is not None and limits.cull)


def difference(a, b):
    """Of two depths. Measured: as ``flushed``."""
    return flushed(fixed.keep_significant_bits(a - b, WEIGHT_BITS))


def sum_of(base, products):
    """A depth and two products, cut 29 bits below the largest's highest bit. Measured: DepthFmt captures."""
    largest = max(abs(term) for term in (base, *products))
    if largest == 0.0:
        return 0.0
    unit = 2.0 ** (math.frexp(largest)[1] - SUM_BITS)
    first, second = (math.trunc(product / unit) * unit for product in products)
    return (base + first) + second


def kept(depth):
    """What an offset is added to. Measured: ZBuf captures with a slope, which lose 1470 of 307200 without."""
    return fixed.keep_significant_bits(depth, WEIGHT_BITS)


def iterate_w(weights, w):
    """A fragment's depth in W buffering: vertex 1's w, plus the others' weighted differences.

    Measured: WBuf24D_LargeZ 307200 of 307200 depths, all depths of 36 of 37 captures without a slope.
    """
    return sum_of(w[1], [weights.q0 * difference(w[0], w[1]), weights.q2 * difference(w[2], w[1])])


def reciprocal(total):
    """1/total, cut to 29 significant bits before and after: fourteen bits of it, and one Newton step.

    Measured: 32 of 33 sums that show in depth buffers (docs/numbers.md, N5.2).
    """
    fraction, exponent = math.frexp(total)
    m = int(math.ldexp(fraction, RECIPROCAL_BITS))  # [2^28, 2^29), the mantissa times 2^28
    one = 1 << (RECIPROCAL_BITS - 1 + SEED_BITS)  # of m and the seed
    seed = (2 * one + m) // (2 * m)  # the nearest; no quotient lies in the middle
    rest, dropped = one - m * seed, RECIPROCAL_BITS - 1 + SEED_BITS - REST_BITS
    nearest = (abs(rest) + (1 << dropped - 1) - 1 >> dropped) * (1 if rest > 0 else -1)
    best = fixed.keep_significant_bits(float(seed * ((1 << REST_BITS) + nearest)), RECIPROCAL_BITS)
    return math.ldexp(best, -SEED_BITS - REST_BITS + 1 - exponent)


def iterate(n, depths):
    """A fragment's depth from its edge values: the base vertex's, plus the others' weighted differences.

    Measured: 90676 of 90676 and 887880 of 887880 pixels (DepthFmt_z24, ZBuf24D_FloorQuad captures).
    """
    e = [fixed.keep_significant_bits(float(n_i), WEIGHT_BITS) for n_i in n]
    inverse = reciprocal((e[0] + e[1]) + e[2])
    base = base_vertex(e)
    products = []
    for i in range(3):
        if i != base:
            weight = fixed.keep_significant_bits(e[i] * inverse, WEIGHT_BITS)
            products.append(weight * difference(depths[i], depths[base]))
    return sum_of(depths[base], products)


def word(depth, depth_format, limits):
    """The depth buffer's word of a fragment's depth; None where the limits end the fragment.

    Measured: DepthFmt captures in all four formats.
    """
    low, high = 0.0, farthest(depth_format)
    if limits is not None:
        low, high = limits.minimum, high if limits.maximum is None else limits.maximum
        if limits.cull and not low <= depth <= high:
            return None
    depth = fixed.clamp(fixed.clamp(depth, low, high), 0.0, farthest(depth_format))
    if depth_format > 0:
        return math.floor(depth)
    exponent_bias, fraction_bits = (7, 12) if depth_format == DepthFormat.FLOAT_16 else (127, 16)
    mantissa, exponent = math.frexp(depth)  # mantissa in [0.5, 1)
    biased = exponent - 1 + exponent_bias
    if depth == 0.0 or biased < 1:
        return 0
    return (biased << fraction_bits) + math.floor((2 * mantissa - 1) * 2**fraction_bits)

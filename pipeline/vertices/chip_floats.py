"""The floats of the vertex hardware, on columns (docs/numbers.md, section 2).

The transform unit, which also runs vertex programs, keeps 24 significant bits; the lighting unit keeps 14.
Both round toward zero, and compute reciprocals from a small table and Newton steps. A column is float64,
which holds such numbers exactly. Their range is single precision's, without denormal numbers.

Source: envytools (nvhw/xf.c, nvhw/pgraph_celsius_xfrm.c), whose model its tests compare with the chips.
"""

from math import isqrt

import numpy as np

from fixedpipe.pipeline.vertices.arithmetic import ONE, ZERO
from fixedpipe.raster.floats import LEAST_SINGLE, keep_significant_bits
from fixedpipe.raster.primitives import chip_floats as seeds
from fixedpipe.raster.primitives.chip_floats import LIGHTING_BITS, SUM_GUARD_BITS, TRANSFORM_BITS

# Seeds of 7 bits, as integers.
LIGHTING_RECIPROCALS = seeds.LIGHTING_RECIPROCALS.astype(np.uint64)
TRANSFORM_RECIPROCALS = seeds.TRANSFORM_RECIPROCALS.astype(np.uint64)
TRANSFORM_ROOTS = seeds.TRANSFORM_ROOTS.astype(np.uint64)
# Measured: truncated, like the lighting unit's reciprocals (Point_params Detailed_FF).
LIGHTING_ROOTS = np.array(
    [isqrt((16384 * scale) // (129 + 2 * k)) for scale in (128, 64) for k in range(64)], np.uint64
)


_SMALLEST, _LIMIT = np.float64(LEAST_SINGLE), np.float64(2.0**128)


def _in_range(column, significant_bits):
    """Replace numbers that are too small by 0, and finite ones that are too large by the largest number."""
    size = np.abs(column)
    largest = np.float64((2.0 - 2.0 ** (1 - significant_bits)) * 2.0**127)
    column = np.where((size >= _LIMIT) & np.isfinite(column), np.copysign(largest, column), column)
    return np.where(size < _SMALLEST, ZERO, column)


def single(column):
    """The nearest single-precision number, as the units read registers and vertices."""
    rounded = np.asarray(column, np.float64).astype(np.float32).astype(np.float64)
    return np.where(np.abs(rounded) < _SMALLEST, ZERO, rounded)


def to_lighting(column):
    """Round a single-precision number as it enters the lighting unit.

    The unit adds half of its last place and drops the lower bits. Where the eight bits above are all ones, it
    drops the lower bits without the addition.
    """
    bits = np.asarray(column, np.float64).astype(np.float32).view(np.uint32)
    carried = np.where((bits >> np.uint32(10)) & np.uint32(255) != 255, bits + np.uint32(512), bits)
    return (carried & np.uint32(0xFFFFFC00)).view(np.float32).astype(np.float64)


def truncated(column, significant_bits):
    """The column with its mantissa cut to this many significant bits, toward zero."""
    values = np.asarray(column, np.float64)
    return np.where(np.isfinite(values), keep_significant_bits(values, significant_bits), values)


def product(a, b, significant_bits):
    """The product of a and b, toward zero; zero times infinity is 0, and an infinite product is positive."""
    exact = np.where(((a == 0) & np.isinf(b)) | (np.isinf(a) & (b == 0)), ZERO, a * b)
    exact = np.where(np.isinf(exact), np.inf, exact)
    return _in_range(truncated(exact, significant_bits), significant_bits)


def transform_product(a, b):
    """A vertex program's product: an infinite product keeps its sign, 0 times anything is 0, NaN has no sign.

    Source: NV_vertex_program; envytools (fp32_mul). Measured: Attrib_float.
    """
    exact = np.where((a == 0) | (b == 0), ZERO, a * b)
    exact = np.where(np.isnan(exact), np.nan, exact)
    return _in_range(truncated(exact, TRANSFORM_BITS), TRANSFORM_BITS)


def total(terms, significant_bits, guard_bits=SUM_GUARD_BITS):
    """The sum of the terms; an infinite sum is positive.

    Each term is cut, toward zero, at ``guard_bits`` below the last bit of the largest term. The exact sum of
    the cut terms is then cut to ``significant_bits``.
    """
    terms = [np.asarray(term, np.float64) for term in terms]
    largest = ZERO
    for term in terms:
        largest = np.maximum(largest, np.abs(term))
    _, exponent = np.frexp(np.where(np.isfinite(largest), largest, ONE))
    unit = np.ldexp(ONE, exponent - significant_bits - guard_bits)
    finite = truncated(sum(np.trunc(term / unit) for term in terms) * unit, significant_bits)
    return np.where(np.isfinite(largest), _in_range(finite, significant_bits), np.abs(sum(terms)))


_NO_BOUND = -1000  # below the exponents of products of single-precision numbers


def _where_finite(result, a, b, c, significant_bits):
    """``result`` cut to its bits, or, where a number is infinite or NaN, a product followed by a sum."""
    finite = np.isfinite(a) & np.isfinite(b) & np.isfinite(c)
    result = _in_range(truncated(np.where(finite, result, ZERO), significant_bits), significant_bits)
    return np.where(finite, result, total((product(a, b, significant_bits), c), significant_bits, 0))


def _bound(column):
    """The least e with |column| < 2^e; for 0, infinity and NaN a value below every number's."""
    return np.where(np.isfinite(column) & (column != 0), np.frexp(column)[1], _NO_BOUND)


def _multiple(column, exponent):
    """The column cut, toward zero, to multiples of 2^exponent."""
    unit = np.ldexp(ONE, exponent)
    return np.trunc(column / unit) * unit


def multiply_add(a, b, c, significant_bits):
    """a b + c, with the terms aligned before the multiplication.

    The place of the product is the sum of the bounds of a and b. The place of c is one above its own bound.
    If the product's place is lower, a loses the bits between the places; if c's is lower, c loses them.
    Nothing more is lost before the result is cut.
    """
    a, b, c = (np.asarray(x, np.float64) for x in (a, b, c))
    lower = _bound(c) + 1 - (_bound(a) + _bound(b))
    lower = np.where((a == 0) | (b == 0) | (c == 0), 0, lower)
    kept_a, kept_c = (
        _multiple(x, _bound(x) - significant_bits + np.maximum(lost, 0))
        for x, lost in ((a, lower), (c, -lower))
    )
    return _where_finite(kept_a * b + kept_c, a, b, c, significant_bits)


def add_product(a, b, c, significant_bits):
    """a b + c: the exact product and c are cut one bit below the last bit of the larger, then added."""
    a, b, c = (np.asarray(x, np.float64) for x in (a, b, c))
    last = np.maximum(_bound(a * b), _bound(c)) - significant_bits - 1
    return _where_finite(_multiple(a * b, last) + _multiple(c, last), a, b, c, significant_bits)


def _mantissa(column, bits):
    """(m, e) with finite |column| = m 2^e and m in [1, 2): m as a uint64 integer of ``bits`` bits, and e."""
    fraction, exponent = np.frexp(np.where(np.isfinite(column) & (column != 0), np.abs(column), ONE))
    return np.trunc(np.ldexp(fraction, bits)).astype(np.uint64), exponent - 1


def _with_limits(result, column):
    """``result`` with the column's sign, except that 1/0 is positive infinity and 1/infinity is 0."""
    result = np.where(result < _SMALLEST, ZERO, np.copysign(result, column))
    result = np.where(column == 0, np.inf, np.where(np.isinf(column), ZERO, result))
    return np.where(np.isnan(column), np.nan, result)


def lighting_reciprocal(column):
    """1 / column in the lighting unit: one Newton step, 13 bits; 1/1 is 8191/8192."""
    m, exponent = _mantissa(column, LIGHTING_BITS)
    seed = LIGHTING_RECIPROCALS[(m >> np.uint64(7)) & np.uint64(63)]
    better = ((np.uint64(1 << 21) - seed * m) * seed) >> np.uint64(14)
    return _with_limits(np.ldexp(better.astype(np.float64), -13 - exponent), column)


def transform_reciprocal(column):
    """1 / column in the transform unit: two Newton steps, 24 bits; exact for powers of two."""
    m, exponent = _mantissa(column, TRANSFORM_BITS)
    seed = TRANSFORM_RECIPROCALS[(m >> np.uint64(17)) & np.uint64(63)]
    better = ((np.uint64(1 << 31) - seed * m) * seed) >> np.uint64(24)
    best = ((np.uint64(1 << 37) - better * m) * better) >> np.uint64(25)
    best = np.where(m == np.uint64(1 << 23), np.uint64(1 << 24), best)
    return _with_limits(np.ldexp(best.astype(np.float64), -24 - exponent), column)


def transform_inverse_root(column):
    """1 / sqrt(|column|) in the transform unit: two Newton steps, 24 bits."""
    m, exponent = _mantissa(column, TRANSFORM_BITS)
    odd = (exponent & 1).astype(np.uint64)
    seed = TRANSFORM_ROOTS[((m >> np.uint64(17)) & np.uint64(63)) + odd * np.uint64(64)]
    x = m << odd
    better = ((np.uint64(3 << 37) - seed * seed * x) * seed) >> np.uint64(32)
    best = ((np.uint64(3 << 49) - better * better * x) * better) >> np.uint64(39)
    root = np.ldexp(best.astype(np.float64), -24 - (exponent >> 1))
    return _with_limits(root, np.abs(column))


def lighting_inverse_root(column):
    """1 / sqrt(|column|) for point sizes, from the lighting unit's table without a Newton step: 7 bits."""
    m, exponent = _mantissa(column, LIGHTING_BITS)
    odd = (exponent & 1).astype(np.uint64)
    seed = LIGHTING_ROOTS[((m >> np.uint64(7)) & np.uint64(63)) + odd * np.uint64(64)]
    return _with_limits(np.ldexp(seed.astype(np.float64), -7 - (exponent >> 1)), np.abs(column))


def transform_dot(a, b):
    """The transform unit's dot product of vectors of three or four columns."""
    return total([product(x, y, TRANSFORM_BITS) for x, y in zip(a, b, strict=True)], TRANSFORM_BITS)


def transform_matrix(matrix, columns):
    """Matrix times column vector in the transform unit, which reads both in single precision."""
    columns = [single(column) for column in columns]
    return [transform_dot(columns, [single(np.float64(m)) for m in row]) for row in matrix]

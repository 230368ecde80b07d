"""The floats of the vertex hardware, one number at a time, for lighting's loops (docs/numbers.md).

``fixedpipe.pipeline.vertices.chip_floats`` computes the same on columns and says where the rules are from.
Numbers have single precision's range and no denormal ones. All steps are selections without a branch, in
float64, which holds every integer that occurs. So a loop over them is vectorized.
"""

from math import isqrt

import numpy as np
from numba import float32, float64

from fixedpipe.raster.floats import EXPONENT, EXPONENT_BIAS, FRACTION_BITS, LEAST_SINGLE, SINGLE_BITS, kept
from fixedpipe.raster.kernel import bits_of, float_of, kernel

TRANSFORM_BITS, LIGHTING_BITS = SINGLE_BITS, 14  # significant bits
SUM_GUARD_BITS = 5  # a sum keeps this many bits below the last bit of its largest term

# Seeds of 7 bits. For 1/x, x in [1, 2), they are the values at the middle of each 64th. For 1/sqrt(x), x in
# [1, 2) comes first, then x in [2, 4). Source: envytools' tables are these values, truncated or rounded.
LIGHTING_RECIPROCALS = np.array([16384 // (129 + 2 * k) for k in range(64)], np.float64)
TRANSFORM_RECIPROCALS = np.array([(32768 // (129 + 2 * k) + 1) // 2 for k in range(64)], np.float64)
_ROOTS = [(isqrt((65536 * scale) // (129 + 2 * k)) + 1) // 2 for scale in (128, 64) for k in range(64)]
TRANSFORM_ROOTS = np.minimum(np.array(_ROOTS, np.float64), 127.0)

_INFINITY, _LIMIT = float("inf"), 2.0**128
_SIGN = -1 << 63
_BELOW_LIMIT = (EXPONENT_BIAS + 128 << FRACTION_BITS) - 1  # the bits of the largest float64 below _LIMIT
_SEED_PLACE = FRACTION_BITS - 6  # of the six bits of a fraction that choose a seed
_ENTERED = FRACTION_BITS - LIGHTING_BITS + 1  # bits that a number loses as it enters the lighting unit


@kernel(in_loops=True)
def in_range(x, bits):
    """A number cut, toward zero, to its significant bits. Too small, it is 0; finite and too large, it is the
    largest number.
    """
    mask = kept_bits(bits)
    cut = float_of(bits_of(x) & mask)
    largest = float_of(_BELOW_LIMIT & mask)
    size = abs(cut)
    signed = largest if cut > 0.0 else -largest
    cut = signed if (size >= _LIMIT) & (size < _INFINITY) else cut
    return 0.0 if size < LEAST_SINGLE else cut


@kernel(in_loops=True)
def kept_bits(bits):
    """``fixedpipe.raster.floats.kept`` of LIGHTING_BITS or TRANSFORM_BITS."""
    return _LIGHTING_MASK if bits == LIGHTING_BITS else _TRANSFORM_MASK


_LIGHTING_MASK, _TRANSFORM_MASK = kept(LIGHTING_BITS), kept(TRANSFORM_BITS)


@kernel(in_loops=True)
def single(x):
    """The nearest single-precision number."""
    rounded = float64(float32(x))
    return 0.0 if abs(rounded) < LEAST_SINGLE else rounded


@kernel(in_loops=True)
def to_lighting(x):
    """A single-precision number as it enters the lighting unit."""
    bits = bits_of(x)
    carried = bits if (bits >> _ENTERED) & 255 == 255 else bits + (1 << (_ENTERED - 1))
    return float_of(carried & (-1 << _ENTERED))


@kernel(in_loops=True)
def product(a, b, bits):
    """The product; zero times infinity is 0, and an infinite product is positive."""
    exact = a * b
    exact = 0.0 if (exact != exact) & (a == a) & (b == b) else exact
    exact = _INFINITY if abs(exact) == _INFINITY else exact
    return in_range(exact, bits)


@kernel(in_loops=True)
def multiple(x, shift):
    """X cut, toward zero, to a multiple of ``shift`` / 2^52, a power of two. |x| is at most ``shift``."""
    size = abs(x)
    near = (size + shift) - shift
    cut = near - shift * 2.0**-FRACTION_BITS if near > size else near
    return float_of(bits_of(cut) | (bits_of(x) & _SIGN))


@kernel(in_loops=True)
def shift_below(size, bits):
    """``multiple``'s shift that keeps so many bits of a size."""
    return float_of((bits_of(size) & EXPONENT) + ((FRACTION_BITS + 1 - bits) << FRACTION_BITS))


@kernel(in_loops=True)
def larger(a, b):
    """The larger of two sizes."""
    return a if a > b else b


@kernel(in_loops=True)
def total2(a, b, bits, guard):
    """The sum; each term is cut ``guard`` bits below the last bit of the largest."""
    plain = a + b
    shift = shift_below(larger(abs(a), abs(b)), bits + guard)
    cut = in_range(multiple(a, shift) + multiple(b, shift), bits)
    return cut if abs(plain) < _INFINITY else abs(plain)


@kernel(in_loops=True)
def total3(a, b, c, bits):
    """``total2`` of three terms."""
    plain = (a + b) + c
    shift = shift_below(larger(larger(abs(a), abs(b)), abs(c)), bits + SUM_GUARD_BITS)
    cut = in_range((multiple(a, shift) + multiple(b, shift)) + multiple(c, shift), bits)
    return cut if abs(plain) < _INFINITY else abs(plain)


@kernel(in_loops=True)
def total4(a, b, c, d, bits):
    """``total2`` of four terms."""
    plain = ((a + b) + c) + d
    shift = shift_below(larger(larger(abs(a), abs(b)), larger(abs(c), abs(d))), bits + SUM_GUARD_BITS)
    sums = (multiple(a, shift) + multiple(b, shift)) + (multiple(c, shift) + multiple(d, shift))
    cut = in_range(sums, bits)
    return cut if abs(plain) < _INFINITY else abs(plain)


@kernel(in_loops=True)
def dot3(a0, a1, a2, b0, b1, b2, bits):
    """The dot product of two vectors."""
    return total3(product(a0, b0, bits), product(a1, b1, bits), product(a2, b2, bits), bits)


@kernel(in_loops=True)
def dot4(a, b, bits):
    """The dot product of two vectors of four components."""
    first, second = product(a[0], b[0], bits), product(a[1], b[1], bits)
    return total4(first, second, product(a[2], b[2], bits), product(a[3], b[3], bits), bits)


@kernel(in_loops=True)
def finite_add_product(a, b, c):
    """a b + c in the lighting unit, of finite numbers."""
    exact = a * b
    shift = shift_below(larger(abs(exact), abs(c)), LIGHTING_BITS + 1)
    return in_range(multiple(exact, shift) + multiple(c, shift), LIGHTING_BITS)


@kernel(in_loops=True)
def place_of(x):
    """The least e with |x| < 2^e, of a finite number that is not 0."""
    return ((bits_of(x) & EXPONENT) >> FRACTION_BITS) - 1022


@kernel(in_loops=True)
def finite_multiply_add(a, b, c):
    """a b + c in the lighting unit, of finite numbers, with the terms aligned before the multiplication."""
    of_a, of_c = place_of(a), place_of(c)
    lower = of_c + 1 - (of_a + place_of(b))
    lower = 0 if (a == 0.0) | (b == 0.0) | (c == 0.0) else lower
    places = EXPONENT_BIAS + FRACTION_BITS - LIGHTING_BITS
    shift_a = float_of((of_a + max(lower, 0) + places) << FRACTION_BITS)
    shift_c = float_of((of_c + max(-lower, 0) + places) << FRACTION_BITS)
    return in_range(multiple(a, shift_a) * b + multiple(c, shift_c), LIGHTING_BITS)


@kernel(in_loops=True)
def product_and_sum(a, b, c):
    """a b + c in the lighting unit, where one of them is infinite or NaN."""
    return total2(product(a, b, LIGHTING_BITS), c, LIGHTING_BITS, 0)


@kernel(in_loops=True)
def mantissa(x, bits):
    """The mantissa of a finite number that is not 0, cut to so many bits, as an integer, in float64."""
    fraction = bits_of(x) & kept_bits(bits) & ((1 << FRACTION_BITS) - 1)
    return float_of(fraction | ((1022 + bits) << FRACTION_BITS))


@kernel(in_loops=True)
def whole(x):
    """The largest integer not above x, 0 <= x < 2^52."""
    return multiple(x, 2.0**FRACTION_BITS)


@kernel(in_loops=True)
def power_of_two(e):
    """2^e as float64."""
    return float_of((e + EXPONENT_BIAS) << FRACTION_BITS)


@kernel(in_loops=True)
def with_limits(result, x):
    """``result`` with the sign of x, except that 1/0 is positive infinity and 1/infinity is 0."""
    result = 0.0 if result < LEAST_SINGLE else float_of(bits_of(result) | (bits_of(x) & _SIGN))
    result = _INFINITY if x == 0.0 else result
    result = 0.0 if abs(x) == _INFINITY else result
    return result if x == x else x


@kernel(in_loops=True)
def lighting_reciprocal(x):
    """1 / x in the lighting unit: one Newton step, 13 bits."""
    m, seed = mantissa(x, LIGHTING_BITS), LIGHTING_RECIPROCALS[(bits_of(x) >> _SEED_PLACE) & 63]
    better = whole((2.0**21 - seed * m) * seed * 2.0**-14)
    return with_limits(better * power_of_two(-12 - place_of(x)), x)


@kernel(in_loops=True)
def transform_reciprocal(x):
    """1 / x in the transform unit: two Newton steps, 24 bits."""
    m, seed = mantissa(x, TRANSFORM_BITS), TRANSFORM_RECIPROCALS[(bits_of(x) >> _SEED_PLACE) & 63]
    better = whole((2.0**31 - seed * m) * seed * 2.0**-24)
    best = whole((2.0**37 - better * m) * better * 2.0**-25)
    best = 2.0**24 if m == 2.0**23 else best
    return with_limits(best * power_of_two(-23 - place_of(x)), x)


@kernel(in_loops=True)
def transform_inverse_root(x):
    """1 / sqrt(|x|) in the transform unit: two Newton steps, 24 bits."""
    exponent = place_of(x) - 1
    odd = exponent & 1
    seed = TRANSFORM_ROOTS[((bits_of(x) >> _SEED_PLACE) & 63) + (odd << 6)]
    m = mantissa(x, TRANSFORM_BITS)
    m = m + m if odd == 1 else m
    better = whole((3 * 2.0**37 - seed * seed * m) * seed * 2.0**-32)
    rest = 3 * 2.0**49 - better * better * m
    high = whole(rest * 2.0**-26)  # in two parts: the product has up to 64 bits
    low = whole((rest - high * 2.0**26) * better * 2.0**-26)
    best = whole((high * better + low) * 2.0**-13)
    return with_limits(best * power_of_two(-24 - (exponent >> 1)), abs(x))

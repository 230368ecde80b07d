"""Number formats: the few scalar rules that narrow, round or truncate. Inlined into the loops that call them.

Values are widened to int32 or float64 when loaded; only these functions and explicit casts make them
narrower.
"""

import math

import numpy as np
from numba import int32, int64

from fixedpipe.raster import codes as C
from fixedpipe.raster import floats
from fixedpipe.raster.float_depths import FLOAT_16, FLOAT_24
from fixedpipe.raster.kernel import bits_of, float_of, kernel

EXPONENT = int64(floats.EXPONENT)
FRACTION = int64(floats.FRACTION)
KEEP_12, KEEP_14, KEEP_15, KEEP_24, KEEP_29 = (
    int64(floats.kept(bits)) for bits in (12, 14, 15, 24, 29)
)  # significant bits
# What rounds a pattern to so many bits; of twelve, a half and 2**-9 more of the last (``reciprocal_24``).
HALF_OF_15, HALF_OF_14, HALF_OF_12 = int64(1 << 37), int64(1 << 38), int64((1 << 40) + (1 << 32))
# The last bit of a Newton step's remainder, in ``reciprocal_24`` and in ``reciprocal_29``.
REST_OF_24, REST_OF_29 = 2.0**-24, 2.0**-30


@kernel
def one_of(bits):
    """The value of one of components of so many bits."""
    return int32(int32(int32(1) << bits) - int32(1))


@kernel
def divide(n, bits):
    """``rn(n) = floor(n/one + 1/2)`` of an int32 by the value of one of ``bits`` bits, 7 to 12; |n| <= 24 *
    4**bits (two dot products, times four, stay below).

    Inferred: rounding to nearest, from the NV2A's final combiner and blender (docs/numbers.md, section 8).
    With u = n + 2**(bits - 1) + one * 2**(bits + 5), which is not negative, the division is
    ``(u + ((u + (u >> bits)) >> bits)) >> bits``, exact for u up to 2**(3 * bits - 1).
    """
    b, far = int32(bits), int32(int32(1) << int32(bits + 5))
    u = int32(n + int32(int32(int32(1) << int32(bits - 1)) + int32(one_of(b) * far)))
    return int32(int32(int32(u + int32(int32(u + int32(u >> b)) >> b)) >> b) - far)


@kernel
def clamp(value, low, high):
    """Clamp an int32."""
    return min(max(value, low), high)


@kernel
def truncate_24(value):
    """A float64 truncated to 24 significant bits.

    Measured: colour weights and the reciprocal of their sum (Depth_buffer and Alpha_func captures).
    """
    return float_of(bits_of(value) & KEEP_24)


@kernel
def power_below(value):
    """The largest power of two that is not above a float64 (0 for 0): its exponent alone."""
    return float_of(bits_of(value) & EXPONENT)


@kernel
def newton_step(total, x, last):
    """x + x (1 - total x), with the remainder rounded to a multiple of ``last``, halves toward zero."""
    rest = (1.0 - total * x) * (1.0 / last)
    return x + x * ((np.ceil(rest - 0.5) if rest > 0.0 else np.floor(rest + 0.5)) * last)


@kernel
def seed_29(total):
    """What ``reciprocal_29`` starts from: 1/total to the nearest 14 bits, halves up."""
    return float_of((bits_of(1.0 / total) + HALF_OF_14) & KEEP_14)


@kernel
def reciprocal_29(total):
    """1/total, cut to 29 significant bits before and after, as the chip makes it for depths: fourteen bits
    of the reciprocal and one Newton step, whose remainder is rounded to 2**-30, halves toward zero.

    Measured: 32 of the 33 sums that show in W_buffering's, Depth_buffer's and
    Depth_buffer_fixed_function's depths (docs/numbers.md, N5.2). The other, 765952, would start from the
    fourteen bits below. With a remainder of 29 or 31 bits, one or two sums more are missed.
    """
    total = float_of(bits_of(total) & KEEP_29)
    return float_of(bits_of(newton_step(total, seed_29(total), REST_OF_29)) & KEEP_29)


@kernel
def reciprocal_24(total):
    """1/total to 24 significant bits as the chip makes it: twelve bits of the reciprocal of its first
    fifteen, and one Newton step, whose remainder is rounded to 2**-24, halves toward zero; then it is cut.

    Measured: 1541 of 1552 sums of weights whose reciprocal shows in a picture (FloorQuad's texels, Fog_gen,
    DotZW and others; the eleven have other open bits), 1502 with a truncated reciprocal, 1305 with one to
    nearest. Inferred: how the twelve bits are rounded; to nearest, two of 228 sums that tell are not met.
    """
    near = float_of((bits_of(total) + HALF_OF_15) & KEEP_15)
    x = float_of((bits_of(1.0 / near) + HALF_OF_12) & KEEP_12)
    return truncate_24(newton_step(total, x, REST_OF_24))


@kernel
def signed_reciprocal(value):
    """``reciprocal_24`` of a number of any sign: of 0 infinity, of infinity 0, and NaN stays."""
    size = abs(value)
    result = reciprocal_24(size) if size < np.inf else (0.0 if size == np.inf else size)
    result = result if size != 0.0 else np.inf
    return result if value >= 0.0 else 0.0 - result


@kernel
def projected(coordinate, q):
    """A texture coordinate by q as the chip makes it: times its reciprocal, cut to 24 bits; a q of 0 counts
    as LEAST_Q.

    Measured: Texgen_with_texture_matrix, three captures that a quotient misses (docs/numbers.md, N6.1).
    """
    fraction, exponent = math.frexp(q if q != 0.0 else floats.LEAST_Q)
    return math.ldexp(truncate_24(coordinate * signed_reciprocal(fraction)), -exponent)


@kernel
def float_depth(number_format):
    """The FloatDepth of DEPTH_FLOAT_16 or DEPTH_FLOAT_24."""
    return FLOAT_16 if number_format == C.DEPTH_FLOAT_16 else FLOAT_24


@kernel
def step_24(value):
    """(2**(e - 23), 2**(23 - e)) for a positive float64 in [2**e, 2**(e + 1)), at least SMALLEST: the last of
    24 bits, and how many of it make one.
    """
    exponent = bits_of(value) & EXPONENT
    # Both differences are int64: LLVM would take one that wraps as a promise, and what follows from it.
    steps = float_of((int64(2046 << 52) - exponent) + int64(23 << 52))
    return float_of(exponent - int64(23 << 52)), steps

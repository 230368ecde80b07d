"""Number formats: the few scalar rules that narrow, round or truncate. Inlined into the loops that call them.

Values are widened to int32 or float64 when loaded; only these functions and explicit casts make them
narrower.
"""

from numba import int32, int64

from fixedpipe.raster.kernel import bits_of, float_of, kernel

_LOW_24 = int64(-1 << 24)  # 29 significant bits
_EXPONENT = int64(0x7FF << 52)
_FRACTION = int64((1 << 52) - 1)  # a float64's mantissa without its leading one: 0 in a power of two
_LOW_29 = int64(-1 << 29)  # keeps sign, exponent and 23 mantissa bits: 24 significant bits


@kernel
def divide_255(n):
    """``rn(n) = floor(n/255 + 1/2)`` of an int32, |n| <= 2**21 (two dot products, times four, stay below).

    Inferred: rounding to nearest, from the NV2A's final combiner and blender (docs/numbers.md, section 8).
    With u = n + 128 + 255*8192 the division is ``(u + ((u + (u >> 8)) >> 8)) >> 8``, exact for u up to 2**23.
    """
    u = int32(n + int32(128 + 255 * 8192))
    return int32(
        int32(int32(u + int32(int32(u + int32(u >> int32(8))) >> int32(8))) >> int32(8)) - int32(8192)
    )


@kernel
def clamp(value, low, high):
    """Clamp an int32."""
    return min(max(value, low), high)


@kernel
def is_power_of_two(value):
    """Whether a positive float64 is 2**k."""
    return (bits_of(value) & _FRACTION) == int64(0)


@kernel
def truncate_24(value):
    """A float64 truncated to 24 significant bits.

    Measured: colour weights and the reciprocal of their sum (Depth_buffer and Alpha_func captures).
    """
    return float_of(bits_of(value) & _LOW_29)


@kernel
def power_below(value):
    """The largest power of two that is not above a float64 (0 for 0): its exponent alone."""
    return float_of(bits_of(value) & _EXPONENT)


@kernel
def reciprocal_29(inverse):
    """1/D to 29 significant bits, from ``inverse``, the float64 nearest to it: a power of two is exact,
    anything else is reduced by 2**21 units of the float64 and truncated.

    Measured: 90676 of 90676 and 887880 of 887880 pixels (DepthFmt_z24, ZBuf24D_FloorQuad captures), which
    allow for 1.4 to 4.3 million units; simply truncated, 28 bits lose 32 pixels and 29 bits 34.
    """
    return float_of((bits_of(inverse) - int64(0 if is_power_of_two(inverse) else 1 << 21)) & _LOW_24)


SMALLEST = 2.0**-100  # of the largest term of a sum: below it nothing is told from zero


@kernel
def step_24(value):
    """(2**(e - 23), 2**(23 - e)) for a positive float64 in [2**e, 2**(e + 1)), at least SMALLEST: the last of
    24 bits, and how many of it make one.
    """
    exponent = bits_of(value) & _EXPONENT
    return float_of(exponent - int64(23 << 52)), float_of(int64(2069 << 52) - exponent)

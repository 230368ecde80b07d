"""Number formats: whole numbers in units of 1/one, real numbers, floats that keep few significant bits.

``one`` is what stands for 1.0: 255 for bytes, 2^n - 1 for n bits, REAL for real numbers, which are not
rounded.
"""

import math
import struct
from fractions import Fraction

REAL = Fraction(1)


def divide(n, one=255):
    """rn: n/one to the nearest integer, of an integer n; every 2^n - 1 is odd, so that there are no ties.

    Measured: the final combiner and the blender of NV2A (136923 and 176504832 pixels); Assumed: other widths.
    """
    return n if one == 1 else (2 * n + one) // (2 * one)


def half(one):
    """One half: what biases subtract, and where a mux changes over. Inferred: 128 of 255."""
    return (one + 1) // 2 if one > 1 else one / 2


def clamp(value, low, high):
    """Source: OpenGL 1.2.1 section 2.13.8, to any interval."""
    return low if value < low else high if value > high else value


def color_code(component, one=255):
    """A color component, 1.0 = full, in units of 1/one: clamped, then to nearest.

    Source: OpenGL 1.2.1 section 2.13.9.
    """
    component = clamp(component, 0.0, 1.0)
    return Fraction(component) if one == 1 else math.floor(one * component + 0.5)


def color_codes(color, one=255):
    """Source: OpenGL 1.2.1 section 2.13.9, for every component of a color."""
    return [color_code(component, one) for component in color]


def converted(value, one, other):
    """Units of 1/one as units of 1/other, to nearest, halves up. Source: OpenGL 1.2.1 section 2.13.9."""
    return value if one == other else (2 * value * other + one) // (2 * one)


def lerp(p, q, fraction, bits=8):
    """Two codes blended by a fraction of so many bits, to a code.

    Measured: bilinear and trilinear captures of NV2A (349524 and 61440 pixels); Assumed: other widths.
    """
    return (p * ((1 << bits) - fraction) + q * fraction + (1 << bits >> 1)) >> bits


def to_pattern(value):
    """The 64 bits of a float64 as an integer. Source: IEEE 754."""
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def from_pattern(pattern):
    """The float64 that has these 64 bits. Source: IEEE 754."""
    return struct.unpack("<d", struct.pack("<Q", pattern))[0]


def to_single(value):
    """The nearest number of single precision, infinite beyond. Source: IEEE 754."""
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)


def keep_significant_bits(value, bits):
    """A float64 whose magnitude is cut to ``bits`` significant bits.

    Measured: NV2A's weights keep 24, its vertex colors 14 (Depth_buffer, Line_width captures).
    """
    dropped = 53 - bits
    return from_pattern(to_pattern(value) >> dropped << dropped)


def round_significant_bits(value, bits):
    """A float64 to the nearest of ``bits`` significant bits, ties to even. Source: IEEE 754."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(round(math.ldexp(mantissa, bits)), exponent - bits)


def floor_float(value):
    """Floor of a float as a float; NaN and infinities stay. Source: IEEE 754 (round toward negative)."""
    return float(math.floor(value)) if math.isfinite(value) else value

"""Number formats: bytes with 255 = 1.0, 9-bit signed registers, floats that keep few significant bits."""

import math
import struct


def divide_by_255(n):
    """rn: n/255 to the nearest integer; n is an integer and 255 is odd, so that there are no ties.

    Measured: the final combiner and the blender of NV2A (136923 and 176504832 pixels).
    """
    return (2 * n + 255) // 510


def clamp(value, low, high):
    """Source: OpenGL 1.2.1 section 2.13.8, to any interval."""
    return low if value < low else high if value > high else value


def color_to_byte(component):
    """A color component, 1.0 = full, as a byte: clamped, then to nearest.

    Source: OpenGL 1.2.1 section 2.13.9.
    """
    return math.floor(255.0 * clamp(component, 0.0, 1.0) + 0.5)


def color_to_bytes(color):
    """Source: OpenGL 1.2.1 section 2.13.9, for every component of a color."""
    return [color_to_byte(component) for component in color]


def lerp_q8(p, q, fraction_q8):
    """Two bytes blended by an 8-bit fraction, to a byte.

    Measured: bilinear and trilinear captures of NV2A (349524 and 61440 pixels).
    """
    return (p * (256 - fraction_q8) + q * fraction_q8 + 128) >> 8


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


def is_power_of_two(value):
    """Whether a positive float64 is 2^k. Source: IEEE 754."""
    return math.frexp(value)[0] == 0.5


def round_significant_bits(value, bits):
    """A float64 to the nearest of ``bits`` significant bits, ties to even. Source: IEEE 754."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(round(math.ldexp(mantissa, bits)), exponent - bits)


def low_reciprocal(inverse):
    """1/D cut to 29 significant bits, from the float64 nearest to it, reduced by 2^21 of its units; exact
    where D is 2^k.

    Measured: 90676 and 887880 pixels (DepthFmt_z24, ZBuf24D_FloorQuad captures).
    """
    if is_power_of_two(inverse):
        return inverse
    return keep_significant_bits(from_pattern(to_pattern(inverse) - 2**21), 29)


def floor_float(value):
    """Floor of a float as a float; NaN and infinities stay. Source: IEEE 754 (round toward negative)."""
    return float(math.floor(value)) if math.isfinite(value) else value

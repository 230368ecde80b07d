"""Fog: a byte by comparison with 255 thresholds, or by NV2A's table; and fragments without combiners."""

import math
from decimal import Decimal, localcontext
from functools import cache

from fixedpipe.pipeline.enums import FogArithmetic, FogMode
from tests.reference import fixed
from tests.reference.fixed import clamp


def exponential_threshold(k, mode, density):
    """Where 255 f = k - 1/2, by 40 decimal digits. Source: OpenGL 1.2.1 equations 3.24 and 3.25."""
    if density == 0.0:
        return float("inf")
    with localcontext() as context:
        context.prec = 40
        distance = -((Decimal(k) - Decimal("0.5")) / Decimal(255)).ln()
        if mode == FogMode.EXP2:
            distance = distance.sqrt()
        return float(distance / Decimal(density))


def linear_threshold(k, start, end):
    """Where 255 f = k - 1/2. Source: OpenGL 1.2.1 equation 3.26."""
    return end - ((k - 0.5) / 255.0) * (end - start)


@cache
def thresholds(mode, density, start, end):
    """T_k for k = 1..255. Source: OpenGL 1.2.1 section 3.10; Assumed: the factor is rounded to nearest."""
    if mode == FogMode.LINEAR:
        return tuple(linear_threshold(k, start, end) for k in range(1, 256))
    return tuple(exponential_threshold(k, mode, density) for k in range(1, 256))


def fog_factor(coordinate, fog, profile):
    """The factor as a byte. Measured: FogGen, its width; Assumed: rounding to nearest (ROUNDED)."""
    if profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE:
        return table_factor(coordinate, fog.mode)
    limits = thresholds(fog.mode, fog.density, fog.start, fog.end)
    if fog.mode == FogMode.LINEAR and fog.start > fog.end:
        return sum(coordinate >= t for t in limits)
    return sum(coordinate <= t for t in limits)


def truncated(value, mode):
    """The float that fog keeps of another. Measured: 14 significant bits of EXP and EXP2 (Fog captures)."""
    return fixed.keep_significant_bits(value, 24 if mode == FogMode.LINEAR else 14)


def rounded(value, mode):
    """The nearest number that fog's registers hold. Measured: 14 significant bits (Fog captures)."""
    if value == 0:
        return value  # with its sign
    bits = 24 if mode == FogMode.LINEAR else 14
    mantissa, exponent = math.frexp(value)
    return math.ldexp(round(mantissa * 2**bits), exponent - bits)


def line(fog):
    """Bias and multiplier. Measured: Fog captures; Inferred: the driver's, from OpenGL's parameters."""
    if fog.registers is not None:
        bias, multiplier = fog.registers.bias, fog.registers.multiplier
    elif fog.mode == FogMode.LINEAR:
        multiplier = -1.0 / (fog.end - fog.start)
        bias = 1.0 - fog.end * multiplier
    else:
        ln_256 = 5.545177444479562
        divisor = 2.0 * (ln_256 if fog.mode == FogMode.EXP else math.sqrt(ln_256))
        bias, multiplier = 1.5, -fog.density / divisor
    return rounded(bias, fog.mode), rounded(multiplier, fog.mode)


def vertex_value(fog, coordinate):
    """What NV2A iterates. Measured: 18 vertices (Fog, Fog_vsh captures); Assumed: 2^127 for infinity."""
    bias, multiplier = line(fog)
    product = truncated(truncated(coordinate, fog.mode) * multiplier, fog.mode)
    value = truncated(product + bias, fog.mode)
    value = value if value < 2.0**127 else 2.0**127
    return value if value > -(2.0**127) else -(2.0**127)


@cache
def nodes(mode):
    """Bytes between which the table's lines run. Measured: Fog and Fog_vsh captures, 27 of the 33."""
    with localcontext() as context:
        context.prec = 40
        powers = [Decimal(j) / 4 if mode == FogMode.EXP else Decimal(j * j) / 128 for j in range(33)]
        return tuple(int(255 * Decimal(2) ** -power + Decimal("0.5")) for power in powers)


def table_factor(value, mode):
    """NV2A's factor of an iterated value, by 1/4096.

    Measured: FogGen_VS-linear-fog_x, 374 of 374 squares; Fog and Fog_vsh captures.
    """
    step = math.floor(clamp(value * 4096.0, 0.0, 8192.0))
    if mode == FogMode.LINEAR:
        return min(clamp(step - 4095, 0, 4096) * 255 >> 12, 255)
    x = 6144 - step
    if x >= 2048:
        return 0
    node, fraction = divmod(max(x, 0), 64)
    low, high = nodes(mode)[node : node + 2]
    return (low * (64 - fraction) + high * fraction + 32) // 64


def add_secondary(color, secondary):
    """Color sum of a fragment without register combiners. Source: OpenGL 1.2.1 section 3.9."""
    return [min(255, c + s) for c, s in zip(color[:3], secondary[:3], strict=True)] + [color[3]]


def blend_with_fog(color, fog_color, factor):
    """Source: OpenGL 1.2.1 section 3.10; Measured: the rounding."""
    mixed = [factor * c + (255 - factor) * cf for c, cf in zip(color[:3], fog_color[:3], strict=True)]
    return [fixed.divide_by_255(n) for n in mixed] + [color[3]]

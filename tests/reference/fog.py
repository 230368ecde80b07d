"""Fog: a byte by comparison with 255 thresholds, or by NV2A's table; and fragments without combiners."""

import math
from decimal import Decimal, localcontext
from functools import cache

from fixedpipe.pipeline.enums import FogArithmetic, FogMode
from tests.reference import fixed, lighting_unit
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
    """Where 255 f = k - 1/2; all of them at once where start is end. Source: OpenGL 1.2.1 equation 3.26;
    WineHQ dlls/d3d9/tests/visual.c, fog_special_test (a step); Assumed: the step's own place is before it.
    """
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
        return table_factor(coordinate, fog.mode, folds(fog))
    limits = thresholds(fog.mode, fog.density, fog.start, fog.end)
    if fog.mode == FogMode.LINEAR and fog.start > fog.end:
        return sum(coordinate >= t for t in limits)
    return sum(coordinate <= t for t in limits)


def line(fog):
    """Bias and multiplier. Measured: Fog captures; Inferred: the driver's, from OpenGL's parameters; Assumed:
    2^-24 for no distance from start to end.
    """
    if fog.registers is not None:
        bias, multiplier = fog.registers.bias, fog.registers.multiplier
    elif fog.mode == FogMode.LINEAR:
        multiplier = -1.0 / (fog.end - fog.start or 2.0**-24)
        bias = 1.0 - fog.end * multiplier
    else:
        ln_256 = 5.545177444479562
        divisor = 2.0 * (ln_256 if fog.mode == FogMode.EXP else math.sqrt(ln_256))
        bias, multiplier = 1.5, -fog.density / divisor
    entered = lighting_unit.single if fog.mode == FogMode.LINEAR else lighting_unit.to_lighting
    return entered(bias), entered(multiplier)


def vertex_value(fog, coordinate):
    """What NV2A iterates. Measured: Fog, Fog_vsh, Fog_gen, Fog_param; Assumed: 2^127 for infinity."""
    bias, multiplier = line(fog)
    entered = lighting_unit.to_lighting(coordinate)
    if fog.mode == FogMode.LINEAR:
        finite = math.isfinite(entered)
        scaled = float(lighting_unit.product(entered, multiplier, lighting_unit.TRANSFORM))
        value = math.ceil((scaled + float(bias)) * 2.0**21) / 2.0**21 if finite else math.inf
    else:
        scaled = lighting_unit.product(entered, multiplier, lighting_unit.LIGHTING)
        value = float(lighting_unit.total((scaled, bias), lighting_unit.LIGHTING))
    if math.isnan(value):
        return 2.0**127
    return clamp(value, -(2.0**127), 2.0**127)


@cache
def nodes(mode):
    """Bytes between which the table's lines run. Measured: Fog and Fog_vsh captures, 27 of the 33."""
    with localcontext() as context:
        context.prec = 40
        powers = [Decimal(j) / 4 if mode == FogMode.EXP else Decimal(j * j) / 128 for j in range(33)]
        return tuple(int(255 * Decimal(2) ** -power + Decimal("0.5")) for power in powers)


def folds(fog):
    """Whether values on both sides of 3/2 are alike. Measured: Fog_param, EXP2 and the _ABS modes."""
    return fog.mode == FogMode.EXP2 or bool(
        fog.mode == FogMode.EXP and fog.registers is not None and fog.registers.absolute
    )


def table_factor(value, mode, folded=False):
    """NV2A's factor of an iterated value, by 1/4096.

    Measured: FogGen_VS-linear-fog_x, 374 of 374 squares; Fog and Fog_vsh captures.
    """
    step = math.floor(clamp(value * 4096.0, 0.0, 8192.0))
    if mode == FogMode.LINEAR:
        return min(clamp(step - 4095, 0, 4096) * 255 >> 12, 255)
    x = abs(6144 - step) if folded else 6144 - step
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
    return [fixed.divide(n) for n in mixed] + [color[3]]

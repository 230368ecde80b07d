"""Fog: a byte by comparison with 255 thresholds; and the color sum and fog of fragments without combiners."""

from decimal import Decimal, localcontext
from functools import cache

from pipeline.enums import FogMode
from tests.reference import fixed


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


def fog_factor(coordinate, fog):
    """The factor as a byte. Measured: FogGen, its width; Assumed: rounding to nearest."""
    limits = thresholds(fog.mode, fog.density, fog.start, fog.end)
    if fog.mode == FogMode.LINEAR and fog.start > fog.end:
        return sum(coordinate >= t for t in limits)
    return sum(coordinate <= t for t in limits)


def add_secondary(color, secondary):
    """Color sum of a fragment without register combiners. Source: OpenGL 1.2.1 section 3.9."""
    return [min(255, c + s) for c, s in zip(color[:3], secondary[:3], strict=True)] + [color[3]]


def blend_with_fog(color, fog_color, factor):
    """Source: OpenGL 1.2.1 section 3.10; Measured: the rounding."""
    mixed = [factor * c + (255 - factor) * cf for c, cf in zip(color[:3], fog_color[:3], strict=True)]
    return [fixed.divide_by_255(n) for n in mixed] + [color[3]]

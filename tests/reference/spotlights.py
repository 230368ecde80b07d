"""Spotlights: a cutoff's cosine, and what a driver gives a lighting unit for a cutoff and an exponent."""

import math
from decimal import Decimal, localcontext
from fractions import Fraction

# By place of the curve, 0 to 14: b and c. Source: nouveau (nv10_state_tnl.c, nv10_spot_params).
CURVES = [
    *((-3.80e-05, -0.01), (-1.77, 1.77), (-2.41, 2.39), (-2.71, 2.70), (-2.88, 2.87)),
    *((-2.98, 2.98), (-3.06, 3.06), (-3.11, 3.10), (-3.17, 3.16), (-3.23, 3.23)),
    *((-3.28, 3.27), (-3.37, 3.37), (-3.47, 3.47), (-3.83, 3.83), (-5.11, 5.11)),
]


def arctangent_of_inverse(n):
    """Arc tangent of 1/n, n >= 5, as a fraction good to 60 digits. Source: Gregory's series."""
    return sum(Fraction((-1) ** k, (2 * k + 1) * n ** (2 * k + 1)) for k in range(45))


def cosine_of_degrees(angle):
    """Cosine of a spot cutoff to 40 decimal places: Taylor's series, with pi by Machin's formula.

    Source: OpenGL 1.2.1 equation 2.5.
    """
    with localcontext() as context:
        context.prec = 70
        pi = 16 * arctangent_of_inverse(5) - 4 * arctangent_of_inverse(239)
        x = Decimal(pi.numerator) / Decimal(pi.denominator) * Decimal(angle) / Decimal(180)
        terms = [(-1) ** k * x ** (2 * k) / math.factorial(2 * k) for k in range(1, 40)]
        return float((1 + sum(terms)).quantize(Decimal("1e-40")))


def curve(which, exponent):
    """Source: nouveau (nv10_state_tnl.c, get_shine)."""
    place = 14 * (1 - 1 / (1 + 0.02 * exponent)) / (1 - 1 / (1 + 0.02 * 1024))
    left = math.floor(place)
    low, high = CURVES[left][which], CURVES[left + 1][which]
    return low + (high - low) * (place - left)


def driver_spot(direction, exponent, cutoff):
    """The axis, four numbers, and a, b, c. Source: nouveau (nv10_state_tnl.c, nv10_get_spot_coeff); of
    exponent 0 nxdk_pgraph_tests (src/tests/lighting_spotlight_tests.cpp, falloff 0 of Direct3D).
    """
    x, y, z = (float(c) for c in direction)
    size = math.sqrt((x * x + y * y) + z * z)
    x, y, z = (x, y, z) if size == 0 else (x / size, y / size, z / size)
    cosine = cosine_of_degrees(cutoff)
    lean = 1 / (1 + 0.273 * exponent)
    if cosine == 1:
        return [-x, -y, -z, -1], [lean, curve(0, exponent), curve(1, exponent) + lean]
    widest, tightest = 1 / (1 - cosine), 0.9 + 0.278 * exponent
    scale = widest if widest > tightest else tightest
    axis = [-scale * x, -scale * y, -scale * z, 1 - scale]
    if exponent == 0:
        return axis, [0, 1, 0]
    a = -1 - 5.36e-3 / math.sqrt(exponent) + lean * scale
    return axis, [a if a > 0 else 0, curve(0, exponent), curve(1, exponent) + lean * scale]

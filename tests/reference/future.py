"""The future board's stages, one number or vector at a time. docs/numbers.md section 20.

Nothing was measured: no such board was built.
"""

from decimal import Decimal, localcontext
from fractions import Fraction
from math import acos, floor, isqrt, sin, sqrt

from fixedpipe.pipeline.enums import CombinerFunction


def square_root(n):
    """The integer nearest to a square root. Source: Kautz, Seidel 2000, section 5.1 (asked for)."""
    return (isqrt(4 * max(n, 0)) + 1) // 2


def divide(n, d, one, largest):
    """Source: Kautz, Seidel 2000, section 5.1; Assumed: the rounding, and what 0 divides."""
    if d == 0:
        return (n > 0) * largest - (n < 0) * largest
    value = floor(Fraction(n * one, d) + Fraction(1, 2))
    return max(-largest, min(largest, value))


def exponential(n, one, largest):
    """By 40 digits. Source: Kautz, Seidel 2000, section 5.1; Assumed: the rounding."""
    with localcontext() as context:
        context.prec = 40
        x = Decimal(n) / Decimal(one) ** 2
        if x > 40:
            return largest
        return min(largest, int(x.exp() * one + Decimal("0.5")))


def applied(function, ab, cd, one, largest):
    """What takes the place of AB + CD. Source: Kautz, Seidel 2000, section 5.1."""
    if function == CombinerFunction.SQUARE_ROOT:
        return min(largest, square_root(ab + cd))
    if function == CombinerFunction.DIVIDE:
        return divide(ab, cd, one, largest)
    return exponential(ab + cd, one, largest)


def turned(a, b, t):
    """A unit vector at the fraction t of the arc from a to b, by sines. Source: Shoemake 1985."""
    cosine = max(-1.0, min(1.0, sum(x * y for x, y in zip(a, b, strict=True))))
    angle = acos(cosine)
    if sin(angle) < 1e-9:
        return list(a)
    weights = sin((1.0 - t) * angle) / sin(angle), sin(t * angle) / sin(angle)
    return [weights[0] * x + weights[1] * y for x, y in zip(a, b, strict=True)]


def normalised(v):
    """Source: OpenGL 1.2.1 section 2.10.3 (unit length)."""
    length = sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def spherical(b0, b2, corners):
    """From vertex 0 to 1, from there to 2. Assumed: the order; along every edge it is the arc."""
    v0, v1, v2 = (normalised(v) for v in corners)
    edge = turned(v0, v1, (1.0 - b2 - b0) / (1.0 - b2)) if b2 < 1.0 else v0
    return turned(edge, v2, b2)

"""The future board's arithmetic (docs/numbers.md, section 20): functions of general combiners, and vectors
that turn steadily. Exact integers, or float64 with + - * / and the square root alone.
"""

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.numbers import INTEGERS

_LN_2_HIGH, _LN_2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # their sum is ln 2; the first has 33 bits
_INVERSE_LN_2 = 1.4426950408889634
_TERMS = 14  # of the exponential series, for |r| <= ln 2 / 2: beyond them is less than 2**-56
_LARGEST_EXPONENT = 21.0  # e to this power is beyond every register
_FARTHEST = 256.0  # Assumed: a register's range, as of the board's 16 bits
_HALVINGS = 12  # of an arc: what is left of it is straight to 2**-40 of its length


def square_root(n):
    """The integer nearest to the square root of n, int64 below 2**62; 0 where n is negative."""
    n = np.maximum(n, 0)
    root = np.floor(np.sqrt(n.astype(np.float64))).astype(np.int64)
    root -= root * root > n
    root += (root + 1) * (root + 1) <= n
    return root + (n - root * root > root)


def divide(n, d, one, largest):
    """``n one / d`` to the nearest integer, halves up, within +-``largest``.

    n / 0 is the largest with n's sign, 0 / 0 is 0. n, d int64 below 2**58; ``one`` is 2**c - 1.
    """
    sign, size = np.where(d < 0, -1, 1), np.abs(d)
    n, divisor = sign * n, np.where(size == 0, 1, size)
    whole = n // divisor
    rest = n - whole * divisor
    # rest * one / divisor, bit by bit of one, so that nothing leaves 64 bits.
    part, left = np.zeros_like(n), np.zeros_like(n)
    for _ in range(int(one).bit_length()):
        part, left = 2 * part, 2 * left + rest
        for _ in range(2):
            over = left >= divisor
            part, left = part + over, left - np.where(over, divisor, 0)
    part += 2 * left >= divisor
    limit = largest // one + 2  # beyond it no part matters
    value = np.clip(whole, -limit, limit) * one + part
    return np.where(size == 0, np.sign(n) * largest, np.clip(value, -largest, largest))


def exponential(x, one, largest):
    """``one e**x`` to the nearest integer, at most ``largest``: x float64 [k].

    By a power of two and a series in Horner's order: the same bits on every machine.
    """
    x = np.minimum(np.maximum(x, -_LARGEST_EXPONENT * 3.0), _LARGEST_EXPONENT)
    power = np.floor(x * _INVERSE_LN_2 + 0.5)
    r = (x - power * _LN_2_HIGH) - power * _LN_2_LOW
    total = np.ones_like(r)
    for term in range(_TERMS, 0, -1):
        total = 1.0 + total * r / float(term)
    value = np.ldexp(total, power.astype(np.int64)) * float(one)
    return np.minimum(np.floor(value + 0.5), float(largest)).astype(np.int64)


def applied(function, ab, cd, one, largest, numbers=INTEGERS):
    """What takes the place of the sum of two products, in the registers' units of ``one``: int64 of exact
    int64 products, or float64 where ``numbers`` are REALS.
    """
    if not numbers.rounds:
        return one * real_function(function, ab / one / one, cd / one / one)
    if function == C.COMBINER_FUNCTION_SQUARE_ROOT:
        return np.minimum(square_root(ab + cd), largest)
    if function == C.COMBINER_FUNCTION_DIVIDE:
        return divide(ab, cd, one, largest)
    if function == C.COMBINER_FUNCTION_EXPONENTIAL:
        x = (ab + cd).astype(np.float64) / float(one) / float(one)
        return exponential(x, one, largest)
    raise ValueError(f"{function!r} is no combiner function that takes a sum's place.")


def real_function(function, ab, cd):
    """The same of real products, 1.0 = one; n / 0 is as far as the board's registers reach."""
    if function == C.COMBINER_FUNCTION_SQUARE_ROOT:
        return np.sqrt(np.maximum(ab + cd, 0.0))
    if function == C.COMBINER_FUNCTION_EXPONENTIAL:
        return np.exp(np.minimum(ab + cd, _LARGEST_EXPONENT))
    if function == C.COMBINER_FUNCTION_DIVIDE:
        return np.where(cd == 0.0, np.sign(ab) * _FARTHEST, ab / np.where(cd == 0.0, 1.0, cd))
    raise ValueError(f"{function!r} is no combiner function that takes a sum's place.")


# ---------------------------------------------------------------------------------------- steady turning


def normalised(v):
    """Vectors float64 [k, 3] of length one; one of length 0 stays."""
    length = np.sqrt((v[:, 0] * v[:, 0] + v[:, 1] * v[:, 1]) + v[:, 2] * v[:, 2])[:, None]
    return v / np.where(length == 0.0, 1.0, length)


def turned(a, b, t):
    """From unit vectors a to b, [k, 3], by the fraction t [k] of the arc between them: halvings of the arc,
    then a straight line. Opposite ones meet in 0.
    """
    for _ in range(_HALVINGS):
        middle, t = normalised(a + b), 2.0 * t
        upper = t >= 1.0
        a, b = np.where(upper[:, None], middle, a), np.where(upper[:, None], b, middle)
        t = np.where(upper, t - 1.0, t)
    return normalised(a + t[:, None] * (b - a))


def spherical(b0, b2, corners):
    """Unit vectors float64 [k, 3] between those of corners [k, 3, 3]: from vertex 0 to vertex 1 by their
    weights, from there to vertex 2 by its own. b0, b2: section 4's.
    """
    v0, v1, v2 = (normalised(corners[:, i]) for i in range(3))
    rest = 1.0 - b2
    along = np.where(rest > 0.0, (rest - b0) / np.where(rest > 0.0, rest, 1.0), 0.0)
    edge = turned(v0, v1, np.clip(along, 0.0, 1.0))
    return turned(edge, v2, np.clip(b2, 0.0, 1.0))


def from_color(color, one, expanded):
    """Vectors of colours, as EXPAND_NORMAL reads them, float64."""
    return (2.0 * color.astype(np.float64) - float(expanded)) / float(one)


def to_color(vector, one, expanded):
    """The nearest colours of vectors, int64, 0 to one."""
    value = np.floor((float(one) * vector + float(expanded)) / 2.0 + 0.5)
    return np.clip(np.where(np.isnan(value), 0.0, value), 0.0, float(one)).astype(np.int64)

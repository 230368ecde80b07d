"""A vertex program's instructions, one vertex at a time, in exact fractions.

A number is a Fraction, or one of the floats infinity and NaN; zeros have no sign here.
"""

import math
from fractions import Fraction

from tests.reference import lighting_unit as unit
from tests.reference.lighting_unit import TRANSFORM, special


def product(a, b):
    """0 times anything is 0; an infinite product keeps its sign. Source: NV_vertex_program."""
    if any(not special(x) and x == 0 for x in (a, b)):
        return Fraction(0)
    if special(a) or special(b):
        if any(special(x) and math.isnan(x) for x in (a, b)):
            return math.nan
        return math.inf if (a > 0) == (b > 0) else -math.inf
    return unit.cut(a * b, TRANSFORM)


def add(*terms):
    """Infinities keep their signs. Source: envytools (xf_sum)."""
    infinite = {x for x in terms if special(x)}
    if infinite:
        return infinite.pop() if len(infinite) == 1 else math.nan
    return unit.total(terms, TRANSFORM)


def dot(a, b):
    """Source: envytools (xf_sum), NV_vertex_program."""
    return add(*(product(x, y) for x, y in zip(a, b, strict=True)))


def reciprocal(x):
    """RCP of what is not 0. Source: envytools (xf_rcp)."""
    return unit.transform_reciprocal(x)


def clamped_reciprocal(x):
    """RCC of what is not 0. Source: NV_vertex_program1_1; envytools (xf_rcp: what is no number stays it)."""
    found = reciprocal(x)
    if special(found):
        return found
    low, high = Fraction(1, 2**64), Fraction(2**64)
    size = min(max(abs(found), low), high)
    return -size if x < 0 else size


# Slopes of the 32 pieces of 2^x and of log2 x in an octave, in units of 2^-22 to 2^-13 and of 2^-26 to 2^-13.
# Source: envytools (xf_exp_lut_b, xf_log_lut_b).
POWER_SLOPES = (
    *(359, 366, 375, 383, 391, 400, 409, 417, 427, 436, 445, 455, 466, 475, 486, 497),
    *(507, 518, 530, 542, 553, 565, 578, 591, 603, 617, 629, 645, 657, 673, 689, 699),
)
LOGARITHM_SLOPES = (
    *(11702, 11271, 10966, 10650, 10361, 10106, 9800, 9574, 9337, 9112, 8898, 8693, 8499, 8310, 8133, 7962),
    *(7796, 7641, 7488, 7343, 7202, 7070, 6939, 6814, 6692, 6578, 6464, 6356, 6251, 6147, 6058, 5930),
)
LAST_BIT = Fraction(1, 2**23)  # of one in single precision. Source: IEEE 754


def climbed(slopes, steps):
    """How high a line of pieces of 256 steps has climbed. Source: envytools (xf_exp_core, xf_log_core)."""
    return sum(slope * min(max(steps - 256 * i, 0), 256) for i, slope in enumerate(slopes))


def power_steps(x):
    """An exponent in 8192ths, toward minus infinity. Source: envytools (xf_pre_exp)."""
    if special(x):
        return 2**31 - 1 if math.isnan(x) or x > 0 else -(2**31)
    return 0 if abs(x) < LAST_BIT else math.floor(x * 8192)


def power_of_steps(steps):
    """2^(steps/8192). Source: envytools (xf_exp_core)."""
    whole, rest = divmod(steps, 8192)
    if whole >= 128:
        return math.inf
    if whole <= -127:
        return Fraction(0)
    return (1 + Fraction(climbed(POWER_SLOPES, rest), 2**22)) * Fraction(2) ** whole


def power_of_two(x):
    """EXP: 2^floor(x), x - floor(x), 2^x, 1. Source: envytools (xf_exp_flr, xf_exp_frc, xf_exp)."""
    if special(x) and math.isnan(x):
        return [math.inf, x, x, Fraction(1)]
    steps = power_steps(x)
    fraction = Fraction(0) if special(x) else x - math.floor(x)
    if not special(x) and x < 0:
        fraction = math.floor(fraction / LAST_BIT) * LAST_BIT if x <= -LAST_BIT else Fraction(1)
    return [power_of_steps(steps // 8192 * 8192), fraction, power_of_steps(steps), Fraction(1)]


def logarithm_steps(x):
    """log2 of a positive number in 2^-26. Source: envytools (xf_log_core)."""
    e = unit.exponent(x)
    steps = math.floor((x / Fraction(2) ** e - 1) * 8192)
    return climbed(LOGARITHM_SLOPES, steps) + e * 2**26


def logarithm(x):
    """LOG: exponent, mantissa and log2 of |x|, 1. Source: envytools (xf_log_e, xf_log_f, xf_log)."""
    if special(x):
        rest = math.nan if math.isnan(x) else Fraction(1)
        return [abs(x), rest, abs(x), Fraction(1)]
    if x == 0:
        return [-math.inf, Fraction(1), -math.inf, Fraction(1)]
    e = unit.exponent(x)
    value = unit.cut(Fraction(logarithm_steps(abs(x)), 2**26), TRANSFORM)
    return [Fraction(e), abs(x) / Fraction(2) ** e, value, Fraction(1)]


def lit(x, y, power):
    """LIT of x, y and w. Source: envytools (xf_lit)."""
    one, zero = Fraction(1), Fraction(0)
    if x <= 0:
        return [one, zero, zero, one]
    if power == 0:
        return [one, x, one, one]
    if y <= 0:
        return [one, x, math.inf if power < 0 else zero, one]
    if special(y):
        return [one, x, zero if power < 0 else math.inf, one]
    steps = logarithm_steps(y) * min(max(power_steps(power), -(2**20)), 2**20 - 1) // 2**26
    return [one, x, power_of_steps(steps), one]


def execute(name, *operands):
    """The four components of a result; ``operands`` have four each. Source: NV_vertex_program."""
    a = operands[0]
    b = operands[1] if len(operands) > 1 else None
    one = Fraction(1)
    return {
        "MOV": lambda: a,
        "MUL": lambda: [product(x, y) for x, y in zip(a, b, strict=True)],
        "ADD": lambda: [add(x, y) for x, y in zip(a, b, strict=True)],
        "MAD": lambda: [add(product(x, y), z) for x, y, z in zip(*operands, strict=True)],
        "DP3": lambda: [dot(a[:3], b[:3])] * 4,
        "DP4": lambda: [dot(a, b)] * 4,
        "DPH": lambda: [dot([*a[:3], one], b)] * 4,
        "DST": lambda: [one, product(a[1], b[1]), a[2], b[3]],
        "MIN": lambda: [min(x, y) for x, y in zip(a, b, strict=True)],
        "MAX": lambda: [max(x, y) for x, y in zip(a, b, strict=True)],
        "SLT": lambda: [Fraction(x < y) for x, y in zip(a, b, strict=True)],
        "SGE": lambda: [Fraction(x >= y) for x, y in zip(a, b, strict=True)],
        "RCP": lambda: [reciprocal(a[0])] * 4,
        "RCC": lambda: [clamped_reciprocal(a[0])] * 4,
        "RSQ": lambda: [unit.transform_inverse_root(a[0])] * 4,
        "EXP": lambda: power_of_two(a[0]),
        "LOG": lambda: logarithm(a[0]),
        "LIT": lambda: lit(a[0], a[1], a[3]),
    }[name]()

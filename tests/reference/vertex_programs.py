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
    """RCC of what is not 0. Source: NV_vertex_program1_1."""
    found = reciprocal(x)
    low, high = Fraction(1, 2**64), Fraction(2**64)
    size = min(max(abs(found), low), high)
    return -size if x < 0 else size


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
    }[name]()

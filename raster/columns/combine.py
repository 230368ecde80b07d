"""Register combiners at any width (docs/numbers.md, section 8), on columns [components, k].

What a register holds is a number in units of ``one``: int64, or float64 where a stage computes with reals.
Every clamp is a switch.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.numbers import INTEGERS, REALS

# How far a register reaches whose clamp is off: products of two, summed and scaled, stay below 2**62.
FAR = 1 << 26

# Of each input mapping: whether it reads numbers below 0, what it multiplies by, and how many of one, of what
# EXPAND_NORMAL subtracts and of one half it adds. Source: NV_register_combiners table 4.
MAPPINGS = {
    C.MAPPING_UNSIGNED_IDENTITY: (False, 1, (0, 0, 0)),
    C.MAPPING_UNSIGNED_INVERT: (False, -1, (1, 0, 0)),
    C.MAPPING_EXPAND_NORMAL: (False, 2, (0, -1, 0)),
    C.MAPPING_EXPAND_NEGATE: (False, -2, (0, 1, 0)),
    C.MAPPING_HALF_BIAS_NORMAL: (False, 1, (0, 0, -1)),
    C.MAPPING_HALF_BIAS_NEGATE: (False, -1, (0, 0, 1)),
    C.MAPPING_SIGNED_IDENTITY: (True, 1, (0, 0, 0)),
    C.MAPPING_SIGNED_NEGATE: (True, -1, (0, 0, 0)),
}


def coefficients(mapping, one, expanded, half):
    """(whether a mapping reads numbers below 0, its factor, its addend) in units of ``one``."""
    if mapping not in MAPPINGS:
        raise ValueError(f"{mapping!r} is no input mapping.")
    signed, factor, (ones, expansions, halves) = MAPPINGS[mapping]
    return signed, factor, ones * one + expansions * expanded + halves * half


@dataclass(frozen=True)
class Arithmetic:
    """How a machine's combiners compute.

    one, half              values of one and one half
    low, high              what general combiners clamp to
    expanded               what EXPAND_NORMAL subtracts: one, or one and a unit
    per_product, round_first   ``product_rounding`` PER_PRODUCT, ``round_before_scale``
    clamps_mapping, clamps_sum, clamps_final   which of the clamps are on
    holds                  (lowest, highest) that a register holds, by which mappings clamp
    numbers                INTEGERS, which are rounded, or REALS
    """

    one: float
    half: float
    low: float
    high: float
    expanded: float
    per_product: bool
    round_first: bool
    clamps_mapping: bool
    clamps_sum: bool
    clamps_final: bool
    holds: tuple[float, float]
    numbers: Any = INTEGERS


# The algorithm's own: only what the mappings and the final combiner clamp by their definitions is clamped.
EXACT = Arithmetic(
    one=1.0,
    half=0.5,
    low=-np.inf,
    high=np.inf,
    expanded=1.0,
    per_product=False,
    round_first=True,
    clamps_mapping=True,
    clamps_sum=False,
    clamps_final=True,
    holds=(-np.inf, np.inf),
    numbers=REALS,
)


def in_reals(a):
    """The same Arithmetic without rounding, and with one half where EXPAND_NORMAL means it."""
    half = a.one / 2
    return replace(a, half=half, expanded=a.one, per_product=False, round_first=True, numbers=REALS)


def unclamped(a):
    """The same Arithmetic without clamps of what stages make."""
    far = FAR if a.numbers.rounds else np.inf
    return replace(a, low=-far, high=far, clamps_final=False)


def map_input(x, mapping, a):
    """Register components through an input mapping. Source: NV_register_combiners table 4."""
    signed, factor, addend = coefficients(mapping, a.one, a.expanded, a.half)
    if not a.clamps_mapping:
        return factor * x + addend
    value = factor * (x if signed else np.maximum(x, 0)) + addend
    if mapping == C.MAPPING_SIGNED_NEGATE:
        return np.clip(value, *a.holds)
    if mapping == C.MAPPING_UNSIGNED_INVERT:
        return np.maximum(value, 0)
    if mapping == C.MAPPING_EXPAND_NEGATE:
        return np.minimum(value, a.holds[1])
    return value  # of UNSIGNED_IDENTITY and the others: a register holds it


def output(products, scale, biased, a):
    """One output of a portion from the exact sum of its products, or from each of them rounded."""
    half, numbers = a.half if biased else 0, a.numbers
    if a.per_product:
        total = numbers.scaled(sum(numbers.quotient(n, a.one) for n in products) - half, scale)
    elif a.round_first:
        total = numbers.scaled(numbers.quotient(sum(products), a.one) - half, scale)
    else:
        n = sum(products)
        if scale == C.SCALE_BY_ONE_HALF:
            total = (n + a.one) // (2 * a.one)
        else:
            total = numbers.quotient(n * (1 << scale), a.one)
        total = total - (2 * half if scale == C.SCALE_BY_TWO else half)
    return np.clip(total, a.low, a.high)


def function_output(value, scale, biased, a):
    """The output of a portion whose sum a function takes the place of, from the function's value."""
    return np.clip(a.numbers.scaled(value - (a.half if biased else 0), scale), a.low, a.high)


def takes_cd(spare0_alpha, lowest_bit, a):
    """Where a mux takes CD: SPARE0's alpha, clamped, has its highest bit, or its lowest, set. Real numbers
    have no lowest bit, and are compared with one half.
    """
    alpha = np.clip(spare0_alpha, 0, a.one)
    if lowest_bit and a.numbers.rounds:
        return np.floor(alpha + 0.5).astype(np.int64) & 1 == 1
    return alpha >= a.half


def product(n, a):
    """A product of two numbers, or a sum of such, rounded."""
    return a.numbers.quotient(n, a.one)


def sum_of_three(products):
    """A dot product's terms, each for all three components."""
    return [np.broadcast_to(p, products[0].shape) for n in products for p in (n[0:1], n[1:2], n[2:3])]


def map_final(x, invert, a):
    """A final combiner's input mapping. Source: NV_register_combiners section 3.8.12.3."""
    if not a.clamps_mapping:
        return a.one - x if invert else x
    return a.one - np.clip(x, 0, a.one) if invert else np.maximum(x, 0)


def final_color(a_, b, c, d, g, a):
    """RGBA [4, k] of the final combiner's mapped inputs: ``rn(A B + (one - A) C) + D`` and G."""
    weight = np.minimum(a_, a.one)
    rgb = product(weight * b + (a.one - weight) * c, a) + d
    color = np.concatenate([rgb, np.broadcast_to(g, (1, rgb.shape[1]))])
    return np.clip(color, 0, a.one) if a.clamps_final else color

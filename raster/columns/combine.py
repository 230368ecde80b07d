"""Register combiners at any width (docs/numbers.md, section 8), on int64 columns [components, k].

What a register holds is a number in units of ``one``. Every clamp is a switch.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.numbers import quotient

# How far a register reaches whose clamp is off: products of two, summed and scaled, stay below 2**62.
FAR = 1 << 26


@dataclass(frozen=True)
class Arithmetic:
    """How a machine's combiners compute.

    one, half              values of one and one half
    low, high              what general combiners clamp to
    expanded               what EXPAND_NORMAL subtracts: one, or one and a unit
    per_product, round_first   ``product_rounding`` PER_PRODUCT, ``round_before_scale``
    clamps_mapping, clamps_sum, clamps_final   which of the clamps are on
    holds                  (lowest, highest) that a register holds, by which mappings clamp
    grid                   what is rounded becomes a multiple of so many units: 1, or of units that are finer
                           than the machine's, how many of these make one of its own
    """

    one: int
    half: int
    low: int
    high: int
    expanded: int
    per_product: bool
    round_first: bool
    clamps_mapping: bool
    clamps_sum: bool
    clamps_final: bool
    holds: tuple[int, int]
    grid: int = 1


def map_input(x, mapping, a):
    """Register components through an input mapping. Source: NV_register_combiners table 4."""
    if mapping == C.MAPPING_SIGNED_IDENTITY:
        return x
    if mapping == C.MAPPING_SIGNED_NEGATE:
        return np.clip(-x, *a.holds) if a.clamps_mapping else -x
    if a.clamps_mapping:
        x = np.maximum(x, 0)
    if mapping == C.MAPPING_UNSIGNED_IDENTITY:
        return x
    if mapping == C.MAPPING_UNSIGNED_INVERT:
        return a.one - (np.minimum(x, a.one) if a.clamps_mapping else x)
    if mapping == C.MAPPING_EXPAND_NORMAL:
        return 2 * x - a.expanded
    if mapping == C.MAPPING_EXPAND_NEGATE:
        negated = a.expanded - 2 * x
        return np.minimum(negated, a.holds[1]) if a.clamps_mapping else negated
    if mapping == C.MAPPING_HALF_BIAS_NORMAL:
        return x - a.half
    if mapping == C.MAPPING_HALF_BIAS_NEGATE:
        return a.half - x
    raise ValueError(f"{mapping!r} is no input mapping.")


def scaled(x, scale):
    """Rounded values times an output scale. Measured: one half as ``(x + 1) >> 1``."""
    if scale == C.SCALE_BY_ONE_HALF:
        return (x + 1) >> 1
    return x << scale


def output(products, scale, biased, a):
    """One output of a portion from the exact sum of its products, or from each of them rounded."""
    half, unit = a.half // a.grid if biased else 0, a.one * a.grid
    if a.per_product:
        total = scaled(sum(quotient(n, unit) for n in products) - half, scale)
    elif a.round_first:
        total = scaled(quotient(sum(products), unit) - half, scale)
    else:
        n = sum(products)
        total = (n + unit) // (2 * unit) if scale == C.SCALE_BY_ONE_HALF else quotient(n << scale, unit)
        total = total - (2 * half if scale == C.SCALE_BY_TWO else half)
    return np.clip(total * a.grid, a.low, a.high)


def function_output(value, scale, biased, a):
    """The output of a portion whose sum a function takes the place of, from the function's value."""
    return np.clip(scaled(value - (a.half if biased else 0), scale), a.low, a.high)


def takes_cd(spare0_alpha, lowest_bit, a):
    """Where a mux takes CD: SPARE0's alpha, clamped, has its highest bit, or its lowest, set."""
    alpha = np.clip(spare0_alpha, 0, a.one)
    return ((alpha + a.grid // 2) // a.grid & 1) == 1 if lowest_bit else alpha >= a.half


def product(n, a):
    """A product of two numbers, or a sum of such, rounded."""
    return quotient(n, a.one * a.grid) * a.grid


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

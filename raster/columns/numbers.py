"""Fixed-point numbers of any width, in int64 columns: the rules of docs/numbers.md with widths as parameters.

A width of n bits has ``one = 2**n - 1`` as its value of one. NumPy only, one fragment in each row.
"""

import numpy as np


def one_of(bits):
    """The value of one of a width."""
    return (1 << bits) - 1


def quotient(n, one):
    """``floor(n / one + 1/2)`` of an int64 array: ``rn`` of docs/numbers.md, section 8."""
    return (2 * n + one) // (2 * one)


def convert(values, one, other):
    """Numbers in units of ``one`` to the nearest in units of ``other``, halves up.

    Source: OpenGL 1.2.1 section 2.13.9 (to nearest); Assumed: between two widths inside a machine too.
    """
    return values if one == other else (2 * other * values + one) // (2 * one)


def fixed(values, one):
    """Reals, clamped to [0, 1], in units of ``one``: ``floor(one v + 1/2)``. Source: OpenGL 1.2.1, 2.13.9."""
    return np.floor(np.clip(np.asarray(values, np.float64), 0.0, 1.0) * one + 0.5).astype(np.int64)


def lerp(p, q, fraction, bits):
    """From p to q by a fraction of ``bits`` bits, to nearest: section 6's filter. Measured: with 8 bits."""
    return (p * ((1 << bits) - fraction) + q * fraction + (1 << bits >> 1)) >> bits


# --------------------------------------------------------------------------------------------------- fog


def fog_factor(coordinate, thresholds, rising):
    """How many of the thresholds the coordinates have not passed, int64 [k]; ``rising``: they grow with k."""
    if rising:  # c >= T_k
        kept = np.searchsorted(thresholds, coordinate, side="right")
    else:  # T_k falls with k; c <= T_k
        kept = len(thresholds) - np.searchsorted(thresholds[::-1], coordinate, side="left")
    return np.where(np.isnan(coordinate), 0, kept).astype(np.int64)  # what is not a number keeps none


def with_fog(color, fog_color, factor, one, grid=1):
    """``rn(f C + (one - f) Cf)`` of columns [..., k], a multiple of ``grid``. Source: OpenGL 1.2.1 section
    3.10.
    """
    return quotient(factor * color + (one - factor) * fog_color, one * grid) * grid

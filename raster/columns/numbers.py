"""Fixed-point numbers of any width, in int64 columns: the rules of docs/numbers.md with widths as parameters.

A width of n bits has ``one = 2**n - 1`` as its value of one. NumPy only, one fragment in each row.

``INTEGERS`` and ``REALS`` are the two kinds of numbers that a stage may compute with. Both count in units of
the same ``one``. Integers round what they make; reals do not.
"""

from typing import Any

import numpy as np

from fixedpipe.raster import codes as C

NOISE = 1e-9  # what float64 may lose of a whole number n by n / 255 * 255


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


class Integers:
    """Whole numbers: every result is rounded as a machine rounds it. Columns are int64, or float64 where an
    earlier stage computed with reals.
    """

    rounds = True
    dtype: Any = np.int64

    @staticmethod
    def quotient(n, one):
        """A product of two numbers, or a sum of such, in units of ``one`` again."""
        return quotient(n, one)

    @staticmethod
    def scaled(x, scale):
        """Rounded values times an output scale. Measured: one half as ``(x + 1) >> 1``."""
        return (x + 1) // 2 if scale == C.SCALE_BY_ONE_HALF else x * (1 << scale)

    @staticmethod
    def fixed(values, one):
        """Reals, clamped to [0, 1], as numbers of this kind."""
        return fixed(values, one)

    @staticmethod
    def convert(values, one, other):
        """Numbers in units of ``one`` in units of ``other``."""
        return convert(values, one, other)

    @staticmethod
    def lerp(p, q, fraction, bits):
        """From p to q by a fraction of ``bits`` bits."""
        return lerp(p, q, fraction, bits)

    @staticmethod
    def shared(total, parts):
        """A sum divided by so many parts, cut."""
        return total // parts


class Reals:
    """Real numbers, float64: nothing is rounded, and no constant is clamped."""

    rounds = False
    dtype: Any = np.float64

    @staticmethod
    def quotient(n, one):
        """A product of two numbers, or a sum of such, in units of ``one`` again."""
        return n / one

    @staticmethod
    def scaled(x, scale):
        """Values times an output scale."""
        return x * (0.5 if scale == C.SCALE_BY_ONE_HALF else float(1 << scale))

    @staticmethod
    def fixed(values, one):
        """Reals as numbers of this kind."""
        return np.asarray(values, np.float64) * one

    @staticmethod
    def convert(values, one, other):
        """Numbers in units of ``one`` in units of ``other``."""
        return values if one == other else values * (other / one)

    @staticmethod
    def lerp(p, q, fraction, bits):
        """From p to q by a fraction of ``bits`` bits; None: by one that is a real number itself."""
        return p + (q - p) * (fraction if bits is None else fraction / (1 << bits))

    @staticmethod
    def shared(total, parts):
        """A sum divided by so many parts."""
        return total / parts


INTEGERS, REALS = Integers(), Reals()


# --------------------------------------------------------------------------------------------------- fog


def fog_factor(coordinate, thresholds, rising):
    """How many of the thresholds the coordinates have not passed, int64 [k]; ``rising``: they grow with k."""
    if rising:  # c >= T_k
        kept = np.searchsorted(thresholds, coordinate, side="right")
    else:  # T_k falls with k; c <= T_k
        kept = len(thresholds) - np.searchsorted(thresholds[::-1], coordinate, side="left")
    return np.where(np.isnan(coordinate), 0, kept).astype(np.int64)  # what is not a number keeps none


def with_fog(color, fog_color, factor, one, numbers=INTEGERS):
    """``rn(f C + (one - f) Cf)`` of columns [..., k]. Source: OpenGL 1.2.1 section 3.10."""
    return numbers.quotient(factor * color + (one - factor) * fog_color, one)

"""Powers of two and logarithms of the transform unit, for vertex programs' EXP, LOG and LIT.

Source: envytools (nvhw/xf.c), whose tables these are: 32 linear pieces each; a piece begins where the one
before ends.
"""

import numpy as np

from fixedpipe.raster.floats import SINGLE_BITS, keep_significant_bits

# Slopes of the 32 pieces of 2^x and of log2(x).
EXPONENTIAL_SLOPES = (
    *(359, 366, 375, 383, 391, 400, 409, 417, 427, 436, 445, 455, 466, 475, 486, 497),
    *(507, 518, 530, 542, 553, 565, 578, 591, 603, 617, 629, 645, 657, 673, 689, 699),
)
LOGARITHM_SLOPES = (
    *(11702, 11271, 10966, 10650, 10361, 10106, 9800, 9574, 9337, 9112, 8898, 8693, 8499, 8310, 8133, 7962),
    *(7796, 7641, 7488, 7343, 7202, 7070, 6939, 6814, 6692, 6578, 6464, 6356, 6251, 6147, 6058, 5930),
)
_EXPONENTIAL, _LOGARITHM = np.array(EXPONENTIAL_SLOPES), np.array(LOGARITHM_SLOPES)
_EXPONENTIAL_STARTS = np.concatenate([[0], np.cumsum(EXPONENTIAL_SLOPES)])
_LOGARITHM_STARTS = np.concatenate([[0], np.cumsum(LOGARITHM_SLOPES)])
_POWER_STEPS = 1 << 13  # in one unit of an exponent
_LAST_BIT = 2.0 ** (1 - SINGLE_BITS)  # of the number one
_LOGARITHM_STEPS = 1 << 26


def _exponential_of_steps(steps):
    """2^(steps / 8192); ``steps`` are whole numbers, int64."""
    whole, piece, rest = steps >> 13, steps >> 8 & 31, steps & 255
    fraction = _EXPONENTIAL_STARTS[piece] * 256 + _EXPONENTIAL[piece] * rest
    value = np.ldexp(((fraction << 1) + (1 << 23)).astype(np.float64), np.clip(whole, -200, 200) - 23)
    return np.where(whole <= -127, 0.0, np.where(whole >= 128, np.inf, value))


def _steps(column):
    """An exponent in steps, rounded toward minus infinity.

    It is limited just beyond single precision's range. A magnitude below the last bit of a single-precision
    one gives 0; NaN counts as infinity.
    """
    column = np.where(np.abs(column) < _LAST_BIT, 0.0, np.where(np.isnan(column), np.inf, column))
    return np.floor(np.clip(column, -512.0, 512.0) * _POWER_STEPS).astype(np.int64)


def exponential(column):
    """2^x of a column."""
    return np.where(np.isnan(column), np.nan, _exponential_of_steps(_steps(column)))


def exponential_parts(column):
    """EXP's x and y: 2^floor(x), and x - floor(x), toward minus infinity where x is negative."""
    whole = _exponential_of_steps(_steps(column) & -_POWER_STEPS)
    large = np.abs(column) >= 1.0 / _LAST_BIT  # these have no fraction
    some = np.where(large | np.isnan(column), 0.0, column)
    negative = np.where(some > -_LAST_BIT, 1.0, np.floor(some / _LAST_BIT) * _LAST_BIT - np.floor(some))
    fraction = np.where(some < 0.0, negative, some - np.floor(some))
    return whole, np.where(np.isnan(column), np.nan, fraction)


def _logarithm_steps(column):
    """log2 of a positive, finite column, in steps of 2^-26, int64."""
    mantissa, power = np.frexp(column)
    fraction = np.ldexp(mantissa, 24).astype(np.int64) - (1 << 23)
    piece, rest = fraction >> 18, fraction >> 10 & 255
    return (
        _LOGARITHM_STARTS[piece] * 256
        + _LOGARITHM[piece] * rest
        + (power.astype(np.int64) - 1) * _LOGARITHM_STEPS
    )


def logarithm(column):
    """log2 of a column without negative numbers, cut to 24 bits; that of 0 is minus infinity."""
    some = np.isfinite(column) & (column > 0)
    steps = _logarithm_steps(np.where(some, column, 1.0))
    value = keep_significant_bits(steps / _LOGARITHM_STEPS, SINGLE_BITS)
    return np.where(some, value, np.where(column == 0, -np.inf, column))


def lit_power(base, exponent):
    """LIT's z where its x is positive: 2^(exponent log2(base)), with the exponent within -128 and 128."""
    some = np.isfinite(base) & (base > 0)
    steps = _logarithm_steps(np.where(some, base, 1.0))
    power = np.clip(_steps(exponent), -(1 << 20), (1 << 20) - 1)
    # 34 bits times 21 fit int64.
    value = _exponential_of_steps(steps * power >> 26)
    limit = np.where(np.signbit(exponent) == np.isinf(base), 0.0, np.inf)
    value = np.where(some, value, limit)
    value = np.where(np.isnan(base) | np.isnan(exponent), np.nan, value)
    return np.where(exponent == 0, 1.0, value)

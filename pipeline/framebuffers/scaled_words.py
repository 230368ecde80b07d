"""Arithmetic on Components of fixed-point pixel groups, in real numbers.

A component of an integer type is a fraction, ``word / one``, which float64 seldom holds exactly. With scale
and bias it may lie half-way between two entries of a table, and such a half must round up at its next
rounding. So the result is the least float64 that is not below the real number. Times a table's size it is not
below the half either, because rounding keeps the order. docs/numbers.md has the rule.

Source: OpenGL 1.2.1 section 3.6.5, Arithmetic on Components. Inferred: the half, from SGI's Sample
Implementation 1.2.1, which takes entry 83 where a byte leads to 82.5.
"""

from math import inf, nextafter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Words(NamedTuple):
    """Pixel groups in fixed point: whole numbers [..., 4], and the number that is 1.0 in each component."""

    values: NDArray[np.integer[Any]]
    ones: tuple[int, ...]


def scaled_words(words: Words, scale: tuple[float, ...], bias: tuple[float, ...]) -> NDArray[np.float64]:
    """Words times ``scale``, plus ``bias``, for each component, float64 [..., 4]."""
    result = np.empty(words.values.shape)
    for k, (one, factor, term) in enumerate(zip(words.ones, scale, bias, strict=True)):
        result[..., k] = _scaled(words.values[..., k], one, float(factor), float(term))
    return result


def _scaled(words, one, scale, bias):
    if (scale, bias) == (1.0, 0.0):  # no half lies there, because ``one`` is odd
        return words / float(one)
    (over, under), (more, part) = scale.as_integer_ratio(), bias.as_integer_ratio()
    factor, term, whole = over * part, more * under * one, under * part * one
    each, places = np.unique(words, return_inverse=True)
    found = [_not_below(word * factor + term, whole) for word in each.tolist()]
    return np.array(found, np.float64)[places].reshape(words.shape)


def _not_below(numerator, denominator):
    """The least float64 that is not below a fraction with a positive denominator."""
    nearest = numerator / denominator  # Python rounds a quotient of integers once.
    top, bottom = nearest.as_integer_ratio()
    return nextafter(nearest, inf) if top * denominator < numerator * bottom else nearest

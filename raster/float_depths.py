"""Depths that are floats without a sign: the bits of their words, and what the largest of them is worth.

A word is the upper bits of the same depth as a float64, its exponent counted from the format's bias: words
grow with depths. An exponent of 0 holds nothing but zero. Kernels read the formats' numbers as constants.

Source: NV_depth_buffer_float (floats hold window z itself). Measured: four bits of exponent and twelve of
fraction, 400 of 400 depths (Depth_buffer captures); Inferred: eight and sixteen.
"""

from typing import NamedTuple

import numpy as np

from fixedpipe.raster.codes import DEPTH_FLOAT_16, DEPTH_FLOAT_24
from fixedpipe.raster.floats import EXPONENT_BIAS, FRACTION_BITS


class FloatDepth(NamedTuple):
    """A format: its code; bits of its fraction; what is added to its exponent; its largest word.

    dropped   how many of a float64's lower bits a word leaves out
    rebias    what a word is less than the float64's upper bits, whose exponent has another bias
    """

    code: int
    fraction_bits: int
    bias: int
    largest: int
    dropped: int
    rebias: int


def _format(code, fraction_bits, bias, largest):
    rebias = (EXPONENT_BIAS - bias) << fraction_bits
    return FloatDepth(code, fraction_bits, bias, largest, FRACTION_BITS - fraction_bits, rebias)


FLOAT_16 = _format(DEPTH_FLOAT_16, fraction_bits=12, bias=7, largest=0xFFFF)
# Inferred: the largest exponent is no number's, as in single precision.
FLOAT_24 = _format(DEPTH_FLOAT_24, fraction_bits=16, bias=127, largest=0xFEFFFF)


def farthest(form):
    """The depth of a format's largest word: 511.9375, or almost 2**128."""
    one = 1 << form.fraction_bits
    exponent, fraction = divmod(form.largest, one)
    return (1.0 + fraction / one) * 2.0 ** (exponent - form.bias)


def words(depths, form):
    """Positive finite depths, float64 [k], as words of a format, int64 [k]; not limited."""
    return (depths.view(np.int64) >> form.dropped) - form.rebias

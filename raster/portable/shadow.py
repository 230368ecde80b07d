"""Comparing depth texels with a reference before they are filtered (docs/numbers.md, section 12)."""

import numpy as np
from numba import float64, int32, uint64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import float_depth, projected
from fixedpipe.raster.kernel import bits_of, kernel, separate_loop
from fixedpipe.raster.portable.per_fragment import passes


@kernel
def depth_word(value, number_format, maximum):
    """A depth in units as the integer that a buffer stores: cut, and limited to 0..``maximum``.

    ``number_format``: codes.DEPTH_.... Measured: 48 captures of fixed depths (Texture_shadow_comparator).
    """
    if not value > 0.0:  # also where it is not a number
        return int32(0)
    if number_format == C.DEPTH_FIXED:
        return int32(value) if value < float64(maximum) else maximum
    if not value < np.inf:
        return maximum
    form = float_depth(number_format)
    bits = (bits_of(value) >> form.dropped) - form.rebias
    return int32(min(max(bits, 0), maximum))


@kernel("void(f8[:,::1],i8,i8,i8,f8,i8,i4,i4[:,::1])")
def shadow_reference(floats, column, divided, count, scale, number_format, maximum, ints):
    """REFERENCE of every fragment: r (``column``), over q (EXTRA) where ``divided``, as a depth word."""
    separate_loop()
    p = uint64(column)
    for i in range(count):
        r = floats[p, i]
        if divided:
            r = projected(r, floats[R.EXTRA, i])
        ints[R.REFERENCE, i] = depth_word(r * scale, number_format, maximum)


@kernel("void(u4[:,::1],i8,i4[:,::1],i4,u4,u4,i8)")
def compare_texels(packed, column, ints, function, held, failed, count):
    """A column of depth words to ``held`` where "reference FUNC texel" holds, else to ``failed``.

    Measured: 8150016 of 8150016 pixels (48 captures of Texture_shadow_comparator).
    """
    separate_loop()
    p = uint64(column)
    for i in range(count):
        holds = passes(function, ints[R.REFERENCE, i], int32(packed[p, i]))
        packed[p, i] = held if holds else failed

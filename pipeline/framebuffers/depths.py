"""Depth formats: the words and the depths that a buffer of each holds, and vertices' depths in its units."""

from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.raster import codes as C
from fixedpipe.raster.primitives.vertices import single_depths


class DepthWords(NamedTuple):
    """The words of a depth buffer.

    code            of ``raster/codes.py``, the kind
    largest         word, and ``farthest``: its depth
    mantissa, bias  a float's bits of mantissa, and what is added to its exponent; None: fixed
    """

    code: int
    largest: int
    farthest: float
    mantissa: int | None = None
    bias: int | None = None

    @property
    def float_bits(self):
        """(mantissa, bias, largest) of a float format, or None."""
        return None if self.mantissa is None else (self.mantissa, self.bias, self.largest)


DEPTH_WORDS = {
    DepthFormat.FIXED_16: DepthWords(C.DEPTH_FIXED, 0xFFFF, 65535.0),
    DepthFormat.FIXED_23: DepthWords(C.DEPTH_FIXED, 0x7FFFFF, 8388607.0),
    DepthFormat.FIXED_24: DepthWords(C.DEPTH_FIXED, 0xFFFFFF, 16777215.0),
    DepthFormat.FLOAT_16: DepthWords(C.DEPTH_FLOAT_16, 0xFFFF, 511.9375, 12, 7),
    DepthFormat.FLOAT_24: DepthWords(C.DEPTH_FLOAT_24, 0xFEFFFF, (2.0 - 2.0**-16) * 2.0**127, 16, 127),
}


def _single(depths, scale=1.0):
    """Depths times ``scale`` as the chip has them: single precision, nothing between 0 and the least normal
    number.

    Measured: vertices below 2**-126 have depth 0 (DepthFmt_z24 FZy captures); Assumed: to nearest.
    """
    single = np.empty(len(depths))
    single_depths(depths, scale, single)
    return single


def depth_units(state, framebuffer, primitives):
    """Every vertex's depth in depth units: clip w, z in these units, or window z, which a fixed format's
    farthest scales. Source: NV_depth_buffer_float (floats hold window z itself).
    """
    with np.errstate(all="ignore"):  # what overflows is limited; what is no number becomes one
        if state.w_buffering:
            return _single(1.0 / primitives.inverse_w)
        is_float = framebuffer.depth_format < 0
        if is_float or state.vertex.depth_units:
            return _single(primitives.z)
        return _single(primitives.z, DEPTH_WORDS[framebuffer.depth_format].farthest)

"""Depth formats: the words and the depths that a buffer of each holds, and vertices' depths in its units."""

import numpy as np

from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.raster import codes as C
from fixedpipe.raster.primitives.vertices import single_depths

FLOAT_DEPTHS = {-16: (12, 7, 0xFFFF), -24: (16, 127, 0xFEFFFF)}  # mantissa, bias, largest word

# The depth of a format's largest word.
FARTHEST = {
    DepthFormat.FIXED_16: 65535.0,
    DepthFormat.FIXED_23: 8388607.0,
    DepthFormat.FIXED_24: 16777215.0,
    DepthFormat.FLOAT_16: 511.9375,
    DepthFormat.FLOAT_24: (2.0 - 2.0**-16) * 2.0**127,
}
DEPTH_ROWS = {  # code, largest word
    DepthFormat.FIXED_16: (C.DEPTH_FIXED, 0xFFFF),
    DepthFormat.FIXED_23: (C.DEPTH_FIXED, 0x7FFFFF),
    DepthFormat.FIXED_24: (C.DEPTH_FIXED, 0xFFFFFF),
    DepthFormat.FLOAT_16: (C.DEPTH_FLOAT_16, 0xFFFF),
    DepthFormat.FLOAT_24: (C.DEPTH_FLOAT_24, 0xFEFFFF),
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
        return _single(primitives.z, FARTHEST[framebuffer.depth_format])

"""Vertices' depths in a depth buffer's units."""

import numpy as np

from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster.primitives.vertices import single_depths


def _single(depths, scale=1.0):
    """Depths times ``scale`` in the chip's single precision, without numbers below the least normal one.

    Measured: vertices below 2**-126 have depth 0 (DepthFmt_z24 FZy captures); Assumed: to nearest.
    """
    single = np.empty(len(depths))
    single_depths(depths, scale, single)
    return single


def depth_units(state, framebuffer, primitives):
    """Every vertex's depth in depth units: clip w, z in these units, or scaled window z.

    A fixed format multiplies window z by its farthest depth. Source: NV_depth_buffer_float (floats hold
    window z itself).
    """
    with np.errstate(all="ignore"):  # Overflow is clamped later, and NaN becomes a number.
        if state.w_buffering:
            return _single(1.0 / primitives.inverse_w)
        if framebuffer.depth_format.is_float or state.vertex.depth_units:
            return _single(primitives.z)
        return _single(primitives.z, DEPTH_WORDS[framebuffer.depth_format].farthest)

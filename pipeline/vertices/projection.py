"""From clip coordinates to window coordinates (section 2.10.1) and to the subpixel grid."""

import numpy as np

from fixedpipe.pipeline.vertices.arithmetic import ONE
from fixedpipe.pipeline.vertices.chip_floats import transform_reciprocal
from fixedpipe.raster.floats import SINGLE_BITS, keep_significant_bits


def viewport_transform(viewport, width, height):
    """Half the viewport's size and its middle, (x, y), in window coordinates with y up."""
    size = (
        width if viewport.width is None else viewport.width,
        height if viewport.height is None else viewport.height,
    )
    half_size = [np.float64(extent * 0.5) for extent in size]
    return half_size, [np.float64(viewport.x) + half_size[0], np.float64(viewport.y) + half_size[1]]


def window_coordinates(clip_coordinates, viewport, half_size, center):
    """Section 2.10.1: window x, y (up) and z, not rounded, and 1 / w."""
    x, y, z, w = clip_coordinates
    near, far = np.float64(viewport.near), np.float64(viewport.far)
    return (
        (x / w) * half_size[0] + center[0],
        (y / w) * half_size[1] + center[1],
        (z / w) * ((far - near) * np.float64(0.5)) + (far + near) * np.float64(0.5),
        ONE / w,
    )


def composite_coordinates(clip_coordinates, offset, height):
    """Window x, y (up), depth units and 1 / w; product and sum are truncated to single precision.

    The reciprocal is the transform unit's; weights use w itself.

    Measured: Depth_buffer_fixed_function z24_Cn_FZn_Mffffff has 48089 depths that a truncated quotient makes
    too large; the reciprocal gives all of them, and 62 of 64 colours. W_buffering FloorQuad_V0: weights by w
    give 230809 of 230809 texels; by the reciprocal's w, 33 differ.
    """
    *coordinates, w = clip_coordinates
    reciprocal = transform_reciprocal(w)
    quotients = [keep_significant_bits(column * reciprocal, SINGLE_BITS) for column in coordinates]
    x, y, z = (keep_significant_bits(q + o, SINGLE_BITS) for q, o in zip(quotients, offset, strict=True))
    own = np.where(np.isfinite(reciprocal) & (reciprocal != 0.0), ONE / w, reciprocal)
    return x, height - y, z, own


def program_reciprocal(w):
    """1/w of a w that a vertex program wrote, clamped as RCC clamps it.

    An infinite w has next to no weight; a w of 0 outweighs all others. A zero keeps its sign. Source:
    NV_vertex_program1_1; Measured: Front_face, W_param.
    """
    clamped = np.fmin(np.fmax(np.abs(ONE / w), np.float64(2.0**-64)), np.float64(2.0**64))
    return np.where(np.isnan(w), w, np.copysign(clamped, w))


def snap(device, extent, profile):
    """Clamp to the guard band, NaN too, then truncate toward zero to the subpixel grid."""
    low, high = np.float64(-profile.arithmetic.guard_band), np.float64(extent + profile.arithmetic.guard_band)
    steps = np.float64(1 << profile.arithmetic.subpixel_bits)
    return np.trunc(np.fmin(np.fmax(device, low), high) * steps)

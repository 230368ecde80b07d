"""Levels with border texels, rewritten as levels that the filters can read without a border."""

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.floats import TAU


def with_border(level, where, sampler, beside, linear):
    """Rewrite a level with border texels so that a filter reads it with CLAMP_TO_EDGE.

    level   float64 [faces, h, w, 4], with the border
    where   the TextureCoordinates
    beside  how many border texels there are along s, t and r

    Returns the level, float64 of the same shape, and positions in it, float64 [k, 2 or 3]. Where a wrap mode
    reads no border, the border holds the texels that the mode reads there. For a nearest filter the positions
    are texel centres. Source: OpenGL 1.2.1 sections 3.8.4 to 3.8.6; docs/numbers.md, section 6.
    """
    position = np.empty(where.position.shape)
    wraps = sampler.wrap_s, sampler.wrap_t, sampler.wrap_r
    for k, (axis, border) in enumerate(zip((2, 1, 0), beside, strict=True)):
        if k >= position.shape[1]:
            break
        size, mode = level.shape[axis] - 2 * border, wraps[k]
        texel = where.position[:, k] * size
        if not linear:
            lifted = where.slip[:, k] * size + where.bias[:, 0]
            texel = texel + np.where(lifted >= 0.0, TAU, -TAU)
        texel, taken = _in_reach(np.where(np.isfinite(texel), texel, 0.0), mode, size, border, linear)
        level = np.take(level, taken + border, axis)
        position[:, k] = (texel + border) / (size + 2 * border)
    return level, position


def _in_reach(texel, mode, size, border, linear):
    """Texel coordinates along an axis after the wrap mode, and which texel each index reads.

    Indices run from -border to size - 1 + border.
    """
    index = np.arange(-border, size + border)
    inside = np.clip(index, 0, size - 1)
    if mode == C.WRAP_REPEAT:
        texel, index = texel % size, index % size
    elif mode == C.WRAP_MIRRORED_REPEAT:
        texel = texel % (2.0 * size)
        texel, index = np.minimum(texel, 2.0 * size - texel), inside
    else:  # CLAMP, CLAMP_TO_EDGE and CLAMP_TO_BORDER
        reach = {
            C.WRAP_CLAMP: 0.0,
            C.WRAP_CLAMP_TO_EDGE: -0.5,
            C.WRAP_CLAMP_TO_BORDER: max(border, 1) - 0.5,
        }[mode]
        texel = np.clip(texel, -reach, size + reach)
        if mode == C.WRAP_CLAMP_TO_EDGE or (mode == C.WRAP_CLAMP and not linear):
            index = inside
    return (texel if linear else np.floor(texel) + 0.5), index

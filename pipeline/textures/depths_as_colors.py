"""Depth textures that a unit reads without a comparison become textures of colours for every engine.

Source: ARB_shadow section 3.8.13.1 (TEXTURE_COMPARE_MODE NONE gives the depth itself); ARB_depth_texture
section 3.8.5 (as LUMINANCE, INTENSITY or ALPHA); NV_register_combiners table 2 (with register combiners
enabled 0, 0, 0 and the depth, in every mode). docs/numbers.md, N12.23, has the arithmetic.
"""

from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from fixedpipe.pipeline.enums import BaseFormat, InternalFormat, TextureCompareMode
from fixedpipe.pipeline.textures.images import (
    DEPTH_TEXELS,
    Texture,
    border_components,
    depth_texture_mode,
    register_components,
)

_FORMATS = {
    BaseFormat.LUMINANCE: InternalFormat.LUMINANCE8,
    BaseFormat.INTENSITY: InternalFormat.INTENSITY8,
    BaseFormat.ALPHA: InternalFormat.ALPHA8,
}
_made = WeakKeyDictionary()  # {depth texture: {(base format, width): texture of colours}}


def depths_as_colors(state, textures, profile):
    """(PassState, textures by name) in which units that read depths without a comparison read colours.

    ``textures`` maps names to Textures, at least to those that the state's units read. Names in a frame are
    strings; the name of a new texture is a tuple. Each depth texture is converted once.
    """
    units, held = list(state.texture_units), None
    for number, unit in enumerate(units):
        if unit is None or unit.texture is None or unit.sampler.compare_mode is not TextureCompareMode.NONE:
            continue
        texture = textures[unit.texture]
        if texture.internal_format not in DEPTH_TEXELS:
            continue
        base = BaseFormat.ALPHA
        if state.register_combiners is None:
            base = depth_texture_mode(unit.sampler, profile)
        # Source: ARB_depth_texture, section 3.8.7 (the border color's red is a depth).
        red = np.full(4, unit.sampler.border_color[0])
        border = tuple(border_components(red, base, 1.0, as_given=False).tolist())
        sampler = replace(unit.sampler, border_color=border, depth_texture_mode=None)
        units[number] = replace(unit, texture=(unit.texture, base), sampler=sampler)
        held = dict(textures) if held is None else held
        held[unit.texture, base] = _colors_of(texture, base, profile.arithmetic.texture_bits)
    if held is None:
        return state, textures
    return replace(state, texture_units=tuple(units)), held


def _colors_of(texture, base, bits):
    """The depth texture as a texture of a base format, with components of ``bits`` bits."""
    made = _made.setdefault(texture, {})
    if (base, bits) not in made:
        unread = DEPTH_TEXELS[texture.internal_format].largest.bit_length() - bits
        dtype: type[np.integer] = np.uint8 if bits == 8 else np.uint16
        words = [np.ascontiguousarray(level).view("<u4") >> unread for level in texture.levels]
        one = dtype((1 << bits) - 1)
        levels = tuple(register_components(word.astype(dtype), base, one) for word in words)
        ideal = texture.ideal
        if ideal is not None:
            ideal = tuple(register_components(level[..., :1], base, 1.0) for level in ideal)
        made[base, bits] = Texture(texture.target, _FORMATS[base], levels, ideal, bits, texture.border)
    return made[base, bits]

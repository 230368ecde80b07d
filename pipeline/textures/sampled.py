"""A texture as a unit samples it: from its base level on, with a color key applied to its texels.

Engines see a texture whose level 0 is the base level. That equals the rule: the scale factor, filters without
mipmaps, magnification and completeness use the base level, and the equations that choose levels only add it.
Source: OpenGL 1.2.1 sections 3.8.5 and 3.8.6, equations 3.15 and 3.21 to 3.23; SGIS_texture_lod.

A color key is compared with single texels, and a unit with a color key reads the nearest texel. So engines
see a texture with the key applied. For a key that discards fragments, they read a second texture of zeros and
ones. Measured: 2727494 of 2727494 pixels (Color_key captures).
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.enums import ColorKeyOperation, InternalFormat, WrapMode
from fixedpipe.pipeline.state import ColorKey, Sampler, SignedComponents, TextureUnit
from fixedpipe.pipeline.textures.images import Texture, store_texels

# By texture, and by the unit's fields that change it. The values hold arrays, and not the key texture.
_sampled: WeakKeyDictionary[Texture, dict[Any, Texture]] = WeakKeyDictionary()


def sampled_texture(unit: TextureUnit, textures: Mapping[str, Texture]) -> Texture:
    """The unit's texture, from the unit's base level on, with its color key applied to the texels.

    ``textures`` are by name. Repeated calls return the same object.
    """
    texture, lowest, key = textures[unit.texture], unit.sampler.base_level, unit.color_key  # type: ignore[index]
    if key is not None and key.operation is ColorKeyOperation.KILL:
        key = None
    if lowest == 0 and key is None:
        return texture
    made = _sampled.setdefault(texture, {})
    if (lowest, key) not in made:
        levels, ideal = texture.levels[lowest:], texture.ideal and texture.ideal[lowest:]
        if key is not None:
            equal = _equal_to(key, texture, lowest)
            levels = _without(levels, equal, key.operation)
            ideal = ideal and _without(ideal, equal, key.operation)
        made[lowest, key] = replace(texture, levels=levels, ideal=ideal)
    return made[lowest, key]


def _equal_to(key: ColorKey, texture: Texture, lowest: int) -> list[NDArray[np.bool_]]:
    """Which stored texels of each level, from the lowest on, equal a key; the ideal uses these too."""
    stored = store_texels(np.array(key.color, np.float64), texture.internal_format)
    return [(level == stored).all(axis=-1) for level in texture.levels[lowest:]]


def _without(
    levels: tuple[NDArray[Any], ...], equal: list[NDArray[np.bool_]], operation: ColorKeyOperation
) -> tuple[NDArray[Any], ...]:
    """Levels in which the texels that equal the key have an alpha of 0, or four zeros."""
    out = []
    for level, chosen in zip(levels, equal, strict=True):
        left = level.copy()
        left[chosen, 3 if operation is ColorKeyOperation.ALPHA else slice(None)] = 0
        out.append(left)
    return tuple(out)


def key_unit(unit: TextureUnit, textures: Mapping[str, Texture]) -> tuple[TextureUnit, Texture]:
    """A unit and its texture that show where the unit's color key discards fragments.

    The texture's four components are 0 there and 1 elsewhere. The border colour is no key (Assumed).
    """
    texture, lowest = textures[unit.texture], unit.sampler.base_level  # type: ignore[index]
    key = unit.color_key
    if key is None:
        raise ValueError("The unit has no color key.")
    made = _sampled.setdefault(texture, {})
    if (key, lowest) not in made:
        left = tuple(np.repeat(~equal[..., None], 4, axis=-1) for equal in _equal_to(key, texture, lowest))
        made[key, lowest] = replace(
            texture,
            internal_format=InternalFormat.RGBA8,
            levels=tuple(level * np.uint8(255) for level in left),
            ideal=tuple(level.astype(np.float64) for level in left),
        )
    ones = replace(unit.sampler, border_color=(1.0,) * 4, signed_components=SignedComponents())
    return replace(unit, sampler=ones, color_key=None, color_table=None), made[key, lowest]


def face_modes(sampler: Sampler, texture: Texture) -> tuple[WrapMode, WrapMode, WrapMode]:
    """The wrap modes of a cube map's faces; with a border they are the sampler's modes that read it.

    Measured: CLAMP_TO_BORDER (Cube_BorderTex_SZ_2x2, _16x16, _32x32). Inferred: CLAMP likewise.
    """
    reads = WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER
    wraps = sampler.wrap_s, sampler.wrap_t
    s, t = (mode if texture.border and mode in reads else WrapMode.CLAMP_TO_EDGE for mode in wraps)
    return s, t, WrapMode.CLAMP_TO_EDGE

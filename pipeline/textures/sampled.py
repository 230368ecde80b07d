"""A texture as a unit samples it: from its base level on.

Engines see a texture whose level 0 is the base level. That is the rule itself. The scale factor, filters
without mipmaps, magnification and completeness go by the base level. The equations that choose levels have it
as an addend alone.
Source: OpenGL 1.2.1 sections 3.8.5 and 3.8.6, equations 3.15 and 3.21 to 3.23; SGIS_texture_lod.
"""

from collections.abc import Mapping
from dataclasses import replace
from weakref import WeakKeyDictionary

from fixedpipe.pipeline.enums import WrapMode
from fixedpipe.pipeline.state import Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import Texture

# By texture and base level. What is kept holds the texture's levels, and not the texture.
_sampled: WeakKeyDictionary[Texture, dict[int, Texture]] = WeakKeyDictionary()


def sampled_texture(unit: TextureUnit, textures: Mapping[str, Texture]) -> Texture:
    """The unit's texture of those by name, from the unit's base level on: the same object each time."""
    texture, lowest = textures[unit.texture], unit.sampler.base_level  # type: ignore[index]  # it names one
    if lowest == 0:
        return texture
    made = _sampled.setdefault(texture, {})
    if lowest not in made:
        ideal = None if texture.ideal is None else texture.ideal[lowest:]
        made[lowest] = replace(texture, levels=texture.levels[lowest:], ideal=ideal)
    return made[lowest]


def face_modes(sampler: Sampler, texture: Texture) -> tuple[WrapMode, WrapMode, WrapMode]:
    """The wrap modes of a cube map's faces: a face with a border has those of its sampler that read it.

    Measured: CLAMP_TO_BORDER (Cube_BorderTex_SZ_2x2, _16x16, _32x32). Inferred: CLAMP likewise.
    """
    reads = WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER
    wraps = sampler.wrap_s, sampler.wrap_t
    s, t = (mode if texture.border and mode in reads else WrapMode.CLAMP_TO_EDGE for mode in wraps)
    return s, t, WrapMode.CLAMP_TO_EDGE

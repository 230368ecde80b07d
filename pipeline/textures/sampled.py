"""A texture as a unit samples it: from its base level on.

Engines see a texture whose level 0 is the base level. That is the rule itself. The scale factor, filters
without mipmaps, magnification and completeness go by the base level. The equations that choose levels have it
as an addend alone.
Source: OpenGL 1.2.1 sections 3.8.5 and 3.8.6, equations 3.15 and 3.21 to 3.23; SGIS_texture_lod.
"""

from collections.abc import Mapping
from dataclasses import replace
from weakref import WeakKeyDictionary

from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import Texture

# By texture and base level. What is kept holds the texture's levels, and not the texture.
_sampled: WeakKeyDictionary[Texture, dict[int, Texture]] = WeakKeyDictionary()


def sampled_texture(unit: TextureUnit, textures: Mapping[str, Texture]) -> Texture:
    """The unit's texture of those by name, from the unit's base level on: the same object each time."""
    texture, base = textures[unit.texture], unit.sampler.base_level  # type: ignore[index]  # it names one
    if base == 0:
        return texture
    made = _sampled.setdefault(texture, {})
    if base not in made:
        ideal = None if texture.ideal is None else texture.ideal[base:]
        made[base] = replace(texture, levels=texture.levels[base:], ideal=ideal)
    return made[base]

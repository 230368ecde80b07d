"""Color keys: what becomes of texels that equal a unit's key.

Measured: 2727494 of 2727494 pixels (Color_key captures); docs/numbers.md section 7.
"""

from dataclasses import replace
from types import SimpleNamespace

from fixedpipe.pipeline.enums import ColorKeyOperation, InternalFormat, TextureShaderOperation
from tests.reference import texel_formats


def changed(texture, of_texel, internal_format):
    """A texture of what a function makes of each texel. Assumed: nothing, a texel at a time."""
    levels = [[[[of_texel(t) for t in row] for row in face] for face in level] for level in texture.levels]
    border = getattr(texture, "border", 0)
    return SimpleNamespace(
        target=texture.target, internal_format=internal_format, levels=levels, border=border
    )


def equals(texel, unit, texture):
    """Whether a texel equals the unit's key, stored as the texture's format stores it.

    Measured: whole words of A8R8G8B8, and X8R8G8B8 without its unused bits; Inferred: other formats.
    """
    key = texel_formats.store_texel(unit.color_key.color, texture.internal_format, floats=True)
    return list(texel) == key


def left(texture, unit):
    """A unit's texture with what its key leaves of each texel. Measured: ALPHA and RGBA (Color_key)."""
    if unit.color_key is None or unit.color_key.operation == ColorKeyOperation.KILL:
        return texture
    alpha = unit.color_key.operation == ColorKeyOperation.ALPHA

    def of_texel(texel):
        """One texel. Measured: as ``left``."""
        if not equals(texel, unit, texture):
            return texel
        return [*texel[:3], 0] if alpha else [0, 0, 0, 0]

    return changed(texture, of_texel, texture.internal_format)


def killing(state):
    """Units that end fragments: those that are sampled. Measured: UnsampledTex (Color_key)."""
    shader, found = state.texture_shader, []
    for i, unit in enumerate(state.texture_units):
        key = None if unit is None else unit.color_key
        if key is None or key.operation != ColorKeyOperation.KILL:
            continue
        if shader is None or (i < len(shader) and shader[i].operation != TextureShaderOperation.NONE):
            found.append(i)
    return found


def ends(texture, unit):
    """(a texture of zeros where a texel ends its fragment, a unit that reads it). Measured: KILL (Color_key);
    Assumed: the border colour ends none.
    """
    flags = changed(texture, lambda t: [0 if equals(t, unit, texture) else 255] * 4, InternalFormat.RGBA8)
    return flags, replace(unit, sampler=replace(unit.sampler, border_color=(1.0,) * 4), color_key=None)

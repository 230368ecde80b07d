"""Formats of NV_texture_shader whose texels have signs, and those whose texels are no colours."""

from dataclasses import replace

from fixedpipe.pipeline.enums import InternalFormat, TextureShaderOperation

# Source: NV_texture_shader table 3.16 (an asterisk is a sign). Assumed: a copy has its original's sign.
SIGNS = {
    InternalFormat.SIGNED_HILO16: "GA",
    InternalFormat.DSDT8: "RGBA",
    InternalFormat.DSDT8_MAG8: "GB",
    InternalFormat.SIGNED_RGBA8: "RGBA",
}
# Source: NV_texture_shader table 3.D: the formats whose type is not RGBA.
COLORLESS = (
    InternalFormat.HILO16,
    InternalFormat.SIGNED_HILO16,
    InternalFormat.DSDT8,
    InternalFormat.DSDT8_MAG8,
)
_LETTERS = {"R": "red", "G": "green", "B": "blue", "A": "alpha"}
_WITHOUT_TEXEL = (
    TextureShaderOperation.NONE,
    TextureShaderOperation.PASS_THROUGH,
    TextureShaderOperation.CULL_FRAGMENT,
    TextureShaderOperation.DOT_PRODUCT,
    TextureShaderOperation.DOT_PRODUCT_DEPTH_REPLACE,
)


def with_signs(state, textures):
    """The state whose samplers read what the formats say is signed. Source: NV_texture_shader table 3.16."""
    units = list(state.texture_units)
    for i, unit in enumerate(units):
        if unit is None or unit.texture not in textures:
            continue
        given = unit.sampler.signed_components
        for letter in SIGNS.get(textures[unit.texture].internal_format, ""):
            given = replace(given, **{_LETTERS[letter]: True})
        units[i] = replace(unit, sampler=replace(unit.sampler, signed_components=given))
    return replace(state, texture_units=tuple(units))


def as_colors(texels, state, textures, profile):
    """What registers receive of the units' texels: (0, 0, 0, 0) of one that is no colour.

    Source: NV_texture_shader table 3.D. Measured: the NV2A's receive the bytes (TexFmt_R16B16_L).
    """
    if profile.textures.hilo_as_color:
        return texels
    stages = state.texture_shader
    out = list(texels)
    for i, unit in enumerate(state.texture_units):
        reads = unit is not None and unit.texture in textures
        if stages is not None:
            operation = stages[i].operation if i < len(stages) else TextureShaderOperation.NONE
            reads = reads and operation not in _WITHOUT_TEXEL
        if reads and textures[unit.texture].internal_format in COLORLESS:
            out[i] = [0, 0, 0, 0]
    return out

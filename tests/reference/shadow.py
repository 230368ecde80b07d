"""Depth textures: every texel compared, or made a colour, before any filter. docs/numbers.md section 12."""

from dataclasses import replace
from math import floor, frexp
from types import SimpleNamespace

from fixedpipe.pipeline.enums import BaseFormat, ComparisonFunction, InternalFormat, TextureCompareMode
from tests.reference import fixed, sample, texel_formats

FIXED = {InternalFormat.DEPTH_COMPONENT16: 0xFFFF, InternalFormat.DEPTH_COMPONENT24: 0xFFFFFF}
FLOAT = {  # largest word, mantissa bits, exponent bias
    InternalFormat.DEPTH_COMPONENT16_FLOAT: (0xFFFF, 12, 7),
    InternalFormat.DEPTH_COMPONENT24_FLOAT: (0xFEFFFF, 16, 127),
}
HOLDS = {
    ComparisonFunction.NEVER: lambda a, b: False,
    ComparisonFunction.LESS: lambda a, b: a < b,
    ComparisonFunction.EQUAL: lambda a, b: a == b,
    ComparisonFunction.LEQUAL: lambda a, b: a <= b,
    ComparisonFunction.GREATER: lambda a, b: a > b,
    ComparisonFunction.NOTEQUAL: lambda a, b: a != b,
    ComparisonFunction.GEQUAL: lambda a, b: a >= b,
    ComparisonFunction.ALWAYS: lambda a, b: True,
}


def depth_word(value, internal_format):
    """Depth units as the word of a format. Measured: 166 of 169 captures (Texture_shadow_comparator)."""
    if not value > 0.0:
        return 0
    if internal_format in FIXED:
        return min(floor(value), FIXED[internal_format]) if value < 2.0**32 else FIXED[internal_format]
    largest, bits, bias = FLOAT[internal_format]
    if value == float("inf"):
        return largest
    mantissa, exponent = frexp(value)
    return min(max(((exponent - 1 + bias) << bits) + floor((2.0 * mantissa - 1.0) * 2**bits), 0), largest)


def largest_word(internal_format):
    """Source: ARB_depth_texture (fixed). Measured: Texture_shadow_comparator (of floats)."""
    return FIXED[internal_format] if internal_format in FIXED else FLOAT[internal_format][0]


def reference_word(strq, projective, internal_format, mode, profile):
    """The word that texels are compared with. Source: ARB_shadow; Measured: zero for the chip's 2D stages."""
    if mode == TextureCompareMode.COMPARE_ZERO_TO_TEXTURE:
        return 0
    r = sample.projected(strq, projective)[2]
    units = 1.0 if profile.textures.depth_units_in_coordinates else float(largest_word(internal_format))
    return depth_word(r * units, internal_format)


def as_mode(value, mode, one=255):
    """A depth texel's value in a register. Source: ARB_depth_texture, NV_register_combiners table 2."""
    return {
        BaseFormat.LUMINANCE: [value, value, value, one],
        BaseFormat.INTENSITY: [value] * 4,
        BaseFormat.ALPHA: [0, 0, 0, value],
    }[mode]


def comparison(texel, sampler, reference, profile):
    """A depth texel's four bytes to a register's.

    Measured: 38 of 38 (Texture_shadow_comparator); Source: SGIX_shadow_ambient (what fails),
    ARB_depth_texture (the mode).
    """
    word = sum(byte << (8 * k) for k, byte in enumerate(texel))
    mode = sampler.depth_texture_mode
    mode = profile.textures.depth_texture_modes[0] if mode is None else mode
    failed = fixed.color_codes([sampler.compare_fail_value] * 4)[0]
    return as_mode(255 if HOLDS[sampler.compare_function](reference, word) else failed, mode)


def compared(texture, unit, reference, profile):
    """(texture of comparisons, unit), whose border colour is a comparison too.

    Source: ARB_shadow, ARB_depth_texture (the border's red is a depth).
    """
    sampler = unit.sampler
    levels = [
        [[[comparison(p, sampler, reference, profile) for p in row] for row in face] for face in level]
        for level in texture.levels
    ]
    border = [fixed.color_code(sampler.border_color[0], largest_word(texture.internal_format))]
    color = tuple(byte / 255 for byte in comparison(border, sampler, reference, profile))
    found = SimpleNamespace(
        target=texture.target,
        internal_format=InternalFormat.RGBA8,
        levels=levels,
        border=getattr(texture, "border", 0),
    )
    return found, replace(unit, sampler=replace(sampler, border_color=color))


def as_colors(texture, unit, combiners, profile):
    """(texture, unit) as a lookup without a comparison reads them: a depth texture as one of colours, whose
    texels are the highest bits of its words. Others, and those that are compared, stay. ``combiners``: the
    register combiners, or None.

    Source: ARB_shadow (NONE gives the depth), ARB_depth_texture (the mode; the border's red is a depth),
    NV_register_combiners table 2 (0, 0, 0 and the depth, whatever the mode); Assumed: docs/numbers.md N12.23
    (which bits, and that filters come after).
    """
    if texture.internal_format not in FIXED or unit.sampler.compare_mode != TextureCompareMode.NONE:
        return texture, unit
    mode, bits = unit.sampler.depth_texture_mode, profile.arithmetic.texture_bits
    if combiners is not None:
        mode = BaseFormat.ALPHA
    elif mode is None:
        mode = profile.textures.depth_texture_modes[0]
    unread = (FIXED[texture.internal_format] + 1) >> bits

    def color(texel):
        """Assumed: docs/numbers.md N12.23 (the highest bits)."""
        return as_mode(sum(byte << (8 * k) for k, byte in enumerate(texel)) // unread, mode, 2**bits - 1)

    levels = [
        [[[color(texel) for texel in row] for row in face] for face in level] for level in texture.levels
    ]
    colors = SimpleNamespace(
        target=texture.target,
        internal_format=InternalFormat[f"{mode.name}8"],
        levels=levels,
        bits=bits,
        fraction_bits=getattr(texture, "fraction_bits", 8),
        border=getattr(texture, "border", 0),
    )
    red = (unit.sampler.border_color[0],) * 4
    border = texel_formats.register_components(texel_formats.kept_components(red, mode), mode, 1.0)
    return colors, replace(unit, sampler=replace(unit.sampler, border_color=tuple(border)))

"""A driver's choice: which of the machine's formats stores a texture of an internal format.

OpenGL leaves the choice to the implementation (OpenGL 1.2.1 section 3.8.1). A sized format keeps its own bits
if the machine has it (Source: table 3.16; each profile's ``internal_formats``). The other rules:

- A base format, and the numbers 1 to 4, have eight bits a component. Assumed: the desktop has 32 bits; on a
  desktop of 16 bits, drivers made 16-bit textures.
- Formats of 10, 12 and 16 bits have twelve if the machine has such formats, otherwise eight. Source: table
  3.16 allows any nearby resolution.
- A request to compress an image, generic or S3TC, stores it uncompressed. Source: ARB_texture_compression
  lets the driver choose this for generic formats; Assumed for S3TC, whose compressor in drivers is unknown.
- A depth texture has 24 bits, unless the program asks for 16. Source: ARB_depth_texture (nearest
  resolution).
- Signed formats of NV_texture_shader with fewer components are stored as SIGNED_RGBA8 with the same register
  components. Inferred: the chip's format list has no other signed colours (nv_objects.h).
"""

from typing import NamedTuple

from fixedpipe.pipeline.enums import BaseFormat, InternalFormat
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.textures.images import BASE_FORMAT, DEPTH_TEXELS, TWELVE_BIT_FORMATS

_F = InternalFormat
# Numbers of components, which OpenGL 1.0 accepts in place of an internal format (section 3.8.1).
COMPONENT_COUNTS = (1, 2, 3, 4)

# Base internal formats as tokens (table 3.15).
BASE_TOKENS = {
    tokens.ALPHA: BaseFormat.ALPHA,
    tokens.LUMINANCE: BaseFormat.LUMINANCE,
    tokens.LUMINANCE_ALPHA: BaseFormat.LUMINANCE_ALPHA,
    tokens.INTENSITY: BaseFormat.INTENSITY,
    tokens.RGB: BaseFormat.RGB,
    tokens.RGBA: BaseFormat.RGBA,
}
# The widest formats of a base format: with twelve bits, with eight.
_WIDEST = {
    BaseFormat.ALPHA: (_F.ALPHA12, _F.ALPHA8),
    BaseFormat.LUMINANCE: (_F.LUMINANCE12, _F.LUMINANCE8),
    BaseFormat.LUMINANCE_ALPHA: (_F.LUMINANCE12_ALPHA12, _F.LUMINANCE8_ALPHA8),
    BaseFormat.INTENSITY: (_F.INTENSITY12, _F.INTENSITY8),
    BaseFormat.RGB: (_F.RGB12, _F.RGB8),
    BaseFormat.RGBA: (_F.RGBA12, _F.RGBA8),
}
_EIGHT_BITS = {
    1: BaseFormat.LUMINANCE,
    2: BaseFormat.LUMINANCE_ALPHA,
    3: BaseFormat.RGB,
    4: BaseFormat.RGBA,
    **BASE_TOKENS,
}
# Formats whose components have more bits than eight.
_WIDE = {
    tokens.ALPHA12: BaseFormat.ALPHA,
    tokens.ALPHA16: BaseFormat.ALPHA,
    tokens.LUMINANCE12: BaseFormat.LUMINANCE,
    tokens.LUMINANCE16: BaseFormat.LUMINANCE,
    tokens.LUMINANCE12_ALPHA4: BaseFormat.LUMINANCE_ALPHA,
    tokens.LUMINANCE12_ALPHA12: BaseFormat.LUMINANCE_ALPHA,
    tokens.LUMINANCE16_ALPHA16: BaseFormat.LUMINANCE_ALPHA,
    tokens.INTENSITY12: BaseFormat.INTENSITY,
    tokens.INTENSITY16: BaseFormat.INTENSITY,
    tokens.RGB10: BaseFormat.RGB,
    tokens.RGB12: BaseFormat.RGB,
    tokens.RGB16: BaseFormat.RGB,
    tokens.RGB10_A2: BaseFormat.RGBA,
    tokens.RGBA12: BaseFormat.RGBA,
    tokens.RGBA16: BaseFormat.RGBA,
}
_SIZED = {
    getattr(tokens, f.name): f
    for f in BASE_FORMAT
    if hasattr(tokens, f.name) and f not in DEPTH_TEXELS and getattr(tokens, f.name) not in _WIDE
} | {tokens.R3_G3_B2: _F.R3_G3_B2}
_RGB2 = 0x804E  # RGB2_EXT, of EXT_texture alone
# Generic requests for compression (ARB_texture_compression).
_COMPRESSING = {
    tokens.COMPRESSED_ALPHA: BaseFormat.ALPHA,
    tokens.COMPRESSED_LUMINANCE: BaseFormat.LUMINANCE,
    tokens.COMPRESSED_LUMINANCE_ALPHA: BaseFormat.LUMINANCE_ALPHA,
    tokens.COMPRESSED_INTENSITY: BaseFormat.INTENSITY,
    tokens.COMPRESSED_RGB: BaseFormat.RGB,
    tokens.COMPRESSED_RGBA: BaseFormat.RGBA,
}


class S3TC(NamedTuple):
    """An S3TC format: the machine's format, and the base format of the texture."""

    format: InternalFormat
    base: BaseFormat


S3TC_FORMATS = {
    tokens.COMPRESSED_RGB_S3TC_DXT1_EXT: S3TC(_F.COMPRESSED_RGBA_S3TC_DXT1, BaseFormat.RGB),
    tokens.COMPRESSED_RGBA_S3TC_DXT1_EXT: S3TC(_F.COMPRESSED_RGBA_S3TC_DXT1, BaseFormat.RGBA),
    tokens.COMPRESSED_RGBA_S3TC_DXT3_EXT: S3TC(_F.COMPRESSED_RGBA_S3TC_DXT3, BaseFormat.RGBA),
    tokens.COMPRESSED_RGBA_S3TC_DXT5_EXT: S3TC(_F.COMPRESSED_RGBA_S3TC_DXT5, BaseFormat.RGBA),
}
# S3_s3tc's requests, which Quake III's engine makes.
_RGB_S3TC, _RGB4_S3TC, _RGBA_S3TC, _RGBA4_S3TC = 0x83A0, 0x83A1, 0x83A2, 0x83A3
_S3_S3TC = {
    _RGB_S3TC: BaseFormat.RGB,
    _RGB4_S3TC: BaseFormat.RGB,
    _RGBA_S3TC: BaseFormat.RGBA,
    _RGBA4_S3TC: BaseFormat.RGBA,
}
DEPTHS = {
    tokens.DEPTH_COMPONENT: 24,
    tokens.DEPTH_COMPONENT16: 16,
    tokens.DEPTH_COMPONENT24: 24,
    tokens.DEPTH_COMPONENT32: 24,
}
INDICES = frozenset(
    {
        tokens.COLOR_INDEX1_EXT,
        tokens.COLOR_INDEX2_EXT,
        tokens.COLOR_INDEX4_EXT,
        tokens.COLOR_INDEX8_EXT,
        tokens.COLOR_INDEX12_EXT,
        tokens.COLOR_INDEX16_EXT,
    }
)
# NV_texture_shader's formats of bumps: of two words of 16 bits, of offsets.
_BUMPS = {
    tokens.HILO_NV: _F.HILO16,
    tokens.HILO16_NV: _F.HILO16,
    tokens.SIGNED_HILO_NV: _F.SIGNED_HILO16,
    tokens.SIGNED_HILO16_NV: _F.SIGNED_HILO16,
    tokens.DSDT_NV: _F.DSDT8,
    tokens.DSDT8_NV: _F.DSDT8,
    tokens.DSDT_MAG_NV: _F.DSDT8_MAG8,
    tokens.DSDT8_MAG8_NV: _F.DSDT8_MAG8,
}
# Its signed colours, by the components that a register receives.
SIGNED_COLORS = {
    tokens.SIGNED_RGBA_NV: BaseFormat.RGBA,
    tokens.SIGNED_RGBA8_NV: BaseFormat.RGBA,
    tokens.SIGNED_RGB_NV: BaseFormat.RGB,
    tokens.SIGNED_RGB8_NV: BaseFormat.RGB,
    tokens.SIGNED_LUMINANCE_NV: BaseFormat.LUMINANCE,
    tokens.SIGNED_LUMINANCE8_NV: BaseFormat.LUMINANCE,
    tokens.SIGNED_LUMINANCE_ALPHA_NV: BaseFormat.LUMINANCE_ALPHA,
    tokens.SIGNED_LUMINANCE8_ALPHA8_NV: BaseFormat.LUMINANCE_ALPHA,
    tokens.SIGNED_ALPHA_NV: BaseFormat.ALPHA,
    tokens.SIGNED_ALPHA8_NV: BaseFormat.ALPHA,
    tokens.SIGNED_INTENSITY_NV: BaseFormat.INTENSITY,
    tokens.SIGNED_INTENSITY8_NV: BaseFormat.INTENSITY,
}
# Formats with names older than OpenGL 2 that no machine here has.
_WITHOUT_MACHINE = frozenset(
    {
        tokens.DSDT_MAG_INTENSITY_NV,
        tokens.DSDT8_MAG8_INTENSITY8_NV,
        tokens.SIGNED_RGB_UNSIGNED_ALPHA_NV,
        tokens.SIGNED_RGB8_UNSIGNED_ALPHA8_NV,
    }
)
# The numbers of internal formats that came with OpenGL 2 and later: sRGB, floats, integers, one and two
# components, depths beside stencil values, buffers of blocks. Source: the Khronos registry.
_LATER = (
    range(0x8225, 0x823D),  # RG, R8 to RG32UI
    range(0x8814, 0x8820),  # RGBA32F to LUMINANCE_ALPHA16F
    range(0x8C3A, 0x8C50),  # R11F_G11F_B10F, RGB9_E5, SRGB and compressed sRGB
    range(0x8CAC, 0x8CAE),  # DEPTH_COMPONENT32F, DEPTH32F_STENCIL8
    range(0x8D70, 0x8D9C),  # RGBA32UI to LUMINANCE_ALPHA_INTEGER
    range(0x8DBB, 0x8DBF),  # RGTC
    range(0x8E8C, 0x8E90),  # BPTC
    range(0x8F90, 0x8FA0),  # signed normalized formats
    (tokens.RED, tokens.DEPTH_STENCIL_EXT, tokens.DEPTH24_STENCIL8_EXT),
)


class Chosen(NamedTuple):
    """How a machine stores an internal format.

    - ``format``: the machine's format.
    - ``base``: the base format of the texture; None for depths, indices and bumps.
    - ``compressing``: whether a request to compress is ignored.
    """

    format: InternalFormat
    base: BaseFormat | None
    compressing: bool = False


def chosen_format(profile, internal_format: int) -> Chosen:
    """How ``profile`` stores textures of an internal format (a token, or 1 to 4).

    Raises GLError for another token, and Refused for an internal format that the machine lacks.
    """
    base = _COMPRESSING.get(internal_format, _S3_S3TC.get(internal_format))
    if base is None and internal_format in S3TC_FORMATS:
        base = S3TC_FORMATS[internal_format].base
    if base is not None:
        return Chosen(_WIDEST[base][1], base, compressing=True)
    if internal_format == _RGB2:
        return Chosen(_F.R3_G3_B2, BaseFormat.RGB)  # Source: table 3.16, the nearest resolution
    if internal_format in _EIGHT_BITS:
        base = _EIGHT_BITS[internal_format]
        return Chosen(_WIDEST[base][1], base)
    if internal_format in _WIDE:
        base = _WIDE[internal_format]
        wide = TWELVE_BIT_FORMATS & profile.textures.internal_formats
        own = next((f for f in wide if getattr(tokens, f.name, None) == internal_format), _WIDEST[base][0])
        return Chosen(own if wide else _WIDEST[base][1], base)
    if internal_format in _SIZED:
        return _of_machine(profile, internal_format, _SIZED[internal_format])
    return _of_extension(profile, internal_format)


def _of_extension(profile, internal_format):
    if internal_format in DEPTHS:
        depth = _F.DEPTH_COMPONENT16 if DEPTHS[internal_format] == 16 else _F.DEPTH_COMPONENT24
        return _of_machine(profile, internal_format, depth)
    if internal_format in INDICES:
        return _of_machine(profile, internal_format, _F.COLOR_INDEX8)
    if internal_format in _BUMPS:
        return _of_machine(profile, internal_format, _BUMPS[internal_format])
    if internal_format in SIGNED_COLORS:
        return _of_machine(profile, internal_format, _F.SIGNED_RGBA8)
    if internal_format in _WITHOUT_MACHINE or any(internal_format in later for later in _LATER):
        raise Refused(f"textures of {_named(internal_format)}: no machine here has the format")
    raise GLError(tokens.INVALID_VALUE, f"{tokens.name_of(internal_format)} is no internal format")


def compressed_format(profile, internal_format: int) -> S3TC:
    """How ``profile`` stores compressed images of a format. Raises GLError or Refused."""
    found = S3TC_FORMATS.get(internal_format)
    if found is None:
        if any(internal_format in later for later in _LATER):
            raise Refused(f"compressed textures of {_named(internal_format)}: no machine here has the format")
        raise GLError(tokens.INVALID_ENUM, f"{_named(internal_format)} is no format of compressed images")
    _of_machine(profile, internal_format, found.format)
    return found


def _of_machine(profile, internal_format, found):
    if found not in profile.textures.internal_formats:
        raise Refused(f"textures of {_named(internal_format)}: {profile.name} has none")
    colors = found not in DEPTH_TEXELS and found is not _F.COLOR_INDEX8 and internal_format not in _BUMPS
    base = SIGNED_COLORS.get(internal_format, BASE_FORMAT[found]) if colors else None
    return Chosen(found, base)


def _named(internal_format):
    return tokens.name_of(internal_format)

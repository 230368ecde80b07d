"""Texture images: texels at the internal format's resolution, expanded to the bytes that registers read.

A texture keeps ``uint8[faces, height, width, 4]`` for each level: the RGBA bytes that a combiner's texture
register receives from a texel. An internal format's own components are quantised to its bits and widened to a
byte by bit replication (Measured: Texture_format captures, distinct levels). The base format decides their
places (Source: NV_register_combiners table 2). The bottom row is first, as TexImage2D reads rows.
"""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.enums import BaseFormat, DepthFormat, InternalFormat, TextureTarget
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.pipeline.textures.pixels import (
    PillowImage,
    bottom_row_first,
    bytes_or_floats,
    refused_type,
)

# Component resolutions of the formats that store an image's components, in the order of the base format's
# components. Source: OpenGL 1.2.1 table 3.16.
COMPONENT_BITS = {
    InternalFormat.ALPHA4: (4,),
    InternalFormat.ALPHA8: (8,),
    InternalFormat.LUMINANCE4: (4,),
    InternalFormat.LUMINANCE8: (8,),
    InternalFormat.LUMINANCE4_ALPHA4: (4, 4),
    InternalFormat.LUMINANCE6_ALPHA2: (6, 2),
    InternalFormat.LUMINANCE8_ALPHA8: (8, 8),
    InternalFormat.INTENSITY4: (4,),
    InternalFormat.INTENSITY8: (8,),
    InternalFormat.R3_G3_B2: (3, 3, 2),
    InternalFormat.RGB4: (4, 4, 4),
    InternalFormat.RGB5: (5, 5, 5),
    InternalFormat.R5_G6_B5: (5, 6, 5),
    InternalFormat.RGB8: (8, 8, 8),
    InternalFormat.RGBA2: (2, 2, 2, 2),
    InternalFormat.RGBA4: (4, 4, 4, 4),
    InternalFormat.RGB5_A1: (5, 5, 5, 1),
    InternalFormat.RGBA8: (8, 8, 8, 8),
}

# Formats for machines whose components have twelve bits. Source: OpenGL 1.2.1 table 3.16.
_TWELVE_BIT_COMPONENTS = {
    InternalFormat.ALPHA12: (12,),
    InternalFormat.LUMINANCE12: (12,),
    InternalFormat.LUMINANCE12_ALPHA4: (12, 4),
    InternalFormat.LUMINANCE12_ALPHA12: (12, 12),
    InternalFormat.INTENSITY12: (12,),
    InternalFormat.RGB12: (12, 12, 12),
    InternalFormat.RGBA12: (12, 12, 12, 12),
}
TWELVE_BIT_FORMATS = frozenset(_TWELVE_BIT_COMPONENTS)
_ALL_COMPONENT_BITS = COMPONENT_BITS | _TWELVE_BIT_COMPONENTS


def _base_format(internal_format):
    if internal_format not in _ALL_COMPONENT_BITS:
        return BaseFormat.RGBA
    name = internal_format.name
    if name.startswith("LUMINANCE"):
        return BaseFormat.LUMINANCE_ALPHA if "ALPHA" in name else BaseFormat.LUMINANCE
    if name.startswith("ALPHA"):
        return BaseFormat.ALPHA
    if name.startswith("INTENSITY"):
        return BaseFormat.INTENSITY
    return BaseFormat.RGBA if len(_ALL_COMPONENT_BITS[internal_format]) == 4 else BaseFormat.RGB


# Formats that only words make count as RGBA, because only a border colour uses their base format. Source:
# OpenGL 1.2.1 table 3.16. Assumed: a border colour reaches the registers whole, as the others do.
BASE_FORMAT = {f: _base_format(f) for f in InternalFormat}

# Formats whose texels are two words of 16 bits: alpha and red, green and blue. Filters take a word whole, and
# its sign is that of its high byte. Measured: Bump_map's R16B16 captures and BumpMap_Y16.
FORMATS_OF_WORDS = frozenset(
    {InternalFormat.HILO16, InternalFormat.SIGNED_HILO16, InternalFormat.LUMINANCE16}
)

# Formats without colours: NV_texture_shader has them for dot products and offsets alone.
COLORLESS_FORMATS = frozenset(
    {
        InternalFormat.HILO16,
        InternalFormat.SIGNED_HILO16,
        InternalFormat.DSDT8,
        InternalFormat.DSDT8_MAG8,
    }
)

# The components that a format's texels hold as two's complement, for every sampler. Source: NV_texture_shader
# table 3.16. Assumed: a copy of a signed component is signed.
_SIGNED = {
    InternalFormat.SIGNED_HILO16: ("green", "alpha"),
    InternalFormat.DSDT8: ("red", "green", "blue", "alpha"),
    InternalFormat.DSDT8_MAG8: ("green", "blue"),
    InternalFormat.SIGNED_RGBA8: ("red", "green", "blue", "alpha"),
}
SIGNED_FORMATS = frozenset(_SIGNED)

# The words of depth textures. Source: ARB_depth_texture.
DEPTH_TEXELS = {
    InternalFormat.DEPTH_COMPONENT16: DEPTH_WORDS[DepthFormat.FIXED_16],
    InternalFormat.DEPTH_COMPONENT24: DEPTH_WORDS[DepthFormat.FIXED_24],
    InternalFormat.DEPTH_COMPONENT16_FLOAT: DEPTH_WORDS[DepthFormat.FLOAT_16],
    InternalFormat.DEPTH_COMPONENT24_FLOAT: DEPTH_WORDS[DepthFormat.FLOAT_24],
}

# The RGBA components of an image that a base format keeps. Source: OpenGL 1.2.1 table 3.15.
KEPT = {
    BaseFormat.ALPHA: (3,),
    BaseFormat.LUMINANCE: (0,),
    BaseFormat.LUMINANCE_ALPHA: (0, 3),
    BaseFormat.INTENSITY: (0,),
    BaseFormat.RGB: (0, 1, 2),
    BaseFormat.RGBA: (0, 1, 2, 3),
}

# The places of a base format's components in a texture register: an index into them, or the constant 0 or 1.
# Source: NV_register_combiners table 2.
REGISTER_COMPONENTS: dict[BaseFormat, tuple[str | int, ...]] = {
    BaseFormat.ALPHA: ("0", "0", "0", 0),
    BaseFormat.LUMINANCE: (0, 0, 0, "1"),
    BaseFormat.LUMINANCE_ALPHA: (0, 0, 0, 1),
    BaseFormat.INTENSITY: (0, 0, 0, 0),
    BaseFormat.RGB: (0, 1, 2, "1"),
    BaseFormat.RGBA: (0, 1, 2, 3),
}

# Their places in a pixel group that GetTexImage returns. Source: OpenGL 1.2.1 table 6.1.
RETURNED_COMPONENTS: dict[BaseFormat, tuple[str | int, ...]] = {
    BaseFormat.ALPHA: ("0", "0", "0", 0),
    BaseFormat.LUMINANCE: (0, "0", "0", "1"),
    BaseFormat.LUMINANCE_ALPHA: (0, "0", "0", 1),
    BaseFormat.INTENSITY: (0, "0", "0", "1"),
    BaseFormat.RGB: (0, 1, 2, "1"),
    BaseFormat.RGBA: (0, 1, 2, 3),
}


def depth_texture_mode(sampler, profile):
    """The BaseFormat of a depth texture in the registers (ARB_depth_texture)."""
    if sampler.depth_texture_mode is not None:
        return sampler.depth_texture_mode
    return profile.textures.depth_texture_modes[0]


def with_signs(state, textures):
    """The PassState whose units' samplers have the signs that their textures' formats require."""
    units = tuple(_with_signs(unit, textures) for unit in state.texture_units)
    return state if units == state.texture_units else replace(state, texture_units=units)


def _with_signs(unit, textures):
    texture = None if unit is None else textures.get(unit.texture)
    if texture is None or texture.internal_format not in SIGNED_FORMATS:
        return unit
    signs = dict.fromkeys(_SIGNED[texture.internal_format], True)
    sampler = replace(unit.sampler, signed_components=replace(unit.sampler.signed_components, **signs))
    return replace(unit, sampler=sampler)


def widen_to_byte(component, bits):
    """An n-bit component (0 .. 2**bits - 1) as a byte, by bit replication.

    Measured: Texture_format captures for 4, 5 and 6 bits; Inferred from them: 1, 2 and 3 bits.
    """
    shift, value = 8 - bits, component << (8 - bits)
    while shift > 0:
        value |= value >> bits
        bits *= 2
        shift = 8 - bits
    return value & 0xFF


def register_components(
    components: NDArray[Any],
    base: BaseFormat,
    one: Any,
    places: dict[BaseFormat, tuple[str | int, ...]] = REGISTER_COMPONENTS,
) -> NDArray[Any]:
    """Base-format components [..., c] as register components [..., 4], or as groups with RETURNED_COMPONENTS.

    ``one`` is full intensity.
    """
    out = np.empty((*components.shape[:-1], 4), components.dtype)
    for k, what in enumerate(places[base]):
        out[..., k] = components[..., what] if isinstance(what, int) else (one if what == "1" else 0)
    return out


def border_components(color: NDArray[Any], base: BaseFormat, one: Any, *, as_given: bool) -> NDArray[Any]:
    """A border colour as register components [4]: itself, or what a base format keeps of it.

    ``as_given``: the profile's ``border_color_as_given``. ``one`` is full intensity.
    """
    return color if as_given else register_components(color[..., list(KEPT[base])], base, one)


def _quantised(unit, bits):
    """Components in [0, 1], rounded to n bits, as bytes."""
    return widen_to_byte(np.floor(unit * (2**bits - 1) + 0.5).astype(np.uint8), bits)


@cache
def _quantised_bytes(bits):
    """``_quantised`` of every byte, uint8 [256]."""
    return _quantised(np.arange(256) / 255.0, bits)


def widen(component, bits, to):
    """An n-bit component as one of ``to`` bits, by bit replication: ``widen_to_byte`` at any width."""
    value, shift = 0, to - bits
    while shift > -bits:
        value = value | (component << shift if shift >= 0 else component >> -shift)
        shift -= bits
    return value


def own_widths(internal_format):
    """(bits of a texture's components, bits that the format keeps of each) where a machine has the format's
    own. Raises KeyError for a format that only words make.
    """
    return (12 if internal_format in TWELVE_BIT_FORMATS else 8), _ALL_COMPONENT_BITS[internal_format]


def stored_widths(internal_format, profile):
    """(bits of a texture's components, bits that the format keeps of each) on a machine.

    The machine's widest formats have its ``texture_bits``. Narrower formats have their own bits, at most as
    many. The result is None for a format that only words make; its components are bytes on every machine.
    """
    widest = 8 if TWELVE_BIT_FORMATS.isdisjoint(profile.textures.internal_formats) else 12
    return _widths(internal_format, widest, profile.arithmetic.texture_bits)


@cache
def _widths(internal_format, widest, most):
    """``stored_widths`` where formats of ``widest`` bits or more have ``most`` bits."""
    own = _ALL_COMPONENT_BITS.get(internal_format)
    if own is None:
        return None
    kept = tuple(most if b >= widest else min(b, most) for b in own)
    return (max(kept) if max(kept) > 8 else min(8, most)), kept


def texels_at(registers, internal_format, bits, kept):
    """Register components in [0, 1], [..., 4], as texels of ``bits`` bits: uint8 for 8 bits, else uint16.

    ``kept`` is the number of bits that the format keeps of each component.
    """
    base, one = BASE_FORMAT[internal_format], (1 << bits) - 1
    out = np.empty(registers.shape, np.uint8 if bits == 8 else np.uint16)
    for k, what in enumerate(REGISTER_COMPONENTS[base]):
        if isinstance(what, int):
            n = kept[what]
            unit = np.clip(registers[..., k], 0.0, 1.0)
            out[..., k] = widen(np.floor(unit * ((1 << n) - 1) + 0.5).astype(np.int64), n, bits)
        else:
            out[..., k] = one if what == "1" else 0
    return out


def at_machine_width(texture, profile):
    """The texture with components of the machine's width, made from ``ideal`` where the texture has it."""
    widths = stored_widths(texture.internal_format, profile)
    if widths is None or (texture.bits, _ALL_COMPONENT_BITS[texture.internal_format]) == widths:
        return texture
    one = float((1 << texture.bits) - 1)
    sources = texture.ideal or [level / one for level in texture.levels]
    levels = tuple(texels_at(source, texture.internal_format, *widths) for source in sources)
    return replace(texture, levels=levels, bits=widths[0])


def stored_texels(rgba, internal_format, profile):
    """(texels of a format on a machine, their bits) from RGBA [..., 4], bytes or floats."""
    bits, kept = stored_widths(internal_format, profile)
    if (bits, kept) == (8, COMPONENT_BITS.get(internal_format)):
        return store_texels(rgba, internal_format), 8
    base, unit = BASE_FORMAT[internal_format], rgba / 255.0 if rgba.dtype == np.uint8 else rgba
    registers = register_components(unit[..., list(KEPT[base])], base, 1.0)
    return texels_at(registers, internal_format, bits, kept), bits


def store_texels(rgba: NDArray[Any], internal_format: InternalFormat) -> NDArray[np.uint8]:
    """RGBA [..., 4], bytes or in [0, 1], as register bytes uint8 [..., 4] at the format's resolution.

    Conversion to n bits rounds to nearest (Source: OpenGL 1.2.1 section 2.13.9). Raises ValueError for a
    format without such components, and for numbers that are neither bytes nor floats.
    """
    if internal_format not in COMPONENT_BITS:
        raise ValueError(
            f"{internal_format.name} is not made from RGBA components; see "
            f"fixedpipe.pipeline.textures.words, or give one of "
            f"{', '.join(f.name for f in COMPONENT_BITS)}."
        )
    if rgba.dtype != np.uint8 and rgba.dtype.kind != "f":
        raise refused_type(rgba, "The image", "bytes (uint8, 255 is one) or floats (1.0 is one)")
    if rgba.dtype == np.uint8 and internal_format is InternalFormat.RGBA8:
        return rgba.copy()  # a byte is its own nearest
    base = BASE_FORMAT[internal_format]
    components = np.empty((*rgba.shape[:-1], len(KEPT[base])), np.uint8)
    for k, (kept, bits) in enumerate(zip(KEPT[base], COMPONENT_BITS[internal_format], strict=True)):
        given = rgba[..., kept]
        if given.dtype == np.uint8:
            components[..., k] = _quantised_bytes(bits)[given]
        else:
            components[..., k] = _quantised(np.clip(given, 0.0, 1.0), bits)
    return register_components(components, base, np.uint8(255))


def depth_texels(words: NDArray[np.integer]) -> NDArray[np.uint8]:
    """Depth-buffer words [h, w], bottom row first, as the four bytes of depth texels, lowest byte first."""
    return np.ascontiguousarray(words.astype("<u4")).view(np.uint8).reshape(*words.shape, 4)


def _is_writable(level):
    return isinstance(level, np.ndarray) and level.flags.writeable


def _frozen_levels(levels):
    """The levels, read-only; writable arrays are copied.

    ``validate`` refuses values that are no tuple of arrays.
    """
    if not isinstance(levels, tuple) or not any(map(_is_writable, levels)):
        return levels
    frozen = []
    for level in levels:
        if _is_writable(level):
            level = level.copy()
            level.setflags(write=False)
        frozen.append(level)
    return tuple(frozen)


@dataclass(frozen=True, eq=False)
class Texture:
    """A texture object's images.

    - ``levels``: tuple of uint8 [faces, height, width, 4], level 0 first: register bytes, bottom row first.
      The faces are a cube map's six or a 3D texture's layers. A depth texel's four bytes are its depth units,
      lowest byte first. HILO formats have HI in alpha and red, LO in green and blue.
    - ``ideal``: the same shapes in float64 before any quantisation. None: the ideal evaluator reads the
      stored texels divided by their value of one.
    - ``bits``: the width of a component; 2**bits - 1 is one. If it is not 8, the levels are uint16.
    - ``border``: the number of border texels on either side of each axis, in every level (OpenGL 1.2.1,
      section 3.8.1). The levels hold them; ``width``, ``height`` and ``depth`` leave them out. A 1D texture
      has them along s alone; a 3D texture also has them along r.

    Writable arrays are copied and made read-only, because results computed from a texture are kept as long as
    it lives.
    """

    target: TextureTarget
    internal_format: InternalFormat
    levels: tuple[NDArray[np.uint8 | np.uint16], ...]
    ideal: tuple[NDArray[np.float64], ...] | None = None
    bits: int = 8
    border: int = 0

    def __post_init__(self):
        for name in ("levels", "ideal"):
            given = getattr(self, name)
            if (frozen := _frozen_levels(given)) is not given:
                object.__setattr__(self, name, frozen)

    @property
    def width(self) -> int:
        """Texels along s of level 0."""
        return self.levels[0].shape[2] - 2 * self.border

    @property
    def height(self) -> int:
        """Texels along t of level 0."""
        return self.levels[0].shape[1] - 2 * self.borders[1]

    @property
    def depth(self) -> int:
        """Texels along r of level 0; 1 unless the texture is 3D."""
        layered = self.target is TextureTarget.TEXTURE_3D
        return self.levels[0].shape[0] - 2 * self.border if layered else 1

    @property
    def borders(self) -> tuple[int, int, int]:
        """The border along s, t and r."""
        along_t = self.target is not TextureTarget.TEXTURE_1D
        return self.border, self.border * along_t, self.border * (self.target is TextureTarget.TEXTURE_3D)


def _as_rgba(image, what, axes):
    """An image as RGBA, bytes or floats; ``axes`` names its axes before the components."""
    image = bytes_or_floats(image, what)
    if 0 in image.shape:
        raise ValueError(
            f"{what} has shape {image.shape}, so it is empty; a texture needs at least 1x1 texels."
        )
    if image.ndim != len(axes) + 1 or image.shape[-1] > 4:
        raise ValueError(
            f"{what} has shape {image.shape}; give [{', '.join(axes)}, components] with 1 to 4 components "
            "(L, LA, RGB or RGBA)."
        )
    one = np.uint8(255) if image.dtype == np.uint8 else 1.0
    c = image.shape[-1]
    out = np.full((*image.shape[:-1], 4), one, image.dtype)
    out[..., :3] = image[..., :3] if c >= 3 else image[..., :1]
    if c in (2, 4):
        out[..., 3] = image[..., c - 1]
    return out


def halve(level: NDArray[Any], layered: bool = False) -> NDArray[Any]:
    """The next mipmap level of whole numbers or float64 [faces, h, w, 4], from boxes of 2x2 texels.

    Along an edge of one texel boxes are 2x1 or 1x2, and count a texel twice. With ``layered`` the faces are a
    3D texture's layers, and boxes have 2x2x2 texels. Whole numbers become (a + b + c + d + 2) >> 2, as the
    rule for generated mipmaps says, or (the eight + 4) >> 3. Raises ValueError for odd edges longer than one
    texel.
    """
    d, h, w = level.shape[:3]
    if (h % 2 and h > 1) or (w % 2 and w > 1) or (layered and d % 2 and d > 1):
        what = f"{w}x{h}x{d}" if layered else f"{w}x{h}"
        raise ValueError(
            f"Mipmaps of a {what} level need even edges; give a texture whose edges are powers of two."
        )
    rows = (level[:, 0::2], level[:, 1::2]) if h > 1 else (level, level)
    corners = [r[:, :, k::2] if w > 1 else r for r in rows for k in (0, 1)]
    if layered:
        corners = [c[k::2] if d > 1 else c for c in corners for k in (0, 1)]
    if level.dtype != np.float64:
        bits = 3 if layered else 2
        # Eight bytes and 4 fit into 16 bits.
        total: NDArray[Any] = corners[0].astype(np.uint16 if level.dtype == np.uint8 else np.uint32)
        for corner in corners[1:]:
            total += corner
        total += 1 << (bits - 1)
        total >>= bits
        return total.astype(level.dtype)
    return sum(corners) / len(corners)  # type: ignore[return-value]  # of arrays, not of none


def pyramid(base: NDArray[Any], layered: bool = False) -> tuple[NDArray[Any], ...]:
    """Every mipmap level from level 0 down to one texel, each by ``halve``: a tuple of read-only arrays."""
    levels = [base]
    while max(levels[-1].shape[0 if layered else 1 : 3]) > 1:
        levels.append(halve(levels[-1], layered))
    for level in levels:
        level.setflags(write=False)
    return tuple(levels)


def build_texture(
    target: TextureTarget,
    faces: NDArray[Any],
    internal_format: InternalFormat,
    mipmaps: bool,
    border: int = 0,
) -> Texture:
    """A texture from RGBA images [faces, h, w, 4], bottom row first: bytes, or floats.

    The ideal evaluator reads floats before quantisation. Raises ValueError for mipmaps of an image with a
    border.
    """
    if mipmaps and border:
        raise ValueError(
            f"Mipmaps of an image with a border of {border} are not generated; give a Texture its levels, "
            "each with its own border."
        )
    source, base_format = None, BASE_FORMAT[internal_format]
    wide = internal_format in TWELVE_BIT_FORMATS
    if faces.dtype != np.uint8 or wide:
        unit = faces / 255.0 if faces.dtype == np.uint8 else faces
        source = register_components(unit[..., list(KEPT[base_format])], base_format, 1.0)
    if wide:
        base = texels_at(source, internal_format, *own_widths(internal_format))
    else:
        base = store_texels(faces, internal_format)
    return texture_of_levels(target, internal_format, source, base, mipmaps, border)


def texture_of_levels(target, internal_format, source, base, mipmaps, border=0):
    """A texture from level 0's real texels, or None, and its texels of the format's own bits, both [faces, h,
    w, 4].
    """
    bits = 12 if internal_format in TWELVE_BIT_FORMATS else 8
    if not mipmaps:
        return Texture(target, internal_format, (base,), None if source is None else (source,), bits, border)
    layered = target is TextureTarget.TEXTURE_3D
    ideal = None if source is None else pyramid(source, layered)
    return Texture(target, internal_format, pyramid(base, layered), ideal, bits)


def texture_1d(
    image: ArrayLike,
    internal_format: InternalFormat = InternalFormat.RGBA8,
    *,
    mipmaps: bool = False,
    border: int = 0,
) -> Texture:
    """A 1D texture from [width, 1..4 components], bytes or floats in [0, 1]; see ``texture_2d``."""
    row = _as_rgba(image, "A 1D texture's image", ("width",))
    return build_texture(TextureTarget.TEXTURE_1D, row[None, None], internal_format, mipmaps, border)


def texture_2d(
    image: ArrayLike | PillowImage,
    internal_format: InternalFormat = InternalFormat.RGBA8,
    *,
    mipmaps: bool = False,
    border: int = 0,
) -> Texture:
    """A 2D texture from [height, width, 1..4 components], bottom row first: uint8 bytes, or floats in [0, 1].

    A Pillow image, whose top row is first, is flipped. The ideal evaluator reads floats before quantisation
    and not clamped. ``border`` is the number of texels on either side of each axis that are a border
    (``Texture``).

    Raises ValueError for other types of numbers, booleans too, for zero sizes, NaN or another shape, and for
    mipmaps of an image with a border.
    """
    image = bottom_row_first(image, "A 2D texture's image")
    rgba = _as_rgba(image, "A 2D texture's image", ("height", "width"))
    return build_texture(TextureTarget.TEXTURE_2D, rgba[None], internal_format, mipmaps, border)


def texture_3d(
    image: ArrayLike,
    internal_format: InternalFormat = InternalFormat.RGBA8,
    *,
    mipmaps: bool = False,
    border: int = 0,
) -> Texture:
    """A 3D texture from [layers, height, width, 1..4 components], bytes or floats in [0, 1].

    r grows from layer to layer. ``texture_2d`` describes the images.
    """
    rgba = _as_rgba(image, "A 3D texture's image", ("layers", "height", "width"))
    return build_texture(TextureTarget.TEXTURE_3D, rgba, internal_format, mipmaps, border)


def texture_cube_map(
    faces: ArrayLike,
    internal_format: InternalFormat = InternalFormat.RGBA8,
    *,
    mipmaps: bool = False,
    border: int = 0,
) -> Texture:
    """A cube map from [6, size, size, components], faces +x, -x, +y, -y, +z, -z; see ``texture_2d``.

    Rows follow EXT_texture_cube_map's t: row 0 is t = 0. Raises ValueError for other shapes too.
    """
    rgba = _as_rgba(faces, "A cube map's image", ("6", "size", "size"))
    if rgba.shape[0] != 6 or rgba.shape[1] != rgba.shape[2]:
        raise ValueError(
            f"A cube map has shape {rgba.shape[:-1]}; give six square faces [6, size, size, components]."
        )
    return build_texture(TextureTarget.TEXTURE_CUBE_MAP, rgba, internal_format, mipmaps, border)

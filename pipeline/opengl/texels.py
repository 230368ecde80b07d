"""Images in client memory as texels of the machine's formats (OpenGL 1.2.1 section 3.8.1).

Texels have the form of ``fixedpipe.pipeline.textures.images.Texture``: [layers, height, width, 4], bytes, or
words for formats with components of twelve bits. A paletted image has indices, [layers, height, width].
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.enums import BaseFormat, InternalFormat
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.internal_formats import Chosen
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.pixels import BUMP_FORMATS, INDEX_FORMATS, ClientImage
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER, PixelImage, PixelTransfer
from fixedpipe.pipeline.textures.images import (
    COMPONENT_BITS,
    DEPTH_TEXELS,
    KEPT,
    TWELVE_BIT_FORMATS,
    depth_texels,
    register_components,
    store_texels,
)
from fixedpipe.pipeline.textures.pixel_formats import DEPTH_FORMAT, IMAGE_FORMATS
from fixedpipe.raster.pixels import transfer as arithmetic

_F = InternalFormat
_BUMPS = {
    _F.HILO16: tokens.HILO_NV,
    _F.SIGNED_HILO16: tokens.HILO_NV,
    _F.DSDT8: tokens.DSDT_NV,
    _F.DSDT8_MAG8: tokens.DSDT_MAG_NV,
}


class Texels(NamedTuple):
    """Texels, and the real numbers that they are made from; None if these equal the texels' values."""

    texels: NDArray[Any]
    real: NDArray[np.float64] | None = None


def one_of(internal_format: InternalFormat) -> int:
    """The integer that means 1.0 in a format's texels."""
    return 4095 if internal_format in TWELVE_BIT_FORMATS else 255


def zero_texels(chosen: Chosen, layers: int, height: int, width: int) -> Texels:
    """Texels of an image whose contents are undefined in OpenGL: each is made from a group of zeros."""
    shape = layers, height, width
    if chosen.format is _F.COLOR_INDEX8:
        return Texels(np.broadcast_to(np.zeros((), np.uint16), shape))
    one = one_of(chosen.format)
    texel = np.zeros(4, np.uint8 if one == 255 else np.uint16)
    if chosen.base is not None:
        kept = np.zeros(len(KEPT[chosen.base]), texel.dtype)
        texel = register_components(kept, chosen.base, 127 if chosen.format is _F.SIGNED_RGBA8 else one)
    return Texels(np.broadcast_to(texel, (*shape, 4)))


def check_image_format(chosen: Chosen, image_format: int) -> None:
    """Raise GLError if an internal format cannot hold the groups of an image.

    Source: ARB_depth_texture, EXT_paletted_texture, NV_texture_shader (INVALID_OPERATION each); OpenGL 1.2.1
    section 3.8.1 (STENCIL_INDEX is INVALID_ENUM).
    """
    if image_format == tokens.STENCIL_INDEX:
        raise GLError(tokens.INVALID_ENUM, "stencil values are no texels")
    depths = image_format in (tokens.DEPTH_COMPONENT, tokens.DEPTH_STENCIL_EXT)
    wanted = _BUMPS.get(chosen.format)
    if wanted is None:
        fits = image_format not in BUMP_FORMATS and depths == (chosen.format in DEPTH_TEXELS)
    else:
        fits = image_format == wanted
    if chosen.format is _F.COLOR_INDEX8:
        fits = image_format == tokens.COLOR_INDEX
    if not fits:
        name = tokens.name_of(image_format)
        raise GLError(tokens.INVALID_OPERATION, f"groups of {name} in a texture of {chosen.format.name}")


def texels_of(
    profile: Any, image: ClientImage, transfer: PixelTransfer, chosen: Chosen, dimensions: int
) -> Texels:
    """The texels of an image after pixel transfer, which must not count anything.

    ``dimensions``: the dimensions of the convolution filter that applies.
    """
    if chosen.format in DEPTH_TEXELS:
        return _depth_texels(image, transfer, chosen.format)
    if chosen.format is _F.COLOR_INDEX8:
        indices = arithmetic.indexed(_whole(image), transfer.index_shift, transfer.index_offset)
        return Texels((indices & 0xFFFF).astype(np.uint16))
    if chosen.format in _BUMPS:
        return Texels(_bump_texels(image.values, chosen.format))
    if chosen.format is _F.SIGNED_RGBA8:
        return Texels(_signed_texels(image, chosen.base or BaseFormat.RGBA))
    plain = transfer is INITIAL_TRANSFER and image.values.dtype == np.uint8 and image.packed is None
    eight = set(COMPONENT_BITS.get(chosen.format, ())) == {8}
    if plain and eight and image.format not in INDEX_FORMATS:
        return Texels(store_texels(_rgba_bytes(image), chosen.format))
    # The import is here because it compiles kernels, which most programs do not need.
    from fixedpipe.pipeline.framebuffers.transfer import image_texels

    pixels = image.pixel_image(layers=True)
    real, texels = image_texels(pixels, True, transfer, profile, None, dimensions, chosen.format)
    same = np.array_equal(real, texels / float(one_of(chosen.format)))
    return Texels(texels, None if same else real)


def _rgba_bytes(image):
    """A ClientImage of bytes as RGBA bytes (section 3.6.4, Conversion to RGB and Final Expansion to RGBA)."""
    values = image.values[..., ::-1] if image.format == tokens.ABGR_EXT else image.values
    return _expanded(values, IMAGE_FORMATS[image.image_format()], np.uint8(255))


def _expanded(values, elements, one):
    """Groups of ``elements`` as RGBA. Missing colours are 0, and a missing alpha is ``one``."""
    if elements == ("R", "G", "B", "A"):
        return values
    out = np.zeros((*values.shape[:-1], 4), values.dtype)
    out[..., 3] = one
    for place, element in enumerate(elements):
        if element == "L":
            out[..., :3] = values[..., place, None]
        else:
            out[..., "RGBA".index(element)] = values[..., place]
    return out


def _whole(image):
    """A ClientImage's indices, int64 [layers, height, width]."""
    values = image.pixel_image(layers=True).values
    return values.astype(np.int64)


def _depth_texels(image, transfer, internal_format):
    from fixedpipe.pipeline.framebuffers.transfer import image_groups, transfer_depths

    layers = [image_groups(PixelImage(v, DEPTH_FORMAT)) for v in image.pixel_image(layers=True).values]
    depths = transfer_depths(np.stack(layers), transfer)
    most = DEPTH_TEXELS[internal_format].largest
    words = arithmetic.fixed(depths, most.bit_length())
    texels = np.stack([depth_texels(layer) for layer in words])
    real = None
    if not np.array_equal(depths, words / float(most)):
        real = np.broadcast_to(depths[..., None], texels.shape)
    return Texels(texels, real)


def _signed(values, bits):
    """Numbers in two's complement of ``bits`` bits, int64. A type of this width is copied, others are rounded
    to nearest.

    Inferred: from NV_texture_shader, whose formats hold signed numbers of the client's types.
    """
    most = float((1 << (bits - 1)) - 1)
    width = 8 * values.dtype.itemsize
    if values.dtype.kind == "i" and width == bits:
        return values.astype(np.int64)
    if values.dtype.kind == "f":
        fractions = values.astype(np.float64)
    else:
        fractions = values / float((1 << (width - (values.dtype.kind == "i"))) - 1)
    return arithmetic.nearest(np.clip(np.nan_to_num(fractions), -1.0, 1.0) * most)


def _unsigned(values, bits):
    """Numbers in [0, 1] as words of ``bits`` bits, int64."""
    width = 8 * values.dtype.itemsize
    if values.dtype.kind == "u" and width == bits:
        return values.astype(np.int64)
    if values.dtype.kind == "f":
        return arithmetic.fixed(np.nan_to_num(values.astype(np.float64)), bits)
    return arithmetic.fixed(values / float((1 << (width - (values.dtype.kind == "i"))) - 1), bits)


def _bump_texels(values, internal_format):
    """HILO or DSDT groups as texels. ``Texture`` and NV_texture_shader specify the places of their bytes."""
    out = np.full((*values.shape[:-1], 4), 255, np.uint8)
    if internal_format in (_F.HILO16, _F.SIGNED_HILO16):
        words = _signed(values, 16) if internal_format is _F.SIGNED_HILO16 else _unsigned(values, 16)
        high, low = words[..., 0], words[..., 1]
        parts = high, low >> 8, low, high >> 8
    else:
        offsets = _signed(values[..., :2], 8)
        ds, dt = offsets[..., 0], offsets[..., 1]
        if internal_format is _F.DSDT8:
            parts = ds, dt, ds, dt
        else:
            parts = _unsigned(values[..., 2], 8), dt, ds, np.int64(255)
    for component, part in enumerate(parts):
        out[..., component] = (part & 255).astype(np.uint8)
    return out


def _signed_texels(image, base):
    """Colours as texels of SIGNED_RGBA8."""
    if image.packed is not None or image.format in INDEX_FORMATS:
        raise GLError(tokens.INVALID_OPERATION, "signed texels of packed colours or of indices")
    values = image.values[..., ::-1] if image.format == tokens.ABGR_EXT else image.values
    groups = _expanded(_signed(values, 8), IMAGE_FORMATS[image.image_format()], 127)
    return (register_components(groups[..., list(KEPT[base])], base, 127) & 255).astype(np.uint8)


def texels_of_groups(groups: NDArray[np.float64], internal_format: InternalFormat) -> Texels:
    """Texels from RGBA groups [..., 4], floats that a machine or the ideal has read from a texture."""
    from fixedpipe.pipeline.textures.images import BASE_FORMAT, own_widths, texels_at

    base = BASE_FORMAT[internal_format]
    real = register_components(groups[..., list(KEPT[base])], base, 1.0)
    texels = texels_at(real, internal_format, *own_widths(internal_format))
    return Texels(texels, real)


def palette_bytes(groups: NDArray[np.float64], base: BaseFormat) -> NDArray[np.uint8]:
    """A palette's colours [n, 4], floats, as register bytes."""
    wide = {
        BaseFormat.ALPHA: _F.ALPHA8,
        BaseFormat.LUMINANCE: _F.LUMINANCE8,
        BaseFormat.LUMINANCE_ALPHA: _F.LUMINANCE8_ALPHA8,
        BaseFormat.INTENSITY: _F.INTENSITY8,
        BaseFormat.RGB: _F.RGB8,
        BaseFormat.RGBA: _F.RGBA8,
    }
    return store_texels(groups, wide[base])


@dataclass(frozen=True, eq=False, slots=True)
class Patch:
    """A box of texels that replaces a part of an image."""

    z: int
    y: int
    x: int
    texels: Texels


def patched(texels: Texels, patches: tuple[Patch, ...], internal_format: InternalFormat) -> Texels:
    """Texels with boxes replaced, one after the other."""
    whole = texels.texels.copy()
    real = None
    if texels.real is not None or any(patch.texels.real is not None for patch in patches):
        real = real_of(texels, internal_format).copy()
    for patch in patches:
        depth, height, width = patch.texels.texels.shape[:3]
        box = (
            slice(patch.z, patch.z + depth),
            slice(patch.y, patch.y + height),
            slice(patch.x, patch.x + width),
        )
        whole[box] = patch.texels.texels
        if real is not None:
            real[box] = real_of(patch.texels, internal_format)
    for array in (whole, real):
        if array is not None:
            array.setflags(write=False)
    return Texels(whole, real)


def real_of(texels: Texels, internal_format: InternalFormat) -> NDArray[np.float64]:
    """The real numbers of texels."""
    if texels.real is not None:
        return texels.real
    if internal_format in DEPTH_TEXELS:
        words = np.ascontiguousarray(texels.texels).view("<u4")
        depths = words / float(DEPTH_TEXELS[internal_format].largest)
        return np.broadcast_to(depths, texels.texels.shape)
    return texels.texels / float(one_of(internal_format))

"""Compressed images, and palettes (ARB_texture_compression, EXT_paletted_texture)."""

from typing import Any

import numpy as np

from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.buffers import memory_at
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.images import (
    PROXIES,
    Place,
    after_images_changed,
    ask_proxy,
    check_box,
    check_image,
    define_image,
    existing_image,
    mark_changed,
    place_of,
)
from fixedpipe.pipeline.opengl.internal_formats import (
    INDICES,
    S3TC_FORMATS,
    Chosen,
    chosen_format,
    compressed_format,
)
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.texels import Patch, Texels
from fixedpipe.pipeline.opengl.texture_objects import (
    TARGETS,
    Image,
    Palette,
)
from fixedpipe.pipeline.opengl.texturing import bound_object
from fixedpipe.pipeline.opengl.values import declare
from fixedpipe.pipeline.textures.words import (
    S3TC_BLOCK_BYTES,
    compressed_volume,
    dithered_level,
    texels_of_blocks,
)

# ------------------------------------------------------------------------------------------ compressed images


def _compressed(size_at):
    """The capture of calls for compressed images. The last argument becomes the bytes, or the error of
    reading them.
    """

    def capture(gl, *arguments):
        *others, given = arguments
        length = int(arguments[size_at])
        try:
            found = memory_at(gl, tokens.PIXEL_UNPACK_BUFFER_ARB, given)
            if found is None:
                raise Refused("its image is not known, only where it lay")
            if not 0 <= length <= len(found):
                raise Refused(f"{len(found)} bytes of memory are known, and its image takes {length}")
            return (*others, found[:length].copy())
        except (GLError, Refused) as error:
            return (*others, error)

    return capture


@entry("CompressedTexImage1D", "CompressedTexSubImage1D")
def compressed_line(gl, target, level, internal_format, *arguments):
    """Raise an error: no compressed format has one-dimensional images (EXT_texture_compression_s3tc)."""
    raise GLError(tokens.INVALID_ENUM, "no compressed image is a line")


@entry("CompressedTexImage2D", capture=_compressed(6))
def compressed_tex_image_2d(gl, target, level, internal_format, width, height, border, length, data):
    """Define an image from compressed blocks (EXT_texture_compression_s3tc)."""
    place, size = place_of(gl, target, 2), (width, height, 1)
    chosen = _compressed_chosen(gl, internal_format, place)
    if place.proxy:
        ask_proxy(gl, place, level, internal_format, chosen, size, border)
        return
    check_image(gl, place, level, size, border)
    if border:
        raise GLError(tokens.INVALID_VALUE, "a compressed image with a border")
    texels = _decoded(gl, internal_format, size, data)
    define_image(gl, place, level, Image(size, 0, internal_format, chosen, texels))


@entry("CompressedTexImage3D", capture=_compressed(7))
def compressed_tex_image_3d(gl, target, level, internal_format, width, height, depth, border, length, data):
    """Define a volume from compressed blocks (NV_texture_compression_vtc)."""
    place, size = place_of(gl, target, 3), (width, height, depth)
    chosen = _compressed_chosen(gl, internal_format, place)
    check_image(gl, place, level, size, border)
    texels = _decoded(gl, internal_format, size, data)
    define_image(gl, place, level, Image(size, 0, internal_format, chosen, texels))


@entry("CompressedTexSubImage2D", capture=_compressed(7))
def compressed_tex_sub_image_2d(gl, target, level, x, y, width, height, internal_format, length, data):
    """Replace blocks of a compressed image."""
    place = place_of(gl, target, 2)
    texture = bound_object(gl, place.target)
    held = existing_image(texture, place, level)
    if held.internal_format != internal_format:
        raise GLError(tokens.INVALID_OPERATION, "the image has another format")
    check_box(texture, held, (x, y, 0), (width, height, 1))
    ends = (x + width, held.size[0]), (y + height, held.size[1])
    if x % 4 or y % 4 or any(end % 4 and end != edge for end, edge in ends):
        raise GLError(tokens.INVALID_OPERATION, "a rectangle that is not one of blocks")
    texels = _decoded(gl, internal_format, (width, height, 1), data)
    texture.images[place.face, level] = held.with_patch(Patch(0, y, x, texels))
    after_images_changed(gl, texture, level)


@entry("CompressedTexSubImage3D")
def compressed_tex_sub_image_3d(gl, *arguments):
    """Refuse to replace parts of compressed volumes. No recording with this call is known."""
    raise Refused("a part of a compressed volume")


def _compressed_chosen(gl, internal_format, place):
    """How the machine stores a compressed image.

    An image without alpha is stored as the colours of its blocks. Inferred: environments treat it as RGB, and
    the machine's compressed formats are all RGBA.
    """
    found = compressed_format(gl.profile, internal_format)
    if place.target not in (tokens.TEXTURE_2D, tokens.TEXTURE_CUBE_MAP, tokens.TEXTURE_3D):
        raise GLError(tokens.INVALID_ENUM, f"no compressed image belongs to {tokens.name_of(place.target)}")
    opaque = internal_format == tokens.COMPRESSED_RGB_S3TC_DXT1_EXT
    return Chosen(InternalFormat.RGB8 if opaque else found.format, found.base)


def _decoded(gl, internal_format, size, data):
    """The Texels of blocks. Raises the error of reading them, and GLError for a wrong number of bytes."""
    if isinstance(data, Exception):
        raise data
    width, height, depth = size
    found = S3TC_FORMATS[internal_format].format
    block, rows, columns = S3TC_BLOCK_BYTES[found], -(-height // 4), -(-width // 4)
    if len(data) != rows * columns * block * depth:
        raise GLError(
            tokens.INVALID_VALUE, f"{len(data)} bytes of {width}x{height}x{depth} compressed texels"
        )
    if depth > 1:
        texels = compressed_volume(data, found, width, height, depth).levels[0]
    else:
        texels = texels_of_blocks(data.reshape(rows, columns, block), found, width, height)[None]
    if internal_format != tokens.COMPRESSED_RGB_S3TC_DXT1_EXT:
        return Texels(texels)
    texels = texels.copy()
    texels[..., 3] = 255
    if not gl.profile.arithmetic.dithered_s3tc_dxt1:
        return Texels(texels)
    return Texels(dithered_level(texels), texels / 255.0)


# -------------------------------------------------------------------------------------------------- palettes

declare("shared_palette", None)


def _share_palette(gl, enabled):
    """Give the shared palette to every paletted texture, or take it away."""
    shared = gl.values["shared_palette"] if enabled else None
    for texture in gl.shared.textures.values():
        if texture is not None and texture.shared_palette is not shared:
            texture.shared_palette = shared
            if any(image.internal_format in INDICES for image in texture.images.values()):
                mark_changed(gl, texture)


capability(tokens.SHARED_TEXTURE_PALETTE_EXT, tokens.TEXTURE_BIT, notify=_share_palette)


def palette_colors(gl: Any, internal_format: int, groups: np.ndarray) -> Palette:
    """A Palette from RGBA groups [n, 4], in the form of an internal format."""
    chosen = chosen_format(gl.profile, internal_format)
    if chosen.base is None:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(internal_format)} is no format of palettes")
    return Palette(internal_format, chosen.base, tuple(map(tuple, np.clip(groups, 0.0, 1.0).tolist())))


def set_palette(gl: Any, target: int, internal_format: int, palette: Palette) -> None:
    """Set a texture's palette, or the shared one."""
    if target == tokens.SHARED_TEXTURE_PALETTE_EXT:
        gl.values.set("shared_palette", palette)
        if gl.values["enabled", tokens.SHARED_TEXTURE_PALETTE_EXT]:
            _share_palette(gl, True)
        return
    place = _palette_place(target)
    if place.proxy:
        return
    texture = bound_object(gl, place.target)
    texture.own_palette = palette
    mark_changed(gl, texture)


def replace_palette(gl: Any, target: int, start: int, groups: np.ndarray) -> None:
    """Replace colours of a palette."""
    if target == tokens.SHARED_TEXTURE_PALETTE_EXT:
        held = gl.values["shared_palette"]
    else:
        held = bound_object(gl, _palette_place(target).target).own_palette
    count = 0 if held is None else len(held.groups)
    if held is None or start + len(groups) > count:
        raise GLError(tokens.INVALID_VALUE, f"colours {start} to {start + len(groups)} of {count}")
    new = tuple(map(tuple, np.clip(groups, 0.0, 1.0).tolist()))
    whole = (*held.groups[:start], *new, *held.groups[start + len(new) :])
    set_palette(gl, target, held.internal_format, held._replace(groups=whole))


def _palette_place(target):
    bound = PROXIES.get(target, target)
    if bound not in TARGETS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} has no colour table")
    return Place(bound, 0, target in PROXIES)

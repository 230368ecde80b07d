"""Textures that commands make from a host's pixels, a framebuffer's rectangle or a whole pbuffer."""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import TextureTarget, WindowOrigin
from fixedpipe.pipeline.framebuffers.transfer import (
    image_groups,
    image_texels,
    transfer_colors,
    transfer_depths,
)
from fixedpipe.pipeline.pixel_transfer import changes_nothing, transferred_size
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    COMPONENT_BITS,
    DEPTH_TEXELS,
    KEPT,
    Texture,
    at_machine_width,
    build_texture,
    depth_texels,
    pyramid,
    register_components,
    stored_texels,
    texture_of_levels,
    widen_to_byte,
)
from fixedpipe.raster.pixels.transfer import fixed

_LAYERED = (TextureTarget.TEXTURE_CUBE_MAP, TextureTarget.TEXTURE_3D)
# Dimensions of a target's convolution; of the others 2.
_DIMENSIONS = {TextureTarget.TEXTURE_1D: 1, TextureTarget.TEXTURE_3D: 3}


def defined_texture(command, profile, statistics, before):
    """TexImage1D/2D/3D of pixels: the texture. ``before`` is the earlier texture of this name, or None."""
    image, target = command.pixels, command.target
    if command.internal_format in DEPTH_TEXELS:
        depths = transfer_depths(image_groups(image), command.transfer)
        return depth_texture(target, command.internal_format, depths)
    layered, dimensions = target in _LAYERED, _DIMENSIONS.get(target, 2)
    given = command.transfer, profile, statistics, dimensions, command.internal_format
    levels = image_texels(image, layered, *given)
    if levels is None:
        layers = image.values.shape[0] if layered else 1
        height, width = image.values.shape[layered : layered + 2]
        size = layers, *transferred_size(width, height, command.transfer, dimensions)
        return sunk_texture(command, size, before, profile)
    made = texture_of_levels(target, command.internal_format, *levels, command.generate_mipmap)
    return at_machine_width(made, profile)


def sunk_texture(command, size, before, profile):
    """The texture after a TexImage or CopyTexImage whose image went into a histogram's or minmax's sink.

    It has the command's target and format and ``size`` (faces or layers, width, height). ``before`` is the
    earlier texture of this name, or None.

    Source: OpenGL 1.2.1 section 3.6.5, Histogram and Minmax: texture memory stays, the object's state
    changes. Assumed: an earlier level of this target, format and size keeps its texels. All other texels,
    which the specification leaves undefined, are zero.
    """
    layers, width, height = size
    zeros = np.zeros((layers, height, width, 4))
    made = build_texture(command.target, zeros, command.internal_format, command.generate_mipmap)
    made = at_machine_width(made, profile)
    if before is None or before.target is not made.target:
        return made
    if (before.internal_format, before.bits) != (made.internal_format, made.bits):
        return made
    ideal = before.ideal and _kept(before.ideal, made.ideal)
    return replace(made, levels=_kept(before.levels, made.levels), ideal=ideal)


def _kept(before, levels):
    """The levels, replaced by the earlier levels of equal size."""
    kept = [old if old.shape == new.shape else new for old, new in zip(before, levels, strict=False)]
    return (*kept, *levels[len(kept) :])


def depth_texture(target, internal_format, depths):
    """A depth texture from depths in [0, 1], float64 [h, w], bottom row first.

    A texel's ``ideal`` has the depth in all four components.
    """
    most = DEPTH_TEXELS[internal_format].largest
    texels = depth_texels(fixed(depths, most.bit_length()))
    texels.setflags(write=False)
    ideal = np.broadcast_to(depths[None, ..., None], (1, *texels.shape))
    return Texture(target, internal_format, (texels[None],), (ideal,))


def _copied_texels(framebuffer, command, box, internal_format, dimensions, profile, statistics):
    """A framebuffer rectangle as texels [h, w, 4], None where a sink took it, and their bits."""
    transfer = command.transfer
    if internal_format in DEPTH_TEXELS:
        depths = transfer_depths(framebuffer.depths(*box), transfer)
        return depth_texture(None, internal_format, depths).levels[0][0], 8
    if framebuffer.is_bytes and changes_nothing(transfer):
        return stored_texels(framebuffer.rectangle(*box), internal_format, profile)
    groups = transfer_colors(framebuffer.groups(*box), transfer, profile, statistics, dimensions)
    return (None, 8) if groups is None else stored_texels(groups, internal_format, profile)


def copied_texture(framebuffer, command, profile, statistics, before):
    """CopyTexImage1D/2D: the texture from a framebuffer rectangle.

    ``before`` is the earlier texture of this name, or None.
    """
    dimensions = 1 if command.target is TextureTarget.TEXTURE_1D else 2
    box = framebuffer.box_of(command)
    texels, bits = _copied_texels(
        framebuffer, command, box, command.internal_format, dimensions, profile, statistics
    )
    if texels is None:
        size = 1, *transferred_size(*box[2:], command.transfer, dimensions)
        return sunk_texture(command, size, before, profile)
    texels.setflags(write=False)
    levels = pyramid(texels[None]) if command.generate_mipmap else (texels[None],)
    return Texture(command.target, command.internal_format, levels, bits=bits)


def replaced_texture(framebuffer, command, texture, profile, statistics):
    """CopyTexSubImage1D/2D/3D: the texture with a rectangle of one level replaced.

    Where a sink took the pixels, it is the same texture.
    """
    dimensions = 1 if texture.target is TextureTarget.TEXTURE_1D else 2
    box = command.x, command.y, command.width, command.height
    texels, _ = _copied_texels(
        framebuffer, command, box, texture.internal_format, dimensions, profile, statistics
    )
    if texels is None:
        return texture
    level = texture.levels[command.level].copy()
    rows = slice(command.y_offset, command.y_offset + texels.shape[0])
    columns = slice(command.x_offset, command.x_offset + texels.shape[1])
    level[command.face, rows, columns] = texels
    level.setflags(write=False)
    if command.generate_mipmap:
        levels = pyramid(level)
    else:
        levels = (*texture.levels[: command.level], level, *texture.levels[command.level + 1 :])
    return Texture(texture.target, texture.internal_format, levels, bits=texture.bits)


def bound_texture(framebuffer, command, samples=None):
    """BindTexImage: the texture made of a pbuffer's colours or depths.

    ``samples`` are the Samples of a pbuffer that has several in a pixel.
    """
    rows = slice(None, None, 1 if command.origin == WindowOrigin.UPPER_LEFT else -1)
    if command.internal_format in DEPTH_TEXELS:
        return Texture(
            command.target, command.internal_format, (depth_texels(framebuffer.depth[rows])[None],)
        )
    rgba = (framebuffer.color if samples is None else samples.side_by_side())[rows]
    base, bits = BASE_FORMAT[command.internal_format], COMPONENT_BITS[command.internal_format]
    components = np.stack(
        [widen_to_byte(rgba[..., kept] >> (8 - b), b) for kept, b in zip(KEPT[base], bits, strict=True)], -1
    )
    texels = register_components(components, base, np.uint8(255))
    return Texture(command.target, command.internal_format, (texels[None],))

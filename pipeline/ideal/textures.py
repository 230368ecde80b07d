"""Textures with real texels: from a command, or copied from the framebuffer."""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.framebuffers.texture_copies import depth_texture, sunk_texture
from fixedpipe.pipeline.framebuffers.texture_queries import queried_colors
from fixedpipe.pipeline.framebuffers.transfer import elements_of, transfer_depths
from fixedpipe.pipeline.ideal.buffers import transferred
from fixedpipe.pipeline.pixel_transfer import transferred_size
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    DEPTH_TEXELS,
    KEPT,
    RETURNED_COMPONENTS,
    Texture,
    pyramid,
    register_components,
    texture_2d,
)


def with_ideal(texture):
    """The texture with its real texels: those that it has, or the values of its words.

    They are C-contiguous, as kernels need them.
    """
    if texture.ideal is not None:
        if all(level.flags.c_contiguous for level in texture.ideal):
            return texture
        return replace(texture, ideal=tuple(np.ascontiguousarray(level) for level in texture.ideal))
    one = 2.0**texture.bits - 1.0
    if texture.internal_format in DEPTH_TEXELS:
        most = DEPTH_TEXELS[texture.internal_format].largest
        words = [np.ascontiguousarray(level).view("<u4") for level in texture.levels]
        return replace(texture, ideal=tuple(np.repeat(w / most, 4, axis=3) for w in words))
    return replace(texture, ideal=tuple(level / one for level in texture.levels))


def copied_texture(command, buffers, statistics, before):
    """The texture that a CopyTexImage makes. ``before``: the earlier texture of that name, or None."""
    copied = _copied(command, command, command.generate_mipmap, buffers, statistics)
    if copied is None:
        dimensions = 1 if command.target is TextureTarget.TEXTURE_1D else 2
        size = 1, *transferred_size(*buffers.box_of(command)[2:], command.transfer, dimensions)
        return sunk_texture(command, size, before, IDEAL)
    return replace(copied, target=command.target)


def replaced_texture(command, texture, buffers, statistics, own=False):
    """The texture after a CopyTexSubImage; None: a sink took the image.

    ``own``: no one else holds the level's image, so it is overwritten in place.
    """
    copied = _copied(command, texture, False, buffers, statistics)
    return None if copied is None else _patched(command, texture, copied, own)


def texture_pixels(texture, command, statistics):
    """The result of a GetTexImage on a texture with real texels; None: a sink took it."""
    level, base = texture.ideal[command.level], BASE_FORMAT[texture.internal_format]
    if texture.internal_format in DEPTH_TEXELS:
        return transfer_depths(level[command.face, ..., 0], command.transfer)
    return queried_colors(
        texture.target,
        level,
        command,
        lambda image: register_components(image[..., list(KEPT[base])], base, 1.0, RETURNED_COMPONENTS),
        lambda groups: elements_of(groups, command.format),
        IDEAL,
        statistics,
    )


def _copied(command, known, mipmaps, buffers, statistics):
    """The copied region as a texture with the target and internal format of ``known``, or None."""
    target, internal_format, box = known.target, known.internal_format, buffers.box_of(command)
    if internal_format in DEPTH_TEXELS:
        depths = transfer_depths(buffers.rows(buffers.depth, *box), command.transfer)
        return depth_texture(target, internal_format, depths)
    dimensions = 1 if target is TextureTarget.TEXTURE_1D else 2
    region = transferred(buffers.rows(buffers.color, *box), command, statistics, dimensions)
    if region is not None and not region.size:  # a rectangle of no pixels replaces none
        return Texture(target, internal_format, (np.zeros((1, *region.shape), np.uint8),), (region[None],))
    return None if region is None else texture_2d(region, internal_format, mipmaps=mipmaps)


def _patched(command, texture, patch, own):
    """A texture with a rectangle of one level replaced by the only level of ``patch``."""
    levels, ideal = list(texture.levels), list(texture.ideal)
    for images, new in ((levels, patch.levels[0]), (ideal, patch.ideal[0])):
        image = images[command.level]
        if not own:
            image = image.copy()
        image.setflags(write=True)
        rows = slice(command.y_offset, command.y_offset + new.shape[1])
        image[command.face, rows, command.x_offset : command.x_offset + new.shape[2]] = new[0]
        image.setflags(write=False)
        images[command.level] = image
        if command.generate_mipmap:
            images[:] = pyramid(image)
    return replace(texture, levels=tuple(levels), ideal=tuple(ideal))

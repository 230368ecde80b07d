"""Textures with real texels: given by a command, or copied from the framebuffer."""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.commands import CopyTexSubImage, TexImage
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.framebuffers.texture_copies import defined_texture, depth_texture
from fixedpipe.pipeline.framebuffers.transfer import transfer_depths
from fixedpipe.pipeline.ideal.buffers import transferred
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.images import DEPTH_TEXELS, pyramid, texture_2d


def with_ideal(texture):
    if texture.ideal is not None:
        return texture
    one = 2.0**texture.bits - 1.0
    if texture.internal_format in DEPTH_TEXELS:
        most, _ = DEPTH_TEXELS[texture.internal_format]
        words = [np.ascontiguousarray(level).view("<u4") for level in texture.levels]
        return replace(texture, ideal=tuple(np.repeat(w / most, 4, axis=3) for w in words))
    return replace(texture, ideal=tuple(level / one for level in texture.levels))


def frame_texture(command, buffers, textures, statistics):
    """The texture that a TexImage of pixels or a copy makes; None where a sink took the image."""
    if isinstance(command, TexImage):
        return defined_texture(command, IDEAL, statistics)
    sub_image = isinstance(command, CopyTexSubImage)
    known = textures[command.texture] if sub_image else command
    target, internal_format, box = known.target, known.internal_format, buffers.box_of(command)
    if internal_format in DEPTH_TEXELS:
        depths = transfer_depths(buffers.rows(buffers.depth, *box), command.transfer)
        copied = depth_texture(target, internal_format, depths)
    else:
        dimensions = 1 if target is TextureTarget.TEXTURE_1D else 2
        region = transferred(buffers.rows(buffers.color, *box), command, statistics, dimensions)
        if region is None:
            return None
        mipmaps = command.generate_mipmap and not sub_image
        copied = texture_2d(region, internal_format, mipmaps=mipmaps)
    return _patched(command, known, copied) if sub_image else replace(copied, target=target)


def _patched(command, texture, patch):
    """A texture with one rectangle of one level replaced by another's only level."""
    levels, ideal = list(texture.levels), list(texture.ideal)
    for images, new in ((levels, patch.levels[0]), (ideal, patch.ideal[0])):
        image = images[command.level].copy()
        rows = slice(command.y_offset, command.y_offset + new.shape[1])
        image[command.face, rows, command.x_offset : command.x_offset + new.shape[2]] = new[0]
        image.setflags(write=False)
        images[command.level] = image
        if command.generate_mipmap:
            images[:] = pyramid(image)
    return replace(texture, levels=tuple(levels), ideal=tuple(ideal))

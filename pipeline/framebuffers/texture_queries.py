"""GetTexImage: the images of a texture as pixels.

Source: OpenGL 1.2.1 section 6.1.4; ARB_depth_texture for depths; for pixel transfer EXT_convolution and
EXT_texture3D.
"""

import numpy as np

from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.framebuffers.scaled_words import Words
from fixedpipe.pipeline.framebuffers.transfer import packed_colors, transfer_colors, transfer_depths
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    DEPTH_TEXELS,
    KEPT,
    RETURNED_COMPONENTS,
    register_components,
    stored_widths,
)
from fixedpipe.raster.pixels.transfer import fixed


def texture_pixels(texture, command, profile, statistics):
    """The pixels that a GetTexImage returns of a machine's texture, [(d, )h, w(, c)]; None from a sink."""
    level, internal_format = texture.levels[command.level], texture.internal_format
    if internal_format in DEPTH_TEXELS:
        return _depths(level[command.face], internal_format, command.transfer)
    return queried_colors(
        texture.target,
        level,
        command,
        lambda image: _words(image, texture, profile),
        lambda groups: packed_colors(groups, command.format, command.type),
        profile,
        statistics,
    )


def queried_colors(target, level, command, groups_of, returned, profile, statistics):
    """The images of a ``level`` [faces, h, w, 4] that a GetTexImage reads; None where a sink took them.

    - ``groups_of``: gives an image's groups before pixel transfer.
    - ``returned``: gives the result for an image's groups after pixel transfer.
    """
    layered = target is TextureTarget.TEXTURE_3D
    dimensions = {TextureTarget.TEXTURE_1D: 1, TextureTarget.TEXTURE_3D: 3}.get(target, 2)
    read = []
    for image in level if layered else level[command.face][None]:
        groups = transfer_colors(groups_of(image), command.transfer, profile, statistics, dimensions)
        if groups is not None:
            read.append(returned(groups))
    if not read:
        return None
    return np.stack(read) if layered else read[0]


def _words(image, texture, profile):
    """A machine's texels [h, w, 4] as groups of fractions.

    The bits that the format keeps of each component are divided by their largest value.
    """
    base, (bits, kept) = BASE_FORMAT[texture.internal_format], stored_widths(texture.internal_format, profile)
    components = image[..., list(KEPT[base])].astype(np.int64) >> (bits - np.array(kept))
    ones = [(1 << kept[place]) - 1 if isinstance(place, int) else 1 for place in RETURNED_COMPONENTS[base]]
    return Words(register_components(components, base, 1, RETURNED_COMPONENTS), tuple(ones))


def _depths(image, internal_format, transfer):
    """Depth texels [h, w, 4] as depths in the texture's units, uint32 [h, w]."""
    words = np.ascontiguousarray(image).view("<u4")[..., 0]
    if (transfer.depth_scale, transfer.depth_bias) == (1.0, 0.0):
        return words.copy()
    most = DEPTH_TEXELS[internal_format].largest
    return fixed(transfer_depths(words / float(most), transfer), most.bit_length()).astype(np.uint32)

"""Images that only the machine knows: they were copied from the framebuffer.

A machine's texture has levels that fit together. A program may copy a level before the others exist, say the
smallest first. Such an image is copied into a texture that has it alone. When the object's levels fit
together, all its copied images are read back, and a HostStep stores them as one texture.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.commands import CopyTexSubImage, GetTexImage, TexImage
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.outcomes import Refused
from fixedpipe.pipeline.opengl.texels import Texels, patched, real_of, texels_of_groups
from fixedpipe.pipeline.textures.images import DEPTH_TEXELS, TWELVE_BIT_FORMATS, Texture, halve


def copy_alone(gl, texture, position, copy: CopyTexSubImage):
    """Copy a rectangle into an image that fits no other level. ``position``: its face and level."""
    image, (face, level) = texture.images[position], position
    if texture.is_volume or image.patches:
        raise Refused(f"copies into level {level} of {texture.name}, which does not fit its other levels")
    if texture.home is not gl.drawable.stored:
        if any(other.texels is None for other in texture.images.values()):
            raise Refused(f"{texture.name} was copied from another window's framebuffer")
        texture.home, texture.home_levels = gl.drawable.stored, 0
    name = f"{texture.name}, face {face}, level {level} alone"
    if image.alone is None:
        known, internal_format = texture.known(image), image.chosen.format
        flat = TextureTarget.TEXTURE_1D if texture.target == tokens.TEXTURE_1D else TextureTarget.TEXTURE_2D
        ideal = None if known.real is None else (known.real,)
        bits = 12 if internal_format in TWELVE_BIT_FORMATS else 8
        stored = Texture(flat, internal_format, (known.texels,), ideal, bits)
        gl.commands.append(TexImage(label=copy.label, texture=name, image=stored))
    gl.commands.append(replace(copy, texture=name, level=0, face=0))
    texture.images[position] = replace(image, texels=None, alone=(name, 0, 0))


def reading(label, name, source, internal_format):
    """The GetTexImage that reads an image as integers of enough bits. ``source``: texture, level and face."""
    deep, wide = internal_format in DEPTH_TEXELS, internal_format in TWELVE_BIT_FORMATS
    texture, level, face = source
    return GetTexImage(
        label=label,
        name=name,
        texture=texture,
        level=level,
        face=face,
        format="DEPTH_COMPONENT" if deep else "RGBA",
        type="UNSIGNED_SHORT" if wide else "UNSIGNED_BYTE",
    )


def with_copies(texture, layout, arrays):
    """A Texture with the images that were read, {(level, face): array}, and with later patches."""
    stored = texture.internal_format
    levels = [level.copy() for level in texture.levels]
    reals = [
        real_of(Texels(level, None if texture.ideal is None else texture.ideal[k]), stored).copy()
        for k, level in enumerate(texture.levels)
    ]
    for (k, face), array in arrays.items():
        found = _texels_read(array, stored)
        image = layout.levels[k][face]
        if image.patches:
            found = patched(found, image.patches, stored)
        part = slice(None) if texture.target is TextureTarget.TEXTURE_3D else slice(face, face + 1)
        levels[k][part] = found.texels
        reals[k][part] = real_of(found, stored)
    return replace(texture, levels=tuple(levels), ideal=tuple(reals))


def _texels_read(array, stored):
    """The Texels [layers, h, w, 4] of an array from GetTexImage, which has integers or floats."""
    if stored in DEPTH_TEXELS:
        most = float(DEPTH_TEXELS[stored].largest)
        depths = array if array.dtype.kind == "f" else array / most
        words = np.floor(np.clip(depths, 0.0, 1.0) * most + 0.5).astype("<u4")
        layers = words.reshape(-1, *words.shape[-2:])
        texels = np.ascontiguousarray(layers).view(np.uint8).reshape(*layers.shape, 4)
        real = np.broadcast_to(depths.reshape(layers.shape)[..., None], texels.shape)
        return Texels(texels, real)
    groups = array if array.dtype.kind == "f" else array / float(np.iinfo(array.dtype).max)
    return texels_of_groups(groups.reshape(-1, *groups.shape[-3:]), stored)


def with_mipmaps(texture, base, volume):
    """A Texture whose levels above level ``base`` are made from that level."""
    levels, ideal = list(texture.levels[: base + 1]), list(texture.ideal[: base + 1])
    while len(levels) < len(texture.levels):
        levels.append(halve(levels[-1], volume))
        ideal.append(halve(ideal[-1], volume))
    return replace(texture, levels=tuple(levels), ideal=tuple(ideal))

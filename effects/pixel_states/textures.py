"""Textures of a small state: texels as bytes, words of memory, indices of a palette, compressed blocks."""

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.pixel_states.values import read_object, read_value, wrong
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.enums import InternalFormat, TexelWord, TextureTarget
from fixedpipe.pipeline.textures.images import Texture, build_texture
from fixedpipe.pipeline.textures.words import (
    S3TC_BLOCK_BYTES,
    compressed_texture,
    paletted_texture,
    texture_of_words,
)

# What a texture is made of, and the keys that go with it.
KINDS = {
    "texels": ("internal_format", "mipmaps", "border"),
    "levels": ("internal_format", "border"),
    "words": ("word",),
    "indices": ("palette",),
    "blocks": ("internal_format", "width", "height", "level_count"),
}
KEYS = ("target", *KINDS, *dict.fromkeys(key for keys in KINDS.values() for key in keys))
MOST_TEXELS = 1 << 18  # of an array; 512 by 512
# Axes of a target's texels, without the components. A cube map has six faces along the first.
AXES = {
    TextureTarget.TEXTURE_1D: 1,
    TextureTarget.TEXTURE_2D: 2,
    TextureTarget.TEXTURE_RECTANGLE: 2,
    TextureTarget.TEXTURE_CUBE_MAP: 3,
    TextureTarget.TEXTURE_3D: 3,
}
_BYTE, _WORD = 255, (1 << 32) - 1
_FACES = 6


def read_texture(given: Any, path: str) -> Texture:
    """The Texture of an object with one of KINDS. ``path`` names it in sentences. Raises Refusal."""
    given = read_object(given, path, KEYS)
    kinds = [kind for kind in KINDS if kind in given]
    if len(kinds) != 1:
        has = " and ".join(kinds) or "none of them"
        raise Refusal(f"{path} takes one of {', '.join(KINDS)}; it has {has}. Give one.")
    (kind,) = kinds
    for key in given:
        if key not in ("target", kind, *KINDS[kind]):
            raise Refusal(f"{path} has {kind!r}, and {key!r} does not go with it; leave {key!r} out.")
    target = read_value(TextureTarget, given.get("target", "TEXTURE_2D"), f"{path}.target")
    try:
        return _MAKERS[kind](given, path, target)
    except Refusal:
        raise
    except ValueError as error:
        raise Refusal(f"{path}: {error}") from error


def whole_array(given: Any, path: str, axes: tuple[int, ...], most: int) -> NDArray[np.int64]:
    """Lists within lists of whole numbers from 0 to ``most``, as int64. ``axes``: how many levels of lists it
    may have. Raises Refusal.
    """
    try:
        array = np.array(given)
    except (ValueError, OverflowError):
        array = np.array(None)
    if array.dtype.kind not in "iu":
        raise Refusal(f"{path} is no block of whole numbers; give lists of equal lengths.")
    if array.ndim not in axes or not array.size:
        wanted = " or ".join(map(str, axes))
        raise Refusal(f"{path} has the shape {list(array.shape)}; give lists nested {wanted} deep.")
    if array.size > 4 * MOST_TEXELS:
        raise Refusal(f"{path} has {array.size} numbers; a small state has at most {4 * MOST_TEXELS}.")
    if int(array.min()) < 0 or int(array.max()) > most:
        raise Refusal(f"{path} has numbers from {array.min()} to {array.max()}; give 0 to {most}.")
    return array.astype(np.int64)


def _faces(given, path, target):
    """Texels [faces, height, width, 4] of bytes, as ``build_texture`` takes them."""
    axes = AXES[target]
    array = whole_array(given, path, (axes + 1,), _BYTE).astype(np.uint8)
    components = array.shape[-1]
    if not 1 <= components <= 4:
        raise Refusal(f"{path} has texels of {components} components; give 1 to 4.")
    if target is TextureTarget.TEXTURE_CUBE_MAP and array.shape[0] != _FACES:
        raise Refusal(f"{path} has {array.shape[0]} faces; give {_FACES}: +x, -x, +y, -y, +z, -z.")
    array = array.reshape((1,) * (4 - array.ndim) + array.shape)
    return np.concatenate([array, *_rest(array)], axis=-1)


def _rest(array):
    """The components that texels of fewer than four lack: luminance in green and blue, and alpha 255."""
    count, opaque = array.shape[-1], np.full_like(array[..., :1], _BYTE)
    if count == 1:
        return [array, array, opaque]
    if count == 2:
        # OpenGL's two components are luminance and alpha.
        raise ValueError("texels of 2 components are luminance and alpha; give four, as [l, l, l, a]")
    return [opaque] * (4 - count)


def _format(given, path):
    return read_value(InternalFormat, given.get("internal_format", "RGBA8"), f"{path}.internal_format")


def _texels(given, path, target):
    faces = _faces(given["texels"], f"{path}.texels", target)
    border = read_value(int, given.get("border", 0), f"{path}.border")
    mipmaps = read_value(bool, given.get("mipmaps", False), f"{path}.mipmaps")
    return build_texture(target, faces, _format(given, path), mipmaps, border)


def _levels(given, path, target):
    if not (isinstance(given["levels"], list) and 0 < len(given["levels"]) < 16):
        wrong(f"{path}.levels", given["levels"], "give a list of the levels' texels, level 0 first")
    border = read_value(int, given.get("border", 0), f"{path}.border")
    made = [
        build_texture(
            target, _faces(level, f"{path}.levels[{n}]", target), _format(given, path), False, border
        )
        for n, level in enumerate(given["levels"])
    ]
    first = made[0]
    levels = tuple(texture.levels[0] for texture in made)
    ideal = None if first.ideal is None else tuple(texture.ideal[0] for texture in made)
    return Texture(target, first.internal_format, levels, ideal, first.bits, border)


def _words(given, path, target):
    words = whole_array(given["words"], f"{path}.words", (AXES[target],), _WORD)
    words = words.reshape((1,) * (2 - words.ndim) + words.shape)
    if "word" not in given:
        raise Refusal(f"{path} has words and no 'word', which names their layout: \"R5G6B5\" for instance.")
    return texture_of_words(words, read_value(TexelWord, given["word"], f"{path}.word"), target)


def _indices(given, path, target):
    indices = whole_array(given["indices"], f"{path}.indices", (AXES[target],), _BYTE)
    indices = indices.reshape((1,) * (2 - indices.ndim) + indices.shape)
    palette = whole_array(given.get("palette"), f"{path}.palette", (1,), _WORD)
    return paletted_texture(indices, palette, target)


def _blocks(given, path, target):
    if target is not TextureTarget.TEXTURE_2D:
        raise Refusal(f"{path} has blocks and the target {target.name}; blocks are of TEXTURE_2D alone.")
    internal_format = _format(given, path)
    if internal_format not in S3TC_BLOCK_BYTES:
        names = ", ".join(known.name for known in S3TC_BLOCK_BYTES)
        raise Refusal(f"{path} has blocks and the format {internal_format.name}; give one of {names}.")
    size = {"width": 4, "height": 4, "level_count": 1}
    width, height, count = (
        read_value(int, given.get(key, usual), f"{path}.{key}") for key, usual in size.items()
    )
    if min(width, height, count) < 1 or prod((width, height)) > MOST_TEXELS or count > 16:
        raise Refusal(f"{path} is {width}x{height} with {count} levels; give 1x1 to 512x512, and 1 to 16.")
    data = read_value(bytes, given["blocks"], f"{path}.blocks")
    return compressed_texture(data, internal_format, width, height, count)


_MAKERS = {
    "texels": _texels,
    "levels": _levels,
    "words": _words,
    "indices": _indices,
    "blocks": _blocks,
}

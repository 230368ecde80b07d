"""Surfaces as words in the chip's memory, row by row, and the same bytes as a picture of other words.

Programs of nxdk_pgraph_tests draw to memory under one format and read it as a texture, or show it, under
another. Here ReadPixels gives a surface's stored bytes, and a HostStep turns them into what another reader
finds.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.texture_memory import WORD_BYTES
from fixedpipe.pipeline.commands import Draw, HostStep, TexImage
from fixedpipe.pipeline.enums import ColorFormat, TextureTarget
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

# Bits of red, green, blue and alpha in a word of 16, each (lowest, how many); of alpha also what pads.
_SHORT = {
    ColorFormat.R5G6B5: ((11, 5), (5, 6), (0, 5), (16, 0)),
    ColorFormat.X1R5G5B5_Z1R5G5B5: ((10, 5), (5, 5), (0, 5), (15, 1)),
    ColorFormat.X1R5G5B5_O1R5G5B5: ((10, 5), (5, 5), (0, 5), (15, 1)),
}


def word_bytes(color_format):
    """Bytes of a surface's pixel."""
    return 2 if color_format in _SHORT else 4


def words_of(rgba, color_format):
    """The words of a surface's stored bytes [rows, columns, 4], top row first: unsigned [rows, columns]."""
    components = rgba.astype(np.int64)
    places = _SHORT.get(color_format, ((16, 8), (8, 8), (0, 8), (24, 8)))
    words = sum((components[..., k] >> (8 - bits)) << low for k, (low, bits) in enumerate(places))
    return words.astype(f"<u{word_bytes(color_format)}")


def clear_color(word, color_format):
    """The colour, RGBA, that a Clear stores from the register's word: CLEAR_SURFACE writes its bits
    unchanged.

    Measured: 6 words in each of 4 formats (Clear captures).
    """
    seven = color_format in (ColorFormat.X1A7R8G8B8_Z1A7R8G8B8, ColorFormat.X1A7R8G8B8_O1A7R8G8B8)
    places = _SHORT.get(color_format, ((16, 8), (8, 8), (0, 8), (24, 7 if seven else 8)))
    return tuple(((word >> low & (1 << bits) - 1) << (8 - bits)) / 255.0 for low, bits in places)


def memory_of(words, pitch=None):
    """The bytes of rows of words, one behind the other; ``pitch``: from row to row, bytes (zeros between)."""
    rows = np.ascontiguousarray(words).view(np.uint8).reshape(words.shape[0], -1)
    if pitch is not None:
        rows = np.pad(rows, ((0, 0), (0, pitch - rows.shape[1])))
    return rows.reshape(-1)


def image_of(memory, word, width, height, pitch=None, offset=0):
    """A rectangle texture from linear memory, read as words ``word`` (a TexelWord), its first row at t = 0.

    ``pitch``: bytes from row to row; ``offset``: of the first row. Memory beyond the end is zero.
    """
    size = WORD_BYTES[word]
    pitch = width * size if pitch is None else pitch
    needed = offset + pitch * height
    bytes_ = np.pad(memory, (0, max(0, needed - len(memory))))[offset:needed].reshape(height, pitch)
    words = np.ascontiguousarray(bytes_[:, : width * size]).view(f"<u{size}").astype(np.int64)
    return texture_of_words(words, word, TextureTarget.TEXTURE_RECTANGLE)


def shown(label, texture, corners, width, height, state=scenes.DEFAULT, combiners=scenes.SHOWS_TEXTURE0):
    """A quad that shows ``width`` by ``height`` texels of a rectangle texture, nearest ones."""
    texels = np.array([(0, 0), (width, 0), (width, height), (0, height)])
    state = replace(
        state,
        texture_units=(TextureUnit(texture, scenes.NEAREST),),
        register_combiners=combiners,
    )
    return Draw(label=label, mesh=scenes.window_mesh(corners, texture_coordinates=(texels,)), state=state)


def host_picture(label, read, image, draws):
    """A HostStep that makes a texture of what ReadPixels called ``read`` gave, ``image(rgba)`` with the top
    row first, and draws it.
    """

    def commands(pixels):
        return (TexImage(label=label, texture=label, image=image(pixels[read][::-1])), *draws)

    return HostStep(label=label, reads=(read,), commands=commands)

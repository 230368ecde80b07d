"""Pictures that the suites' programs make, and the words that they write to texture memory.

A program converts a picture of RGBA bytes to a format's words, by SDL's conversion, which cuts bits, or by
its own formula. It writes them row by row or swizzled, and names the format to the chip. If it has no
conversion for a format, it writes words of another format. The chip reads those bytes under the named format,
and so do these functions.

Source: TextureStage and the texture generators of pbkitplusplus; SDL's pixel formats.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.enums import TexelWord, TextureTarget
from fixedpipe.pipeline.textures.words import texture_of_words

WORD_BYTES = {
    **dict.fromkeys(TexelWord, 2),
    **dict.fromkeys((TexelWord.Y8, TexelWord.AY8, TexelWord.A8), 1),
    **dict.fromkeys(
        (
            *(TexelWord.A8R8G8B8, TexelWord.X8R8G8B8, TexelWord.A8B8G8R8, TexelWord.B8G8R8A8),
            *(TexelWord.R8G8B8A8, TexelWord.R16B16, TexelWord.X8_Y24_FIXED, TexelWord.X8_Y24_FLOAT),
        ),
        4,
    ),
}

# Each component's highest bits (SDL's conversion, but for R6G5B5, which is later programs' own): the lowest
# bit and the width of red, green, blue and alpha.
_PACKED = {
    TexelWord.A8R8G8B8: ((16, 8), (8, 8), (0, 8), (24, 8)),
    TexelWord.X8R8G8B8: ((16, 8), (8, 8), (0, 8), (24, 8)),
    TexelWord.A8B8G8R8: ((0, 8), (8, 8), (16, 8), (24, 8)),
    TexelWord.B8G8R8A8: ((8, 8), (16, 8), (24, 8), (0, 8)),
    TexelWord.R8G8B8A8: ((24, 8), (16, 8), (8, 8), (0, 8)),
    TexelWord.R5G6B5: ((11, 5), (5, 6), (0, 5), (0, 0)),
    TexelWord.R6G5B5: ((10, 6), (5, 5), (0, 5), (0, 0)),
    TexelWord.A1R5G5B5: ((10, 5), (5, 5), (0, 5), (15, 1)),
    TexelWord.X1R5G5B5: ((10, 5), (5, 5), (0, 5), (15, 1)),
    TexelWord.A4R4G4B4: ((8, 4), (4, 4), (0, 4), (12, 4)),
}


@dataclass(frozen=True)
class Format:
    """One entry of the programs' format table. It has the name there, the words, whether rows lie in order
    (coordinates of such textures count texels), and whether and to which words SDL converts.
    """

    name: str
    word: TexelWord
    linear: bool = False
    converted_by_sdl: bool = True
    sdl_word: TexelWord | None = None

    @property
    def case_name(self):
        """As in the names of captures."""
        return f"{self.name}_L" if self.linear else self.name

    @property
    def target(self):
        """The chip's name of such a texture."""
        return TextureTarget.TEXTURE_RECTANGLE if self.linear else TextureTarget.TEXTURE_2D


def _entries(linear, names):
    sdl = {TexelWord.A8: TexelWord.B8G8R8A8, TexelWord.R6G5B5: TexelWord.A1R5G5B5}
    for name in names.split():
        word = TexelWord[name]
        by_hand = word not in _PACKED and word is not TexelWord.A8
        yield Format(name, word, linear, not by_hand, sdl.get(word, word if word in _PACKED else None))


# Source: kTextureFormats, but for palettes and S3TC; depths follow. Formats that need a conversion by hand
# are R8G8B8A8 to SDL.
FORMATS = (
    *_entries(
        False,
        "A8B8G8R8 R8G8B8A8 A8R8G8B8 X8R8G8B8 B8G8R8A8 R5G6B5 A1R5G5B5 X1R5G5B5 A4R4G4B4 R16B16 Y16 Y8 AY8 A8 "
        "A8Y8 G8B8 R8B8 R6G5B5",
    ),
    *_entries(
        True,
        "A8B8G8R8 R8G8B8A8 A8R8G8B8 X8R8G8B8 B8G8R8A8 R5G6B5 A1R5G5B5 X1R5G5B5 A4R4G4B4 G8B8 R16B16 Y16 YUY2 "
        "UYVY Y8 A8 AY8",
    ),
)
# The swizzled ones, which the programs fill as R8G8B8A8 where they do not write words.
DEPTHS = tuple(
    Format(f"D_{name}", word, sdl_word=TexelWord.R8G8B8A8)
    for name, word in (
        ("X8Y24_FIXED", TexelWord.X8_Y24_FIXED),
        ("X8Y24_FLOAT", TexelWord.X8_Y24_FLOAT),
        ("Y16_FIXED", TexelWord.Y16_FIXED),
        ("Y16_FLOAT", TexelWord.Y16_FLOAT),
    )
)


# ------------------------------------------------------------------------------------------- pictures


def ramp(size):
    """``size`` integers from 0 to 255, as the programs' single precision gives them."""
    return (np.arange(size, dtype=np.float32) * np.float32(255) / np.float32(size)).astype(np.int64)


def gradient(width=256, height=256):
    """RGBA bytes [height, width, 4]: red grows downwards and blue falls, green to the right, alpha is the sum
    of red and green.
    """
    x, y = np.meshgrid(ramp(width), ramp(height))
    return (np.stack([y, x, 255 - y, x + y], -1) & 255).astype(np.uint8)


def radial_gradient(width, height):
    """RGBA bytes: brighter away from the middle; red grows to the right as well, green downwards."""
    x, y = np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)[:, None]
    center = np.float32(width - 1) / np.float32(2), np.float32(height - 1) / np.float32(2)
    dx, dy = x - center[0], y - center[1]
    distance = np.sqrt(dx * dx + dy * dy) / np.sqrt(center[0] * center[0] + center[1] * center[1])
    colors = (
        x / np.float32(width) * distance,
        y / np.float32(height) * distance,
        np.float32(0.75) * distance,
    )
    opaque = np.full((height, width), 255)
    return np.stack([*((c * np.float32(255)).astype(np.int64) for c in colors), opaque], -1).astype(np.uint8)


# --------------------------------------------------------------------------------------- conversions


def packed_words(rgba, word):
    """RGBA bytes [..., 4] as words of each component's highest bits."""
    components = rgba.astype(np.int64)
    return sum(
        (components[..., k] >> (8 - bits)) << low for k, (low, bits) in enumerate(_PACKED[word]) if bits
    )


def _weighted(rgba, weights, offset=0.0):
    """Single-precision sum of weighted components and the offset, in this order, cut to an integer."""
    red, green, blue = (
        np.float32(weight) * rgba[..., component].astype(np.float32)
        for component, weight in enumerate(weights)
    )
    return (((red + green) + blue) + np.float32(offset)).astype(np.int64)


def _luminance(rgba):
    return _weighted(rgba, (0.299, 0.587, 0.114))


def _ycbcr_words(rgba, word):
    """Y of every texel; U and V of the second texel of its pair."""
    y = _weighted(rgba, (0.257, 0.504, 0.098), 16.0)
    second = np.repeat(rgba[..., 1::2, :], 2, -2)
    u, v = (
        _weighted(second, (-0.148, -0.291, 0.439), 128.0),
        _weighted(second, (0.439, -0.368, -0.071), 128.0),
    )
    chroma = np.where(np.arange(rgba.shape[-2]) % 2 == 0, u, v)
    return y | (chroma << 8) if word is TexelWord.YUY2 else chroma | (y << 8)


def converted_words(rgba, word):
    """The programs' own conversions of RGBA bytes [..., 4]."""
    red, green, blue, alpha = (rgba[..., k].astype(np.int64) for k in range(4))
    if word in (TexelWord.YUY2, TexelWord.UYVY):
        return _ycbcr_words(rgba, word)
    if word in (TexelWord.Y8, TexelWord.AY8):
        return _luminance(rgba)
    if word is TexelWord.A8Y8:
        return _luminance(rgba) | (alpha << 8)
    if word is TexelWord.Y16:
        shares = _luminance(rgba).astype(np.float32) / np.float32(255)
        return (shares * np.float32(65535)).astype(np.int64)
    if word is TexelWord.R16B16:
        return (red * 257 << 16) | (blue * 257)
    return blue | ((green if word is TexelWord.G8B8 else red) << 8)


# ------------------------------------------------------------------------------------------- memory


def swizzled_places(width, height, depth=1):
    """Where texel [layer, row, column] lies in a swizzled texture: the bits of the column, row and layer
    interleaved from the lowest up, each while it has any.
    """
    column, row, layer = np.arange(width), np.arange(height)[:, None], np.arange(depth)[:, None, None]
    place, at = np.zeros((depth, height, width), np.int64), 0
    for bit in range(max(width, height, depth).bit_length()):
        for size, index in ((width, column), (height, row), (depth, layer)):
            if 1 << bit < size:
                place += ((index >> bit) & 1) << at
                at += 1
    return place


def read_as(words, written, word, swizzled):
    """The words [layers, rows, columns] that the chip reads of a texture of that size.

    ``written``: the words that the program wrote, in the format of ``words``; ``word``: the format that it
    set.
    """
    if WORD_BYTES[written] == WORD_BYTES[word]:
        return words
    depth, height, width = words.shape
    places = swizzled_places(width, height, depth) if swizzled else np.arange(words.size).reshape(words.shape)
    memory = np.empty(words.size, np.dtype(f"<u{WORD_BYTES[written]}"))
    memory[places] = words
    return memory.view(np.dtype(f"<u{WORD_BYTES[word]}"))[places].astype(np.int64)


def texture_of(rgba, entry):
    """The texture that the chip sees of a picture, RGBA bytes [rows, columns, 4], in a format."""
    if entry.word is TexelWord.R6G5B5:
        # The version that drew Texture_format's captures lets SDL write R5G6B5; the volumes' writes A1R5G5B5,
        # those of the bump maps and the render targets R6G5B5 itself (``highest_bits``).
        return texture_of_words(packed_words(rgba, TexelWord.R5G6B5), entry.word, entry.target)
    if not entry.converted_by_sdl:
        return texture_of_words(converted_words(rgba, entry.word), entry.word, entry.target)
    words = packed_words(rgba, entry.sdl_word)[None]
    return texture_of_words(
        read_as(words, entry.sdl_word, entry.word, not entry.linear), entry.word, entry.target
    )


def highest_bits(rgba, entry):
    """The texture of a picture, RGBA bytes [rows, columns, 4], whose words are the format's own."""
    return texture_of_words(packed_words(rgba, entry.word), entry.word, entry.target)


def dxt1_blocks(rgba):
    """The programs' own DXT1: bytes [rows / 4, columns / 4, 8], the colour of each block's first texel.

    A block is wholly opaque, or transparent where the alpha of that texel is below 125.
    """
    first = rgba[::4, ::4]
    blocks = np.zeros((*first.shape[:2], 8), np.uint8)
    color = packed_words(first, TexelWord.R5G6B5)
    blocks[..., 2], blocks[..., 3] = color & 255, color >> 8
    blocks[..., 4:] = np.where(first[..., 3:] >= 125, 0x55, 0xFF)  # all texels the second colour, or none
    return blocks


def volume_of(layers, entry):
    """The 3D texture of pictures [layers, rows, columns, 4] in a swizzled format.

    The programs convert volumes with SDL alone, formats that need more to R8G8B8A8.
    """
    written = TexelWord.R8G8B8A8 if entry.sdl_word is None else entry.sdl_word
    words = read_as(packed_words(layers, written), written, entry.word, True)
    return texture_of_words(words, entry.word, TextureTarget.TEXTURE_3D)

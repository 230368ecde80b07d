"""Texels as memory holds them: words, YCbCr pairs and S3TC blocks, one at a time, to four register bytes."""

from tests.reference import fixed
from tests.reference.texel_formats import ONE, replicate

# Components from the highest bit down, with their bits; a digit after the letters says which of two.
# Source: the formats' names; Measured: Texture_format and Volume_texture captures.
LAYOUTS = {
    "A8R8G8B8": "A8 R8 G8 B8",
    "X8R8G8B8": "X8 R8 G8 B8",
    "A8B8G8R8": "A8 B8 G8 R8",
    "B8G8R8A8": "B8 G8 R8 A8",
    "R8G8B8A8": "R8 G8 B8 A8",
    "A1R5G5B5": "A1 R5 G5 B5",
    "X1R5G5B5": "X1 R5 G5 B5",
    "A4R4G4B4": "A4 R4 G4 B4",
    "R5G6B5": "R5 G6 B5",
    "R6G5B5": "R6 G5 B5",
    "G8B8": "G8 B8",
    "R8B8": "R8 B8",
    "A8Y8": "A8 Y8",
    "Y8": "Y8",
    "AY8": "Y8",
    "A8": "A8",
    "Y16": "G8 B8",
    "R16B16": "A8 R8 G8 B8",
    "V8U8": "G8 B8",
    "L6V5U5": "R6 G5 B5",
    "X8L8V8U8": "X8 R8 G8 B8",
    "Q8W8V8U8": "A8 B8 G8 R8",
    "V16U16": "G8 B8 A8 R8",
}
# Register components that a format takes from another of its own. Measured: their captures.
COPIES = {
    "G8B8": {"R": "B", "A": "G"},
    "V8U8": {"R": "B", "A": "G"},
    "R8B8": {"G": "B", "A": "R"},
    "A8Y8": {"R": "Y", "G": "Y", "B": "Y"},
    "Y8": {"R": "Y", "G": "Y", "B": "Y"},
    "AY8": {"R": "Y", "G": "Y", "B": "Y", "A": "Y"},
}


def texel_of_word(word, name):
    """Four register bytes. Components that a word does not hold are one. Source: the formats' names."""
    held, at = {}, 0
    for component in reversed(LAYOUTS[name].split()):
        letter, bits = component[0], int(component[1:])
        held[letter] = replicate((word >> at) % 2**bits, bits)
        at += bits
    copies = COPIES.get(name, {})
    return [held.get(copies.get(letter, letter), ONE) for letter in "RGBA"]


def texel_of_ycbcr(y, u, v):
    """Measured: 123904 of 123904 pixels (Texture_format UYVY_L)."""
    light = (298 * y) // 256 - 19
    red = light + 2 * ((409 * (v - 128) + 128) // 512)
    green = light + 1 - 2 * ((25 * (u - 128)) // 128) - 2 * ((13 * (v - 128)) // 32)
    blue = light + (129 * (u - 128)) // 64
    return [fixed.clamp(component, 0, 255) for component in (red, green, blue)] + [ONE]


def texels_of_block(block, name):
    """Sixteen texels, row by row, of an S3TC block's bytes; ``name``: DXT1, DXT3 or DXT5.

    Source: EXT_texture_compression_s3tc; Measured: thirds, fifths and sevenths round to nearest
    (DXT3_plasma, DXT5_plasma_alpha).
    """
    color = block[-8:]
    ends = [int.from_bytes(bytes(color[k : k + 2]), "little") for k in (0, 2)]
    a, b = (texel_of_word(end, "R5G6B5")[:3] for end in ends)
    mix = lambda p, q, of: [(p * x + q * y + of // 2) // of for x, y in zip(a, b, strict=True)]  # noqa: E731
    palette = [[*a, ONE], [*b, ONE], [*mix(2, 1, 3), ONE], [*mix(1, 2, 3), ONE]]
    if name == "DXT1" and ends[0] <= ends[1]:
        palette[2:] = [[*mix(1, 1, 2), ONE], [0, 0, 0, 0]]
    codes = int.from_bytes(bytes(color[4:]), "little")
    texels = [list(palette[(codes >> (2 * i)) & 3]) for i in range(16)]
    if name == "DXT3":
        alphas = int.from_bytes(bytes(block[:8]), "little")
        for i, texel in enumerate(texels):
            texel[3] = replicate((alphas >> (4 * i)) & 15, 4)
    elif name == "DXT5":
        a, b, codes = block[0], block[1], int.from_bytes(bytes(block[2:8]), "little")
        steps = 7 if a > b else 5
        levels = [a, b, *(((steps - k) * a + k * b + steps // 2) // steps for k in range(1, steps))]
        levels += [] if a > b else [0, 255]
        for i, texel in enumerate(texels):
            texel[3] = levels[(codes >> (3 * i)) & 7]
    return texels


def place_of_block(layer, row, column, rows, columns, depth):
    """How many blocks of a 3D texture lie before that one. Source: NV_texture_compression_vtc."""
    first = layer - layer % 4
    together = min(4, depth - first)
    return first * rows * columns + (row * columns + column) * together + layer % 4


# What is taken off red, green and blue in each row of a square of 4x4 texels, and the step that is kept.
# Measured: 2048 of 2048 texels (Texture_DXT captures).
DITHER = (
    ("0415 2637 5140 7362", 8),
    ("3120 2013 1302 0231", 4),
    ("7362 5140 2637 0415", 8),
)


def dithered(texel, x, y):
    """A DXT1 texel at (x, y) as the NV2A holds it: five or six bits of each colour less the place's number,
    which is given back with half a step; none of the bits is 0, all of them 255.

    Measured: all pixels of Texture_DXT's and Volume_texture's DXT1 captures (docs/numbers.md section 7).
    """
    out = list(texel)
    for channel, (rows, step) in enumerate(DITHER):
        taken = int(rows.split()[y % 4][x % 4])
        kept = max(texel[channel] - taken, 0) // step
        between = step * kept + taken + step // 2 - 1
        out[channel] = {0: 0, 255 // step: 255}.get(kept, between)
    return out

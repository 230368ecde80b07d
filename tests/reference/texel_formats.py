"""Texels: a format's bits per component, and where its components go in a texture register."""

import math

from fixedpipe.pipeline.enums import BaseFormat
from tests.reference import fixed

ONE = 255

# Base format, then the bits of each of its components.  Source: OpenGL 1.2.1 table 3.16.
FORMATS = {
    "ALPHA4": (BaseFormat.ALPHA, 4),
    "ALPHA8": (BaseFormat.ALPHA, 8),
    "LUMINANCE4": (BaseFormat.LUMINANCE, 4),
    "LUMINANCE8": (BaseFormat.LUMINANCE, 8),
    "LUMINANCE4_ALPHA4": (BaseFormat.LUMINANCE_ALPHA, 4, 4),
    "LUMINANCE6_ALPHA2": (BaseFormat.LUMINANCE_ALPHA, 6, 2),
    "LUMINANCE8_ALPHA8": (BaseFormat.LUMINANCE_ALPHA, 8, 8),
    "INTENSITY4": (BaseFormat.INTENSITY, 4),
    "INTENSITY8": (BaseFormat.INTENSITY, 8),
    "R3_G3_B2": (BaseFormat.RGB, 3, 3, 2),
    "RGB4": (BaseFormat.RGB, 4, 4, 4),
    "RGB5": (BaseFormat.RGB, 5, 5, 5),
    "R5_G6_B5": (BaseFormat.RGB, 5, 6, 5),
    "RGB8": (BaseFormat.RGB, 8, 8, 8),
    "RGBA2": (BaseFormat.RGBA, 2, 2, 2, 2),
    "RGBA4": (BaseFormat.RGBA, 4, 4, 4, 4),
    "RGB5_A1": (BaseFormat.RGBA, 5, 5, 5, 1),
    "RGBA8": (BaseFormat.RGBA, 8, 8, 8, 8),
}


def base_format(internal_format):
    """Source: OpenGL 1.2.1 table 3.16; Assumed: formats of words alone hold four components."""
    return FORMATS.get(internal_format.name, (BaseFormat.RGBA,))[0]


def quantise_byte(byte, bits):
    """A byte to the nearest of 2^bits levels; there are no ties. Source: OpenGL 1.2.1 section 2.13.9."""
    return (2 * byte * (2**bits - 1) + 255) // 510


def quantise_float(component, bits):
    """A component in [0, 1] to the nearest of 2^bits levels. Source: OpenGL 1.2.1 section 2.13.9."""
    return math.floor(fixed.clamp(component, 0.0, 1.0) * (2**bits - 1) + 0.5)


def replicate(component, bits):
    """The bits written again and again until there are eight.

    Measured: Texture_format captures for 4, 5 and 6 bits; Inferred for 1, 2 and 3.
    """
    word = format(component, f"0{bits}b")
    return int((word * 8)[:8], 2)


def kept_components(rgba, base):
    """Which components of an image a base format keeps. Source: OpenGL 1.2.1 table 3.15."""
    red, green, blue, alpha = rgba
    return {
        BaseFormat.ALPHA: [alpha],
        BaseFormat.LUMINANCE: [red],
        BaseFormat.LUMINANCE_ALPHA: [red, alpha],
        BaseFormat.INTENSITY: [red],
        BaseFormat.RGB: [red, green, blue],
        BaseFormat.RGBA: [red, green, blue, alpha],
    }[base]


def register_components(components, base, one=255):
    """What a texture register receives. Source: NV_register_combiners table 2."""
    if base == BaseFormat.ALPHA:
        return [0, 0, 0, components[0]]
    if base == BaseFormat.LUMINANCE:
        return [components[0]] * 3 + [one]
    if base == BaseFormat.LUMINANCE_ALPHA:
        return [components[0]] * 3 + [components[1]]
    if base == BaseFormat.INTENSITY:
        return [components[0]] * 4
    if base == BaseFormat.RGB:
        return [*components, one]
    return list(components)


def store_texel(rgba, internal_format, *, floats=False):
    """An image's RGBA texel (bytes, or floats in [0, 1]) as the bytes that a register receives.

    Source: OpenGL 1.2.1 section 3.8.1 and NV_register_combiners table 2.
    """
    base, *bits = FORMATS[internal_format.name]
    quantise = quantise_float if floats else quantise_byte
    kept = kept_components(rgba, base)
    return register_components([replicate(quantise(c, b), b) for c, b in zip(kept, bits, strict=True)], base)


def border_texel(color, internal_format, one=255, *, as_given=False):
    """The border color in a register. Source: OpenGL 1.2.1 section 3.8.5, NV_register_combiners table 2.

    ``as_given``: itself for every format. Measured: TextureBorderColor.
    """
    codes, base = fixed.color_codes(color, one), base_format(internal_format)
    return codes if as_given else register_components(kept_components(codes, base), base, one)


def box(corners):
    """Four texels' rounded mean. Assumed: as whoever builds mipmaps with integers does."""
    return [(sum(corner[k] for corner in corners) + 2) >> 2 for k in range(4)]


def next_volume(layers):
    """The next mipmap of a 3D texture: boxes of 2x2x2 texels, an edge of one counted twice.

    Source: as ``next_level``; Assumed: rounded boxes.
    """
    height, width = len(layers[0]), len(layers[0][0])
    columns = [(2 * i, 2 * i + 1) for i in range(width // 2)] or [(0, 0)]
    lines = [(2 * j, 2 * j + 1) for j in range(height // 2)] or [(0, 0)]
    planes = [(2 * k, 2 * k + 1) for k in range(len(layers) // 2)] or [(0, 0)]

    def mean(ks, js, pair):
        """A box of texels, rounded. Assumed: as ``box``."""
        corners = [layers[k][j][i] for k in ks for j in js for i in pair]
        return [(sum(corner[c] for corner in corners) + 4) >> 3 for c in range(4)]

    return [[[mean(ks, js, pair) for pair in columns] for js in lines] for ks in planes]


def next_level(rows):
    """The next mipmap of one face, rows of RGBA texels: boxes of 2x2 texels, an edge of one counted twice.

    Source: OpenGL 1.2.1 section 3.8.5 leaves the filter to whoever builds mipmaps; Assumed: rounded boxes.
    """
    height, width = len(rows), len(rows[0])
    columns = [(2 * i, 2 * i + 1) for i in range(width // 2)] or [(0, 0)]
    lines = [(2 * j, 2 * j + 1) for j in range(height // 2)] or [(0, 0)]
    return [[box([rows[j][i] for j in js for i in pair]) for pair in columns] for js in lines]

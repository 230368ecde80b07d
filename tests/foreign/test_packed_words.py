"""Packed pixels and words of textures as components, and S3TC's blocks. Source: Mesa, mesa,
src/util/format/u_format_tests.c, util_format_test_cases, compared byte for byte by
src/util/tests/format/u_format_test.c, test_format_unpack_rgba_8unorm; Khronos, VK-GL-CTS,
modules/internal/ditTextureFormatTests.cpp, TextureFormatCase, s_unorm... and their float references.
"""

import numpy as np
import pytest

from fixedpipe.pipeline import DrawPixels, PixelImage, TexImage, TextureUnit
from fixedpipe.pipeline.enums import InternalFormat, TexelWord
from fixedpipe.pipeline.state import RasterPosition
from fixedpipe.pipeline.textures.words import compressed_texture, texture_of_words
from tests.foreign.comparison import (
    MACHINES,
    Case,
    assert_drawn,
    assert_held,
    everywhere,
    on_machines,
    picture,
)
from tests.foreign.opengl import NEAREST, UNIT_SQUARE, clear, draw, rectangle

CORNER = RasterPosition(position=(0.0, 0.0, 0.0, 1.0), window=True)
# Of white alpha, YCbCr and S3TC.
WITH_S3TC = "GEFORCE_3", "NV2A"
# A byte of a frame is the number of 255 nearest to a component.
NEAREST_BYTE = 0.5 + 1e-9  # half-way is as near on either side
RED, GREEN, BLUE, ALPHA = (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)
NONE, ALL, OPAQUE = (0, 0, 0, 0), (1, 1, 1, 1), (0, 0, 0, 1)


def opaque(colors):
    return [(*color[:3], 1) for color in colors]


PRIMARIES = (NONE, RED, GREEN, BLUE, ALPHA, ALL)
SOLID = opaque((NONE, RED, GREEN, BLUE, ALL))
# Mesa's words (of bytes, little-endian) and what they are, by the names of OpenGL's packed types.
MESA_PIXELS = {
    ("BGRA", "UNSIGNED_INT_8_8_8_8_REV"): (
        [0, 0x00FF0000, 0x0000FF00, 0x000000FF, 0xFF000000, 0xFFFFFFFF],
        PRIMARIES,
    ),
    ("BGRA", "UNSIGNED_INT_8_8_8_8"): ([0, 0xFF00, 0xFF0000, 0xFF000000, 0xFF, 0xFFFFFFFF], PRIMARIES),
    ("RGBA", "UNSIGNED_INT_8_8_8_8"): ([0, 0xFF000000, 0xFF0000, 0xFF00, 0xFF, 0xFFFFFFFF], PRIMARIES),
    ("RGBA", "UNSIGNED_INT_8_8_8_8_REV"): ([0, 0xFF, 0xFF00, 0xFF0000, 0xFF000000, 0xFFFFFFFF], PRIMARIES),
    ("RGBA", "UNSIGNED_INT_2_10_10_10_REV"): (
        [0, 0x000003FF, 0x000FFC00, 0x3FF00000, 0xC0000000, 0xFFFFFFFF],
        PRIMARIES,
    ),
    ("BGRA", "UNSIGNED_INT_2_10_10_10_REV"): (
        [0, 0x3FF00000, 0x000FFC00, 0x000003FF, 0xC0000000, 0xFFFFFFFF],
        PRIMARIES,
    ),
    ("BGRA", "UNSIGNED_SHORT_1_5_5_5_REV"): ([0, 0x7C00, 0x03E0, 0x001F, 0x8000, 0xFFFF], PRIMARIES),
    ("RGBA", "UNSIGNED_SHORT_5_5_5_1"): ([0, 0xF800, 0x07C0, 0x003E, 0x0001, 0xFFFF], PRIMARIES),
    ("BGRA", "UNSIGNED_SHORT_4_4_4_4_REV"): ([0, 0x0F00, 0x00F0, 0x000F, 0xF000, 0xFFFF], PRIMARIES),
    ("RGB", "UNSIGNED_SHORT_5_6_5"): ([0, 0xF800, 0x07E0, 0x001F, 0xFFFF], SOLID),
}
# The same of words that textures are made of; X: what is no component has any bits.
MESA_TEXTURES = {
    "A8R8G8B8": MESA_PIXELS["BGRA", "UNSIGNED_INT_8_8_8_8_REV"],
    "X8R8G8B8": ([0, 0xFF0000, 0xFF00, 0xFF, 0xFF000000, 0xFFFFFFFF], opaque(PRIMARIES)),
    "B8G8R8A8": MESA_PIXELS["BGRA", "UNSIGNED_INT_8_8_8_8"],
    "R8G8B8A8": MESA_PIXELS["RGBA", "UNSIGNED_INT_8_8_8_8"],
    "A8B8G8R8": MESA_PIXELS["RGBA", "UNSIGNED_INT_8_8_8_8_REV"],
    "X1R5G5B5": ([0, 0x7C00, 0x03E0, 0x001F, 0x7FFF], SOLID),
    "A1R5G5B5": MESA_PIXELS["BGRA", "UNSIGNED_SHORT_1_5_5_5_REV"],
    "A4R4G4B4": MESA_PIXELS["BGRA", "UNSIGNED_SHORT_4_4_4_4_REV"],
    "R5G6B5": MESA_PIXELS["RGB", "UNSIGNED_SHORT_5_6_5"],
    "Y8": ([0x00, 0xFF], [OPAQUE, ALL]),
    "A8": ([0x00, 0xFF], [NONE, ALPHA]),
    "AY8": ([0x00, 0xFF], [NONE, ALL]),
    "A8Y8": ([0x0000, 0x00FF, 0xFF00, 0xFFFF], [NONE, (1, 1, 1, 0), ALPHA, ALL]),
    "UYVY": ([0x1080, 0x1080, 0xEB80, 0x1080, 0x1080, 0xEB80], [OPAQUE] * 2 + [ALL, OPAQUE, OPAQUE, ALL]),
    "YUY2": ([0x8010, 0x8010, 0x80EB, 0x8010, 0x8010, 0x80EB], [OPAQUE] * 2 + [ALL, OPAQUE, OPAQUE, ALL]),
}
# Mesa's components, by the image's format.
MESA_COMPONENTS = {
    ("LUMINANCE", "uint8"): ([[0x00], [0xFF]], [OPAQUE, ALL]),
    ("ALPHA", "uint8"): ([[0x00], [0xFF]], [NONE, ALPHA]),
    ("LUMINANCE_ALPHA", "uint8"): (
        [[0, 0], [0xFF, 0], [0, 0xFF], [0xFF, 0xFF]],
        [NONE, (1, 1, 1, 0), ALPHA, ALL],
    ),
    ("LUMINANCE", "uint16"): ([[0x0000], [0xFFFF]], [OPAQUE, ALL]),
    ("RED", "uint8"): ([[0x00], [0xFF]], [OPAQUE, (1, 0, 0, 1)]),
    ("RED", "uint16"): ([[0x0000], [0xFFFF]], [OPAQUE, (1, 0, 0, 1)]),
    ("RGB", "uint8"): (255 * np.array(SOLID)[:, :3], SOLID),
    ("RGBA", "uint16"): (65535 * np.array(PRIMARIES), PRIMARIES),
    ("RED", "int8"): ([[0x00], [0x7F], [-0x7F]], [OPAQUE, (1, 0, 0, 1), OPAQUE]),
}
# VK-GL-CTS's words, and their numerators; its references are the quotients in single precision.
CTS_PIXELS = {
    ("RGB", "UNSIGNED_SHORT_5_6_5"): (
        [0x7EEA, 0x28CC, 0xCE38, 0x168F],
        [(15, 55, 10), (5, 6, 12), (25, 49, 24), (2, 52, 15)],
        (31, 63, 31),
    ),
    ("RGBA", "UNSIGNED_SHORT_4_4_4_4"): (
        [0xDB19, 0xA8A8, 0x2972, 0x2DB4],
        [(13, 11, 1, 9), (10, 8, 10, 8), (2, 9, 7, 2), (2, 13, 11, 4)],
        (15,) * 4,
    ),
    ("RGBA", "UNSIGNED_SHORT_5_5_5_1"): (
        [0x8913, 0x3C6F, 0xE9AE, 0xD9F2],
        [(17, 4, 9, 1), (7, 17, 23, 1), (29, 6, 23, 0), (27, 7, 25, 0)],
        (31, 31, 31, 1),
    ),
    # Its components are alpha, red, green and blue; here the first is the highest bit.
    ("BGRA", "UNSIGNED_SHORT_1_5_5_5_REV"): (
        [0xC5F8, 0x6C1F, 0x2FF0, 0x95F2],
        [(17, 15, 24, 1), (27, 0, 31, 0), (11, 31, 16, 0), (5, 15, 18, 1)],
        (31, 31, 31, 1),
    ),
    ("RGBA", "UNSIGNED_INT_2_10_10_10_REV"): (
        [0xC4F5C6FD, 0x7DFDA832, 0xD0103FE7, 0xD0660D86],
        [(765, 369, 79, 3), (50, 874, 991, 1), (999, 15, 257, 3), (390, 387, 262, 3)],
        (1023, 1023, 1023, 3),
    ),
}
CTS_TEXTURES = {
    "R5G6B5": CTS_PIXELS["RGB", "UNSIGNED_SHORT_5_6_5"],
    "A1R5G5B5": CTS_PIXELS["BGRA", "UNSIGNED_SHORT_1_5_5_5_REV"],
    "X1R5G5B5": (
        [0xEA02, 0x1389, 0x5A94, 0x605B],
        [(26, 16, 2), (4, 28, 9), (22, 20, 20), (24, 2, 27)],
        (31, 31, 31),
    ),
}
CTS_COMPONENTS = {
    "uint8": bytes.fromhex("90a0a92624c4a1a5db0e097a7f3df21f"),
    "uint16": bytes.fromhex("b685f01abc765b59f874806cb1804adceb61a312f6656b2529e0e30d3aaca797"),
    "uint32": bytes.fromhex(
        "457de155d2cbc51764878450376054a1a87eea981ad1b4702dcbff133dd73ce4"
        "94d6b4f70158329d912b491fd0ca3d05145a95d0fd6433d37387a5f96dc83903"
    ),
}
CTS_REFERENCES = {  # floats, by their bits
    "uint8": "3f109091 3f20a0a1 3f29a9aa 3e189899 3e109091 3f44c4c5 3f21a1a2 3f25a5a6 "
    "3f5bdbdc 3d60e0e1 3d109091 3ef4f4f5 3efefeff 3e74f4f5 3f72f2f3 3df8f8f9",
    "uint16": "3f05b686 3dd780d8 3eed78ed 3eb2b6b3 3ee9f0ea 3ed900d9 3f00b181 3f5c4adc "
    "3ec3d6c4 3d951895 3ecbeccc 3e15ac96 3f6029e0 3d5e30de 3f2c3aac 3f17a798",
    "uint32": "3eabc2fb 3dbe2e5f 3ea1090f 3f215460 3f18ea7f 3ee169a2 3d9ffe59 3f643cd7 "
    "3f77b4d7 3f1d3258 3dfa495d 3ca7b95a 3f50955a 3f533365 3f79a587 3c4e721b",
}
# Mesa's blocks, and their texels as 0xRRGGBBAA, by rows.
BLOCKS = {
    "DXT1, four colours": (
        "DXT1",
        "f2d7b020ae2c6f97",
        "99b08eff 5d6289ff 99b08eff 99b08eff d6ff94ff 5d6289ff 99b08eff d6ff94ff "
        "5d6289ff 5d6289ff 99b08eff 211484ff 5d6289ff 211484ff 211484ff 99b08eff",
    ),
    "DXT1, three colours": (
        "DXT1",
        "ff2fa472ebb2bdbe",
        "00000000 4eaa90ff 4eaa90ff 00000000 4eaa90ff 29ffffff 00000000 4eaa90ff "
        "735521ff 00000000 00000000 4eaa90ff 4eaa90ff 00000000 00000000 4eaa90ff",
    ),
    "DXT3": (
        "DXT3",
        "e74a8f965bc11c84f68fab322a9a955a",
        "6dc69677 6dc696ee 6dc696aa 8cffb544 6dc696ff 6dc69688 31555a66 6dc69699 "
        "31555abb 31555a55 31555a11 6dc696cc 6dc696cc 6dc69611 31555a44 31555a88",
    ),
    "DXT5": (
        "DXT5",
        "f811c50c9a73b49cf68fab322a9a955a",
        "6dc69674 6dc696f8 6dc696b6 8cffb553 6dc696f8 6dc69695 31555a53 6dc69695 "
        "31555ab6 31555a53 31555a11 6dc696d7 6dc696b6 6dc69611 31555a32 31555a95",
    ),
}


def fractions(numerators, greatest):
    return opaque(np.array(numerators) / greatest) if len(greatest) == 3 else np.array(numerators) / greatest


def row(name, frame, colors, machines=MACHINES):
    wanted = np.array(colors, float)[None]
    return Case(
        name, (clear(0, 0, 0, 0), *frame), picture(wanted, NEAREST_BYTE), (wanted.shape[1], 1), machines
    )


def pixels_of(suite, form, packed, words, colors):
    words = np.array([words], np.uint32 if "INT" in packed else np.uint16)
    image = PixelImage(words, form, packed)
    return row(f"{suite}, {form}, {packed}", (DrawPixels(label="row", image=image, position=CORNER),), colors)


def components_of(suite, form, kind, components, colors):
    image = PixelImage(np.array([components]).astype(kind), form)
    return row(f"{suite}, {form}, {kind}", (DrawPixels(label="row", image=image, position=CORNER),), colors)


def shown(texture):
    """The commands that draw a texture, a pixel for each texel; t = 0 is the first row of words."""
    return (
        TexImage(label="words", texture="words", image=texture),
        draw(
            rectangle(-1, -1, 2, 2, texture_coordinates=(UNIT_SQUARE,), color=(1, 1, 1, 1)),
            texture_units=(TextureUnit("words", NEAREST),),
        ),
    )


def texture_of(suite, kind, words, colors):
    """The last word fills the row, whose length has to be a power of two."""
    more = (1 << (len(words) - 1).bit_length()) - len(words)
    words, colors = [*words, *words[-1:] * more], [*colors, *[colors[-1]] * more]
    texture = texture_of_words(np.array([words]), TexelWord[kind])
    machines = WITH_S3TC if kind in ("A8", "UYVY", "YUY2") else MACHINES
    return row(f"{suite}, texture of {kind}", shown(texture), colors, machines)


def block_of(kind, data):
    return compressed_texture(bytes.fromhex(data), InternalFormat[f"COMPRESSED_RGBA_S3TC_{kind}"], 4, 4)


def texels_of(texels):
    """Mesa's texels of a block, int64 [4, 4, 4]; t = 0 is the first row."""
    return np.array([list(bytes.fromhex(texel)) for texel in texels.split()]).reshape(4, 4, 4)


def half_of_block(name, half):
    """A block's ``half``, "alpha" or "colours", byte for byte."""
    kind, data, texels = BLOCKS[name]
    wanted = texels_of(texels)[::-1].astype(float) / 255
    frame = clear(0, 0, 0, 0), *shown(block_of(kind, data))
    channels = np.s_[..., 3:] if half == "alpha" else np.s_[..., :3]
    expected = picture(wanted[channels], 0.0)
    return Case(f"{name}, {half}", frame, lambda image: expected(image[channels]), (4, 4), WITH_S3TC)


def reference(kind):
    bits = np.array([int(word, 16) for word in CTS_REFERENCES[kind].split()], np.uint32)
    return bits.view(np.float32).reshape(4, 4)


CASES = (
    *(pixels_of("Mesa", *key, *given) for key, given in MESA_PIXELS.items()),
    *(components_of("Mesa", *key, *given) for key, given in MESA_COMPONENTS.items()),
    *(texture_of("Mesa", key, *given) for key, given in MESA_TEXTURES.items()),
    *(pixels_of("CTS", *key, given[0], fractions(*given[1:])) for key, given in CTS_PIXELS.items()),
    *(
        components_of("CTS", "RGBA", kind, np.frombuffer(data, kind).reshape(4, 4), reference(kind))
        for kind, data in CTS_COMPONENTS.items()
    ),
    *(texture_of("CTS", key, given[0], fractions(*given[1:])) for key, given in CTS_TEXTURES.items()),
    *(half_of_block(name, half) for name in BLOCKS for half in ("alpha", "colours")),
)
DISAGREEMENTS = {
    **everywhere(
        "OpenGL 1.2.1 is right for its machines: table 2.6 makes (2 c + 1)/255 of a signed byte, 1/255 of 0. "
        "Mesa's is c/127, of OpenGL 4.2 and Direct3D 10",
        ["Mesa, RED, int8"],
        MACHINES,
    ),
    **everywhere(
        "the machines repeat a component's bits, so that 24 of 31 is the byte 198 (Measured: the NV2A's "
        "Texture_format captures, every pixel); the quotient is 197.4. The ideal reads the same bytes",
        [f"CTS, texture of {name}" for name in CTS_TEXTURES],
        MACHINES,
    ),
    **everywhere(
        "the NV2A's A8 is white (Measured: the Texture_format captures); Mesa's, of OpenGL 3, is black",
        ["Mesa, texture of A8"],
        WITH_S3TC,
    ),
    **everywhere(
        "the NV2A makes 254, 255, 254 of Y 235 (Measured: the UYVY_L captures, 123904 of 123904 pixels); by "
        "ITU-R BT.601 it is 1, as Mesa has it",
        ["Mesa, texture of UYVY", "Mesa, texture of YUY2"],
        WITH_S3TC,
    ),
    **everywhere(
        "the NV2A dithers what it decodes of DXT1 (Measured: the Texture_DXT captures, 2048 of 2048 texels)",
        ["DXT1, four colours, colours", "DXT1, three colours, colours"],
        WITH_S3TC,
    ),
    **everywhere(
        "Mesa cuts thirds, 109 of (2 * 140 + 49)/3; the NV2A takes the nearest, 110 (Measured: DXT3_plasma, "
        "1024 of 1024 texels). EXT_texture_compression_s3tc has the real quotient, 109.67",
        ["DXT3, colours", "DXT5, colours"],
        WITH_S3TC,
    ),
}


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, DISAGREEMENTS))
def test_words_are_what_the_suites_say(case, machine):
    assert_drawn(case, machine)
    if machine != "IDEAL":
        assert_drawn(case, machine, engine="columns")


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=0)


@pytest.mark.parametrize("name", BLOCKS)
def test_a_decoded_block_is_mesa_s_but_for_thirds_that_mesa_cuts(name):
    """Before any dithering; a third is the real quotient of Mesa's own two ends, to nearest."""
    kind, data, texels = BLOCKS[name]
    found, wanted = block_of(kind, data).levels[0][0].astype(int), texels_of(texels)
    ends = {"DXT1": ((0xD6, 0xFF, 0x94), (0x21, 0x14, 0x84))}.get(
        kind, ((0x8C, 0xFF, 0xB5), (0x31, 0x55, 0x5A))
    )
    thirds = [(2 * np.array(a) + b) for a, b in (ends, ends[::-1])]
    cut = np.any([(wanted[..., :3] == third // 3).all(-1) for third in thirds], 0) & (
        name != "DXT1, three colours"
    )
    np.testing.assert_array_equal(found[~cut], wanted[~cut])
    np.testing.assert_array_equal(found[..., 3], wanted[..., 3])
    for third in thirds:
        of_it = cut & (wanted[..., :3] == third // 3).all(-1)
        assert (np.abs(3 * found[of_it][:, :3] - third) <= 1).all()
    assert cut.any() == (name != "DXT1, three colours")

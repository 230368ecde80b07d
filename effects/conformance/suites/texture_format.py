"""Texture_format: a colour gradient in every texture format, on a square larger than the texture.

XAlpha: textures of one word each, whose unused bits are not alpha. They are drawn unblended and blended, and
their alpha as grey. Not included: the DepthFmt cases, which compare a pattern of depths. No available version
of the library has the function that makes it (GenerateRadialDepthPattern). Source:
src/tests/texture_format_tests.cpp of nxdk_pgraph_tests, src/texture_stage.cpp of pbkitplusplus.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, texture_memory, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.passes.combiners import ONE, SPARE0, TEXTURE0, TEXTURE1, alpha_of, stage, total
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import (
    InternalFormat,
    PrimitiveType,
    TexelWord,
    TextureTarget,
)
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import compressed_texture, paletted_texture, texture_of_words

SUITE = "Texture_format"

SIZE, HALF, DEPTH, EYE = 256, 0.75, 0.1, 2.25
PALETTES = (256, 128, 64, 32)
FORMATS = {f"TexFmt_{entry.case_name}": entry for entry in texture_memory.FORMATS}
PALETTED = {f"TexFmt_SZ_Index8_p{size}": size for size in PALETTES}
COMPRESSED = "TexFmt_DXT1"

X_ALPHA_WORDS = {  # by a word's bytes
    4: (0x00DACABA, 0x011B2B3B, 0x7F3C2C1C, 0x804D5D6D, 0xFE0ECE3E, 0xFF8F9FAF),
    2: (0x03E0, 0x83E0, 0x03FF, 0x83FF, 0x7FFF, 0xFFFF),
}
PLAIN = 64  # texels along an edge of such a texture
LEFT, STEP, WIDE, HIGH, TOPS = 30.0, 100.0, 80.0, 75.0, (200.0, 325.0)  # pixels


def palette(size):
    """Words A8R8G8B8: quarters of falling blue, green, red and grey."""
    quarter = size // 4
    value = 255 - np.arange(quarter) * -(-255 // quarter)
    return (0xFF << 24) + np.concatenate(
        [value, value << 8, value << 16, value | (value << 8) | (value << 16)]
    )


def indices(size):
    """Into a palette: every colour in turn in the upper half, each four times over in the lower."""
    count = np.arange(SIZE * SIZE)
    return (np.where(count < SIZE * SIZE // 2, count, count & ~3) % size).reshape(SIZE, SIZE)


def square():
    """Two triangles with (s, t) from (0, 0) to (1, 1)."""
    corners = {"ul": (-1, 1, 0, 0), "ur": (1, 1, 1, 0), "lr": (1, -1, 1, 1), "ll": (-1, -1, 0, 1)}
    at = np.array([corners[c] for c in ("ul", "ur", "lr", "ul", "lr", "ll")], np.float64)
    points = np.column_stack([HALF * at[:, :2], np.full(6, DEPTH)])
    return vertex_programs.perspective(points, eye=EYE, depth_maximum=0x7FFF, far=10.0), at[:, 2:]


def _opaque(register):
    """Combiners that show one register's colour, or its alpha, and an alpha of one."""
    general = stage(total(register, to=SPARE0), alpha=total(ONE, to=SPARE0))
    return replace(scenes.SHOWS_TEXTURE0, general=(general,))


def _textured(label, corners, texture, coordinates, combiners, blending=None):
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(texture, scenes.NEAREST),),
        register_combiners=combiners,
        blending=blending,
    )
    mesh = scenes.window_mesh(scenes.rectangle(*corners), texture_coordinates=(coordinates,))
    return Draw(label=label, mesh=mesh, state=state)


def x_alpha(entry):
    """Commands of an XAlpha case: for every word two halves above, unblended and blended, its alpha below.

    The program draws the first word's halves while its combiners still show the background's unit 1, which is
    off by then.
    """
    checkers = texture_memory.packed_words(scenes.checkerboard(0xFF202020, 0xFF707070, 8), TexelWord.A8B8G8R8)
    background = texture_of_words(checkers, TexelWord.A8B8G8R8, TextureTarget.TEXTURE_RECTANGLE)
    corners, texels = (0, 0, WIDTH, HEIGHT), scenes.UNIT_SQUARE * SIZE
    commands = [
        scenes.clear(0xFF220022),
        TexImage(label="checkerboard", texture="checkerboard", image=background),
        _textured("background", corners, "checkerboard", texels, _opaque(TEXTURE0)),
    ]
    scale = PLAIN if entry.linear else 1
    for i, word in enumerate(X_ALPHA_WORDS[texture_memory.WORD_BYTES[entry.word]]):
        texture, left = f"{word:X}", LEFT + i * STEP
        image = texture_of_words(np.full((PLAIN, PLAIN), word), entry.word, entry.target)
        commands.append(TexImage(label=texture, texture=texture, image=image))
        combiners = scenes.SHOWS_TEXTURE0 if i else _opaque(TEXTURE1)
        for half, blending in enumerate((None, scenes.BLENDED)):
            at = left + half * WIDE / 2
            corners = (at, TOPS[0], at + WIDE / 2, TOPS[0] + HIGH)
            coordinates = (scenes.UNIT_SQUARE * (0.5, 1) + (half / 2, 0)) * scale
            label = "blended" if blending else "unblended"
            commands.append(_textured(label, corners, texture, coordinates, combiners, blending))
        corners = (left, TOPS[1], left + WIDE, TOPS[1] + HIGH)
        alpha = _opaque(alpha_of(TEXTURE0))
        commands.append(_textured("alpha", corners, texture, scenes.UNIT_SQUARE * scale, alpha))
    return tuple(commands)


def texture_of(name):
    """The texture of a TexFmt case, and what its coordinates count where one is its whole edge."""
    if name in FORMATS:
        entry = FORMATS[name]
        texture = texture_memory.texture_of(texture_memory.gradient(SIZE, SIZE), entry)
        return texture, SIZE if entry.linear else 1
    if name in PALETTED:
        return paletted_texture(indices(PALETTED[name]), palette(PALETTED[name])), 1
    blocks = texture_memory.dxt1_blocks(texture_memory.gradient(SIZE, SIZE)).tobytes()
    return compressed_texture(blocks, InternalFormat.COMPRESSED_RGBA_S3TC_DXT1, SIZE, SIZE), 1


def _x_alpha(entry):
    return Case(commands=x_alpha(entry))


def _case(name):
    texture, scale = texture_of(name)
    positions, coordinates = square()
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("texture", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    mesh = scenes.window_mesh(positions, PrimitiveType.TRIANGLES, texture_coordinates=(coordinates * scale,))
    return Case(
        commands=(
            scenes.clear(0xFE202020),
            TexImage(label=name, texture="texture", image=texture),
            Draw(label="square", mesh=mesh, state=state),
        )
    )


CASES = {  # every case of the suite but DepthFmt
    **{name: partial(_case, name) for name in (*FORMATS, COMPRESSED, *PALETTED)},
    **{
        f"XAlpha_{entry.case_name}": partial(_x_alpha, entry)
        for entry in texture_memory.FORMATS
        if entry.word in (TexelWord.X8R8G8B8, TexelWord.X1R5G5B5) or entry.case_name == "A8R8G8B8_L"
    },
}

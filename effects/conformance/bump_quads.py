"""The common part of Bump_map and Bump_env_lum: a bump texture that offsets a checkerboard on four quads.

The texture has four different texels, enlarged; each quad has one choice of signed components.

Source: src/tests/bump_map_tests.cpp and bump_env_lum_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes, texture_memory
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import InternalFormat, Register, TexelWord, TextureFilter
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage, TextureUnit
from fixedpipe.pipeline.textures.images import Texture, texture_2d
from fixedpipe.pipeline.textures.words import compressed_texture, ycbcr_of_words

SIZE = 256  # of both textures
LEFT, TOP, EDGE, STEP = 146, 66, 168, 180
LINEAR = replace(scenes.NEAREST, min_filter=TextureFilter.LINEAR, mag_filter=TextureFilter.LINEAR)
DXT1 = "DXT1"
YCBCR = frozenset({TexelWord.YUY2, TexelWord.UYVY})


def picture(colors):
    """RGBA bytes [SIZE, SIZE, 4] of four colours 0xRRGGBBAA: two columns and rows, and all that follow."""
    at = (np.arange(SIZE) >= 2).astype(int)
    words = np.array(colors)[at[:, None] * 2 + at[None]]
    return np.stack([(words >> shift) & 255 for shift in (24, 16, 8, 0)], -1).astype(np.uint8)


def dxt1_of(rgba):
    """The program's own DXT1: every block its first texel's colour, or transparent if its alpha is small."""
    red, green, blue, alpha = (rgba[::4, ::4, k].astype(np.int64) for k in range(4))
    blocks = np.zeros((*red.shape, 8), np.uint8)
    blocks[..., 2] = ((green & 0x1C) << 3) + (blue >> 3)
    blocks[..., 3] = (red & 0xF8) + (green >> 5)
    blocks[..., 4:] = np.where(alpha >= 125, 0x55, 0xFF)[..., None]
    return compressed_texture(blocks.tobytes(), InternalFormat.COMPRESSED_RGBA_S3TC_DXT1, SIZE, SIZE)


def case_of(image, linear, stages, register, signs, checkers, coordinates, ycbcr=False):
    """The frame: ``image`` on unit 0, a checkerboard of two colours 0xAABBGGRR on the last stage's unit;
    ``ycbcr``: whether all texels that units read are converted.

    ``linear``: coordinates of unit 0 count texels. ``signs(column, row)``: unit 0's signed components.
    ``coordinates``: the other units', each [4, 1..4].
    """
    bumps = 1.0 + 2.0 * scenes.UNIT_SQUARE
    coordinates = (bumps if linear else bumps / SIZE, *coordinates)
    odd = (np.arange(SIZE)[:, None] // 8 + np.arange(SIZE)[None] // 8) % 2
    words = np.array(checkers)[odd]
    board = texture_2d(np.stack([(words >> shift) & 255 for shift in (0, 8, 16, 24)], -1).astype(np.uint8))
    commands = [
        scenes.clear(0xFE202020),
        TexImage(label="bumps", texture="bumps", image=image),
        TexImage(label="checkerboard", texture="checkers", image=board),
    ]
    last = len(stages) - 1
    for row in range(2):
        for column in range(2):
            left, top = LEFT + column * STEP, TOP + row * STEP
            sampler = replace(LINEAR, signed_components=signs(column == 1, row == 1))
            units = [
                TextureUnit(
                    "checkers" if k == last else (None if k else "bumps"),
                    scenes.NEAREST if k else sampler,
                    coordinates=k,
                )
                for k in range(last + 1)
            ]
            state = replace(
                scenes.DEFAULT,
                register_combiners=scenes.shows(register),
                texture_units=tuple(units),
                texture_shader=stages,
                ycbcr_conversion=ycbcr,
            )
            mesh = scenes.window_mesh(
                scenes.rectangle(left, top, left + EDGE, top + EDGE, 1.0),
                texture_coordinates=tuple(scenes.single(c) for c in coordinates),
            )
            commands.append(Draw(label=f"quad {column} {row}", mesh=mesh, state=state))
    return Case(commands=tuple(commands))


def offset_case(colors, entry, operation, matrix, signs, checkers, **scaled):
    """The frame of four colours in a format (``texture_of``), whose texels offset the checkerboard's
    coordinates.

    They do it through an offset matrix (a1, a2, a3, a4). ``operation``: unit 1's. ``scaled``: further fields
    of its TextureShaderStage.
    """
    image, linear = texture_of(colors, entry)
    stages = (
        TextureShaderStage(Operation.TEXTURE_RECTANGLE if linear else Operation.TEXTURE_2D),
        # The chip reads the matrix in single precision.
        TextureShaderStage(operation, offset_texture_matrix=tuple(scenes.single(matrix).tolist()), **scaled),
    )
    ycbcr = entry is not None and entry.word in YCBCR
    return case_of(image, linear, stages, Register.TEXTURE1, signs, checkers, (scenes.UNIT_SQUARE,), ycbcr)


def formats(without):
    """Every format of the programs' table but depths, palettes and those in ``without``, by its case name."""
    found = {entry.case_name: entry for entry in texture_memory.FORMATS if entry.case_name not in without}
    return {**found, DXT1: None}


def texture_of(colors, entry):
    """(the bump texture, whether its coordinates count texels) in a format; None: DXT1."""
    if entry is None:
        return dxt1_of(picture(colors)), False
    if entry.word is TexelWord.R6G5B5:  # Measured: BumpEnvLum_R6G5B5_B, _B_R90
        return texture_memory.highest_bits(picture(colors), entry), entry.linear
    if entry.word in YCBCR:
        words = texture_memory.converted_words(picture(colors), entry.word)
        texels = ycbcr_of_words(words, entry.word)
        return Texture(entry.target, InternalFormat.RGBA8, (texels[None],)), entry.linear
    return texture_memory.texture_of(picture(colors), entry), entry.linear


def variants(name, switches=("", "_B", "_R90", "_B_R90")):
    """(case name's ending, crossed on blue, turned) for a format that has them."""
    return {f"{name}{s}": ("_B" in s, "_R90" in s) for s in switches}

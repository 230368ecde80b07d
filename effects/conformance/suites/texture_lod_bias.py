"""Texture_LOD_Bias: a texture of eight coloured levels at eight sizes, and on small squares with a bias.

Source: src/tests/texture_lod_bias_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TexelWord, TextureFilter
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_LOD_Bias"

SIZE, CELL, DARK = 512, 4, 0xFF050505
COLORS = (0xFF0000FF, 0xFF00FF00, 0xFFFF0000, 0xFFFFFFFF, 0xFF00FFFF, 0xFFFF00FF, 0xFFFFFF00, 0xFF808080)
SQUARE, SPACING, HEADER = 64, 32, 64
RIGHT_OF_NESTED = WIDTH // 4
BIASES = (-15.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 15.0, -0.8, 1.2, 1.8, 2.5, 3.5)


def _level(color, size):
    at = np.arange(size) // CELL
    return np.where((at[:, None] + at) % 2 == 0, color, DARK)


def _squares():
    """(left, top, edge, bias): the nested squares, then one for each bias."""
    middle = HEADER + (HEIGHT - HEADER) // 2
    for level in range(len(COLORS)):
        edge = SIZE >> level
        yield RIGHT_OF_NESTED - edge, middle - edge // 2, edge, 0.0
    first = RIGHT_OF_NESTED + SPACING
    left, top = first, (HEIGHT - SQUARE) // 2 - 8
    for bias in BIASES:
        yield left, top, SQUARE, bias
        left += SQUARE + SPACING
        if left + SQUARE > WIDTH:
            left, top = first, top + SQUARE + SPACING


def _case():
    levels = [_level(color, SIZE >> k) for k, color in enumerate(COLORS)]
    sampler = replace(
        scenes.NEAREST, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR, max_level=len(COLORS) - 1
    )
    st = (np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),)
    image = texture_of_words(levels, TexelWord.A8R8G8B8)
    commands = [scenes.clear(0xFE202020), TexImage(label="levels", texture="levels", image=image)]
    for left, top, edge, bias in _squares():
        unit = TextureUnit("levels", sampler, lod_bias=int(bias * 256) / 256)
        state = replace(scenes.DEFAULT, texture_units=(unit,), register_combiners=scenes.SHOWS_TEXTURE0)
        mesh = scenes.window_mesh(
            scenes.rectangle(left, top, left + edge, top + edge), texture_coordinates=st
        )
        commands.append(Draw(label=f"{edge} pixels, bias {bias:g}", mesh=mesh, state=state))
    return Case(commands=tuple(commands))


CASES = {"LODBias": _case}

"""Texture_border: a small texture under every wrap mode, on panels of three by three tiles.

Not named: cases (2D_BorderTex_SZ, 3D and cube maps) whose textures have border texels, which the machine has
not. Source: src/tests/texture_border_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TexelWord, TextureFilter, WrapMode
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_border"

SIZE, CELL = 32, 2
COLORS = (
    0xFFFF0000, 0x66FF0000, 0xFF00FF00, 0x6600FF00, 0xFF4444FF, 0x664444FF, 0xFFFFFFFF, 0x66FFFFFF,
)  # fmt: skip
LEFT, RIGHT, TOP, BOTTOM, SPACING, DEPTH = -2.75, 2.75, 1.75, -1.75, 0.1, 1.0
PANEL = (RIGHT - LEFT - 2 * SPACING) / 3, (TOP - BOTTOM - SPACING) / 2
TOPS = (TOP + PANEL[1] / 4 + SPACING, -2 * SPACING)  # of the panels' two rows

MODES = {
    "2D": (
        (0, WrapMode.REPEAT, None),
        (1, WrapMode.MIRRORED_REPEAT, None),
        (2, WrapMode.CLAMP_TO_EDGE, None),
        (3, WrapMode.CLAMP_TO_BORDER, 0xF0FF00FF),
        (5, WrapMode.CLAMP, 0xF0FF00FF),
    ),
    "xemu#1034": (
        (0, WrapMode.REPEAT, None),
        (1, WrapMode.MIRRORED_REPEAT, None),
        (2, WrapMode.CLAMP_TO_EDGE, None),
        (3, WrapMode.CLAMP_TO_BORDER, 0xF0559FFF),
        (4, WrapMode.CLAMP_TO_BORDER, 0xF0FF5533),
        (5, WrapMode.CLAMP, 0xF0FF5533),
    ),
}


def names():
    """The cases whose textures have no border texels, but for one panel of 2D."""
    return list(MODES)


def colored_checkerboard():
    """Words A8R8G8B8: squares whose colours change along the diagonals."""
    at = np.arange(SIZE) // CELL
    return np.array(COLORS)[(at[:, None] + at) % len(COLORS)]


def _tiles(panel):
    """Nine tiles of two triangles; (s, t) from (-1, -1) to (2, 2)."""
    left, top = LEFT + panel % 3 * (PANEL[0] + SPACING), TOPS[panel // 3]
    width, height = PANEL[0] / 3, PANEL[1] / 3
    positions, coordinates = [], []
    for row in range(3):
        for column in range(3):
            for s, t in scenes.TWO_TRIANGLES:
                positions.append((left + (column + s) * width, top - (row + t) * height, DEPTH))
                coordinates.append((column - 1 + s, row - 1 + t))
    return scenes.textured_triangles(positions, coordinates)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in MODES:
        return None
    image = texture_of_words(colored_checkerboard(), TexelWord.A8R8G8B8)
    commands = [scenes.clear(0xFE202020), TexImage(label="texture", texture="texture", image=image)]
    for panel, mode, border in MODES[name]:
        sampler = replace(
            scenes.NEAREST,
            min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR,
            max_level=0,
            wrap_s=mode,
            wrap_t=mode,
            border_color=scenes.argb(border or 0),
        )
        state = replace(
            scenes.DEFAULT,
            vertex=scenes.xdk_vertex(),
            texture_units=(TextureUnit("texture", sampler),),
            register_combiners=scenes.SHOWS_TEXTURE0,
        )
        commands.append(Draw(label=mode.name, mesh=_tiles(panel), state=state))
    if name != "2D":
        return Case(commands=tuple(commands))
    # The panel whose texture has border texels is left out: no texture here has them.
    left, right = (round(scenes.WIDTH / 2 + side * 65) for side in (-1, 1))
    rest = (
        (0, 0, scenes.WIDTH, 250),
        (0, 250, left, scenes.HEIGHT),
        (right, 250, scenes.WIDTH, scenes.HEIGHT),
    )
    return Case(commands=tuple(commands), region=rest)

"""Texture_perspective_enable: quads whose corners' w run from infinity to 0 and below, with correction for
perspective and without, textured or coloured.

Source: src/tests/texture_perspective_enable_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texture_perspective_enable"

QUAD_WIDTH, QUAD_HEIGHT, Z = WIDTH / 5, HEIGHT / 5, 1.0
INFINITE = 2.0**64  # stands for infinity: the chip's reciprocal of w is at least 2^-64
# w of the corners, from the upper left clockwise, of the upper and of the lower row.
ROWS = ((INFINITE, 1.0, 0.980578, 0.0), (INFINITE, 1.0, 2.980578, -0.5))
COLORS = ((1.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
ORDER = (0, 2, 3, 0, 1, 2)  # of the corners, in two triangles


def _case(textured):
    state = replace(scenes.DEFAULT, polygon=scenes.FRONT_FACES)
    checkers = scenes.checkerboard(0xFFFFFF00, 0xFF000000, 8)
    commands = [scenes.clear(0xFE323232)]
    if textured:
        commands.append(TexImage(label="checkers", texture="checkers", image=texture_2d(checkers)))
        state = replace(
            state,
            texture_units=(TextureUnit("checkers", scenes.NEAREST),),
            register_combiners=scenes.SHOWS_TEXTURE0,
        )
    for column, corrected in ((1, False), (3, True)):
        for row, w in zip((1, 3), ROWS, strict=True):
            left, top = column * QUAD_WIDTH, row * QUAD_HEIGHT
            places = scenes.rectangle(left, top, left + QUAD_WIDTH, top + QUAD_HEIGHT, Z)
            corners = np.column_stack([places, w])[list(ORDER)]
            mesh = scenes.window_mesh(
                corners,
                PrimitiveType.TRIANGLES,
                colors=scenes.single(COLORS)[list(ORDER)],
                texture_coordinates=(scenes.UNIT_SQUARE[list(ORDER)],),
            )
            drawn = replace(state, perspective_correction=corrected)
            commands.append(Draw(label=f"column {column}, row {row}", mesh=mesh, state=drawn))
    return Case(commands=tuple(commands))


CASES = {
    "TexPerspective_Textured": partial(_case, True),
    "TexPerspective_Untextured": partial(_case, False),
}

"""Texture_perspective: one quad whose vertices have other w, textured or coloured, with correction for
perspective or without.

Source: src/tests/texture_perspective_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureTarget
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texture_perspective"

SIZE, EDGE = 256, 1.75
# x and y, w where the quad is textured, w where it is coloured, s and t, colour.
CORNERS = {
    "ul": ((-EDGE, EDGE), 0.3, 0.3, (0, 0), (1, 0, 0)),
    "ur": ((EDGE, EDGE), 1.0, 1.0, (SIZE, 0), (0, 1, 0)),
    "lr": ((EDGE, -EDGE), 3.0, 0.3, (SIZE, SIZE), (0, 0, 1)),
    "ll": ((-EDGE, -EDGE), 1.0, 1.0, (0, SIZE), (1, 1, 1)),
}
SHAPES = {
    "quad": (PrimitiveType.QUADS, ("ul", "ur", "lr", "ll")),
    "bitri": (PrimitiveType.TRIANGLES, ("ul", "ur", "ll", "lr", "ll", "ur")),
}


def _case(textured, corrected, shape):
    primitive, order = SHAPES[shape]
    corners = [CORNERS[corner] for corner in order]
    positions = [(*xy, 0.0, w if textured else w_colored) for xy, w, w_colored, _, _ in corners]
    mesh = Mesh(
        scenes.single(positions),
        primitive,
        colors=None if textured else np.array([color for *_, color in corners], np.float64),
        texture_coordinates=(np.array([st for *_, st, _ in corners], np.float64),),
    )
    state = replace(scenes.DEFAULT, vertex=scenes.xdk_vertex(), perspective_correction=corrected)
    commands = [scenes.clear(0xFE251135)]
    if textured:
        board = replace(
            texture_2d(scenes.checkerboard(0xFF00FFFF, 0xFF000000, 8)), target=TextureTarget.TEXTURE_RECTANGLE
        )
        commands.append(TexImage(label="checkerboard", texture="checkerboard", image=board))
        state = replace(
            state,
            texture_units=(TextureUnit("checkerboard", scenes.NEAREST),),
            register_combiners=scenes.SHOWS_TEXTURE0,
        )
    return Case(commands=(*commands, Draw(label=shape, mesh=mesh, state=state)))


CASES = {
    f"tex_{kind}_pers_{corrected}_{shape}": partial(_case, kind == "tex", corrected == "y", shape)
    for kind, corrected, shape in product(("tex", "diff"), "ny", SHAPES)
}

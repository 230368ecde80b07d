"""Texture_anisotropy: a checkerboard floor that runs to the horizon, under growing anisotropy.

Source: src/tests/texture_anisotropy_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, WrapMode
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texture_anisotropy"

SIZE, CELL, REPEATS = 128, 4, 32.0
HALF, FLOOR, FAR, NEAR = 4.0, -1.5, 200.0, 0.0
INEXACT = "weights one off, texels beside an edge, the horizon: a footprint's precision on the chip is open"


def _case(taps):
    sampler = replace(
        scenes.NEAREST,
        wrap_s=WrapMode.REPEAT,
        wrap_t=WrapMode.REPEAT,
        max_anisotropy=float(taps),
    )
    mesh = Mesh(
        scenes.single([(-HALF, FLOOR, FAR), (HALF, FLOOR, FAR), (HALF, FLOOR, NEAR), (-HALF, FLOOR, NEAR)]),
        PrimitiveType.QUADS,
        texture_coordinates=(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, REPEATS), (0.0, REPEATS)]),),
    )
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(),
        texture_units=(TextureUnit("checkerboard", sampler),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    board = texture_2d(scenes.checkerboard(0xFFFFFF00, 0xFF663333, CELL, SIZE))
    return Case(
        commands=(
            scenes.clear(0xFE202020),
            TexImage(label="checkerboard", texture="checkerboard", image=board),
            Draw(label="floor", mesh=mesh, state=state),
        ),
        explanation="" if taps == 1 else INEXACT,
    )


CASES = {f"Anisotropy-{taps}": partial(_case, taps) for taps in (1, 2, 4, 8)}

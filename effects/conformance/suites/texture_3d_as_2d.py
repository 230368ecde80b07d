"""Texture_3D_as_2D: a cube map in a stage that projects 2D coordinates.

The chip reads face +x at ((s + 1) / 2, (1 - t) / 2): docs/numbers.md, N12.11. Here the face is a 2D texture,
with these coordinates.

Source: src/tests/texture_3d_as_2d_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.texture_memory import gradient
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texture_3D_as_2D"

SIZE = 64  # texels of a face
FACE = "face +x"
SHOWN, REFERENCE = (192, 112, 448, 368), (32, 208, 96, 272)


def _quad(label, box, coordinates):
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(FACE, scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    mesh = scenes.window_mesh(
        scenes.unprojected_rectangle(*box), texture_coordinates=(coordinates,), colors=np.ones((4, 4))
    )
    return Draw(label=label, mesh=mesh, state=state)


def _cube_map():
    s, t = scenes.UNIT_SQUARE.T
    face = gradient(SIZE, SIZE)
    face[..., 3] = 255
    return Case(
        commands=(
            scenes.clear(0xFE121212),
            TexImage(label=FACE, texture=FACE, image=texture_2d(face)),
            _quad("the cube map", SHOWN, np.stack([(s + 1) / 2, (1 - t) / 2], axis=1)),
            _quad("its first face", REFERENCE, scenes.UNIT_SQUARE),
        )
    )


CASES = {"Cubemap_as_2D": _cube_map}

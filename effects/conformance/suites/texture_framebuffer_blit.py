"""Texture_Framebuffer_Blit: four triangles, copied into memory, and that as a texture over them.

Source: src/tests/texture_framebuffer_blit_tests.cpp of nxdk_pgraph_tests. The copy leaves every pixel as it
is. So the triangles are also drawn to a pbuffer, which serves as the texture.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, Mesh
from fixedpipe.pipeline.enums import PrimitiveType, TextureTarget, WindowOrigin
from fixedpipe.pipeline.state import TextureUnit

SUITE = "Texture_Framebuffer_Blit"

RIGHT, TOP, NEAR, FAR = 2.75, 1.75, 0.1, 1.0  # of the rectangle round the middle; depths
# Corners as shares of (RIGHT, TOP), with their colours.
TRIANGLES = (
    *((-1, 1, (0.25,) * 3), (0, 1, (0.55,) * 3), (-1, 0, (0.75,) * 3)),
    *((1, 1, (0.8, 0.25, 0.1)), (1, 0, (0.1, 0.85, 0.1)), (0, 0, (0.1, 0.25, 0.9))),
    *((1, -1, (0.8, 0.25, 0.9)), (0, -1, (0.1, 0.85, 0.9)), (1, 0, (0.85, 0.95, 0.1))),
    *((-1, -1, (0.2, 0.4, 0.8)), (0, 0, (0.3, 0.5, 0.9)), (0, -1, (0.4, 0.3, 0.7))),
)


def _case():
    state = replace(scenes.DEFAULT, vertex=scenes.xdk_vertex(), register_combiners=scenes.SHOWS_PRIMARY)
    mesh = Mesh(
        scenes.single([(x * RIGHT, y * TOP, FAR) for x, y, _ in TRIANGLES]),
        PrimitiveType.TRIANGLES,
        colors=scenes.single([(*color, 1.0) for *_, color in TRIANGLES]),
    )
    drawn = scenes.clear(0xF0441111), Draw(label="triangles", mesh=mesh, state=state)
    st = np.array(scenes.TWO_TRIANGLES, np.float64)
    shown = replace(
        state,
        texture_units=(TextureUnit("copy", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    square = scenes.textured_triangles(
        [(RIGHT * (2 * s - 1), TOP * (1 - 2 * t), NEAR) for s, t in st], st * (WIDTH, HEIGHT)
    )
    return Case(
        commands=(
            MakeCurrent(label="copy", surface="copy", width=WIDTH, height=HEIGHT),
            *drawn,
            BindTexImage(
                label="copy",
                texture="copy",
                surface="copy",
                target=TextureTarget.TEXTURE_RECTANGLE,
                origin=WindowOrigin.UPPER_LEFT,
            ),
            MakeCurrent(label="window"),
            *drawn,
            Draw(label="the copy", mesh=square, state=shown),
        )
    )


CASES = {"FBToTexture": _case, "FBToZetaAsTex": _case}  # the second copies into the depth buffer

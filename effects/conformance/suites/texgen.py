"""Texgen: texture coordinates generated from positions and normals, on a rectangle that faces the eye.

Source: src/tests/texgen_tests.cpp of nxdk_pgraph_tests. SphereMap and ReflectionMap for an infinite viewer
are not included. In the machine, these maps have a local viewer (SET_TEXGEN_VIEW_MODEL LOCAL_VIEWER).
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import (
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    shown,
    signed,
    stage,
    total,
)
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TexGenMode
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import (
    IDENTITY,
    TexGen,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texgen"

MODES = {
    "Disabled": TexGenMode.NONE,
    "EyeLinear": TexGenMode.EYE_LINEAR,
    "ObjectLinear": TexGenMode.OBJECT_LINEAR,
    "SphereMap": TexGenMode.SPHERE_MAP,
    "NormalMap": TexGenMode.NORMAL_MAP,
    "ReflectionMap": TexGenMode.REFLECTION_MAP,
}

_SHOWS_OPAQUE = replace(scenes.SHOWS_TEXTURE0, final=shown(SPARE0))

# The combiner of what is passed through: texture 1 plus the coordinates that unit 0 passes, as signed.
_SUM = stage(total(TEXTURE1, signed(TEXTURE0), to=SPARE0), alpha=total(PRIMARY, to=SPARE0))

CHECKERS = (0x60FF6060, 0x90FF9090)  # the program's words 0xFF606060, 0xFF909090, which are R8G8B8A8 there


def gradient(width=256, height=128):
    """uint8 [height, width, 4]: red grows downwards, green to the right, blue upwards, alpha both ways."""
    x = np.arange(width, dtype=np.float32) * np.float32(255) / np.float32(width)
    y = np.arange(height, dtype=np.float32) * np.float32(255) / np.float32(height)
    x, y = np.broadcast_arrays(x.astype(int), y.astype(int)[:, None])
    return np.stack([y, x, 255 - y, (x + y) & 255], -1).astype(np.uint8)


def commands(top, mode, matrix=IDENTITY, passed_through=False):
    """The frame: the gradient on a rectangle, with s, t and r generated, through a texture matrix.

    ``passed_through``: the coordinates as colours instead, added to texel (0, 0) of a checkerboard, as the
    vertices have no coordinates for it. Source: test_suite.cpp, which sets these to zeros for every suite.

    The rectangle is 5.5 wide and 3.5 high, at z = 0; ``top`` is its upper edge's y. Its vertices have no
    normals. Measured: the chip then takes (0, 0, 0) (NormalMap_Arbitrary capture, all pixels).
    """
    corners = scenes.rectangle(-2.75, top, 2.75, top - 3.5)
    texture = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    order = [0, 1, 2, 0, 2, 3]
    mesh = Mesh(
        np.array(corners)[order],
        PrimitiveType.TRIANGLES,
        normals=np.zeros((6, 3)),
        texture_coordinates=(np.array(texture)[order],),
    )
    # OpenGL's sphere map gives s and t alone. Measured: the chip's r is the reflection vector's
    # (Texgen_with_texture_matrix SphereMap_Arbitrary, whose matrix makes it q).
    modes = [mode, mode, TexGenMode.REFLECTION_MAP if mode == TexGenMode.SPHERE_MAP else mode]
    planes = [*(TexGen(m, row) for m, row in zip(modes, IDENTITY, strict=False)), TexGen()]
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(),
        texture_units=(TextureUnit("gradient", scenes.NEAREST, gen=tuple(planes), matrix=matrix),),
        register_combiners=_SHOWS_OPAQUE,
    )
    board = scenes.checkerboard(*CHECKERS, 8)[:128]
    if passed_through:
        sets = (*mesh.texture_coordinates, np.zeros((len(order), 2)))
        mesh = replace(mesh, texture_coordinates=sets)
        state = replace(
            state,
            texture_units=(*state.texture_units, TextureUnit("checkerboard", scenes.NEAREST, coordinates=1)),
            texture_shader=(
                TextureShaderStage(Operation.PASS_THROUGH),
                TextureShaderStage(Operation.TEXTURE_2D),
            ),
            register_combiners=replace(_SHOWS_OPAQUE, general=(_SUM,)),
        )
    return (
        scenes.clear(0xFE202020),
        TexImage(label="checkerboard", texture="checkerboard", image=texture_2d(board)),
        TexImage(label="gradient", texture="gradient", image=texture_2d(gradient())),
        Draw(label="rectangle", mesh=mesh, state=state),
    )


def _case(mode):
    return Case(commands=commands(1.75, mode))


CASES = {  # every case of the suite that the machine can draw
    **{name: partial(_case, mode) for name, mode in MODES.items()},
    # Modes that do not ask where the viewer is.
    **{
        f"{name}_InfiniteViewer": partial(_case, MODES[name])
        for name in ("Disabled", "EyeLinear", "ObjectLinear")
    },
}

"""Texgen: texture coordinates generated from positions and normals, on a rectangle that faces the eye.

Source: src/tests/texgen_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from effects.conformance import scenes
from effects.conformance.case import Case
from pipeline.commands import Draw, Mesh, TexImage
from pipeline.enums import ComponentUsage, Mapping, PrimitiveType, Register, TexGenMode
from pipeline.state import IDENTITY, CombinerInput, TexGen, TextureUnit
from pipeline.textures import texture_2d

SUITE = "Texgen"

MODES = {
    "Disabled": TexGenMode.NONE,
    "EyeLinear": TexGenMode.EYE_LINEAR,
    "ObjectLinear": TexGenMode.OBJECT_LINEAR,
    "SphereMap": TexGenMode.SPHERE_MAP,
    "NormalMap": TexGenMode.NORMAL_MAP,
    "ReflectionMap": TexGenMode.REFLECTION_MAP,
}

_OPAQUE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA)
_SHOWS_OPAQUE = replace(scenes.SHOWS_TEXTURE0, final=replace(scenes.SHOWS_TEXTURE0.final, g=_OPAQUE))


def names():
    """Every case of the suite."""
    return [mode for mode in MODES if mode != "SphereMap"]


def gradient(width=256, height=128):
    """uint8 [height, width, 4]: red grows downwards, green to the right, blue upwards, alpha both ways."""
    x = np.arange(width, dtype=np.float32) * np.float32(255) / np.float32(width)
    y = np.arange(height, dtype=np.float32) * np.float32(255) / np.float32(height)
    x, y = np.broadcast_arrays(x.astype(int), y.astype(int)[:, None])
    return np.stack([y, x, 255 - y, (x + y) & 255], -1).astype(np.uint8)


def commands(top, mode, matrix=IDENTITY):
    """The frame: the gradient on a rectangle, with s, t and r generated, through a texture matrix.

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
    # The sphere map gives s and t alone.
    axes = 2 if mode == TexGenMode.SPHERE_MAP else 3
    planes = [TexGen(mode, row) for row in IDENTITY[:axes]] + [TexGen()] * (4 - axes)
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(),
        texture_units=(TextureUnit("gradient", scenes.NEAREST, gen=tuple(planes), matrix=matrix),),
        register_combiners=_SHOWS_OPAQUE,
    )
    return (
        scenes.clear(0xFE202020),
        TexImage(label="gradient", texture="gradient", image=texture_2d(gradient())),
        Draw(label="rectangle", mesh=mesh, state=state),
    )


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    return Case(commands=commands(1.75, MODES[name]))

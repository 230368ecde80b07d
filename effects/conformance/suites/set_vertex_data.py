"""SetVertexData: a vertex attribute as each of the chip's methods sets it, as a colour and as a normal.

Source: src/tests/set_vertex_data_tests.cpp of nxdk_pgraph_tests. A component that a method does not set is 0,
or 1 for the fourth. Whole numbers of 16 bits stay unchanged; bytes become parts of 255.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import Light, Lighting, Material

SUITE = "SetVertexData"

MOST, LEAST = 32767.0, -32768.0
# By name: the colour, and the first component of the normals that point right and left.
DEPTH = 1.0
COLORED = ((-2.75, 1.75), (0.0, 1.75), (-1.375, -1.75))
RIGHTWARDS = ((1.375, 1.75), (2.75, 0.0), (0.0, 0.0))
LEFTWARDS = ((0.0, 0.0), (2.75, 0.0), (1.375, -1.75))
LIGHTS = (((1.0, 0.0, 0.0), (0.0, 0.25, 0.8)), ((-1.0, 0.0, 0.0), (0.8, 0.25, 0.33)))  # towards, diffuse


def _lighting():
    white = lit_scenes.WHITE
    lights = tuple(
        Light(
            **lit_scenes.colors(diffuse=diffuse),
            position=(*towards, 0.0),
            half_vector=lit_scenes.EYE_DIRECTION,
        )
        for towards, diffuse in LIGHTS
    )
    return Lighting(
        lights=lights,
        front=Material(white, white, white, specular_coefficients=(0.0,) * 6),
        model_ambient=lit_scenes.BLACK,
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )


def _triangle(label, corners, state, **arrays):
    positions = scenes.single([(x, y, DEPTH) for x, y in corners])
    arrays = {name: np.tile(scenes.single(value), (3, 1)) for name, value in arrays.items()}
    return Draw(label=label, mesh=Mesh(positions, PrimitiveType.TRIANGLES, **arrays), state=state)


def _case(color, right, left):
    lit = lit_scenes.state(_lighting(), scenes.SHOWS_PRIMARY)
    unlit = replace(lit, vertex=replace(lit.vertex, lighting=None))
    return Case(
        commands=(
            scenes.clear(0xFF303030),
            _triangle("the attribute as colour", COLORED, unlit, colors=color),
            _triangle("as normal, rightwards", RIGHTWARDS, lit, normals=(right, 0.0, 0.0)),
            _triangle("as normal, leftwards", LEFTWARDS, lit, normals=(left, 0.0, 0.0)),
        )
    )


CASES = {
    "SET_VERTEX_DATA2F_M": partial(_case, (0.5, 1.0, 0.0, 1.0), 1.0, -1.0),
    "SET_VERTEX_DATA4F_M": partial(_case, (0.5, 1.0, 0.25, 0.75), 1.0, -1.0),
    "SET_VERTEX_DATA2S-0001": partial(_case, (1.0, 1.0, 0.0, 1.0), 1.0, -1.0),
    "SET_VERTEX_DATA2S-7FFF": partial(_case, (MOST, MOST, 0.0, 1.0), MOST, LEAST),
    "SET_VERTEX_DATA4S_M-0001": partial(_case, (1.0, 1.0, 1.0, 1.0), 1.0, -1.0),
    "SET_VERTEX_DATA4S_M-7FFF": partial(_case, (MOST,) * 4, MOST, LEAST),
    # The program cuts 255 c to a byte, and keeps the lowest eight bits of -255.
    "SET_VERTEX_DATA4UB": partial(_case, (127 / 255, 1.0, 63 / 255, 191 / 255), 1.0, 1 / 255),
}

"""Lighting_range: a light's range ends on a turned plane; two quads stand inside and outside of it.

Source: src/tests/lighting_range_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import WIDTH, Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import Lighting, Material

SUITE = "Lighting_range"

POSITION, DIRECTION, RANGE = (0.0, 0.0, -7.0), (0.0, 0.0, 1.0), 8.0
ATTENUATION = (0.0001, 0.0, 0.0)
COLORS = lit_scenes.colors((0.05, 0.05, 0.05), (1.0, 1.0, 0.0), (0.0, 0.0, 1.0))
LIGHTS = {
    "Directional": lit_scenes.directional(DIRECTION, **COLORS),
    "Point": lit_scenes.point(POSITION, RANGE, ATTENUATION, **COLORS),
    "Spot": lit_scenes.spotlight(
        POSITION, DIRECTION, RANGE, (45.0, 10.0), ATTENUATION, (0.0, -0.494592, 1.494592), **COLORS
    ),
}
PLANE_COLORS = ((0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.25))
QUAD_COLORS = ((1.0, 0.5, 1.0, 0.25), (0.0, 0.5, 1.0, 0.25))
QUAD_WIDTH, QUAD_HEIGHT, MARGIN, TOP = 128, 256, 24, 64
TILT, TOWARDS = 0.099014754297667, -0.990147542976674


def _plane(inputs):
    """The grid turned by 45 degrees about the y axis, in single precision."""
    grid = lit_scenes.model(inputs, lit_scenes.GRID)
    angle = scenes.single(-np.pi / 4)
    cosine, sine = scenes.single(np.cos(angle)), scenes.single(np.sin(angle))

    def turned(v):
        x, y, z = v.T
        right = scenes.single(scenes.single(x * cosine) + scenes.single(z * sine))
        deep = scenes.single(scenes.single(x * -sine) + scenes.single(z * cosine))
        return np.stack([right, y, deep], axis=1)

    return replace(grid, positions=turned(grid.positions), normals=turned(grid.normals)).mesh(*PLANE_COLORS)


def _quad(left, z):
    corners = scenes.rectangle(left, TOP, left + QUAD_WIDTH, TOP + QUAD_HEIGHT)
    normals = ((-TILT, -TILT), (TILT, -TILT), (TILT, TILT), (-TILT, TILT))
    color, specular = (np.tile(scenes.single(c), (4, 1)) for c in QUAD_COLORS)
    return Mesh(
        np.array([lit_scenes.unproject(x, y, z) for x, y, _ in corners]),
        PrimitiveType.QUADS,
        normals=scenes.single([(*n, TOWARDS) for n in normals]),
        colors=color,
        secondary_colors=specular,
    )


def _case(light, inputs):
    white = lit_scenes.WHITE
    lighting = Lighting(
        lights=(light,),
        front=Material(white, (1.0, 1.0, 1.0, 0.75), white, specular_coefficients=lit_scenes.MECH_ASSAULT),
        model_ambient=lit_scenes.color((0.031373, 0.031373, 0.031373)),
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    state = lit_scenes.state(lighting)
    return Case(
        commands=(
            scenes.clear(0xFF232623),
            *scenes.background(0xFF202020, 0xFF909090, 24),
            Draw(label="turned plane", mesh=_plane(inputs), state=state),
            Draw(label="inside", mesh=_quad(MARGIN, -2.0), state=state),
            Draw(label="outside", mesh=_quad(WIDTH - MARGIN - QUAD_WIDTH, 2.0), state=state),
        )
    )


CASES = {name: partial(_case, light) for name, light in LIGHTS.items()}

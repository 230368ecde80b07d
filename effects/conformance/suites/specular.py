"""Specular: the secondary colour under every light control, with specular coefficients and scaled normals.

Source: src/tests/specular_tests.cpp of nxdk_pgraph_tests. ControlFlags draws 16 quads: the first and third
row show the secondary colour, the others the primary. The upper two rows have no secondary colour. FF is the
fixed-function stage; VS is a vertex program that passes the vertex's colours on.
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance import control_flags, lit_scenes, scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.passes.combiners import ONE, SECONDARY, SPARE0, program, shown, stage, total
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import (
    PrimitiveType,
    SecondaryColor,
)
from fixedpipe.pipeline.state import Lighting, Material

SUITE = "Specular"

CLEAR_FLAGS, CLEAR_PARAMETERS, DARK, BLACK, LIGHT = 0xFE323232, 0xFE313131, 0xFF202020, 0xFF000000, 0xFF909090
NORMAL_LENGTHS = (0.972, 0.973, 1.0, 1.008, 1.009)
POWER_125 = (-0.972162, -3.206372, 3.23421, -0.945147, -3.140267, 3.195119)
SEGMENTS, RADIUS = 64, 128.0
COLORS = lit_scenes.colors((0.0, 0.0, 0.05), (0.25, 0.0, 0.0), (0.0, 0.2, 0.4))
VERTEX_DIFFUSE, VERTEX_SPECULAR = (0.0, 0.0, 0.0, 0.75), (0.0, 0.4, 0.0, 0.25)
ALONG = (1.0, 0.0, 1.0)
WHITE = lit_scenes.WHITE

# Colour and normal of a quad's corners: upper left, upper right, lower right, lower left.
TILT, TOWARDS = 0.099014754297667, -0.990147542976674
CORNERS = control_flags.Corners(
    primary=((0.0, 0.0, 0.5, 1.0), (0.0, 0.0, 0.75, 1.0), (0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 0.25, 1.0)),
    secondary=((1.0, 0.0, 0.0, 0.15), (1.0, 0.0, 0.0, 0.75), (0.0, 1.0, 0.0, 1.0), (0.0, 1.0, 0.0, 0.2)),
    normals=((-TILT, -TILT, TOWARDS), (TILT, -TILT, TOWARDS), (TILT, TILT, TOWARDS), (-TILT, TILT, TOWARDS)),
)

# The quads stand at the depth 1, in depth units: next to the near plane, whose w is 1.
UNPROJECT = {
    "FF": partial(lit_scenes.unproject, z=1.0 - lit_scenes.EYE_DISTANCE),
    "VS": partial(vertex_programs.unproject, z=1.0),
}
# Fitted to rows 1 to 3 of the capture ControlFlags_VS; row 0 is black. What moves the place between rows is
# not known, so of each row's 16 vertices one number is not predicted.
FIRST_PLACES = (0, 3, 4, 4)


def _lighting(coefficients, lights, ambient=0.031373, alpha=0.75, **given):
    return Lighting(
        lights=lights,
        front=Material(WHITE, (1.0, 1.0, 1.0, alpha), WHITE, specular_coefficients=coefficients),
        model_ambient=lit_scenes.color((ambient,) * 3),
        viewer_direction=lit_scenes.EYE_DIRECTION,
        **given,
    )


def _control_flags(name):
    light = (lit_scenes.directional(ALONG, **COLORS),)
    lighting = _lighting(lit_scenes.COEFFICIENTS["Pow16_0"], light)
    draws = control_flags.draws(name, CORNERS, lighting, UNPROJECT, FIRST_PLACES)
    corners = lit_scenes.program_background() if name.endswith("VS") else None
    background = scenes.background(DARK, BLACK, 14, corners=corners)
    return Case(
        commands=(scenes.clear(CLEAR_FLAGS), *background, *draws),
    )


def _parameters(coefficients, inputs):
    point = lit_scenes.point((1.5, 1.0, -2.5), 4.0, (0.025, 0.15, 0.02), **COLORS)
    lights = (lit_scenes.directional(ALONG, **COLORS), point)
    lighting = _lighting(coefficients, lights, ambient=0.1, separate_specular_color=True)
    combiners = scenes.shows(SECONDARY)
    state = lit_scenes.state(lighting, combiners, secondary_color=SecondaryColor.OPAQUE)
    draws = lit_scenes.model_draws(inputs, lit_scenes.MODELS, VERTEX_DIFFUSE, VERTEX_SPECULAR, state)
    return Case(commands=(scenes.clear(CLEAR_PARAMETERS), *scenes.background(DARK, BLACK, 20), *draws))


def _fan(length):
    """A disc in the middle of the screen, normals bent towards its rim."""
    angles = scenes.single(np.arange(SEGMENTS + 1) % SEGMENTS * scenes.single(2 * np.pi / SEGMENTS))
    rim = zip(WIDTH / 2 + RADIUS * np.cos(angles), HEIGHT / 2 + RADIUS * np.sin(angles), strict=True)
    positions = [lit_scenes.unproject(x, y, 0.0) for x, y in [(WIDTH / 2, HEIGHT / 2), *rim]]
    normals = [(0.0, 0.0, -1.0)] + [lit_scenes.unit((-x, -y, -3.0)) for x, y, _ in positions[1:]]
    return Mesh(
        np.array(positions),
        PrimitiveType.TRIANGLE_FAN,
        normals=scenes.single(scenes.single(normals) * scenes.single(length)),
    )


def _normals(length):
    light = lit_scenes.directional((0.0, 0.0, 1.0), **lit_scenes.colors(specular=(1.0, 1.0, 1.0)))
    lighting = _lighting(
        POWER_125, (light,), ambient=0.0, alpha=1.0, local_viewer=True, separate_specular_color=True
    )
    opaque = program(
        stage(total(SECONDARY, to=SPARE0), alpha=total(ONE, to=SPARE0)), shown(SPARE0, alpha=SPARE0)
    )
    draw = Draw(label="disc", mesh=_fan(length), state=lit_scenes.state(lighting, opaque))
    return Case(commands=(scenes.clear(CLEAR_FLAGS), *scenes.background(DARK, LIGHT, 14), draw))


CASES = {
    **{name: partial(_control_flags, name) for name in control_flags.NAMES},
    **{
        f"SpecParams_FF_{name}": partial(_parameters, given)
        for name, given in lit_scenes.COEFFICIENTS.items()
    },
    **{f"NonUnitNormal_{length:.3f}": partial(_normals, length) for length in NORMAL_LENGTHS},
}

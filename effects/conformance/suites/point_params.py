"""Point_params: points whose size shrinks with distance, with and without sprites.

Source: src/tests/point_params_tests.cpp of nxdk_pgraph_tests. FF is the fixed-function vertex stage, which
attenuates. VS is a vertex program that passes window coordinates and the vertex's own size on; the
parameters' switch lets the size through. Sprites (Smooth) repeat a checkerboard over the point. Without them
the whole point shows the texel at (0, 0).
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.passes.combiners import PRIMARY, TEXTURE3, final, program
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, WrapMode
from fixedpipe.pipeline.state import (
    PointParameters,
    PointState,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Point_params"
OPEN = "points of fractional and smooth sizes"

# a, b, c of the attenuation, range, bias, minimum.
BASIC = (
    *((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 16.0)),
    *((1e-6, 0.0, 0.0, 16.0, 0.0, 0.0), (1e-6, 0.0, 0.0, 16.0, 0.0, 8.0)),
    *((4.0, 0.0, 0.0, 14.0, 0.0, 16.0), (4.0, 0.0, 0.0, 36.0, 0.0, 4.0)),
    *((256.0, 0.0, 0.0, 36.0, 0.0, 4.0), (0.0, 0.25, 0.0, 39.0, 0.0, 1.0)),
    *((0.0, 0.0, 0.05, 39.0, 0.0, 1.0), (4.0, 0.0, 0.0, 14.0, -0.5, 16.0)),
    *((4.0, 0.0, 0.0, 14.0, 0.5, 16.0), (0.0, 0.0, 0.0, 15.0, -100.0, 1.0)),
    (0.0, 0.0, 0.0, 15.0, 100.0, 1.0),
)
DETAILED = (
    *((0.0, 0.25, 0.0, 39.0, bias, 1.0) for bias in (-1.0, -0.5, -0.25, -0.01, 0.0, 0.01, 0.25, 0.5, 1.0)),
    *((4.0, 0.0, 0.0, 36.0, bias, 4.0) for bias in (-0.4, -0.25, 0.25, 0.4)),
)
# Parameters on, sprites on, size in 1/8 pixel, stage.
CHECKERBOARD = "checkerboard"


def _mesh(x, y, z, color, stage, size):
    arrays = {"colors": scenes.single([color]), "texture_coordinates": (np.zeros((1, 2)),)}
    if stage == "VS":
        return scenes.window_mesh([(x, y, z, 1.0)], PrimitiveType.POINTS, point_sizes=[size], **arrays)
    return Mesh(scenes.single([scenes.unprojected(x, y, z)]), PrimitiveType.POINTS, **arrays)


def _state(stage, parameters, size, sprite):
    """What the program sets; ``parameters`` as in BASIC, or None."""
    if stage == "VS":
        point = PointState(program_size=parameters is not None, sprite=sprite)
        return replace(scenes.DEFAULT, point=point)
    given = None
    if parameters is not None:
        a, b, c, extent, bias, minimum = parameters
        given = PointParameters((a, b, c), bias, extent, minimum)
    point = PointState(size=size, sprite=sprite, parameters=given)
    return replace(scenes.DEFAULT, vertex=scenes.xdk_vertex(), point=point)


def _textured(state):
    """The same with texture times colour, opaque."""
    repeat = replace(scenes.NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)
    unit = TextureUnit(CHECKERBOARD, repeat, coord_replace=True)
    return replace(
        state,
        texture_units=(None, None, None, unit),
        register_combiners=program(final(TEXTURE3, PRIMARY)),
    )


def _rows(parameters, enabled, sprite, size, stage):
    """Points in rows, each with the next parameters; a row lies 25 units behind the one above."""
    draws, red = [], np.float32(0.1)
    for row, y in enumerate(range(100, HEIGHT, 48)):
        blue, z = np.float32(0.1), 25.0 * row - 5.0
        for column, x in enumerate(range(20, WIDTH, 48)):
            given = parameters[column % len(parameters)] if enabled else None
            mesh = _mesh(x, y, z, (red, 0.65, blue, 1.0), stage, size)
            blue = np.float32(blue + np.float32(0.1))
            # The program's points of the first row have a negative depth, which the chip culls.
            if stage == "FF" or z >= 0:
                draws.append(
                    Draw(label="point", mesh=mesh, state=_textured(_state(stage, given, size, sprite)))
                )
        red = np.float32(red + np.float32(0.1))
    image = texture_2d(scenes.checkerboard(0xFFFFFFFF, 0xFF333333, 2, size=32))
    return (TexImage(label=CHECKERBOARD, texture=CHECKERBOARD, image=image), *draws)


def _scaled(attenuation, stage):
    """192 points, each one unit farther away than the one before it."""
    x, y, draws = 32.0, 116.0, []
    color = (0.93, 0.33, 0.33, 1.0) if stage == "VS" else scenes.abgr(0xFF5555EE)
    for z in range(192):
        state = _state(stage, (*map(float, attenuation), 64.0, 0.0, 0.5), 16.25, False)
        draws.append(Draw(label="point", mesh=_mesh(x, y, float(z), color, stage, 16.25), state=state))
        x += 32.0
        if x >= WIDTH - 32.0:
            x, y = 32.0, y + 32.0
    return draws


def _case(enabled, sprite, eighths, stage):
    size = eighths / 8 if enabled or stage == "FF" else 1.0
    return Case(commands=(scenes.clear(0xFF222323), *_rows(BASIC, enabled, sprite, size, stage)))


def _detailed(stage):
    return Case(commands=(scenes.clear(0xFF222324), *_rows(DETAILED, True, True, 16.0, stage)))


def _scale(attenuation, stage):
    return Case(commands=(scenes.clear(0xFF242323), *_scaled(attenuation, stage)))


CASES = {
    "PointParamsOff_SmoothOff_128_FF": partial(_case, False, False, 128, "FF"),
    "PointParamsOn_SmoothOn_001_FF": partial(_case, True, True, 1, "FF"),
    "PointParamsOn_SmoothOn_128_FF": partial(_case, True, True, 128, "FF"),
    "PointParamsOn_SmoothOff_128_FF": partial(_case, True, False, 128, "FF"),
    "PointParamsOn_SmoothOn_128_VS": partial(_case, True, True, 128, "VS"),
    "PointParamsOn_SmoothOff_128_VS": partial(_case, True, False, 128, "VS"),
    "PointParamsOff_SmoothOff_128_VS": partial(_case, False, False, 128, "VS"),
    "Detailed_FF": partial(_detailed, "FF"),
    "Detailed_VS": partial(_detailed, "VS"),
    **{
        f"Scale_{a}_{b}_{c}_{stage}": partial(_scale, (a, b, c), stage)
        for stage, c, b, a in product(("FF", "VS"), (0, 1), (0, 1), (0, 4))
    },
}

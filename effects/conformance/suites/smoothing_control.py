"""Smoothing_control: primitives in four quarters of the screen, with line and polygon smoothing off and on.

Source: src/tests/smoothing_tests.cpp of nxdk_pgraph_tests. Measured: with SET_SMOOTHING_CONTROL 0xFFFF0001
the smoothing switches change no pixel, and lines are rectangles, as with OpenGL's MULTISAMPLE enabled; with
0xFFFF0000 lines that are not smooth are steps.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, shapes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import LineRasterization, PrimitiveType
from fixedpipe.pipeline.state import LineState

SUITE = "Smoothing_control"

SHAPES = shapes.SHAPES[:-1]
# Left, top, and whether lines and polygons are asked to be smooth.
QUARTERS = (
    (0.0, 0.0, False, False),
    (WIDTH / 2, 0.0, True, False),
    (0.0, HEIGHT / 2, False, True),
    (WIDTH / 2, HEIGHT / 2, True, True),
)


def _in_pixels(shape, left, top):
    """Points at the middles of their pixels, window coordinates floored (OpenGL 1.2.1 section 3.3); all else
    as it is.

    Measured: 64 points, 48 of them on a boundary.
    """
    primitive, vertices = shape
    if primitive != PrimitiveType.POINTS:
        return shape
    x, y = (
        scenes.single(origin) + scenes.single(v)
        for origin, v in zip((left, top), np.array(vertices).T, strict=True)
    )
    middles = np.floor(x) + 0.5 - left, np.ceil(y) - 0.5 - top
    return primitive, tuple(zip(*middles, strict=True))


def _case(smooths):
    draws = []
    for left, top, lines, polygons in QUARTERS:
        steps = smooths and not lines
        rasterization = LineRasterization.STEPS if steps else LineRasterization.RECTANGLE
        state = replace(
            scenes.DEFAULT,
            polygon=replace(scenes.FRONT_FACES, smooth=smooths and polygons),
            line=LineState(rasterization=rasterization, smooth=smooths and lines),
        )
        draws += [
            Draw(
                label=shape[0].name,
                mesh=shapes.mesh(_in_pixels(shape, left, top) if smooths else shape, left, top),
                state=state,
            )
            for shape in SHAPES
        ]
    return Case(commands=(scenes.clear(0xFF32343A), *draws))


CASES = {"0xFFFF0000": partial(_case, True), "0xFFFF0001": partial(_case, False)}

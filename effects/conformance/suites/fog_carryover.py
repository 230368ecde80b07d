"""Fog_carryover: shapes with a fog coordinate, then one whose vertex program writes none.

Measured: it keeps the last one written (5 captures). Source: src/tests/fog_carryover_tests.cpp of
nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import WIDTH, Case
from fixedpipe.effects.conformance.suites import fog
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import FogMode, PrimitiveType
from fixedpipe.pipeline.state import Fog, FogRegisters

SUITE = "Fog_carryover"

# Bias without fog, and the coordinate, of each mode.
MODES = {
    FogMode.LINEAR: (2.0, 0.6),
    FogMode.EXP: (1.51, 0.1),
    FogMode.EXP2: (1.5, 0.2),
}
BLUE = (0.0, 0.0, 1.0, 1.0)
TRIANGLE, FIRST_TOP = (96.0, 42.0), 62.0  # pixels
# The shapes' vertices: eighths of the box's width and quarters of its height, from its upper left.
LINES = ((0, 0), (4, 1), (6, 0), (8, 2), (8, 4), (4, 3.75), (4, 2), (0, 4))
SHAPES = {
    "Points": (PrimitiveType.POINTS, LINES),
    "Lines": (PrimitiveType.LINES, LINES),
    "LineLoop": (PrimitiveType.LINE_LOOP, LINES),
    "LineStrip": (PrimitiveType.LINE_STRIP, LINES),
    "Tris": (
        PrimitiveType.TRIANGLES,
        ((0, 0), (2, 0), (0, 4), (2, 4), (4, 0), (6, 4), (8, 0), (8, 4), (6, 0)),
    ),
    "TriStrip": (PrimitiveType.TRIANGLE_STRIP, ((0, 4), (0, 0), (4, 2), (4, 0), (6, 1), (6, 0), (8, 3))),
    "TriFan": (PrimitiveType.TRIANGLE_FAN, ((4, 2), (0, 3), (2, 0), (6, 1), (8, 4))),
    "Quads": (
        PrimitiveType.QUADS,
        ((0, 0), (2, 0), (2, 2), (0, 2), (4, 0), (8, 0), (8, 2), (4, 2), (0, 3), (8, 3), (8, 4), (0, 4)),
    ),
    "QuadStrip": (PrimitiveType.QUAD_STRIP, ((0, 4), (0, 0), (4, 3), (4, 1), (8, 4), (8, 0))),
    "Poly": (PrimitiveType.POLYGON, ((2, 4), (0, 2), (0, 0), (8, 1), (6, 3))),
}
BOX, SQUARE_LEFT, ROWS, ROW = (8.0, 64.0, 304.0, 64.0), 448.0, 4, 104.0
COORDINATE = 0.6


def _draw(label, points, primitive, mode, coordinate, absolute=False):
    bias, _ = MODES[mode]
    registers = FogRegisters(bias, -1.0, absolute=absolute)
    state = replace(
        scenes.DEFAULT,
        polygon=scenes.FRONT_FACES,
        register_combiners=fog.combined(),
        fog=Fog(mode, color=(1.0, 0.0, 0.0, 1.0), registers=registers),
    )
    mesh = scenes.window_mesh(
        points,
        primitive,
        colors=np.tile(BLUE, (len(points), 1)),
        fog_coordinates=scenes.single(np.full(len(points), coordinate)),
    )
    return Draw(label=label, mesh=mesh, state=state)


def _modes():
    """A triangle of every mode, and on its right one with the coordinate that it left behind."""
    width, height = TRIANGLE
    start = np.float32((WIDTH - 2 * width) / 3)
    for row, (mode, absolute) in enumerate(fog.MODES.values()):
        top = FIRST_TOP + row * (height + 8.0)
        for left in (start, start * np.float32(2)):
            points = [(left, top), (left + width, top), (left + width / 2, top + height)]
            yield _draw("triangle", points, PrimitiveType.TRIANGLES, mode, MODES[mode][1], absolute)


def _shapes(primitive, places):
    left, top, width, height = BOX
    for row in range(ROWS):
        y = top + row * ROW
        points = [(left + width * x / 8, y + height * down / 4) for x, down in places]
        yield _draw("shape", points, primitive, FogMode.EXP, COORDINATE)
        square = scenes.rectangle(SQUARE_LEFT, y, SQUARE_LEFT + 64.0, y + 64.0)
        yield _draw("square", square, PrimitiveType.QUADS, FogMode.EXP, COORDINATE)


def _all_modes():
    return Case(commands=(scenes.clear(0xFF201F20), *_modes()))


def _one_shape(primitive, places):
    return Case(commands=(scenes.clear(0xFFAAAAAA), *_shapes(primitive, places)))


CASES = {"FogCarryover": _all_modes} | {
    f"Carryover{name}": partial(_one_shape, *shape) for name, shape in SHAPES.items()
}

"""Smoothing_control: primitives in four quarters of the screen, with line and polygon smoothing off and on.

Source: src/tests/smoothing_tests.cpp of nxdk_pgraph_tests. Measured: with SET_SMOOTHING_CONTROL 0xFFFF0001
the smoothing switches change no pixel, and lines are rectangles.
"""

from dataclasses import replace

from fixedpipe.effects.conformance import scenes, shapes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import LineRasterization
from fixedpipe.pipeline.state import LineState

SUITE = "Smoothing_control"

CONTROLS = {"0xFFFF0000": LineRasterization.STEPS, "0xFFFF0001": LineRasterization.RECTANGLE}
SHAPES = shapes.SHAPES[:-1]
QUARTERS = ((0.0, 0.0), (WIDTH / 2, 0.0), (0.0, HEIGHT / 2), (WIDTH / 2, HEIGHT / 2))


def names():
    """Every case of the suite."""
    return list(CONTROLS)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in CONTROLS:
        return None
    state = replace(
        scenes.DEFAULT,
        polygon=scenes.FRONT_FACES,
        line=LineState(rasterization=CONTROLS[name]),
    )
    draws = [
        Draw(label=shape[0].name, mesh=shapes.mesh(shape, *corner), state=state)
        for corner in QUARTERS
        for shape in SHAPES
    ]
    smoothed = "edges that the program asks to be smoothed are not"
    explanation = smoothed if CONTROLS[name] == LineRasterization.STEPS else ""
    return Case(commands=(scenes.clear(0xFF32343A), *draws), explanation=explanation)

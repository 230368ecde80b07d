"""Stipple_tests: every primitive through polygon stipple patterns.

Source: src/tests/stipple_tests.cpp of nxdk_pgraph_tests. Measured: the words' order of rows and of bytes, by
the square of the asymmetric pattern, in which no two agree.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, shapes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw

SUITE = "Stipple_tests"

# Words for rows of device pixels from the bottom, the leftmost pixel in the lowest byte's highest bit.
PATTERNS = {
    "Zero": (0,) * 32,
    "Border": (0, *(0x7FFFFFFE,) * 30, 0),
    "Alternating": (0xAAAAAAAA,) * 32,
    "Checkered": ((0x0F0F0F0F,) * 4 + (0xF0F0F0F0,) * 4) * 4,
    "Asymmetric": (0xC0C0FFFF,) * 8 + (0x3030FFFF,) * 8 + (0x00008CEF,) * 8 + (0x0F000F0F,) * 8,
}
LEFT, TOP = 160.0, 48.0
SQUARE = (288, 384, 352, 448)


def _case(stipple):
    polygon = replace(scenes.FRONT_FACES, stipple=stipple)
    state = replace(scenes.DEFAULT, polygon=polygon)
    draws = [
        Draw(label=shape[0].name, mesh=shapes.mesh(shape, LEFT, TOP), state=state) for shape in shapes.SHAPES
    ]
    square = scenes.window_mesh(scenes.rectangle(*SQUARE), colors=np.ones((4, 4)))
    commands = (scenes.clear(0xFF202224), *draws, Draw(label="square", mesh=square, state=state))
    return Case(commands=commands)


CASES = {"Checkered_Off": partial(_case, None)} | {
    f"{name}_On": partial(_case, np.array(rows, "<u4").tobytes()) for name, rows in PATTERNS.items()
}

"""Stipple_tests: every primitive through polygon stipple patterns.

Source: src/tests/stipple_tests.cpp of nxdk_pgraph_tests. The program that made the captures also draws a
square of 64 pixels and has an asymmetric pattern; of the versions that could be read, none has these.
Measured: the square at (288, 384), white. The pattern's four words are read off the square, which therefore
is not compared.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes, shapes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw

SUITE = "Stipple_tests"
OPEN = "how the pattern lies on borders of primitives"

# Words for rows of device pixels from the top, the leftmost pixel in the highest bit.
PATTERNS = {
    "Zero": (0,) * 32,
    "Border": (0, *(0x7FFFFFFE,) * 30, 0),
    "Alternating": (0xAAAAAAAA,) * 32,
    "Checkered": ((0x0F0F0F0F,) * 4 + (0xF0F0F0F0,) * 4) * 4,
    "Asymmetric": (0x0F0F000F,) * 8 + (0xEF8C0000,) * 8 + (0xFFFF3030,) * 8 + (0xFFFFC0C0,) * 8,
}
LEFT, TOP = 160.0, 48.0
SQUARE = (288, 384, 352, 448)
# All but the square's box.
BESIDE_SQUARE = (
    (0, 0, WIDTH, SQUARE[1]),
    (0, SQUARE[1], SQUARE[0], SQUARE[3]),
    (SQUARE[2], SQUARE[1], WIDTH, SQUARE[3]),
    (0, SQUARE[3], WIDTH, HEIGHT),
)


def names():
    """Every case of the suite."""
    return ["Checkered_Off", *(f"{pattern}_On" for pattern in PATTERNS)]


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    pattern, switch = name.split("_")
    upwards = np.array(PATTERNS[pattern][::-1], ">u4").tobytes()
    stipple = upwards if switch == "On" else None
    polygon = replace(scenes.FRONT_FACES, stipple=stipple)
    state = replace(scenes.DEFAULT, polygon=polygon)
    draws = [
        Draw(label=shape[0].name, mesh=shapes.mesh(shape, LEFT, TOP), state=state) for shape in shapes.SHAPES
    ]
    square = scenes.window_mesh(scenes.rectangle(*SQUARE), colors=np.ones((4, 4)))
    commands = (scenes.clear(0xFF202224), *draws, Draw(label="square", mesh=square, state=state))
    if pattern == "Asymmetric":
        return Case(commands=commands, region=BESIDE_SQUARE)
    return Case(commands=commands)

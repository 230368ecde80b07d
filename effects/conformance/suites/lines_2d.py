"""2D_Lines: solid lines of the chip's 2D engine.

Source: src/tests/two_d_line_tests.cpp of nxdk_pgraph_tests. There is no 2D engine here: its lines are redrawn
as lines in STEPS between pixel centres, which also begin with their first pixel and end before their last.
Measured: 200 and 1 pixels of the two captures; Assumed for lines that are neither level nor upright.
"""

from dataclasses import replace

from effects.conformance import scenes
from effects.conformance.case import Case
from pipeline.commands import Draw
from pipeline.enums import PrimitiveType
from pipeline.state import LineState

SUITE = "2D_Lines"

# Colour word, its format's bits, first and last pixel.
LINES = (
    (0xFFFFFFFF, 24, (100, 100), (100, 400)),
    (0xFFFFFF, 24, (222, 222), (222, 222)),
    (0x000000, 24, (400, 200), (400, 400)),
    (0xFF0000, 24, (400, 200), (400, 400)),
    (0x00FF00, 24, (400, 200), (400, 400)),
    (0x0007E0, 16, (400, 200), (400, 400)),
    (0x0003E0, 15, (400, 200), (400, 400)),
    (0x00FF00, 24, (444, 222), (444, 444)),
    (0xFFFFFF, 24, (0, 0), (639, 479)),
    (0xFFFFFF, 24, (639, 479), (0, 0)),
    (0xFFFFFF, 24, (400, 0), (400, 479)),
    (0xFFFFFF, 24, (400, 300), (401, 300)),
    (0xFFFFFF, 24, (400, 300), (400, 301)),
)
WIDTHS = {24: (8, 8, 8), 16: (5, 6, 5), 15: (5, 5, 5)}  # of red, green, blue


def _name(color, bits, first, last):
    return f"2DLine-{bits}-C{color:08X}-{first[0]}_{first[1]}-{last[0]}_{last[1]}"


_CASES = {_name(*line): line for line in LINES}


def names():
    """Every case of the suite."""
    return list(_CASES)


def _color(word, bits):
    """Opaque RGBA of a colour word."""
    components = []
    for width in reversed(WIDTHS[bits]):
        components.insert(0, (word & (2**width - 1)) / (2**width - 1))
        word >>= width
    return (*components, 1.0)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in _CASES:
        return None
    color, bits, first, last = _CASES[name]
    ends = [(x + 0.5, y + 0.5) for x, y in (first, last)]
    mesh = scenes.window_mesh(ends, PrimitiveType.LINES, colors=scenes.single([_color(color, bits)] * 2))
    state = replace(scenes.DEFAULT, blending=None, line=LineState())
    return Case(commands=(scenes.clear(0xFF440011), Draw(label="line", mesh=mesh, state=state)))

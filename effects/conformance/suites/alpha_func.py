"""Alpha_func: three quads of varying alpha and one of constant alpha through every alpha function.

Source: src/tests/alpha_func_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.state import AlphaTest

SUITE = "Alpha_func"

FUNCTIONS = {
    "Never": ComparisonFunction.NEVER,
    "LessThan": ComparisonFunction.LESS,
    "Equal": ComparisonFunction.EQUAL,
    "LessThanOrEqual": ComparisonFunction.LEQUAL,
    "GreaterThan": ComparisonFunction.GREATER,
    "NotEqual": ComparisonFunction.NOTEQUAL,
    "GreaterThanOrEqual": ComparisonFunction.GEQUAL,
    "Always": ComparisonFunction.ALWAYS,
}
REFERENCE = 0x7F
LEFT, RIGHT, TOP = (WIDTH - 512) / 2, (WIDTH + 512) / 2, (HEIGHT - 256) / 3 * 2
GRADIENTS = (  # colour, alpha on the left, alpha on the right; each quad is 64 rows high
    ((1.0, 0.0, 0.0), 0.0, 1.0),
    ((0.0, 0.0, 1.0), 1.0, 0.0),
    ((0.0, 1.0, 0.0), 0.495, 0.505),
)


def _quads():
    positions, colors = [], []
    for row, (color, left, right) in enumerate(GRADIENTS):
        top = TOP + 64 * row
        positions += scenes.rectangle(LEFT, top, RIGHT, top + 64)
        colors += [(*color, left), (*color, right), (*color, right), (*color, left)]
    top = TOP + 64 * len(GRADIENTS)
    positions += scenes.rectangle(0, top, WIDTH, top + 32)
    colors += [scenes.abgr(0x7FFFFFFF)] * 4
    return scenes.window_mesh(positions, colors=scenes.single(colors))


def _case(function, enabled):
    test = AlphaTest(function, REFERENCE / 255) if enabled else None
    state = replace(scenes.DEFAULT, alpha_test=test)
    return Case(commands=(scenes.clear(0xFF222322), Draw(label="quads", mesh=_quads(), state=state)))


CASES = {
    f"AlphaFunc{name}_{switch}": partial(_case, function, switch == "Enabled")
    for name, function in FUNCTIONS.items()
    for switch in ("Enabled", "Disabled")
}

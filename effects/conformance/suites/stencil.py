"""Stencil: a square drawn where a smaller one left a stencil value, with tests and writes on and off.

Source: src/tests/stencil_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case, Shows
from fixedpipe.pipeline.enums import ComparisonFunction, StencilOperation
from fixedpipe.pipeline.state import ColorMask, DepthTest, StencilTest

SUITE = "Stencil"

CLEAR_DEPTH = 0xFFFF / 0xFFFFFF
OPERATIONS = {  # the operation, what the stencil buffer is cleared to, the reference
    "ZERO": (StencilOperation.ZERO, 0xFF, 0),
    "REPLACE": (StencilOperation.REPLACE, 0, 1),
}
SWITCHES = ("", "_ST", "_DT", "_ST_DT")  # stencil test, depth test
NOTHING = ColorMask(False, False, False, False)


def names():
    """Every case of the suite."""
    return [f"Stencil_{o}{s}{zb}" for o in OPERATIONS for s in SWITCHES for zb in ("", "_ZB")]


def _square(side, color, state):
    half = side // 2
    corners = scenes.rectangle(320 - half, 240 - half, 320 + half, 240 + half)
    return scenes.quad("square", corners, (*color, 1.0), state)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    operation, cleared, reference = OPERATIONS[name.split("_")[1]]
    written = replace(
        scenes.DEFAULT,
        color_mask=NOTHING,
        stencil_test=StencilTest(reference=reference, depth_pass=operation) if "_ST" in name else None,
        depth_test=DepthTest(ComparisonFunction.ALWAYS, write=False) if "_DT" in name else None,
    )
    equal = replace(scenes.DEFAULT, stencil_test=StencilTest(ComparisonFunction.EQUAL, reference))
    commands = (
        scenes.clear(0xFF000000, CLEAR_DEPTH, cleared),
        _square(200, (1.0, 0.0, 0.0), scenes.DEFAULT),
        _square(100, (0.0, 0.0, 1.0), written),
        _square(200, (0.0, 1.0, 0.0), equal),
    )
    return Case(commands=commands, shows=Shows.ZETA if name.endswith("_ZB") else Shows.COLOR)

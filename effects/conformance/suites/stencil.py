"""Stencil: a square drawn where a smaller one left a stencil value, with tests and writes on and off.

Source: src/tests/stencil_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import SHOWS, Case
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


def _square(side, color, state):
    half = side // 2
    corners = scenes.rectangle(320 - half, 240 - half, 320 + half, 240 + half)
    return scenes.quad("square", corners, (*color, 1.0), state)


def _case(operation, cleared, reference, stencils, tests_depth, shows):
    written = replace(
        scenes.DEFAULT,
        color_mask=NOTHING,
        stencil_test=StencilTest(reference=reference, depth_pass=operation) if stencils else None,
        depth_test=DepthTest(ComparisonFunction.ALWAYS, write=False) if tests_depth else None,
    )
    equal = replace(scenes.DEFAULT, stencil_test=StencilTest(ComparisonFunction.EQUAL, reference))
    commands = (
        scenes.clear(0xFF000000, CLEAR_DEPTH, cleared),
        _square(200, (1.0, 0.0, 0.0), scenes.DEFAULT),
        _square(100, (0.0, 0.0, 1.0), written),
        _square(200, (0.0, 1.0, 0.0), equal),
    )
    return Case(commands=commands, shows=shows)


CASES = {
    f"Stencil_{name}{switches}{zeta}": partial(_case, *operation, "_ST" in switches, "_DT" in switches, shows)
    for name, operation in OPERATIONS.items()
    for switches in SWITCHES
    for zeta, shows in SHOWS.items()
}

"""Stencil_func: nine patches that stencil operations prepare, then a quad through each stencil function.

Source: src/tests/stencil_func_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import SHOWS, Case
from fixedpipe.effects.conformance.suites.stencil import CLEAR_DEPTH, NOTHING
from fixedpipe.pipeline.enums import ComparisonFunction, StencilOperation
from fixedpipe.pipeline.state import ColorMask, StencilTest

SUITE = "Stencil_func"

FUNCTIONS = {
    "Never": ComparisonFunction.NEVER,
    "Less": ComparisonFunction.LESS,
    "Equal": ComparisonFunction.EQUAL,
    "LessThanOrEqual": ComparisonFunction.LEQUAL,
    "Greater": ComparisonFunction.GREATER,
    "NotEqual": ComparisonFunction.NOTEQUAL,
    "GreaterThanOrEqual": ComparisonFunction.GEQUAL,
    "Always": ComparisonFunction.ALWAYS,
}
REFERENCE = 0x7F
ZERO, REPLACE, INVERT = StencilOperation.ZERO, StencilOperation.REPLACE, StencilOperation.INVERT
PATCHES = (  # column, upper edge, what is done to a stencil value of 0x7F
    (0, 44, (ZERO,)),
    (1, 44, (REPLACE, StencilOperation.DECR_WRAP)),
    (2, 44, (REPLACE,)),
    (3, 44, (REPLACE, StencilOperation.INCR_WRAP)),
    (4, 44, (ZERO, INVERT)),
    (0, 286, (ZERO, StencilOperation.DECR_WRAP)),
    (1, 286, (ZERO, StencilOperation.DECR)),
    (2, 286, (ZERO, INVERT, StencilOperation.INCR_WRAP)),
    (3, 286, (ZERO, INVERT, StencilOperation.INCR)),
)
RGB = ColorMask(alpha=False)


def _state(color_mask, **test):
    return replace(
        scenes.DEFAULT, color_mask=color_mask, stencil_test=StencilTest(reference=REFERENCE, **test)
    )


def _case(function, shows):
    commands = [scenes.clear(0xFF000000, CLEAR_DEPTH, 0)]
    for column, top, operations in PATCHES:
        left = 125 + 81 * column
        corners = scenes.rectangle(left, top, left + 80, top + 80, 0.1)
        masked = _state(RGB, depth_pass=INVERT, write_mask=REFERENCE)
        commands.append(scenes.quad("blue patch", corners, (0.0, 0.0, 1.0, 1.0), masked))
        commands += [
            scenes.quad(f"{o.name} the patch", corners, (1.0, 1.0, 1.0, 1.0), _state(NOTHING, depth_pass=o))
            for o in operations
        ]
    state = _state(RGB, function=function)
    overlay = scenes.rectangle(120, 40, 530, 450, 0.1)
    commands.append(scenes.quad("green overlay", overlay, (0.0, 0.75, 0.0, 1.0), state))
    return Case(commands=tuple(commands), shows=shows)


CASES = {
    f"{name}{zeta}": partial(_case, function, shows)
    for name, function in FUNCTIONS.items()
    for zeta, shows in SHOWS.items()
}

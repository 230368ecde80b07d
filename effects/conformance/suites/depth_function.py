"""Depth_function: quads behind, at and in front of a strip, under every depth function.

Source: src/tests/depth_function_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import SHOWS, Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.state import DepthTest

SUITE = "Depth_function"

FRONT, SAME, BEHIND = -1.0, 0.0, 1.0  # z in the XDK's view
BACKDROP = 0xFFAAAAAA  # colours are 0xAABBGGRR
SWATCHES = (  # colour, how far below the strip's upper edge, height, depth
    (0xFF3333FF, 4, 20, BEHIND),
    (0xFFFF3333, 36, 24, SAME),
    (0xFF33FF33, 68, 24, FRONT),
)
FUNCTIONS = (
    ComparisonFunction.ALWAYS,
    ComparisonFunction.NEVER,
    ComparisonFunction.LESS,
    ComparisonFunction.EQUAL,
    ComparisonFunction.LEQUAL,
    ComparisonFunction.GREATER,
    ComparisonFunction.NOTEQUAL,
    ComparisonFunction.GEQUAL,
)
# Upper edges of the strips' rows; the chip ignores the codes that the lower two rows set, which are none of a
# depth function's, and keeps the function set before: the column's, and ALWAYS.
ROWS = ((64, FUNCTIONS), (200, FUNCTIONS), (320, (ComparisonFunction.ALWAYS,) * len(FUNCTIONS)))


def _quad(color, left, top, right, bottom, z, function):
    corners = [scenes.unprojected(*corner) for corner in scenes.rectangle(left, top, right, bottom, z)]
    mesh = Mesh(scenes.single(corners), PrimitiveType.QUADS, colors=scenes.single([scenes.abgr(color)] * 4))
    return Draw(
        label=f"a quad through {function.name}",
        mesh=mesh,
        state=replace(
            scenes.DEFAULT, vertex=scenes.xdk_vertex(depth_maximum=65535.0), depth_test=DepthTest(function)
        ),
    )


def _case(shows):
    commands = [scenes.clear(0xFF000000)]
    for top, functions in ROWS:
        for column, function in enumerate(functions):
            x = 32 + 40 * column
            commands.append(_quad(BACKDROP, x + 4, top, x + 32, top + 96, SAME, ComparisonFunction.ALWAYS))
            for color, down, height, z in SWATCHES:
                y = top + down
                commands.append(_quad(color, x, y, x + 24, y + height, z, function))
    return Case(commands=tuple(commands), shows=shows, depth_bits=16)


CASES = {f"DepthFunc{zeta}": partial(_case, shows) for zeta, shows in SHOWS.items()}

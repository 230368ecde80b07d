"""Point_size: points of every size, one after the other.

Source: src/tests/point_size_tests.cpp of nxdk_pgraph_tests. Sizes are in 1/8 pixel. The register holds nine
bits; a wider value leaves the earlier size. SmoothOn makes point sprites, which no texture changes here. FF
is the fixed-function vertex stage. Its points were unprojected, so they come back to their places, except for
the viewport's offset. VS is a vertex program that passes window coordinates on.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import PointState

SUITE = "Point_size"

HIGHEST = 0x1FF
STAGES = {"FF": scenes.XDK_OFFSET, "VS": 0.0}  # how far from its pixel coordinates a point lands
STEPS = (1, 4, 8, 16)
LARGEST = 64.0  # pixels
GREY, GREEN, WHITE, BLUE = 0xFFBBBBBB, 0xFF00BB00, 0xFFFFFFFF, 0xFFFF0000


def _point(x, y, color, eighths, offset):
    mesh = scenes.window_mesh(
        [(x + offset, y + offset, 0.0)], PrimitiveType.POINTS, colors=scenes.single([color])
    )
    state = replace(scenes.DEFAULT, point=PointState(size=min(eighths, HIGHEST) / 8))
    return Draw(label=f"{eighths / 8} pixels", mesh=mesh, state=state)


def _sweep(step, offset):
    """Points in rows; red grows from row to row, blue along a row, each by a tenth."""
    spacing = (64, 64) if step > 1 else (40, 30)
    draws, eighths, red = [], 0, np.float32(0.1)
    for y in range(100, HEIGHT, spacing[1]):
        blue = np.float32(0.1)
        for x in range(20, WIDTH, spacing[0]):
            draws.append(_point(x, y, (red, 0.65, blue, 1.0), min(eighths, HIGHEST // step * step), offset))
            eighths, blue = eighths + step, np.float32(blue + np.float32(0.1))
        red = np.float32(red + np.float32(0.1))
    return draws


def _largest(offset):
    """Two rows: a point, a square of 64 pixels with two rulers, on it a point of a size beyond nine bits."""
    x, y = np.floor((WIDTH - LARGEST) / 3), np.floor((HEIGHT - LARGEST) / 3)
    draws = []
    for row, eighths in ((1, 8), (2, HIGHEST)):
        middle, left, top = y * row, 2 * x - LARGEST / 2, y * row - LARGEST / 2
        draws.append(_point(x, middle, scenes.abgr(GREY), eighths, offset))
        for box in (
            (left, top, left + LARGEST, top + LARGEST),
            (left - 4, top, left - 2, top + LARGEST),
            (left, top - 4, left + LARGEST, top - 2),
        ):
            corners = scenes.rectangle(*(v + offset for v in box))
            draws.append(scenes.quad("ruler", corners, scenes.abgr(GREEN)))
        draws.append(_point(2 * x, middle, scenes.abgr(WHITE), eighths, offset))
    return draws


def _smallest(stage):
    """Points of 0 to 8 eighths of a pixel; a program's are as large as the one before, 8 eighths, as the
    vertices' sizes take no part.
    """
    for eighths in range(9):
        x = 16.0 + 85.0 * eighths
        size = 8 if stage == "VS" else eighths
        yield _point(x, 240.0, scenes.abgr(WHITE), size, STAGES[stage])


def _program_sizes():
    """Four rows of a point from immediate commands and one from an array, whose size the program also makes a
    colour of. Without point parameters the register's size stands; with them the program's, which immediate
    commands leave as the last array had it.
    """
    before = 0.0
    for y, eighths, size, written in (
        (150.0, 240, 2.0, False),
        (210.0, 80, 50.0, False),
        (286.0, 240, 2.0, True),
        (346.0, 80, 25.0, True),
    ):
        shade = scenes.single(scenes.single(size) * scenes.single(1 / 64))
        for x, color, own in ((128.0, scenes.abgr(BLUE), before), (400.0, (shade, 0.0, 0.0, 1.0), size)):
            point = PointState(program_size=True) if written else PointState(size=eighths / 8)
            mesh = scenes.window_mesh(
                [(x, y, 1.0)], PrimitiveType.POINTS, colors=scenes.single([color]), point_sizes=[own]
            )
            yield Draw(label=f"{own} pixels", mesh=mesh, state=replace(scenes.DEFAULT, point=point))
        before = size


def _case(background, points, *given):
    return Case(commands=(scenes.clear(background), *points(*given)))


CASES = {
    **{
        f"PointSmooth{on}_{step:02d}_{stage}": partial(_case, 0xFF222322, _sweep, step, offset)
        for on, step, (stage, offset) in product(("On", "Off"), STEPS, STAGES.items())
    },
    **{f"LargestPointSize_{s}": partial(_case, 0xFF444444, _largest, offset) for s, offset in STAGES.items()},
    **{f"SmallestPointSize_{stage}": partial(_case, 0xFF444444, _smallest, stage) for stage in STAGES},
    "VSPointSize": partial(_case, 0xFF444444, _program_sizes),
}

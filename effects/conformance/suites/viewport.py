"""Viewport: a checkered rectangle, half of its squares through a vertex program, half through the
fixed-function stage, whose viewport offset moves them.

Source: src/tests/viewport_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import host_matrices, scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.vertex_programs import perspective
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType

SUITE = "Viewport"

# The viewport's offset in x and y, and its scale in x, which the fixed-function stage does not read.
OFFSETS = {
    0.0: (0.0, 0.531250, 0.5625, -0.531250, -0.4375, 1.0, -1.0),
    2.0: (0.0, 0.531250, -0.531250, 1.0, -1.0),
}
LEFT, TOP, SIZE = WIDTH / 2 - 200, HEIGHT / 2 - 100, 100.0
BOTTOM_Z, TOP_Z = 0.0, 10.0
GREY, PROGRAMMED, FIXED = 0xFFE0E0E0, 0xFF001199, 0xFF0033BB  # 0xAABBGGRR


def _unprojected(left, top, width, height, z=(TOP_Z, BOTTOM_Z)):
    """World positions [4, 3] that the program takes for a rectangle's corners."""
    corners = np.array([(left, top), (left + width, top), (left + width, top + height), (left, top + height)])
    _, inverse = host_matrices.fixed_function()
    return host_matrices.unproject(inverse, *corners.T, np.repeat(z, 2)).astype(np.float64)


def draws(colors, offset, moved=0.0):
    """Draws of a rectangle and of eight squares over it, which a program and the fixed functions transform.

    ``colors``: of the rectangle, the program's and the fixed functions' squares, 0xAABBGGRR. ``offset``: the
    viewport's, pixels. ``moved``: how far to the right and down the squares lie, pixels.
    """
    grey, by_program, by_functions = colors
    square = np.arange(8)
    boxes = [(LEFT + SIZE * (i % 4) + moved, TOP + SIZE * (i // 4) + moved, SIZE, SIZE) for i in square]
    programmed = (square + square // 4) % 2 == 0
    background = _unprojected(LEFT, TOP, 4 * SIZE, 2 * SIZE, (TOP_Z + 0.0001, BOTTOM_Z + 0.0001))
    yield Draw(
        label="background",
        mesh=scenes.window_mesh(perspective(background), colors=np.tile(scenes.abgr(grey), (4, 1))),
        state=scenes.DEFAULT,
    )
    colors = np.tile(scenes.abgr(by_program), (16, 1))
    points = np.concatenate([_unprojected(*boxes[i]) for i in square[programmed]])
    yield Draw(
        label="squares of the vertex program",
        mesh=scenes.window_mesh(perspective(points), colors=colors),
        state=scenes.DEFAULT,
    )
    colors = np.tile(scenes.abgr(by_functions), (16, 1))
    points = np.concatenate([_unprojected(*boxes[i]) for i in square[~programmed]])
    yield Draw(
        label="squares of the fixed-function stage",
        mesh=Mesh(points, PrimitiveType.QUADS, colors=colors),
        state=replace(scenes.DEFAULT, vertex=scenes.xdk_vertex(offset=offset)),
    )


def _case(offset):
    return Case(commands=(scenes.clear(0xFE404040), *draws((GREY, PROGRAMMED, FIXED), offset)))


CASES = {
    f"{offset:.3f}_{offset:.3f}-{scale:.3f}_0.000": partial(_case, offset)
    for scale, offsets in OFFSETS.items()
    for offset in offsets
}

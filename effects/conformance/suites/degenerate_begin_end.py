"""Degenerate_begin_end: primitives begun while another one is open.

Source: src/tests/degenerate_begin_end_tests.cpp of nxdk_pgraph_tests. Measured: a second beginning changes
nothing, and all vertices up to the end belong to the first (BeginWithoutEnd).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType

SUITE = "Degenerate_begin_end"

TRIANGLES, QUADS, POLYGON = PrimitiveType.TRIANGLES, PrimitiveType.QUADS, PrimitiveType.POLYGON
COLORS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.75, 0.75, 0.75))
# Rows of four shapes; the first is a primitive of its own, the second begins the one that the others go on.
ROWS = (
    (TRIANGLES, TRIANGLES, TRIANGLES, QUADS),
    (QUADS, QUADS, TRIANGLES, TRIANGLES),
    (QUADS, QUADS, TRIANGLES, QUADS),
    (POLYGON, POLYGON, TRIANGLES, QUADS),
)
ACROSS, DOWN, WIDTH, HEIGHT, TOP = 128.0, 80.0, 64.0, 40.0, 100.0  # pixels, of columns, rows and shapes


def _corners(shape, column, row):
    left, top = ACROSS * (column + 1) - WIDTH / 2, TOP + DOWN * row
    right, bottom = left + WIDTH, top + HEIGHT
    three = [(left, bottom), (left, top), (right, top)]
    return three if shape == TRIANGLES else [(right, bottom), *three]


def _draw(label, shapes, row, first):
    vertices = [
        (x, y, 1.0, 1.0, *COLORS[column], 1.0)
        for column, shape in enumerate(shapes, first)
        for x, y in _corners(shape, column, row)
    ]
    size = {TRIANGLES: 3, QUADS: 4, POLYGON: 1}[shapes[0]]
    rows = np.array(vertices[: len(vertices) // size * size])  # what is left over draws nothing
    mesh = scenes.window_mesh(rows[:, :4], shapes[0], colors=rows[:, 4:])
    return Draw(label=label, mesh=mesh, state=replace(scenes.DEFAULT, polygon=scenes.FRONT_FACES))


def _case():
    draws = [
        draw
        for row, shapes in enumerate(ROWS)
        for draw in (_draw("ended", shapes[:1], row, 0), _draw("not ended", shapes[1:], row, 1))
    ]
    return Case(commands=(scenes.clear(0xFE242424), *draws))


CASES = {"BeginWithoutEnd": _case}

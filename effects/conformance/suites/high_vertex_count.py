"""High_vertex_count: 8738 small squares in one draw, some of them over others.

Source: src/tests/high_vertex_count_tests.cpp of nxdk_pgraph_tests.
"""

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw

SUITE = "High_vertex_count"

ENTRIES, PER_VERTEX = 0x07FFFF, 15  # numbers that the draw sends at most, and of each vertex
INSET, TOP, SIZE = 2.0, 48.0, 6.0  # pixels
FIRST, AGAIN = (0.0, 0.5, 0.75), (1.0, 0.0, 1.0)  # colours with which a pass over the screen begins
STEP = np.array([0.03, 0.05, 0.01], np.float32)
FADING = np.float32(0.75)  # of alpha, each pass


def _squares():
    """Left and top of every square, and whether a pass begins after it."""
    left, top = INSET, TOP
    for number in range(1, ENTRIES // (4 * PER_VERTEX) + 1):
        row_ends = number % int((WIDTH - 2 * INSET) / SIZE) == 0
        again = row_ends and top + SIZE > HEIGHT - SIZE
        yield left, top, again
        left = INSET if row_ends else left + SIZE
        if row_ends:
            top = TOP if again else top + SIZE


def _case():
    color, alpha, one = np.array(FIRST, np.float32), np.float32(1.0), np.float32(1.0)
    corners, colors = [], []
    for left, top, again in _squares():
        for corner in scenes.rectangle(left, top, left + SIZE, top + SIZE):
            corners.append(corner)
            colors.append((*color, alpha))
            for _ in range(2):  # once more for the secondary colour
                color = color + STEP
                color = np.where(color > one, color - one, color)
        if again:
            color, alpha = np.array(AGAIN, np.float32), alpha * FADING
    mesh = scenes.window_mesh(corners, colors=np.array(colors, np.float64))
    return Case(commands=(scenes.clear(0xFF444444), Draw(label="squares", mesh=mesh, state=scenes.DEFAULT)))


CASES = {
    f"HighVtxCount-{how}": _case for how in ("arrays", "inlinebuffers", "inlinearrays", "inlineelements")
}

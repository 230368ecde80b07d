"""Overlapping_draw_modes: one primitive whose vertices come by index, as arrays, and by index again.

Measured: they are one list of vertices, in the order of the commands. Source:
src/tests/overlapping_draw_modes_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import host_matrices, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType

SUITE = "Overlapping_draw_modes"

LEFT, RIGHT, TOP, BOTTOM = -2.75, 2.75, 1.75, -1.75
STRIP = (
    *((LEFT, 0.0, (1.0, 0.0, 0.0)), (LEFT + 1.0, TOP, (0.0, 1.0, 0.0))),
    *((LEFT + 0.5, BOTTOM, (0.0, 0.0, 1.0)), (LEFT + 1.5, TOP - 0.5, (0.25, 0.0, 0.8))),
    *((LEFT + 2.0, BOTTOM + 0.5, (0.75, 0.0, 0.25)), (LEFT + 2.5, TOP - 1.0, (0.33,) * 3)),
    *((LEFT + 3.0, BOTTOM + 1.0, (0.7,) * 3), (LEFT + 3.5, TOP, (0.5, 0.5, 0.6))),
)
TRIANGLES = (
    *((LEFT, TOP, (0.25,) * 3), (0.0, TOP, (0.55,) * 3), (LEFT, 0.0, (0.75,) * 3)),
    *((RIGHT, TOP, (0.8, 0.25, 0.1)), (0.1, BOTTOM, (0.1, 0.85, 0.1)), (0.25, 0.0, (0.1, 0.25, 0.9))),
    *((-0.4, BOTTOM, (0.8, 0.25, 0.9)), (-1.4, -1.4, (0.1, 0.85, 0.9)), (0.0, 0.0, (0.85, 0.95, 0.1))),
    *((LEFT, BOTTOM, (0.2, 0.4, 0.8)), (LEFT, 0.0, (0.3, 0.5, 0.9)), (0.0, 0.0, (0.4, 0.3, 0.7))),
)
# By name: the primitive, its vertices, and which of the triangles come in what order.


def _case(primitive, vertices, order):
    mesh = Mesh(
        scenes.single([(x, y, 1.0) for x, y, _ in vertices]),
        primitive,
        indices=list(order),
        colors=np.array([(*color, 1.0) for *_, color in vertices]),
    )
    state = replace(scenes.DEFAULT, vertex=host_matrices.xdk_vertex(), polygon=scenes.FRONT_FACES)
    return Case(commands=(scenes.clear(0xFE242424), Draw(label="primitive", mesh=mesh, state=state)))


CASES = {
    "ArrElm_DrwArr_ArrElm": partial(_case, PrimitiveType.TRIANGLE_STRIP, STRIP, range(8)),
    "DrwArr_DrwArr": partial(_case, PrimitiveType.TRIANGLES, TRIANGLES, (0, 1, 2, 6, 7, 8)),
    "SquashOpt": partial(_case, PrimitiveType.TRIANGLES, TRIANGLES, range(12)),
    "SquashOptSingleArray": partial(_case, PrimitiveType.TRIANGLES, TRIANGLES, (*range(6, 12), *range(6))),
}

"""Edge_flag: every primitive as outlines, with edge flags set and cleared, and three with flags of their own.

Source: src/tests/edge_flag_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, shapes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PolygonMode, PrimitiveType

SUITE = "Edge_flag"

LEFT, TOP = 160.0, 48.0
# Shapes whose flags change within them: those of odd, or of even, vertices are set.
OWN = (
    (
        PrimitiveType.TRIANGLES,
        (
            (365.185925, 35.0),
            (349.778838, 22.523717),
            (410.0, 19.0),
            (344.0, 48.0),
            (404.0, 37.0),
            (332.0, 103.0),
        ),
        1,
    ),
    (
        PrimitiveType.POLYGON,
        ((320.0, 232.0), (340.0, 142.1), (361.0, 120.0), (405.0, 169.3), (419.0, 230.5)),
        0,
    ),
    (PrimitiveType.QUADS, ((100.0, 350.0), (160.0, 340.0), (158.5, 425.4), (112.75, 407.5)), 0),
)


def _case(enabled):
    line = PolygonMode.LINE
    polygon = replace(scenes.FRONT_FACES, front_mode=line, back_mode=line)
    state = replace(scenes.DEFAULT, polygon=polygon)
    drawn = [(shape, np.full(len(shape[1]), enabled)) for shape in shapes.SHAPES]
    for primitive, vertices, parity in OWN:
        flags = (np.arange(len(vertices)) % 2 == parity) | enabled
        drawn.append(((primitive, vertices), flags))
    draws = [
        Draw(label=shape[0].name, mesh=shapes.mesh(shape, LEFT, TOP, edge_flags=flags), state=state)
        for shape, flags in drawn
    ]
    return Case(commands=(scenes.clear(0xFF303234), *draws))


CASES = {"Enabled": partial(_case, True), "Disabled": partial(_case, False)}

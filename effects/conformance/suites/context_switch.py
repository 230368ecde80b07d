"""Context_switch: vertices that are sent while the graphics class of the channel's context is set to zero.

Source: src/tests/context_switch_tests.cpp of nxdk_pgraph_tests. Measured: nothing that is sent meanwhile
arrives, neither vertices nor colours (GRZero).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType

SUITE = "Context_switch"

LEFT, RIGHT, TOP, MIDDLE = 64.0, 576.0, 48.0, 240.0
POLYGON = (
    (LEFT, MIDDLE, (1.0, 0.0, 0.0, 0.75)),
    (LEFT, TOP, (0.0, 1.0, 0.0, 0.5)),
    (RIGHT, TOP, (0.0, 0.0, 1.0, 0.75)),
    (RIGHT, MIDDLE, (0.3, 0.4, 0.7, 0.66)),
)
TRIANGLE = ((16.0, TOP), (32.0, MIDDLE), (0.0, MIDDLE))  # with the last colour that arrived


def _draw(label, primitive, positions, colors):
    mesh = scenes.window_mesh(positions, primitive, colors=scenes.single(colors))
    return Draw(label=label, mesh=mesh, state=replace(scenes.DEFAULT, polygon=scenes.FRONT_FACES))


def _case():
    corners = np.array(scenes.rectangle(0, 0, WIDTH, HEIGHT))
    return Case(
        commands=(
            scenes.clear(0xFE1F1F1F),
            *scenes.background(corners=corners),
            _draw(
                "polygon", PrimitiveType.POLYGON, [(x, y) for x, y, _ in POLYGON], [c for *_, c in POLYGON]
            ),
            _draw("triangle", PrimitiveType.TRIANGLES, TRIANGLE, [POLYGON[-1][2]] * 3),
        )
    )


CASES = {"GRZero": _case}

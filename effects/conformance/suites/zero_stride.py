"""Zero_stride: three triangles whose colours lie at a stride of zero, so that all vertices have the first.

Source: src/tests/zero_stride_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.state import DepthTest

SUITE = "Zero_stride"

FRONT, BACK = 1.0, 5.0
TRIANGLES = (
    *((-2.75, 1.75, FRONT), (0.0, 1.75, FRONT), (-2.75, 0.0, FRONT)),
    *((2.75, 1.75, FRONT), (0.1, -1.75, BACK), (0.25, 0.0, FRONT)),
    *((-0.4, -1.75, BACK), (-1.4, -1.4, BACK), (0.0, 0.0, BACK)),
)
COLOR = (0.25, 0.25, 0.25, 1.0)  # of the first vertex


def _case():
    mesh = Mesh(
        scenes.single(TRIANGLES), PrimitiveType.TRIANGLES, colors=scenes.single([COLOR] * len(TRIANGLES))
    )
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(),
        register_combiners=scenes.SHOWS_PRIMARY,
        depth_test=DepthTest(ComparisonFunction.LESS),
    )
    return Case(commands=(scenes.clear(0xFF303030), Draw(label="triangles", mesh=mesh, state=state)))


CASES = {name: _case for name in ("DrawArrays", "InlineElements")}

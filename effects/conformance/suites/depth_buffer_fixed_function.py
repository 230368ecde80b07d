"""Depth_buffer_fixed_function: slopes through the default view, in every depth format, below a few cut-offs.

The cut-off is the depth buffer's clear value. Compression (C) is a way in which the chip stores depth, and
changes no value. Source: src/tests/depth_format_fixed_function_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import cache, partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import SHOWS, Case
from fixedpipe.effects.conformance.host_matrices import (
    FARTHEST_16_BIT_FLOAT,
    FARTHEST_24_BIT_FLOAT,
    default_view,
)
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction, DepthFormat, PrimitiveType
from fixedpipe.pipeline.state import DepthClamp, DepthTest

SUITE = "Depth_buffer_fixed_function"
OPEN = "the last bits of the depth weights' reciprocal"
single = np.float32

FORMATS = {  # the name's parts: format, the farthest word, the farthest depth of the view
    ("z16", "n"): (DepthFormat.FIXED_16, 0xFFFF, 65535.0),
    ("z24", "n"): (DepthFormat.FIXED_24, 0xFFFFFF, 16777215.0),
    ("z16", "y"): (DepthFormat.FLOAT_16, 0xFFFF, FARTHEST_16_BIT_FLOAT),
    ("z24", "y"): (DepthFormat.FLOAT_24, 0xFEFFFF, FARTHEST_24_BIT_FLOAT),
}
CUT_OFFS = 4
NEAR, FAR = -6.0, 193.0  # z of the view volume's planes
LIMIT = 16777216.0  # the depth clip's
LEFT, TOP, RIGHT, BOTTOM = 128.0, 48.0, 512.0, 432.0
SQUARE, STEP = 16, 20  # pixels: a small quad's edge, and from one to the next
COUNT = int(RIGHT - LEFT - SQUARE) // STEP  # of small quads in a row and in a column


def _cases():
    for (width, is_float), (depth_format, farthest, depth) in FORMATS.items():
        for compressed in "ny":
            for k in range(CUT_OFFS + 1):
                cut_off = farthest - k * (farthest // CUT_OFFS)
                name = f"{width}_C{compressed}_FZ{is_float}_M{cut_off:06x}"
                for zeta, shows in SHOWS.items():
                    yield name + zeta, partial(_case, depth_format, depth, cut_off, shows)


def _quads():
    """The scene, front to back: (left, top, right, bottom), z and colours of the four corners, from the upper
    left clockwise. The program hands its colours over counter-clockwise, so two of them change places.
    """
    step = (single(FAR) - single(NEAR)) / (single(3 + COUNT * COUNT) + single(1))
    z, rise = single(NEAR), step * single(0.75)
    begin = [
        low + 4 + (high - low - (SQUARE + COUNT * STEP)) / 2 for low, high in ((LEFT, RIGHT), (TOP, BOTTOM))
    ]
    for row in range(COUNT):
        for column in range(COUNT):
            x, y, far = begin[0] + STEP * column, begin[1] + STEP * row, z + rise
            near, right = ((single(0.25) + d / single(FAR) * single(0.75),) * 3 for d in (z, far))
            yield (x, y, x + SQUARE, y + SQUARE), (z, far, far, z), (near, near, right, right)
            z, rise = z + step, -rise
    far = single(FAR)
    left, right = single(FAR * 0.75), single(NEAR)
    a, b = (left / far, 0.75, left / far), (0.75, right / far, right / far)
    yield (LEFT + 4, BOTTOM - 10, RIGHT - 20, BOTTOM - 5), (left, right, right, left), (a, a, b, b)
    top, low = single(NEAR), far * single(0.5)
    a, b = (top / far, 0.5, top / far), (0.5, low / far, low / far)
    yield (RIGHT - 10, TOP + 5, RIGHT - 2, BOTTOM - 5), (top, top, low, low), (a, b, b, a)
    top = far * single(2.0) / single(3.0)
    corners = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.4, 0.3, 0.0), (1.0, 0.0, 0.0))
    yield (LEFT, TOP, RIGHT, BOTTOM), (top, top, far, far), corners


@cache
def _mesh():
    """The scene in the world: made while the depth buffer still has 16 bits, whatever the case's format."""
    view = default_view(65535.0)
    points, colors = [], []
    for box, depths, corners in _quads():
        for (x, y, _), z in zip(scenes.rectangle(*box), depths, strict=True):
            points.append(view.unprojected_at(x, y, z))
        colors.extend(corners)
    return Mesh(scenes.single(points), PrimitiveType.QUADS, colors=scenes.single(colors))


def _case(depth_format, depth, cut_off, shows):
    state = replace(
        scenes.DEFAULT,
        vertex=default_view(depth).vertex_state(),
        depth_test=DepthTest(ComparisonFunction.LESS),
        depth_clamp=DepthClamp(maximum=LIMIT, cull=True),
    )
    return Case(
        commands=(
            scenes.clear(0xFF000000, depth=cut_off / (2 ** abs(depth_format) - 1)),
            Draw(label="slopes", mesh=_mesh(), state=state),
        ),
        depth_bits=depth_format,
        shows=shows,
    )


CASES = dict(_cases())

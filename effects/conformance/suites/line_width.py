"""Line_width: every primitive, filled and as outlines, under every line width.

Source: src/tests/line_width_tests.cpp of nxdk_pgraph_tests. Widths are in 1/8 pixel. The register holds nine
bits; a wider value leaves the earlier width of one pixel.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes, shapes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PolygonMode

SUITE = "Line_width"

ONE, HIGHEST, MINUS_ONE = 8, 0x1FF, 0xFFFFFFFF
WIDTHS = sorted(
    {
        *range(0, 16),
        *range(3 * ONE, 16 * ONE, ONE),
        *range(16 * ONE, 57 * ONE, 8 * ONE),
        *range(57 * ONE, 65 * ONE, ONE),
        *range(63 * ONE, 65 * ONE),
    }
)
LEFT, TOP = 160.0, 48.0


def _name(mode, width):
    return f"{mode}_FFFFFFFF" if width == MINUS_ONE else f"{mode}_{width >> 3:04d}.{width & 7}"


def _case(mode, width):
    state = replace(
        scenes.DEFAULT,
        polygon=replace(scenes.FRONT_FACES, front_mode=mode, back_mode=mode),
        line=replace(scenes.RECTANGLES, width=(width if width <= HIGHEST else ONE) / 8),
    )
    draws = [
        Draw(label=shape[0].name, mesh=shapes.mesh(shape, LEFT, TOP), state=state) for shape in shapes.SHAPES
    ]
    return Case(commands=(scenes.clear(0xFF202224), *draws))


CASES = {_name("Line", width): partial(_case, PolygonMode.LINE, width) for width in (*WIDTHS, MINUS_ONE)} | {
    _name("Fill", width): partial(_case, PolygonMode.FILL, width) for width in (0, ONE, 32 * ONE)
}

"""ZPass_pixel_count: a quad, and points or lines of every size behind it and beside it.

The chip counts the pixels that pass. The program prints the counts; the pictures hold the pixels.

Source: src/tests/zpass_pixel_count_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import SHOWS, WIDTH, Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.state import DepthTest, PointState

SUITE = "ZPass_pixel_count"

# Eighths of a pixel. The register of a point's size holds nine bits, and a wider value leaves the size that
# was there before, the suite's one pixel.
POINT_SIZES = (0, 1, 4, 7, 8, 9, 15, 16, 64, 255, 256, 504, 505, 511, 512, 513)
LINE_WIDTHS = (0, 1, 4, 8, 15, 16, 64, 255, 504)
WIDEST, BEFORE = 511, 8
SIZE, LEFT, TOP, Z = 128.0, 32.0, 240.0, 0.0
PURPLE, WHITE = 0xFF773377, 0xFFFFFFFF  # colours are 0xAABBGGRR
FARTHEST = 65535.0
STATE = replace(scenes.DEFAULT, depth_test=DepthTest(ComparisonFunction.LESS))
FIXED = replace(STATE, vertex=scenes.xdk_vertex(depth_maximum=FARTHEST))


def _shapes(kind, eighths):
    """(label, color, device positions, primitive, state) of what lies on and beside the quad."""
    middle = TOP + SIZE / 2
    right = LEFT + 2 * SIZE
    if kind == "LineWidth":
        state = replace(FIXED, line=replace(scenes.RECTANGLES, width=eighths / 8))
        ends = [(x, middle, Z + 1.5) for x in (LEFT, LEFT + SIZE / 2, right, right + SIZE / 2)]
        return "lines", ends, PrimitiveType.LINES, state
    state = STATE if kind == "PointSizeVS" else FIXED
    state = replace(state, point=PointState(size=(eighths if eighths <= WIDEST else BEFORE) / 8))
    places = [(LEFT + SIZE / 2, middle, Z + 1.5), (right, middle, Z)]
    return "points", places, PrimitiveType.POINTS, state


def _draw(label, color, places, state, primitive=PrimitiveType.QUADS):
    """What the chip puts at device ``places`` (x, y, z): further by the viewport's offset, with the view's
    depth, unless a program passes them on.
    """
    colors = scenes.single([scenes.abgr(color)] * len(places))
    if state.vertex == scenes.PROGRAM_RESULTS:
        mesh = scenes.window_mesh(places, primitive, colors=colors)
    else:
        points = scenes.single([scenes.unprojected(*place) for place in places])
        mesh = Mesh(points, primitive, colors=colors)
    return Draw(label=label, mesh=mesh, state=state)


def _quads():
    """The quads of the case ZPass: one, one behind it, one beside it, two partly beyond the right edge."""
    edge = WIDTH - SIZE / 2
    for label, color, left, top, z in (
        ("in front", PURPLE, LEFT, TOP, Z),
        ("behind it", 0xFFFF0000, LEFT, TOP, Z + 1.0),
        ("beside it", 0xFF777733, LEFT + 1.5 * SIZE, TOP, Z),
        ("at the edge", 0xFFE0E0E0, edge, TOP, Z),
        ("in front of the edge", 0xFF33CC33, edge, TOP - SIZE / 2, Z - 0.1),
    ):
        yield _draw(label, color, scenes.rectangle(left, top, left + SIZE, top + SIZE, z), FIXED)


def _sized(kind, eighths):
    label, places, primitive, state = _shapes(kind, eighths)
    corners = scenes.rectangle(LEFT, TOP, LEFT + SIZE, TOP + SIZE, Z)
    plain = replace(state, line=scenes.RECTANGLES, point=PointState())
    yield _draw("quad", PURPLE, corners, plain)
    yield _draw(label, WHITE, places, state, primitive)


def _cases():
    """Name and (what draws, kind, size in eighths of a pixel)."""
    for kind, sizes in (("PointSize", POINT_SIZES), ("PointSizeVS", POINT_SIZES), ("LineWidth", LINE_WIDTHS)):
        for eighths in sizes:
            yield f"ZPass{kind}-0x{eighths:04X}", (_sized, kind, eighths)


def _case(shows, draws, *given):
    return Case(commands=(scenes.clear(0xFF333333), *draws(*given)), depth_bits=16, shows=shows)


CASES = {
    name + zeta: partial(_case, shows, *given)
    for name, given in (("ZPass", (_quads,)), *_cases())
    for zeta, shows in SHOWS.items()
}

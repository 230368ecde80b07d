"""Clears, depths, clipping, stencil, viewports, points and which pixels a triangle has. Source: WineHQ, wine,
dlls/d3d8/tests/visual.c, clear_test, z_range_test, test_filling_convention, test_pointsize,
test_edge_antialiasing_blending, depth_buffer_test and depth_buffer2_test; dlls/d3d9/tests/visual.c,
depth_clamp_test, clip_planes_test, stencil_cull_test, test_viewport and test_depthbias.
"""

import pytest

from fixedpipe.pipeline import Blending, ColorMask, DepthTest, Scissor, StencilTest, VertexState
from fixedpipe.pipeline.commands import Clear, MakeCurrent, Mesh
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    Face,
    FrontFace,
    PrimitiveType,
    StencilOperation,
)
from fixedpipe.pipeline.state import DepthClamp, PointParameters, PointState, PolygonState, Viewport
from tests.foreign.comparison import (
    MACHINES,
    Case,
    assert_drawn,
    assert_held,
    on_machines,
    pixels,
)
from tests.foreign.direct3d import QUAD, argb, clear, draw, strip, transformed, vertex_state

FULL = 640, 480
SMALL = 64, 48
FLAT = [[-1, -1, 0], [-1, 1, 0], [1, -1, 0], [1, 1, 0]]
LESS, GREATER = ComparisonFunction.LESS, ComparisonFunction.GREATER
ALONE = VertexState()  # of transformed vertices


def rectangle(x0, y0, x1, y1, z, color):
    """A rectangle of transformed vertices."""
    return strip(transformed([(x, y, z, 1) for y in (y0, y1) for x in (x0, x1)], FULL), color)


CLEARS = (
    Case("a clear", (clear(0xFF00DDEE),), pixels([(63, 47, 0x00DDEE, 0), (1, 1, 0x00DDEE, 0)]), SMALL),
    Case(
        "a clear of a rectangle",
        (
            clear(0xFFFFFFFF),
            Clear(label="clear", color=argb(0xFFFF0000), scissor=Scissor(0, 24, 32, 24)),
        ),
        pixels([(16, 36, 0xFFFFFF, 0), (16, 12, 0xFF0000, 0), (48, 36, 0xFFFFFF, 0), (48, 12, 0xFFFFFF, 0)]),
        SMALL,
    ),
)

# z_range_test: z from 1.1 at the left to -1.1 at the right, beside 0.75 in the buffer.
SLOPE = [[-1, 0, 1.1], [-1, 1, 1.1], [1, 0, -1.1], [1, 1, -1.1]]
FALLING = transformed([(640, 240, -1.1, 1), (640, 480, -1.1, 1), (0, 240, 1.1, 1), (0, 480, 1.1, 1)], FULL)


def depth_tested(function, mesh, **state):
    return draw(mesh, FULL, depth_test=DepthTest(function, write=False), **state)


def across(y, *colors):
    return pixels([(x, y, color, 0) for x, color in zip((28, 31, 100, 104, 318, 321), colors, strict=True)])


RED, BLUE, GREEN, YELLOW, WHITE = 0xFF0000, 0x0000FF, 0x00FF00, 0xFFFF00, 0xFFFFFF
DEPTHS = (
    Case(
        "depths beyond 0 and 1 are clipped",
        (
            clear(0xFFFFFFFF, 0.75),
            depth_tested(GREATER, strip(SLOPE, 0xFFFF0000)),
            depth_tested(LESS, strip(SLOPE, 0xFF0000FF)),
        ),
        across(238, WHITE, RED, RED, BLUE, BLUE, WHITE),
        FULL,
    ),
    Case(
        "depths of transformed vertices are clipped",
        (
            clear(0xFFFFFFFF, 0.75),
            depth_tested(LESS, strip(FALLING, 0xFF00FF00), vertex=ALONE),
            depth_tested(GREATER, strip(FALLING, 0xFFFFFF00), vertex=ALONE),
        ),
        across(241, WHITE, YELLOW, YELLOW, GREEN, GREEN, WHITE),
        FULL,
    ),
    Case(
        "depths of transformed vertices, not clipped",
        (
            clear(0xFFFFFFFF, 0.75),
            depth_tested(LESS, strip(FALLING, 0xFF00FF00), vertex=ALONE, depth_clamp=DepthClamp()),
            depth_tested(GREATER, strip(FALLING, 0xFFFFFF00), vertex=ALONE, depth_clamp=DepthClamp()),
        ),
        across(241, YELLOW, YELLOW, YELLOW, GREEN, GREEN, GREEN),
        FULL,
    ),
)

# depth_clamp_test: rectangles at depths of 5 and 10.
AT_MOST = DepthTest(ComparisonFunction.LEQUAL)
FAR = (
    (0, 0, 640, 480, 5.0, 0xFF002B7F),
    (0, 300, 640, 360, 10.0, 0xFFF9E814),
    (112, 108, 208, 204, 5.0, 0xFFFFFFFF),
    (42, 41, 112, 108, 10.0, 0xFFFFFFFF),
)
CLAMPED = Case(
    "depths of 5 and 10 are 1",
    (
        clear(0xFF00FF00, 1.0),
        *[
            draw(rectangle(*each), FULL, vertex=ALONE, depth_test=AT_MOST, depth_clamp=DepthClamp())
            for each in FAR
        ],
        *[
            draw(strip([[x, y, 10] for y in ys for x in (-half, half)], color), FULL, depth_test=AT_MOST)
            for half, ys, color in ((0.5, (0.5, -0.5), 0xFF14F914), (1, (0.5, 0.25), 0xFFF91414))
        ],
    ),
    pixels([(75, 75, WHITE, 1), (150, 150, WHITE, 1), (320, 240, 0x002B7F, 1), (320, 330, 0xF9E814, 1)]),
    FULL,
)

# depth_buffer_test and depth_buffer2_test: SetRenderTarget keeps the window's depth surface.
TARGETS = ("GEFORCE_3", "NV2A")
BACK = MakeCurrent(label="SetRenderTarget")


def render_target(name, width, height):
    """SetRenderTarget of one with the window's depth surface."""
    size = {"width": width, "height": height}
    return MakeCurrent(label="SetRenderTarget", surface=name, shares_depth=True, **size)


def nearest(z, color, size, write=True):
    return draw(
        strip([[x, y, z] for y in (1, -1) for x in (-1, 1)], color),
        size,
        depth_test=DepthTest(ComparisonFunction.LEQUAL, write=write),
    )


def quarters(rows):
    """The colours of 4x4 places, from the top."""
    return pixels(
        [(80 * (2 * j + 1), 60 * (2 * i + 1), c, 0) for i, row in enumerate(rows) for j, c in enumerate(row)]
    )


SHARED = (
    Case(
        "targets of three sizes draw into one depth surface",
        (
            render_target("third", 640, 480),
            clear(0xFF0000FF, 0.0),
            BACK,
            clear(0xFF0000FF, 1.0),
            render_target("first", 320, 240),
            clear(0xFFFFFFFF, 0.0),
            render_target("second", 480, 360),
            nearest(0.50, 0xFFFF00FF, (480, 360)),
            BACK,
            nearest(0.33, 0xFF00FF00, FULL, write=False),
            nearest(0.66, 0xFFFF0000, FULL, write=False),
        ),
        quarters([[BLUE, BLUE, GREEN, RED], [BLUE, BLUE, GREEN, RED], [GREEN, GREEN, GREEN, RED], [RED] * 4]),
        FULL,
        TARGETS,
    ),
    Case(
        "a clear of a smaller target clears a part of the depth surface",
        (
            render_target("first", 640, 480),
            clear(0xFF0000FF, 1.0),
            BACK,
            clear(0xFF00FF00, 0.5),
            render_target("second", 480, 360),
            clear(0xFFFFFFFF, 0.0),
            BACK,
            nearest(0.66, 0xFFFF0000, FULL, write=False),
        ),
        quarters([[GREEN] * 4] * 4),
        FULL,
        TARGETS,
    ),
)

CLIPPED = Case(
    "a user clip plane a quarter of a pixel below the middle",
    (
        clear(0xFFFFFFFF),
        draw(strip(FLAT, 0xFFF9E814), FULL),
        draw(
            strip(FLAT, 0xFF002B7F),
            FULL,
            vertex=vertex_state(FULL, clip_planes=((0.0, 1.0, 0.0, 0.5 / 480),)),
        ),
    ),
    pixels([(x, y, color, 1) for x in (1, 638) for y, color in ((240, 0x002B7F), (241, 0xF9E814))]),
    FULL,
)

# stencil_cull_test: counts of clockwise and of counter-clockwise triangles, each by a Draw of its own.
OPERATION = StencilOperation
OF_CLOCKWISE = StencilTest(
    reference=3, fail=OPERATION.INCR, depth_fail=OPERATION.DECR, depth_pass=OPERATION.REPLACE
)
OF_OTHERS = StencilTest(
    reference=3, fail=OPERATION.REPLACE, depth_fail=OPERATION.DECR, depth_pass=OPERATION.INCR
)
TRIANGLES = (0, 1, 3), (0, 2, 3)


def counted(x, y, indices, test, culled):
    corners = [[x, y, 0.1], [x + 1, y, 0.1], [x, y + 1, 0.1], [x + 1, y + 1, 0.1]]
    return draw(
        Mesh(corners, indices=indices),
        SMALL,
        stencil_test=test,
        color_mask=ColorMask(False, False, False, False),
        polygon=PolygonState(cull_face=culled, front_face=FrontFace.CW),
    )


def two_sided(x, y, culled=None):
    for indices in TRIANGLES:
        if culled != Face.FRONT:
            yield counted(x, y, indices, OF_CLOCKWISE, Face.BACK)
        if culled != Face.BACK:
            yield counted(x, y, indices, OF_OTHERS, Face.FRONT)


def shown():
    """Every count as a blue of its own."""
    for value in range(16):
        test = StencilTest(function=ComparisonFunction.EQUAL, reference=value)
        yield draw(strip(FLAT, value * 16), SMALL, stencil_test=test)


COUNTED = {
    **{(16, 42): 0x30, (16, 30): 0x80, (48, 42): 0x90, (48, 30): 0x30},
    **{(16, 18): 0x80, (16, 6): 0x30, (48, 18): 0x90, (48, 6): 0x80},
}
STENCIL = Case(
    "stencil counts by facing",
    (
        clear(0x00FF0000, stencil=8),
        *[counted(-1, -1, indices, OF_CLOCKWISE, Face.FRONT) for indices in TRIANGLES],
        *two_sided(0, -1),
        *two_sided(0, 0, Face.FRONT),
        *two_sided(-1, 0, Face.BACK),
        *shown(),
    ),
    pixels([(*place, color, 0) for place, color in COUNTED.items()]),
    SMALL,
)


def referenced(name, reference):
    replaces = StencilTest(
        reference=reference,
        mask=0,
        fail=OPERATION.REPLACE,
        depth_fail=OPERATION.REPLACE,
        depth_pass=OPERATION.REPLACE,
    )
    less = StencilTest(function=LESS, reference=0xDB, mask=0x0F)
    corners = [[-1, -1, 0.1], [0, -1, 0.1], [-1, 0, 0.1], [0, 0, 0.1]]
    frame = (
        clear(0x00FF0000, stencil=0),
        draw(Mesh(corners, indices=(0, 1, 3)), SMALL, stencil_test=replaces),
        clear(0x00FF0000),
        draw(strip(FLAT, 0xF0), SMALL, stencil_test=less),
    )
    return Case(name, frame, pixels([(28, 36, 0xF0, 0)]), SMALL)


# test_viewport: x, y from the top, width and height, and the first and last pixels inside.
VIEWPORTS = (
    ((0, 0, 640, 480), (0, 120, 479, 359)),
    ((0, 0, 320, 240), (0, 60, 239, 179)),
    ((0, 0, 1280, 960), (0, 240, 639, 479)),
    ((0, 0, 2000, 1600), (0, 400, 639, 479)),
    ((100, 100, 640, 480), (100, 220, 579, 459)),
)


def viewport(place, inside, function):
    """A quad whose depth is 0.001, beside a depth a little nearer, or farther."""
    x, y, width, height = place
    vertex = vertex_state((width, height), viewport=Viewport(x, 480 - y - height, width, height, 0.0, 0.001))
    mesh = strip([[-1.5, -0.5, 1], [-1.5, 0.5, 1], [0.5, -0.5, 1], [0.5, 0.5, 1]])
    left, top, right, bottom = inside
    wanted = [(across, down, WHITE, 0) for across in (left, right) for down in (top, bottom)]
    wanted += [
        (across, down, 0, 0)
        for across, down in ((left - 1, top), (right + 1, top), (left, top - 1), (left, bottom + 1))
        if 0 <= across < 640 and 0 <= down < 480
    ]
    depth = 0.0009 if function == GREATER else 0.0011
    frame = clear(0xFF000000, depth), draw(mesh, FULL, vertex=vertex, depth_test=DepthTest(function))
    return Case(f"viewport {place}, {function.name}", frame, pixels(wanted), FULL)


# test_filling_convention: four triangles around a point; which pixels each has, in a window of eight.
LEFT, TOP, RIGHT, BOTTOM = 0xFFFF0000, 0xFF00FF00, 0xFF000000, 0xFFFFFF00
LETTERS = {"L": LEFT, "T": TOP, "R": RIGHT, "B": BOTTOM, " ": 0xFF}
ON_EDGES = " /  TT    /  LT    /  LR    /  LB    / / / "
NUDGE = 1 / 64
# By name: where the point is, in pixels; a nudge in clip coordinates; the rows of the picture.
FILLED = {
    "around a centre": ((-1.5, 0.5), (0, 0), "  /  /  TT    /  LR    /  LR    /  BB    / / "),
    "edges through centres": ((-1, 1), (0, 0), ON_EDGES),
    "nudged right": ((-1, 1), (NUDGE, 0), " /   TT   /   TR   /   LR   /   BR   / / / "),
    "nudged left": ((-1, 1), (-NUDGE, 0), ON_EDGES),
    "nudged up": ((-1, 1), (0, NUDGE), " /  LT    /  LT    /  LB    /  LB    / / / "),
    "nudged down": ((-1, 1), (0, -NUDGE), " / /  LT    /  LT    /  LB    /  LB    / / "),
}
EIGHT = 8, 8


def star(x, y, up):
    """Corners of the four triangles around (x, y), and their colours; ``up``: 1 where y is."""
    a, b, c = (x - 1, y - 2 * up), (x - 1, y + 2 * up), (x, y)
    d, e = (x + 1, y + 2 * up), (x + 1, y - 2 * up)
    triangles = ((a, b, c), LEFT), ((c, b, d), TOP), ((e, c, d), RIGHT), ((a, c, e), BOTTOM)
    return [p for corners, _ in triangles for p in corners], [argb(k) for _, k in triangles for _ in range(3)]


def picture_of(pattern):
    rows = [row.ljust(8) for row in pattern.split("/")]
    return pixels([(x, y, LETTERS[rows[y][x]] & WHITE, 1) for y in range(8) for x in range(8)])


def filled(name):
    middle, (right, up), pattern = FILLED[name]
    corners, colors = star(*middle, 1)
    mesh = Mesh([[x / 4 + right, y / 4 + up, 0] for x, y in corners], colors=colors)
    return Case(f"filled, {name}", (clear(0xFF), draw(mesh, EIGHT)), picture_of(pattern), EIGHT)


def filled_transformed(name, x, y):
    corners, colors = star(x, y, -1)
    mesh = Mesh(transformed([(*corner, 0, 1) for corner in corners], EIGHT), colors=colors)
    frame = clear(0xFF), draw(mesh, EIGHT, vertex=ALONE)
    return Case(f"filled, transformed, {name}", frame, picture_of(FILLED[name][2]), EIGHT)


# test_pointsize: a point's middle, its size, and how many pixels it reaches from the middle.
TO_PIXELS = [[2 / 640, 0, 0, 0], [0, -2 / 480, 0, 0], [0, 0, 1, 0], [-1, 1, 0, 1]]
POINTS = ((64, 15.0, 7), (128, 31.0, 15), (192, 30.75, 15), (256, 63.0, 31), (384, 62.75, 31), (320, 1.0, 0))


def point(name, x, state, reach):
    mesh = Mesh([[x, 64, 0.1]], PrimitiveType.POINTS)
    drawn = draw(mesh, FULL, vertex=vertex_state(FULL, projection=TO_PIXELS), point=state)
    wanted = [
        (x + across * (reach + more), 64 + down * (reach + more), color, 0)
        for across in (-1, 1)
        for down in (-1, 1)
        for more, color in ((0, WHITE), (1, BLUE))
    ]
    return Case(name, (clear(0xFF), drawn), pixels(wanted), FULL)


# test_depthbias: z from 0 to 1 beside 0.5 in the buffer, with biases as parts of the depth range.
RISING = [[-1, -1, 0], [-1, 1, 0], [1, -1, 1], [1, 1, 1]]
BIASES = ((0xFFFF0000, -0.2), (0xFF00FF00, 0.0), (0xFF0000FF, 0.2), (0xFFFFFFFF, 0.4))
BIASED = (
    *((61, WHITE), (65, BLUE), (190, BLUE), (194, GREEN)),
    *((318, GREEN), (322, RED), (446, RED), (450, 0)),
)


def biased(bits):
    frame = [clear(0, 0.5)]
    for color, bias in BIASES:
        polygon = PolygonState(offset_fill=True, offset_units=bias * 2**bits)
        depth_test = DepthTest(ComparisonFunction.LEQUAL, write=False)
        frame.append(draw(strip(RISING, color), (640, 4), depth_test=depth_test, polygon=polygon))
    wanted = pixels([(x, 2, color, 1) for x, color in BIASED])
    # The ideal's depth has no bits of which a bias could be a number.
    machines = [machine for machine in MACHINES if machine != "IDEAL"]
    return Case(f"depth bias, {bits} bits", tuple(frame), wanted, (640, 4), machines, bits)


# test_edge_antialiasing_blending: source and destination by their alphas, or no blending.
BLENDING = Blending(BlendFactor.SRC_ALPHA, BlendFactor.DST_ALPHA)
GREEN_HALF, RED_MOST = 0x7F00FF00, 0xCCFF0000
SMOOTHED = (
    (GREEN_HALF, RED_MOST, BLENDING, False, 0xCC7F00),
    (RED_MOST, GREEN_HALF, BLENDING, False, 0xCC7F00),
    (GREEN_HALF, RED_MOST, None, False, 0x00FF00),
    (RED_MOST, GREEN_HALF, None, False, 0xFF0000),
    (GREEN_HALF, RED_MOST, None, True, 0x00FF00),
    (RED_MOST, GREEN_HALF, None, True, 0xFF0000),
)


def smoothed(color, below, blending, smooth, wanted):
    drawn = draw(strip(QUAD, color), SMALL, blending=blending, polygon=PolygonState(smooth=smooth))
    kind = "smooth" if smooth else "blended" if blending else "plain"
    return Case(
        f"{color:08x} over {below:08x}, {kind}", (clear(below), drawn), pixels([(32, 24, wanted, 1)]), SMALL
    )


MOVED = [viewport(*VIEWPORTS[-1], function) for function in (GREATER, LESS)]
CASES = (
    *CLEARS,
    *DEPTHS,
    *SHARED,
    CLAMPED,
    CLIPPED,
    STENCIL,
    referenced("a stencil reference of 1cc is cc", 0x1CC),
    referenced("a stencil reference of cc", 0xCC),
    *[viewport(*each, function) for each in VIEWPORTS[:-1] for function in (GREATER, LESS)],
    *MOVED,
    *map(filled, FILLED),
    filled_transformed("around a centre", 2.5, 3.5),
    filled_transformed("edges through centres", 3, 3),
    *[point(f"point of size {size}", x, PointState(size=size), reach) for x, size, reach in POINTS],
    point("point of size 1, at least 15", 512, PointState(1.0, parameters=PointParameters(minimum=15.0)), 7),
    biased(24),
    biased(16),
    *[smoothed(*each) for each in SMOOTHED],
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES))
def test_the_window_is_what_wine_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=34)

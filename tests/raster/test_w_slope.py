"""The slope of W buffering's polygon offset: the kernel and the columns against the specification."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import Vertices
from fixedpipe.raster.columns.w_slope import w_slope as columns_w_slope
from fixedpipe.raster.portable.w_slope import w_slope as kernel_w_slope
from tests.reference import coverage, depth
from tests.reference.w_slope import slope

BOX = (3, 2, 41, 33)  # the scissor's, device pixels


def slopes(points, w, box=BOX):
    """(the kernel's, the columns', the specification's) of one triangle; points: 1/16 pixel."""
    x, y = np.array(points, np.int32).T
    singles = [depth.single(v) for v in w]
    inverse_w = 1.0 / np.array(singles)
    draw = np.zeros(R.DRAW_SIZE, np.int64)
    draw[[R.X0, R.Y0, R.X1, R.Y1]] = box
    colors, coordinates = np.zeros((3, 2, 8), np.uint8), np.zeros((3, 0, 4))
    vertices = Vertices(x.copy(), y.copy(), np.array(singles), inverse_w, colors, coordinates)
    triangle = coverage.make_triangle(*points, tuple(v < 0 for v in w))
    return (
        kernel_w_slope(draw, vertices, 0, 1, 2),
        columns_w_slope(x.astype(np.int64), y.astype(np.int64), np.array(singles), inverse_w, box, 4),
        slope(triangle, singles, inverse_w.tolist(), range(box[0], box[2]), range(box[1], box[3])),
    )


places = st.tuples(st.integers(-300, 900), st.integers(-300, 900))
grid = st.tuples(st.integers(-4, 44).map(lambda k: 16 * k + 8), st.integers(-4, 40).map(lambda k: 16 * k + 8))


@given(
    points=st.lists(places, min_size=3, max_size=3) | st.lists(grid, min_size=3, max_size=3),
    logarithms=st.lists(st.floats(-3.0, 12.0), min_size=3, max_size=3),
    alike=st.booleans(),
    behind=st.sampled_from([(), (), (), (0,), (1, 2), (0, 1, 2)]),
    box=st.sampled_from([BOX, (0, 0, 40, 32), (0, 0, 3, 3), (5, 5, 5, 9)]),
)
def test_slopes_of_w_equal_the_specification(points, logarithms, alike, behind, box):
    w = [2.0**k for k in logarithms]
    if alike:
        w[2] = w[0]
    for i in behind:
        w[i] = -w[i]
    kernel, columns, expected = slopes(points, w, box)
    assert kernel == expected
    assert columns == expected


FAR, NEAR = 325.8057861328125, 58.379993440  # w of W_buffering's floor and wall
FLOOR = [(851, -549), (9388, -549), (28939, 7248)], (FAR, FAR, NEAR)
FLOOR_1 = [(851, -549), (28939, 7248), (-18699, 7248)], (FAR, NEAR, NEAR)
WALL = [(10197, -429), (10197, 8108), (2400, 27659)], (FAR, FAR, NEAR)
WALL_1 = [(10197, -429), (2400, 27659), (2400, -19979)], (FAR, NEAR, NEAR)
TALL = [(2568, 8), (5760, 8), (2568, 168)], (325.0, 58.0, 325.0)  # its TriV and TriH
TALL_1 = [(2584, 328), (5776, 328), (2584, 488)], (325.0, 58.0, 325.0)
WIDE = [(2568, 8), (2728, 8), (2568, 3200)], (325.0, 325.0, 58.0)
WIDE_1 = [(2888, 24), (3048, 24), (2888, 3216)], (325.0, 325.0, 58.0)


@pytest.mark.parametrize(
    ("triangle", "corner", "low", "high"),
    [  # what all depths of a triangle leave for the offset, whose factor is 65536 (WBuf24D captures)
        (FLOOR, (150, 0), 113137.28661, 113137.29906),
        (FLOOR_1, (150, 0), 113136.77203, 113136.77448),
        (FLOOR, (150, 32), 75289.2175, 75289.23508),
        (FLOOR_1, (150, 32), 73585.95741, 73585.96188),
        (WALL, (150, 0), 199541.0145, 199541.02771),
        (WALL_1, (261, 0), 9748.96189, 9748.96637),
        # Of which both weights change: along x vertex 0's lower row, vertex 2's upper one, the lower block.
        (TALL, (150, 0), 403283.155156, 403283.156599),
        (TALL_1, (150, 0), 421475.652272, 421475.668919),
        # Vertex 2's right column (WBuf24F).
        (WIDE, (150, 0), 439380.432519, 439380.516078),
        (WIDE_1, (150, 0), 459200.405962, 459200.413565),
    ],
    ids=[
        *("floor 0", "floor 1", "clipped floor 0", "clipped floor 1", "wall 0", "clipped wall 1"),
        *("tall 0", "tall 1", "wide 0", "wide 1"),
    ],
)
def test_slopes_of_w_lie_where_the_captures_leave_room(triangle, corner, low, high):
    for found in slopes(*triangle, (*corner, 640, 480)):
        assert low < 65536.0 * found < high

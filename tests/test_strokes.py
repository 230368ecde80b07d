"""Points, lines and outlines: which pixels they draw, in which order, and what never becomes one."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.assembly import boundary_edges
from pipeline.commands import Draw, Mesh
from pipeline.enums import (
    Face,
    FrontFace,
    LineRasterization,
    PolygonMode,
    PrimitiveType,
    ProvokingVertex,
    VertexStage,
)
from pipeline.execute import execute
from pipeline.profiles import GEFORCE_256
from pipeline.state import (
    LineState,
    PassState,
    PointState,
    PolygonState,
    Scissor,
    VertexState,
    WindowClip,
)
from pipeline.vertex import process

WIDTH, HEIGHT = 16, 8
PROGRAMMED = PassState(vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS))
RECTANGLE, STEPS = LineRasterization.RECTANGLE, LineRasterization.STEPS
OUTLINES = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)


def pixels(vertices, primitive, state=PROGRAMMED, **arrays):
    """Every fragment's (primitive, x, y), device rows, of vertices in device pixels."""
    positions = np.array(vertices, float)
    positions[:, 1] = HEIGHT - positions[:, 1]
    draw = Draw(label="d", mesh=Mesh(positions, primitive, **arrays), state=state)
    (found,) = execute((draw,), GEFORCE_256, WIDTH, HEIGHT, record=True).records
    return list(zip(found.triangle.tolist(), found.x.tolist(), found.y.tolist(), strict=True))


def line(a, b, width, rasterization):
    state = replace(PROGRAMMED, line=LineState(width, rasterization))
    return {(x, y) for _, x, y in pixels([a, b], PrimitiveType.LINES, state)}


def point(at, size):
    state = replace(PROGRAMMED, point=PointState(size=size))
    return {(x, y) for _, x, y in pixels([at], PrimitiveType.POINTS, state)}


def box(left, top, right, bottom):
    return {(x, y) for x in range(left, right) for y in range(top, bottom)}


def test_a_line_between_two_columns_draws_the_right_one_between_two_rows_the_upper():
    for ends in (((4, 1), (4, 6)), ((4, 6), (4, 1))):
        assert line(*ends, 1.0, RECTANGLE) == box(4, 1, 5, 6)
        assert line(*ends, 3.0, RECTANGLE) == box(3, 1, 6, 6)
    assert line((2, 4), (9, 4), 1.0, RECTANGLE) == box(2, 3, 9, 4)


def test_a_wide_slanted_line_takes_the_larger_and_half_the_smaller_step_for_its_length():
    # 3:4:5, 4 + 3/2 = 5.5: the line is 1.1 times as wide as it says.
    (exact, wider) = (line((2.5, 1.5), (5.5, 5.5), width, RECTANGLE) for width in (1.0, 1.2))
    assert exact < wider
    assert line((2, 2), (10, 2.0625), 0.0, RECTANGLE) == set()


def test_a_stepped_line_draws_one_pixel_a_step_without_the_last():
    assert line((2.7, 3.5), (7.2, 3.5), 1.0, STEPS) == box(2, 3, 7, 4)
    assert line((7.2, 3.5), (2.7, 3.5), 1.0, STEPS) == box(3, 3, 8, 4)
    diagonal = line((1.5, 1.5), (5.5, 5.5), 1.0, STEPS)
    assert diagonal == {(k, k) for k in range(1, 5)}


@pytest.mark.parametrize(
    ("at", "size", "expected"),
    [
        ((4.0, 4.0), 1.0, box(3, 3, 4, 4)),  # a power of two: the left and upper side only
        ((4.0, 4.0), 3.0, box(2, 2, 6, 6)),  # else all sides
        ((4.5, 4.5), 2.0, box(3, 3, 5, 5)),
        ((4.5, 4.5), 6.0, box(1, 1, 8, 8)),
        ((4.5, 4.5), 0.0, box(4, 4, 5, 5)),
    ],
)
def test_points_as_the_chip_draws_them(at, size, expected):
    assert point(at, size) == expected


@pytest.mark.parametrize(
    ("primitive", "count", "edges"),
    [
        (PrimitiveType.TRIANGLES, 3, [7]),
        (PrimitiveType.TRIANGLE_STRIP, 4, [7, 7]),
        (PrimitiveType.QUADS, 4, [1 | 4, 1 | 2]),
        (PrimitiveType.QUAD_STRIP, 6, [2 | 4, 1 | 2, 2 | 4, 1 | 2]),
        (PrimitiveType.POLYGON, 5, [1 | 4, 1, 1 | 2]),
        (PrimitiveType.POLYGON, 3, [7]),
    ],
)
def test_edges_inside_a_primitive_are_no_boundary(primitive, count, edges):
    assert boundary_edges(Mesh(np.zeros((count, 3)), primitive)).tolist() == edges


def test_an_edge_whose_first_vertex_has_no_flag_is_left_out():
    flags = [True, False, True, True]
    mesh = Mesh(np.zeros((4, 3)), PrimitiveType.QUADS, edge_flags=flags)
    assert boundary_edges(mesh).tolist() == [4, 1 | 2]
    strip = Mesh(np.zeros((4, 3)), PrimitiveType.TRIANGLE_STRIP, edge_flags=flags)
    assert boundary_edges(strip).tolist() == [7, 7]


def test_outlines_come_in_the_chips_order_and_are_culled_by_their_polygon():
    clockwise = [(2.0, 1.0), (12.0, 1.0), (12.0, 7.0)]
    mesh = Mesh(np.array(clockwise) * (1, -1) + (0, HEIGHT), PrimitiveType.TRIANGLES)
    rows = process(mesh, replace(PROGRAMMED, polygon=OUTLINES), GEFORCE_256, WIDTH, HEIGHT).triangles
    assert rows[:, [1, 0]].tolist() == [[1, 2], [2, 0], [0, 1]]  # first and second vertex of each line
    for culled, drawn in ((Face.BACK, False), (Face.FRONT, True), (Face.FRONT_AND_BACK, False)):
        state = replace(PROGRAMMED, polygon=replace(OUTLINES, cull_face=culled))
        assert bool(pixels(clockwise, PrimitiveType.TRIANGLES, state)) == drawn


@pytest.mark.parametrize("front_face", FrontFace)
def test_a_triangle_without_area_faces_as_a_counter_clockwise_one(front_face):
    polygon = replace(OUTLINES, cull_face=Face.BACK, front_face=front_face)
    flat = [(4.0, 1.0), (4.0, 4.0), (4.0, 7.0)]
    drawn = bool(pixels(flat, PrimitiveType.TRIANGLES, replace(PROGRAMMED, polygon=polygon)))
    assert drawn == (front_face == FrontFace.CCW)


def test_a_line_is_clipped_at_the_near_plane_and_a_point_beyond_it_is_discarded():
    through = [[-1.0, 0.0, 0.0, 1.0], [1.0, 0.0, -2.0, 1.0]]
    got = process(Mesh(through, PrimitiveType.LINES), PassState(), GEFORCE_256, WIDTH, HEIGHT)
    b, a = got.triangles[0, :2]
    assert (got.x[a], got.x[b], got.z[b]) == (0, WIDTH * 8, 0.0)  # half of the way
    points = process(Mesh(through, PrimitiveType.POINTS), PassState(), GEFORCE_256, WIDTH, HEIGHT)
    assert len(points.triangles) == 1


def test_the_provoking_vertex_of_a_line_is_its_last_or_its_first():
    mesh = Mesh(np.zeros((4, 3)), PrimitiveType.LINE_LOOP)
    for provoking, column in ((ProvokingVertex.LAST, 0), (ProvokingVertex.FIRST, 1)):
        state = PassState(polygon=PolygonState(provoking_vertex=provoking))
        rows = process(mesh, state, GEFORCE_256, WIDTH, HEIGHT).triangles
        assert rows[:, 1].tolist() == [0, 1, 2, 3]
        assert rows[:, 0].tolist() == [1, 2, 3, 0]
        assert (rows[:, 3] == rows[:, column]).all()


def test_stipple_counts_rows_from_the_bottom_and_spares_lines():
    lowest_row = b"\xa0\x00\x00\x00" + bytes(124)
    state = replace(PROGRAMMED, polygon=PolygonState(stipple=lowest_row))
    quad = [(0.0, 0.0), (16.0, 0.0), (16.0, 8.0), (0.0, 8.0)]
    assert {(x, y) for _, x, y in pixels(quad, PrimitiveType.QUADS, state)} == {(0, 7), (2, 7)}
    stippled = replace(
        state, polygon=replace(state.polygon, front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
    )
    plain = replace(PROGRAMMED, polygon=OUTLINES)
    assert pixels(quad, PrimitiveType.QUADS, stippled) == pixels(quad, PrimitiveType.QUADS, plain)


@pytest.mark.parametrize("exclusive", [False, True])
def test_window_clip_keeps_what_is_in_any_rectangle_or_in_none(exclusive):
    clip = WindowClip((Scissor(1, 1, 3, 2), Scissor(3, 2, 9, 9), Scissor(5, 5, 0, 1)), exclusive)
    machine = replace(GEFORCE_256, max_window_rectangles=8)
    mesh = Mesh([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    draw = Draw(label="d", mesh=mesh, state=PassState(window_clip=clip))
    (found,) = execute((draw,), machine, WIDTH, HEIGHT, record=True).records
    inside = box(1, 5, 4, 7) | box(3, 0, 12, 6)
    expected = box(0, 0, WIDTH, HEIGHT) - inside if exclusive else inside
    assert set(zip(found.x.tolist(), found.y.tolist(), strict=True)) == expected

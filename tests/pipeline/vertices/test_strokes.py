"""Points, lines and outlines: which pixels they draw, in which order, and what never becomes one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import (
    Face,
    FrontFace,
    LineRasterization,
    PolygonMode,
    PrimitiveType,
    ProvokingVertex,
    VertexStage,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import (
    LineState,
    PassState,
    PointState,
    PolygonState,
    Scissor,
    VertexState,
    WindowClip,
)
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.pipeline.vertices.assembly import boundary_edges, split_lines
from fixedpipe.pipeline.vertices.clip import VIEW_VOLUME_SIDES, clip_lines
from fixedpipe.pipeline.vertices.stage import process
from fixedpipe.pipeline.vertices.strokes import with_squares
from tests.reference import strokes

WIDTH, HEIGHT = 16, 8
PLAIN = PassState()
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


@pytest.mark.parametrize(("width", "half"), [(63.875, 32), (63.125, 32), (62.0, 31)])
def test_a_wide_line_ends_at_the_box_around_its_ends_pixels(width, half):
    """Measured: Line_width, a line of its loop, whose rectangle has a corner at x = 387.6."""
    positions = np.array([(354.0, 480 - 67.0), (342.0, 480 - 145.0)])
    state = replace(PROGRAMMED, line=LineState(width, RECTANGLE))
    draw = Draw(label="d", mesh=Mesh(positions, PrimitiveType.LINES), state=state)
    (found,) = execute((draw,), NV2A, 640, 480, record=True).records
    assert found.x.max() == 354 + half


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
        ((4.0, 4.0), 0.0, box(4, 4, 5, 5)),  # the pixel that it lies in (Point_size PointSmoothOff_01_VS)
        ((4.0, 4.0), 0.125, set()),
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
    through_infinity = [(x, y, 0.0, w) for (x, y), w in zip(flat, (1.0, 1.0, -1.0), strict=True)]
    turned = bool(pixels(through_infinity, PrimitiveType.TRIANGLES, replace(PROGRAMMED, polygon=polygon)))
    assert turned != drawn


@pytest.mark.parametrize("corners", [(0, 0, 1), (0, 1, 1), (0, 1, 0), (0, 0, 0)])
@pytest.mark.parametrize("cull_face", Face)
def test_a_triangle_two_of_whose_corners_coincide_is_never_culled(corners, cull_face):
    mesh = Mesh(np.array([(4.0, 1.0), (4.0, 7.0)])[list(corners)], PrimitiveType.TRIANGLES)
    state = replace(PROGRAMMED, polygon=replace(OUTLINES, cull_face=cull_face))
    assert len(process(mesh, state, NV2A, WIDTH, HEIGHT).triangles) == 3


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


def opengl(vertices, primitive, state=PLAIN, **arrays):
    """Every fragment's (primitive, x, y) on a machine of OpenGL 1.2, y counted upwards."""
    positions = np.array(vertices, float) * (2 / WIDTH, 2 / HEIGHT) - 1
    draw = Draw(label="d", mesh=Mesh(positions, primitive, **arrays), state=state)
    (found,) = execute((draw,), OPENGL_1_2, WIDTH, HEIGHT, record=True).records
    return list(zip(found.triangle.tolist(), found.x.tolist(), (HEIGHT - 1 - found.y).tolist(), strict=True))


def opengl_line(a, b, width=1.0):
    state = PassState(line=LineState(width))
    return {(x, y) for _, x, y in opengl([a, b], PrimitiveType.LINES, state)}


def test_a_line_draws_the_pixels_whose_diamonds_it_leaves():
    assert opengl_line((1.5, 1.5), (5.5, 5.5)) == {(k, k) for k in range(1, 5)}  # half open
    assert opengl_line((5.5, 5.5), (1.5, 1.5)) == {(k, k) for k in range(2, 6)}
    # It begins beyond the middle, but in the diamond; it ends beyond the next one's, and in a diamond.
    assert opengl_line((2.9375, 3.5), (4.5, 3.5)) == {(2, 3), (3, 3)}
    assert opengl_line((2.9375, 3.75), (4.9375, 3.75)) == {(3, 3), (4, 3)}
    assert opengl_line((2.5, 3.5), (2.75, 3.5)) == set()  # never left
    assert opengl_line((2.5, 3.5), (2.5, 4.0625)) == {(2, 3)}
    # Between two rows the lower one, between two columns the left one; slanted, where it was just before.
    assert opengl_line((2.5, 3.0), (5.5, 3.0)) == {(2, 2), (3, 2), (4, 2)}
    assert opengl_line((3.0, 2.5), (3.0, 5.5)) == {(2, 2), (2, 3), (2, 4)}


def test_wide_lines_repeat_pixels_along_the_shorter_axis():
    assert opengl_line((2.5, 3.5), (6.5, 3.5), 3.0) == {(x, y) for x in range(2, 6) for y in (2, 3, 4)}
    assert opengl_line((2.5, 3.5), (6.5, 3.5), 2.4) == {(x, y) for x in range(2, 6) for y in (2, 3)}
    assert opengl_line((5.5, 1.5), (5.5, 4.5), 2.0) == {(x, y) for x in (4, 5) for y in (1, 2, 3)}
    assert opengl_line((2.5, 3.5), (6.5, 3.5), 0.2) == opengl_line((2.5, 3.5), (6.5, 3.5))


def test_a_wide_line_s_pixels_have_the_colours_of_those_they_repeat():
    mesh = Mesh([[-0.7, -0.9], [0.6, 0.3]], PrimitiveType.LINES, colors=[[0.0] * 4, [1.0] * 4])
    for turned in (mesh.positions, mesh.positions[:, ::-1].copy()):
        draw = Draw(label="d", mesh=replace(mesh, positions=turned), state=PassState(line=LineState(3.0)))
        color = execute((draw,), OPENGL_1_2, 16, 16).framebuffer.color[..., 0].astype(int)
        along = [set(line[line > 0].tolist()) for line in (color.T if turned is mesh.positions else color)]
        assert [len(values) for values in along if values] == [1] * 9


@pytest.mark.parametrize(
    ("at", "size", "expected"),
    [
        ((4.3, 4.7), 1.0, [(4, 4)]),
        ((4.0, 5.0), 0.2, [(4, 5)]),
        ((4.3, 4.7), 3.0, [(x, y) for x in (3, 4, 5) for y in (3, 4, 5)]),
        ((4.3, 4.7), 2.0, [(x, y) for x in (3, 4) for y in (4, 5)]),
        ((4.5, 4.5), 1.5, [(x, y) for x in (4, 5) for y in (4, 5)]),
        ((4.4375, 4.4375), 2.0, [(x, y) for x in (3, 4) for y in (3, 4)]),
    ],
)
def test_points_as_opengl_draws_them(at, size, expected):
    state = PassState(point=PointState(size=size))
    assert sorted((x, y) for _, x, y in opengl([at], PrimitiveType.POINTS, state)) == expected


@given(st.integers(-99, 9999), st.integers(-99, 9999), st.integers(1, 9))
def test_points_move_to_middles_and_corners_as_specified(x, y, size):
    primitives = process(Mesh([[0.0, 0.0]], PrimitiveType.POINTS), PassState(), OPENGL_1_2, WIDTH, HEIGHT)
    x_y = {"x": np.full(4, x, np.int32), "y": np.full(4, y, np.int32)}
    alone = replace(primitives, triangles=np.zeros((1, 4), np.int32), **x_y)
    square = with_squares(alone, np.float64(size), [], OPENGL_1_2)
    (right, middle, _), (_, _, below) = square.x[4:], square.y[4:]
    assert (right - middle, below - square.y[5]) == (8 * 8 * size, 8 * 8 * size)
    assert (middle, square.y[5]) == strokes.point_center(x, y, size)


DASHES = PassState(line=LineState(stipple=(1, 0b1011_0001_1101_0010)))


def dashes(*pixels):
    """What DASHES leaves of pixels that follow each other."""
    return [p for k, p in enumerate(pixels) if 0b1011_0001_1101_0010 >> k % 16 & 1]


def test_line_stipple_goes_on_along_strips_and_begins_anew_with_each_line():
    corners = [(1.5, 2.5), (6.5, 2.5), (6.5, 6.5), (11.5, 6.5)]
    first, second, third = [(x, 2) for x in range(1, 6)], [(6, y) for y in range(2, 6)], range(6, 11)
    third = [(x, 6) for x in third]

    def drawn(primitive, vertices, state=DASHES, **arrays):
        return sorted((x, y) for _, x, y in opengl(vertices, primitive, state, **arrays))

    assert drawn(PrimitiveType.LINE_STRIP, corners) == sorted(dashes(*first, *second, *third))
    assert drawn(PrimitiveType.LINES, [*corners[:2], *corners[2:]]) == sorted(dashes(*first) + dashes(*third))
    two = [*corners[:3], *corners[2:]]
    assert drawn(PrimitiveType.LINE_STRIP, two, counts=[3, 2]) == sorted(
        dashes(*first, *second) + dashes(*third)
    )
    loop = [(1.5, 2.5), (6.5, 2.5), (6.5, 6.5), (1.5, 6.5)]
    back = [*first, *second, *[(x, 6) for x in range(6, 1, -1)], *[(1, y) for y in range(6, 2, -1)]]
    assert drawn(PrimitiveType.LINE_LOOP, loop) == sorted(dashes(*back))
    slow = replace(DASHES, line=LineState(stipple=(3, 0b101)))
    assert drawn(PrimitiveType.LINE_STRIP, corners, slow) == sorted([*first[:3], *second[1:4]])
    wide = replace(DASHES, line=LineState(2.0, stipple=(1, 0b101)))
    assert drawn(PrimitiveType.LINES, corners[:2], wide) == [(1, 1), (1, 2), (3, 1), (3, 2)]


def along(mesh, state, profile):
    """The pixels that each line draws, in the order in which it does: a list for each row."""
    primitives = process(mesh, state, profile, WIDTH, HEIGHT)
    (found,) = execute(
        (Draw(label="d", mesh=mesh, state=state),), profile, WIDTH, HEIGHT, record=True
    ).records
    lines = []
    for row, (b, a, *_) in enumerate(primitives.triangles.tolist()):
        by = primitives.x[b] - primitives.x[a], primitives.y[b] - primitives.y[a]
        of_row = zip(
            found.x[found.triangle == row].tolist(), found.y[found.triangle == row].tolist(), strict=True
        )
        lines.append(sorted(of_row, key=lambda pixel, by=by: pixel[0] * by[0] + pixel[1] * by[1]))
    return lines


@pytest.mark.parametrize("profile", [GEFORCE_256, OPENGL_1_2])
@pytest.mark.parametrize(
    ("primitive", "groups"),
    [
        (PrimitiveType.TRIANGLES, [3, 3]),
        (PrimitiveType.TRIANGLE_STRIP, [3, 3, 3, 3, 3, 3]),
        (PrimitiveType.QUADS, [4, 4]),
        (PrimitiveType.QUAD_STRIP, [4, 4, 4]),
        (PrimitiveType.POLYGON, [8]),
    ],
)
def test_a_polygon_s_edges_share_one_stipple_counter(profile, primitive, groups):
    around = [(4, 1), (2, 2), (1, 4), (2, 6), (5, 7), (9, 6), (12, 4), (9, 2)]
    mesh = Mesh(np.array(around) * (2 / WIDTH, 2 / HEIGHT) - 1, primitive)
    plain = PassState(polygon=OUTLINES)
    whole = along(mesh, plain, profile)
    got = along(mesh, replace(plain, line=DASHES.line), profile)
    assert len(whole) == sum(groups)
    for edges in groups:
        expected = dashes(*[pixel for _ in range(edges) for pixel in whole.pop(0)])
        assert [pixel for _ in range(edges) for pixel in got.pop(0)] == expected


@pytest.mark.parametrize(
    ("line", "profile", "words"),
    [
        (LineState(rasterization=RECTANGLE), OPENGL_1_2, "give line.rasterization STEPS"),
        (LineState(rasterization=RECTANGLE, stipple=(1, 1)), GEFORCE_256, "counts the steps"),
        (LineState(stipple=(0, 1)), GEFORCE_256, "a factor of 1 to 256"),
        (LineState(stipple=(1, 1 << 16)), OPENGL_1_2, "16 bits"),
        (LineState(stipple=(1, 1)), OPENGL_1_2.changed(line_stipple=False), "no line stipple"),
    ],
)
def test_lines_that_a_machine_does_not_draw_are_refused(line, profile, words):
    draw = Draw(label="d", mesh=Mesh([[0.0, 0.0]] * 2, PrimitiveType.LINES), state=PassState(line=line))
    with pytest.raises(UnsupportedState, match=words):
        execute((draw,), profile, WIDTH, HEIGHT)


@pytest.mark.parametrize("exclusive", [False, True])
def test_window_clip_keeps_what_is_in_any_rectangle_or_in_none(exclusive):
    clip = WindowClip((Scissor(1, 1, 3, 2), Scissor(3, 2, 9, 9), Scissor(5, 5, 0, 1)), exclusive)
    machine = GEFORCE_256.changed(max_window_rectangles=8)
    mesh = Mesh([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    draw = Draw(label="d", mesh=mesh, state=PassState(window_clip=clip))
    (found,) = execute((draw,), machine, WIDTH, HEIGHT, record=True).records
    inside = box(1, 5, 4, 7) | box(3, 0, 12, 6)
    expected = box(0, 0, WIDTH, HEIGHT) - inside if exclusive else inside
    assert set(zip(found.x.tolist(), found.y.tolist(), strict=True)) == expected


@pytest.mark.parametrize("primitive", [PrimitiveType.LINES, PrimitiveType.LINE_LOOP, PrimitiveType.POINTS])
def test_a_line_outside_changes_nothing_about_lines_inside(primitive):
    """Lines that lie inside all planes take a short way; beside a line outside they take the long one."""
    rows, _ = split_lines(primitive, [4], ProvokingVertex.LAST)
    columns = [np.array([-0.5, 0.5, 0.25, -0.25, 9.0]), np.full(5, 0.5), np.zeros(5), np.ones(5)]
    outside = np.concatenate([rows, [[4, 4, 4, 4]]])
    with np.errstate(divide="ignore", invalid="ignore"):  # as the vertex stage does
        short = clip_lines(rows.astype(np.int32), [c[:4] for c in columns], 4, VIEW_VOLUME_SIDES)
        long = clip_lines(outside.astype(np.int32), columns, 5, VIEW_VOLUME_SIDES)
    assert short[0].dtype == long[0].dtype and short[0].flags.c_contiguous
    assert short[0].tolist() == long[0].tolist() == rows.tolist()
    assert short[2].tolist() == long[2].tolist() and short[3] == long[3] == 0


def test_infinite_coordinates_drop_a_line_that_no_plane_clips():
    rows = np.array([[1, 0, 0, 1]], np.int32)
    columns = [np.zeros(2), np.zeros(2), np.zeros(2), np.array([1.0, np.inf])]
    with np.errstate(divide="ignore", invalid="ignore"):
        kept, _, origin, dropped = clip_lines(rows, columns, 2, VIEW_VOLUME_SIDES)
    assert (len(kept), len(origin), dropped) == (0, 0, 1)

"""The sides of the view volume (OpenGL 1.2.1 section 2.11): polygons end at the viewport with the bits that
they have without it, lines are cut, points go by their middles. A bare chip's window coordinates have none.
"""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.enums import LineRasterization, PolygonMode, PrimitiveType, VertexStage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.inspection.inspect import inspect
from fixedpipe.pipeline.profiles import GEFORCE_256, INFINITE_REALITY, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import (
    Composite,
    LineState,
    PassState,
    PointState,
    PolygonState,
    Scissor,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.vertices.view_volume import within_viewport

SIZE = 24
VIEW = Viewport(6, 4, 12, 16)
INSIDE = np.zeros((SIZE, SIZE), bool)  # of pictures: the top row first
INSIDE[SIZE - 20 : SIZE - 4, 6:18] = True
WHOLE = Mesh([[-4, -4], [4, -4], [4, 4], [-4, 4]], PrimitiveType.QUADS, colors=[
    [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0],
])  # fmt: skip


def drawn(mesh, profile=GEFORCE_256, view=VIEW, **state):
    """Which pixels a white mesh, or one of its own colours, draws, and the picture."""
    draw = Draw(label="it", mesh=mesh, state=PassState(vertex=VertexState(viewport=view), **state))
    picture = execute((Clear(label="black", color=(0, 0, 0, 0)), draw), profile, SIZE, SIZE).image()
    return picture[..., :3].any(axis=-1), picture


def lines(*ends, primitive=PrimitiveType.LINES):
    return Mesh(list(ends), primitive)


# ---------------------------------------------------------------------------------------------- polygons


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256, NV2A], ids=lambda profile: profile.name)
@pytest.mark.parametrize("engine", [None, "portable", "columns"])
def test_a_polygon_ends_at_the_viewport(profile, engine):
    draw = Draw(label="it", mesh=WHOLE, state=PassState(vertex=VertexState(viewport=VIEW)))
    picture = execute((draw,), profile, SIZE, SIZE, engine=engine).image()
    np.testing.assert_array_equal(picture[..., :3].any(axis=-1), INSIDE)


def test_no_bit_inside_changes():
    """A composite matrix, which has no sides, against the same mesh in the viewport: one matrix does both."""
    _, inside = drawn(WHOLE, NV2A)
    half = [VIEW.width / 2, VIEW.height / 2]
    middle = [VIEW.x + half[0], SIZE - VIEW.y - half[1]]
    matrix = ((half[0], 0, 0, 0), (0, -half[1], 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    composite = Composite(matrix=matrix, offset=(*middle, 0.0))
    draw = Draw(label="it", mesh=WHOLE, state=PassState(vertex=VertexState(composite=composite)))
    bare = execute((draw,), NV2A, SIZE, SIZE).image()
    assert bare[..., :3].any(axis=-1).all()
    np.testing.assert_array_equal(bare[INSIDE], inside[INSIDE])


def test_an_explicit_scissor_box_is_cut_too():
    box = Scissor(0, 10, 10, 30)
    seen, _ = drawn(WHOLE, scissor=box)
    expected = INSIDE.copy()
    expected[:, 10:] = expected[SIZE - 10 :] = False
    np.testing.assert_array_equal(seen, expected)
    assert not drawn(WHOLE, scissor=Scissor(0, 0, 6, 24))[0].any()


def test_the_ideal_s_polygons_end_there_too():
    draw = Draw(label="it", mesh=WHOLE, state=PassState(vertex=VertexState(viewport=VIEW)))
    np.testing.assert_array_equal(execute_ideal((draw,), SIZE, SIZE).color[..., 3] > 0, INSIDE)


def test_several_samples_end_there_too():
    draw = Draw(label="it", mesh=WHOLE, state=PassState(vertex=VertexState(viewport=VIEW)))
    picture = execute((draw,), INFINITE_REALITY, SIZE, SIZE, samples=4).image()
    np.testing.assert_array_equal(picture[..., :3].any(axis=-1), INSIDE)


def test_an_inspected_pixel_beyond_the_viewport_is_touched_by_nothing():
    frame = (Draw(label="it", mesh=WHOLE, state=PassState(vertex=VertexState(viewport=VIEW))),)
    for x in (5, 6):
        assert bool(inspect(frame, GEFORCE_256, SIZE, SIZE, (x, 12)).touched) == (x == 6)


def test_a_viewport_may_reach_beyond_the_window_and_be_as_wide_as_it():
    seen, _ = drawn(WHOLE, view=Viewport(-5, 20, None, 100))
    expected = np.zeros((SIZE, SIZE), bool)
    expected[:4, :19] = True
    np.testing.assert_array_equal(seen, expected)


def clipped(polygon, axis, limit, sign):
    """A polygon of Fractions cut by sign * (coordinate - limit) >= 0."""
    out = []
    for here, there in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        d, e = (sign * (p[axis] - limit) for p in (here, there))
        if d >= 0:
            out.append(here)
        if (d >= 0) != (e >= 0):
            t = Fraction(d, d - e)
            out.append(tuple(a + t * (b - a) for a, b in zip(here, there, strict=True)))
    return out


def side(a, b, p):
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def contains(polygon, point):
    """Whether a convex polygon has a point in it; None: on an edge."""
    sides = [side(a, b, point) for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True) if a != b]
    if not sides or any(s == 0 for s in sides):
        return None if sides else False
    return all(s > 0 for s in sides) or all(s < 0 for s in sides)


NEAR = st.integers(-16 * 40, 16 * 64)  # 1/16 pixel


@given(st.tuples(*[st.tuples(NEAR, NEAR)] * 3), st.integers(0, 20), st.integers(0, 20), st.integers(1, 20))
def test_a_pixel_s_middle_is_in_the_cut_polygon_as_it_is_in_the_polygon_and_the_viewport(corners, x, y, edge):
    """In exact arithmetic: what makes a box in the window as good as cutting."""
    assume(side(*corners) != 0)
    triangle = [tuple(Fraction(c, 16) for c in corner) for corner in corners]
    cut = triangle
    for axis, low in ((0, x), (1, y)):
        cut = clipped(cut, axis, low, 1) if cut else cut
        cut = clipped(cut, axis, low + edge, -1) if cut else cut
    for px in range(0, 44, 3):
        for py in range(0, 44, 3):
            middle = Fraction(2 * px + 1, 2), Fraction(2 * py + 1, 2)
            whole = contains(triangle, middle)
            if whole is None:
                continue
            in_box = x <= px < x + edge and y <= py < y + edge
            assert bool(len(cut) > 2 and contains(cut, middle)) == (whole and in_box)


# ------------------------------------------------------------------------------------- lines and points


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256, NV2A], ids=lambda profile: profile.name)
def test_a_line_is_cut(profile):
    beyond, _ = drawn(lines([-3, 0.25], [3, 0.25]), profile)
    cut, _ = drawn(lines([-1, 0.25], [1, 0.25]), profile)
    np.testing.assert_array_equal(beyond, cut)
    assert cut.sum() in (11, 12, 13) and not beyond[:, :5].any()


def test_the_end_of_a_cut_line_may_be_as_wide_as_the_line():
    wide, _ = drawn(lines([-3, 1], [3, 1]), OPENGL_1_2, line=LineState(width=5.0))
    assert wide[: SIZE - 20].any() and wide[:, 6:18].any() and not wide[:, :5].any()


def test_a_line_beyond_a_side_is_gone():
    assert not drawn(lines([-3, -1.01], [3, -1.01]), line=LineState(width=9.0))[0].any()


def test_colours_are_of_the_whole_line():
    mesh = replace(lines([-2, 0], [2, 0]), colors=np.array([[0.0, 0, 0], [1, 1, 1]]))
    _, picture = drawn(mesh)
    row = picture[..., 0].max(axis=0)
    assert row[6] > 60 and row[17] < 195


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256, NV2A], ids=lambda profile: profile.name)
def test_a_point_goes_by_its_middle(profile):
    large = PointState(size=8.0)
    for middle, is_seen in (
        ((-1.0, 0.0), True),
        ((-1.01, 0.0), False),
        ((0.0, 1.0), True),
        ((0.0, 1.01), False),
    ):
        seen, _ = drawn(lines(middle, primitive=PrimitiveType.POINTS), profile, point=large)
        assert seen.any() == is_seen
        assert (seen & ~INSIDE).any() == is_seen  # a large one reaches beyond the side


def test_an_outlined_polygon_is_cut_and_outlined_along_the_sides():
    outline = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
    seen, _ = drawn(WHOLE, OPENGL_1_2, polygon=outline)
    rows, columns = np.nonzero(seen)
    assert rows.min() >= SIZE - 21 and rows.max() <= SIZE - 4
    assert columns.min() >= 5 and columns.max() <= 18
    assert seen[:, 5:7].sum() >= 15 and seen[:, 17:19].sum() >= 15


def test_filled_faces_of_a_mesh_that_is_outlined_from_behind_end_there_too():
    mixed = PolygonState(front_mode=PolygonMode.FILL, back_mode=PolygonMode.LINE)
    np.testing.assert_array_equal(drawn(WHOLE, polygon=mixed)[0], INSIDE)


# ---------------------------------------------------------------------------------------- the bare chip


def test_a_vertex_program_s_point_may_lie_beyond_the_window():
    mesh = Mesh([[-2, 12, 0, 1]], PrimitiveType.POINTS)
    vertex = VertexState(stage=VertexStage.PROGRAM_RESULTS)
    state = PassState(vertex=vertex, point=PointState(size=8.0))
    picture = execute((Draw(label="it", mesh=mesh, state=state),), NV2A, SIZE, SIZE).image()
    assert picture[..., :3].any()


# ------------------------------------------------------------------------------------------- the states


def test_one_state_stands_for_a_state_and_a_size():
    state = PassState(vertex=VertexState(viewport=VIEW))
    assert within_viewport(WHOLE, state, SIZE, SIZE) is within_viewport(WHOLE, state, SIZE, SIZE)
    other = replace(state)
    boxes = [within_viewport(WHOLE, s, SIZE, SIZE).scissor for s in (state, other)]
    assert boxes[0] is boxes[1]
    assert boxes[0] == Scissor(6, 4, 12, 16)


@pytest.mark.parametrize(
    "state",
    [
        PassState(),
        PassState(vertex=VertexState(viewport=Viewport(0, 0, SIZE, SIZE))),
        PassState(vertex=VertexState(viewport=Viewport(-3, -3, 2 * SIZE, 2 * SIZE))),
        PassState(vertex=VertexState(viewport=VIEW), scissor=Scissor(6, 4, 12, 16)),
        PassState(vertex=VertexState(viewport=VIEW), scissor=Scissor(8, 8, 2, 2)),
    ],
)
def test_a_state_that_a_viewport_does_not_change_stays_itself(state):
    assert within_viewport(WHOLE, state, SIZE, SIZE) is state


def test_lines_by_steps_and_rectangles_are_cut_alike():
    for rasterization in LineRasterization:
        line = LineState(width=1.0, rasterization=rasterization)
        seen, _ = drawn(lines([-5, 5], [5, -5]), NV2A, line=line)
        np.testing.assert_array_equal(seen, drawn(lines([-1, 1], [1, -1]), NV2A, line=line)[0])

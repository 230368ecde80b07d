"""Selection and feedback beside records that were computed by hand."""

import math

import numpy as np
import pytest

from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.selection import (
    MAX_NAME_STACK_DEPTH,
    feed_back_rectangle,
    select_raster_position,
)
from fixedpipe.pipeline.state import RasterPosition
from tests.pipeline.opengl.drawn import context, counted, refusals, textured

_LARGEST = 2**32 - 1


def _selecting(size=100):
    """A context of 100 x 100 pixels in selection, whose object coordinates are 0 to 10, depths 0 to 1."""
    gl = context(width=100, height=100)
    gl.MatrixMode(GL.PROJECTION)
    gl.Ortho(0.0, 10.0, 0.0, 10.0, 0.0, -1.0)
    gl.MatrixMode(GL.MODELVIEW)
    gl.SelectBuffer(size)
    assert gl.RenderMode(GL.SELECT) == 0
    gl.InitNames()
    return gl


def _triangle(gl, x=1.0, y=1.0, depths=(0.25, 0.5, 0.75)):
    gl.Begin(GL.TRIANGLES)
    for (dx, dy), z in zip(((0, 0), (1, 0), (0, 1)), depths, strict=True):
        gl.Vertex3f(x + dx, y + dy, z)
    gl.End()


def _scaled(*depths):
    return [round(depth * _LARGEST) for depth in depths]


# ----------------------------------------------------------------------------------------------- selection


def test_hit_records():
    gl = _selecting()
    gl.PushName(7)
    _triangle(gl)
    gl.LoadName(8)
    _triangle(gl, x=20.0)  # outside
    gl.PushName(9)
    _triangle(gl, depths=(0.125, 0.125, 0.125))
    _triangle(gl, depths=(0.5, 0.5, 0.625))
    gl.PopName()
    gl.PushName(10)
    gl.PopName()
    _triangle(gl, depths=(1.0, 1.0, 1.0))
    assert gl.RenderMode(GL.RENDER) == 3
    assert gl.selection.written == [
        *(1, *_scaled(0.25, 0.75), 7),
        *(2, *_scaled(0.125, 0.625), 8, 9),
        *(1, *_scaled(1.0, 1.0), 8),
    ]
    assert not gl.take_commands()
    assert not refusals(gl)


def test_names_that_are_errors_write_no_record():
    gl = _selecting()
    for name in (5, 6):
        _triangle(gl)
        gl.LoadName(name)
        gl.PopName()
    assert gl.RenderMode(GL.RENDER) == 1
    assert counted(gl, "error") == [
        ("glLoadName: GL_INVALID_OPERATION, the name stack is empty", 2),
        ("glPopName: GL_STACK_UNDERFLOW", 2),
    ]


def test_a_hit_without_names():
    gl = _selecting()
    _triangle(gl)
    assert gl.RenderMode(GL.SELECT) == 1
    assert gl.selection.names == []
    assert gl.RenderMode(GL.RENDER) == 0


@pytest.mark.parametrize(
    ("depths", "record"),
    [
        ((-0.5, 0.5, 0.5), (0.0, 0.5)),  # cut at the near plane
        ((0.25, 0.5, 1.5), (0.25, 1.0)),
        ((-1.0, 2.0, 0.5), (0.0, 1.0)),
        ((-0.25, -0.5, -0.125), None),
    ],
)
def test_depths_are_those_after_clipping(depths, record):
    gl = _selecting()
    _triangle(gl, depths=depths)
    assert gl.RenderMode(GL.RENDER) == (record is not None)
    expected = [] if record is None else [0, *_scaled(*record)]
    assert np.allclose(gl.selection.written, expected, atol=1)


def test_depths_lie_in_the_depth_range():
    gl = _selecting()
    gl.DepthRange(0.5, 1.0)
    _triangle(gl, depths=(0.0, 0.5, 1.0))
    gl.RenderMode(GL.RENDER)
    assert gl.selection.written == [0, *_scaled(0.5, 1.0)]


@pytest.mark.parametrize(
    ("mode", "vertices", "hit"),
    [
        (GL.POINTS, [(5, 5)], True),
        (GL.POINTS, [(10.5, 5)], False),
        (GL.POINTS, [(10.5, 5), (10, 10)], True),
        (GL.LINES, [(-5, 5), (15, 5)], True),
        (GL.LINES, [(-5, 5), (5, 16)], False),
        (GL.LINE_LOOP, [(-1, -1), (-1, 20), (20, 20)], True),
        (GL.LINE_STRIP, [(-1, -1), (-1, 20), (20, 20)], False),
        (GL.POLYGON, [(-50, -50), (50, -50), (50, 50), (-50, 50)], True),
        (GL.TRIANGLES, [(-5, 9), (1, 15), (-5, 15)], False),
        (GL.QUAD_STRIP, [(-9, 0), (-9, 1), (-8, 0), (-8, 1), (1, 0), (1, 1)], True),
    ],
)
def test_what_intersects_the_view_volume(mode, vertices, hit):
    gl = _selecting()
    gl.Begin(mode)
    for x, y in vertices:
        gl.Vertex3f(x, y, 0.5)
    gl.End()
    assert gl.RenderMode(GL.RENDER) == hit
    assert gl.selection.written == ([0, *_scaled(0.5, 0.5)] if hit else [])


def test_user_planes_clip_too():
    gl = _selecting()
    gl.ClipPlane(GL.CLIP_PLANE0, [1.0, 0.0, 0.0, -5.0])
    gl.Enable(GL.CLIP_PLANE0)
    _triangle(gl)
    gl.PushName(1)
    assert gl.selection.written == []
    _triangle(gl, x=6.0)
    assert gl.RenderMode(GL.RENDER) == 1


@pytest.mark.parametrize(
    ("culled", "front_face", "hit"),
    [
        (GL.BACK, GL.CCW, True),
        (GL.FRONT, GL.CCW, False),
        (GL.BACK, GL.CW, False),
        (GL.FRONT, GL.CW, True),
        (GL.FRONT_AND_BACK, GL.CCW, False),
    ],
)
def test_culled_polygons_are_no_hits(culled, front_face, hit):
    gl = _selecting()
    gl.Enable(GL.CULL_FACE)
    gl.CullFace(culled)
    gl.FrontFace(front_face)
    gl.PolygonMode(GL.FRONT_AND_BACK, GL.POINT)  # which selection disregards
    _triangle(gl, x=-0.5)
    assert gl.RenderMode(GL.RENDER) == hit


def test_arrays_and_lists_are_selected():
    gl = _selecting()
    gl.NewList(1, GL.COMPILE)
    gl.PushName(3)
    _triangle(gl)
    gl.EndList()
    gl.CallList(1)
    gl.LoadName(4)
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(3, GL.FLOAT, 0, [1.0, 1.0, 0.0])
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert gl.RenderMode(GL.RENDER) == 2
    assert gl.selection.written == [1, *_scaled(0.25, 0.75), 3, 1, 0, 0, 4]


def test_a_record_is_cut_where_the_buffer_ends():
    gl = _selecting(6)
    gl.PushName(7)
    _triangle(gl)
    gl.PushName(8)
    _triangle(gl)
    assert gl.RenderMode(GL.SELECT) == -1
    assert gl.RenderMode(GL.RENDER) == 0
    gl = _selecting(6)
    gl.PushName(7)
    _triangle(gl)
    gl.PushName(8)
    _triangle(gl)
    gl.PopName()
    assert gl.selection.written == [1, *_scaled(0.25, 0.75), 7, 2, _scaled(0.25)[0]]


def test_the_callers_array_is_filled():
    gl = context(width=100, height=100)
    array, values = np.zeros(8, np.uint32), [0] * 8
    for buffer in (array, values):
        gl.SelectBuffer(8, buffer)
        gl.RenderMode(GL.SELECT)
        gl.PushName(0xFFFFFFFF)
        gl.Begin(GL.POINTS)
        gl.Vertex3f(0.0, 0.0, 1.0)
        gl.End()
        assert gl.RenderMode(GL.RENDER) == 1
        assert list(buffer) == [1, _LARGEST, _LARGEST, 0xFFFFFFFF, 0, 0, 0, 0]


def test_name_stack_errors():
    gl = _selecting()
    gl.PopName()
    gl.LoadName(1)
    for name in range(MAX_NAME_STACK_DEPTH + 1):
        gl.PushName(name)
    kinds = [sentence for sentence, _ in counted(gl, "error")]
    assert kinds == [
        "glPopName: GL_STACK_UNDERFLOW",
        "glLoadName: GL_INVALID_OPERATION, the name stack is empty",
        "glPushName: GL_STACK_OVERFLOW",
    ]
    gl.RenderMode(GL.RENDER)
    gl.PopName()
    gl.InitNames()
    gl.PushName(3)
    gl.LoadName(3)
    assert len(refusals(gl)) == 3
    assert gl.selection.names == []


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("RenderMode", (GL.SELECT,), "INVALID_OPERATION"),
        ("RenderMode", (GL.FEEDBACK,), "INVALID_OPERATION"),
        ("RenderMode", (GL.FLOAT,), "INVALID_ENUM"),
        ("SelectBuffer", (-1,), "INVALID_VALUE"),
        ("FeedbackBuffer", (-1, GL._2D), "INVALID_VALUE"),
        ("FeedbackBuffer", (1, GL.FLOAT), "INVALID_ENUM"),
    ],
)
def test_errors(call, arguments, kind):
    gl = context()
    gl.call(f"gl{call}", arguments)
    ((sentence, _),) = refusals(gl)
    assert sentence.startswith(f"gl{call}: GL_{kind}")
    assert gl.values["render_mode"] == GL.RENDER


def test_a_buffer_in_use_is_not_replaced():
    gl = _selecting()
    gl.SelectBuffer(1)
    gl.FeedbackBuffer(100, GL._2D)
    gl.RenderMode(GL.FEEDBACK)
    gl.FeedbackBuffer(1, GL._2D)
    assert [sentence for sentence, _ in counted(gl, "error")] == [
        "glSelectBuffer: GL_INVALID_OPERATION, the buffer is in use",
        "glFeedbackBuffer: GL_INVALID_OPERATION, the buffer is in use",
    ]


def test_a_raster_position_is_a_hit():
    gl = _selecting()
    select_raster_position(gl, RasterPosition((20.0, 0.0, 0.5, 1.0)), gl.state())
    gl.PushName(1)
    assert gl.selection.written == []
    select_raster_position(gl, RasterPosition((5.0, 5.0, 0.5, 1.0)), gl.state())
    assert gl.RenderMode(GL.RENDER) == 1
    assert gl.selection.written == [1, *_scaled(0.5, 0.5), 1]


# ------------------------------------------------------------------------------------------------ feedback


def _feeding_back(type_=GL._3D, size=1000):
    gl = context(width=100, height=100)
    gl.MatrixMode(GL.PROJECTION)
    gl.Ortho(0.0, 10.0, 0.0, 10.0, 0.0, -1.0)
    gl.MatrixMode(GL.MODELVIEW)
    gl.FeedbackBuffer(size, type_)
    gl.RenderMode(GL.FEEDBACK)
    return gl


def _fed_back(gl):
    count = gl.RenderMode(GL.RENDER)
    assert not refusals(gl)
    assert not gl.take_commands()
    assert count == len(gl.selection.written)
    return gl.selection.written


def _close(found, expected):
    assert len(found) == len(expected)
    assert np.allclose(found, expected, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize(
    ("type_", "vertex"),
    [
        (GL._2D, [10.0, 20.0]),
        (GL._3D, [10.0, 20.0, 0.5]),
        (GL._3D_COLOR, [10.0, 20.0, 0.5, 0.5, 0.25, 0.125, 1.0]),
        (GL._3D_COLOR_TEXTURE, [10.0, 20.0, 0.5, 0.5, 0.25, 0.125, 1.0, 6.0, 2.0, 3.0, 4.0]),
        (GL._4D_COLOR_TEXTURE, [10.0, 20.0, 0.5, 2.0, 0.5, 0.25, 0.125, 1.0, 6.0, 2.0, 3.0, 4.0]),
    ],
)
def test_the_types_of_feedback(type_, vertex):
    gl = _feeding_back(type_)
    gl.MatrixMode(GL.TEXTURE)
    gl.Translatef(1.25, 0.0, 0.0)  # times q
    gl.Color3f(0.5, 0.25, 0.125)
    gl.TexCoord4f(1.0, 2.0, 3.0, 4.0)
    gl.Begin(GL.POINTS)
    gl.Vertex4f(2.0, 4.0, 1.0, 2.0)
    gl.End()
    _close(_fed_back(gl), [GL.POINT_TOKEN, *vertex])


@pytest.mark.parametrize("enabled", [False, True])
def test_generated_texture_coordinates(enabled):
    gl = _feeding_back(GL._3D_COLOR_TEXTURE)
    if enabled:
        textured(gl, 0)
    gl.TexGeni(GL.S, GL.TEXTURE_GEN_MODE, GL.OBJECT_LINEAR)
    gl.TexGenfv(GL.S, GL.OBJECT_PLANE, [0.5, 0.0, 0.0, 1.0])
    gl.TexGeni(GL.R, GL.TEXTURE_GEN_MODE, GL.NORMAL_MAP)
    gl.Enable(GL.TEXTURE_GEN_S)
    gl.Enable(GL.TEXTURE_GEN_R)
    gl.Normal3f(0.0, 0.0, -1.0)
    gl.TexCoord2f(7.0, 8.0)
    gl.Begin(GL.POINTS)
    gl.Vertex3f(2.0, 4.0, 0.5)
    gl.End()
    _close(_fed_back(gl), [GL.POINT_TOKEN, 20.0, 40.0, 0.5, 1.0, 1.0, 1.0, 1.0, 2.0, 8.0, -1.0, 1.0])


def test_lines_and_where_their_stipple_begins():
    gl = _feeding_back(GL._2D)
    for mode in (GL.LINES, GL.LINE_STRIP, GL.LINE_LOOP):
        gl.Begin(mode)
        for x in (1, 2, 3, 4)[: 4 if mode == GL.LINES else 3]:
            gl.Vertex2f(x, 0.5 * x)
        gl.End()
    ends = [(1, 2, 1), (3, 4, 1), (1, 2, 1), (2, 3, 0), (1, 2, 1), (2, 3, 0), (3, 1, 0)]
    tokens = {1: GL.LINE_RESET_TOKEN, 0: GL.LINE_TOKEN}
    _close(_fed_back(gl), [v for a, b, reset in ends for v in (tokens[reset], 10 * a, 5 * a, 10 * b, 5 * b)])


def test_a_clipped_line():
    gl = _feeding_back(GL._3D_COLOR)
    gl.Begin(GL.LINES)
    gl.Color4f(0.0, 0.0, 0.0, 0.0)
    gl.Vertex3f(5.0, 5.0, 0.0)
    gl.Color4f(1.0, 1.0, 0.5, 1.0)
    gl.Vertex3f(15.0, 5.0, 1.0)
    gl.End()
    middle = [100.0, 50.0, 0.5, 0.5, 0.5, 0.25, 0.5]
    _close(_fed_back(gl), [GL.LINE_RESET_TOKEN, 50.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0, *middle])


def test_polygons_are_triangles():
    gl = _feeding_back(GL._2D)
    gl.Begin(GL.QUADS)
    for x, y in ((1, 1), (2, 1), (2, 2), (1, 2)):
        gl.Vertex2f(x, y)
    gl.End()
    values = np.array(_fed_back(gl)).reshape(2, 8)
    assert values[:, :2].tolist() == [[GL.POLYGON_TOKEN, 3.0]] * 2
    areas = [
        (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0) for x0, y0, x1, y1, x2, y2 in values[:, 2:].tolist()
    ]
    assert areas == [100.0, 100.0]


def test_a_clipped_triangle_covers_what_is_left_of_it():
    gl = _feeding_back(GL._2D)
    gl.Begin(GL.TRIANGLES)
    for x, y in ((5, 2), (15, 2), (5, 12)):
        gl.Vertex2f(x, y)
    gl.End()
    values = np.array(_fed_back(gl)).reshape(-1, 8)
    corners = values[:, 2:].reshape(-1, 3, 2)
    assert corners.min() >= 0.0
    assert corners.max() <= 100.0
    sides = corners[:, 1:] - corners[:, :1]
    doubled = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    # A triangle of 5000 square pixels, without two corners of 1250 (right) and 200 (top).
    assert math.isclose(doubled.sum() / 2, 5000.0 - 1250.0 - 200.0)


@pytest.mark.parametrize("edges", ["all", "some"])
@pytest.mark.parametrize("mode", [GL.LINE, GL.POINT])
def test_polygons_drawn_as_lines_and_points(mode, edges):
    gl = _feeding_back(GL._2D)
    gl.PolygonMode(GL.FRONT, mode)
    gl.Begin(GL.POLYGON)
    corners = [(1, 1), (3, 1), (4, 2), (3, 3), (1, 3)]
    for number, (x, y) in enumerate(corners):
        gl.EdgeFlag(edges == "all" or number != 2)
        gl.Vertex2f(x, y)
    gl.End()
    values = _fed_back(gl)
    width = 5 if mode == GL.LINE else 3
    rows = np.array(values).reshape(-1, width).round(9)
    assert len(rows) == (5 if edges == "all" else 4)
    if mode == GL.POINT:
        assert set(rows[:, 0]) == {GL.POINT_TOKEN}
        expected = {
            (10.0 * x, 10.0 * y) for number, (x, y) in enumerate(corners) if edges == "all" or number != 2
        }
        assert set(map(tuple, rows[:, 1:].tolist())) == expected
    else:
        assert rows[0, 0] == GL.LINE_RESET_TOKEN
        assert set(rows[1:, 0]) == {GL.LINE_TOKEN}
        found = {frozenset(((x0, y0), (x1, y1))) for _, x0, y0, x1, y1 in rows.tolist()}
        pairs = list(zip(corners, corners[1:] + corners[:1], strict=True))
        drawn = [pair for number, pair in enumerate(pairs) if edges == "all" or number != 2]
        assert found == {frozenset((10.0 * x, 10.0 * y) for x, y in pair) for pair in drawn}


def test_culled_polygons_are_not_fed_back_and_the_back_has_its_own_mode():
    gl = _feeding_back(GL._2D)
    gl.PolygonMode(GL.BACK, GL.POINT)
    gl.FrontFace(GL.CW)
    _triangle(gl)
    gl.PassThrough(4.5)
    gl.Enable(GL.CULL_FACE)
    _triangle(gl)
    values = _fed_back(gl)
    assert values[::3][:3] == [GL.POINT_TOKEN] * 3
    assert values[9:] == [GL.PASS_THROUGH_TOKEN, 4.5]


def test_flat_triangles_have_the_color_of_their_last_vertex():
    gl = _feeding_back(GL._3D_COLOR)
    gl.ShadeModel(GL.FLAT)
    gl.Begin(GL.TRIANGLES)
    for red, x, y in ((0.0, 9, 9), (0.5, 12, 9), (1.0, 9, 12)):  # clipped on two sides
        gl.Color3f(red, 0.0, 0.0)
        gl.Vertex2f(x, y)
    gl.End()
    values = _fed_back(gl)
    rows = np.array(values).reshape(-1, 23)
    assert len(rows) >= 2
    assert (rows[:, 2:].reshape(-1, 7)[:, 3:] == [1.0, 0.0, 0.0, 1.0]).all()


def test_lit_colors_of_both_sides():
    gl = _feeding_back(GL._3D_COLOR)
    for capability in (GL.LIGHTING, GL.LIGHT0):
        gl.Enable(capability)
    gl.LightModeli(GL.LIGHT_MODEL_TWO_SIDE, 1)
    gl.LightModelfv(GL.LIGHT_MODEL_AMBIENT, [0.0, 0.0, 0.0, 1.0])
    gl.Lightfv(GL.LIGHT0, GL.POSITION, [0.0, 0.0, 1.0, 0.0])
    gl.Materialfv(GL.FRONT, GL.DIFFUSE, [0.5, 0.0, 0.0, 0.25])
    gl.Materialfv(GL.BACK, GL.DIFFUSE, [0.0, 0.5, 0.0, 0.75])
    gl.Materialfv(GL.BACK, GL.EMISSION, [0.0, 0.0, 7.0, 0.0])
    gl.Normal3f(0.0, 0.0, 0.5)
    _triangle(gl)
    gl.FrontFace(GL.CW)
    gl.Normal3f(0.0, 0.0, -0.5)
    _triangle(gl)
    rows = np.array(_fed_back(gl)).reshape(2, 23)[:, 2:].reshape(2, 3, 7)
    assert np.allclose(rows[0, :, 3:], [0.25, 0.0, 0.0, 0.25])
    assert np.allclose(rows[1, :, 3:], [0.0, 0.25, 1.0, 0.75])


def test_feedback_ends_where_the_buffer_ends():
    gl = _feeding_back(GL._2D, 10)
    _triangle(gl)
    _triangle(gl)
    assert gl.selection.written == [
        GL.POLYGON_TOKEN,
        3.0,
        10.0,
        10.0,
        20.0,
        10.0,
        10.0,
        20.0,
        GL.POLYGON_TOKEN,
        3.0,
    ]
    assert gl.RenderMode(GL.FEEDBACK) == -1
    _triangle(gl)
    assert gl.RenderMode(GL.RENDER) == 8


def test_the_callers_array_holds_feedback():
    gl = context(width=100, height=100)
    array = np.full(4, -1.0, np.float32)
    gl.FeedbackBuffer(4, GL._2D, array)
    gl.RenderMode(GL.FEEDBACK)
    gl.Begin(GL.POINTS)
    gl.Vertex2f(0.0, 0.5)
    gl.End()
    gl.RenderMode(GL.RENDER)
    assert array.tolist() == [GL.POINT_TOKEN, 50.0, 75.0, -1.0]


def test_rectangles_feed_back_their_raster_position():
    gl = _feeding_back(GL._3D_COLOR_TEXTURE)
    position = RasterPosition(
        (2.0, 4.0, 0.5, 1.0), color=(0.5, 0.25, 0.0, 1.0), texture_coordinates=((1.0, 2.0, 3.0, 4.0),)
    )
    feed_back_rectangle(gl, GL.BITMAP_TOKEN, position, gl.state())
    feed_back_rectangle(gl, GL.DRAW_PIXEL_TOKEN, RasterPosition((20.0, 0.0, 0.0, 1.0)), gl.state())
    _close(_fed_back(gl), [GL.BITMAP_TOKEN, 20.0, 40.0, 0.5, 0.5, 0.25, 0.0, 1.0, 1.0, 2.0, 3.0, 4.0])
    feed_back_rectangle(gl, GL.BITMAP_TOKEN, position, gl.state())
    assert len(gl.selection.written) == 12


def test_pass_through_is_nothing_elsewhere():
    gl = _selecting()
    gl.PassThrough(1.0)
    assert gl.RenderMode(GL.RENDER) == 0
    assert gl.selection.written == []

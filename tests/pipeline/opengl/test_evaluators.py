"""Evaluators beside closed forms, and meshes of them beside the specification's loops."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.evaluators import MAX_EVAL_ORDER, bernstein, bernstein_slopes
from tests.pipeline.opengl.drawn import context, counted, draws, meshes, refusals, textured

_CURVE = [[0.0, 1.0, 2.0], [4.0, 0.5, -1.0], [2.0, 2.0, 8.0]]


def _curved(gl=None, domain=(0.0, 1.0)):
    gl = gl or context()
    gl.Map1f(GL.MAP1_VERTEX_3, *domain, 3, 3, np.array(_CURVE).reshape(-1).tolist())
    gl.Enable(GL.MAP1_VERTEX_3)
    return gl


def _points(gl, *calls):
    """The vertices' columns of some calls between Begin and End."""
    gl.Begin(GL.POINTS)
    for call, *arguments in calls:
        gl.call(f"gl{call}", arguments)
    gl.End()
    ((_, _, columns, _),) = draws(gl)
    return columns


def _quadratic(t):
    first, second, third = np.array(_CURVE)
    return (1 - t) ** 2 * first + 2 * t * (1 - t) * second + t * t * third


# --------------------------------------------------------------------------------------------- polynomials


@pytest.mark.parametrize("degree", [0, 1, 2, 7, MAX_EVAL_ORDER - 1])
def test_bernstein_polynomials_are_a_partition_of_one(degree):
    t = np.linspace(-0.25, 1.25, 13)
    assert np.allclose(bernstein(degree, t).sum(axis=0), 1.0, rtol=1e-9)
    assert bernstein(degree, np.array([0.0, 1.0]))[[0, degree], [0, 1]].tolist() == [1.0, 1.0]
    step = 1e-6
    slopes = (bernstein(degree, t + step) - bernstein(degree, t - step)) / (2 * step)
    assert np.allclose(bernstein_slopes(degree, t), slopes, atol=1e-4 * 2**degree)


@settings(max_examples=50)
@given(
    u=st.floats(-3.0, 3.0),
    domain=st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)).filter(lambda d: abs(d[0] - d[1]) > 0.1),
)
def test_a_curve_is_its_polynomial(u, domain):
    columns = _points(_curved(domain=domain), ("EvalCoord1f", u), ("EvalCoord1dv", [u]))
    expected = _quadratic((u - domain[0]) / (domain[1] - domain[0]))
    assert np.allclose(np.array(columns["positions"])[:, :3], expected, rtol=1e-12, atol=1e-9)


def test_strides_skip_what_lies_between():
    gl = context()
    points = [*_CURVE[0], 99.0, *_CURVE[1], 99.0, *_CURVE[2]]
    gl.Map1d(GL.MAP1_VERTEX_3, 0.0, 1.0, 4, 3, np.array(points))
    gl.Enable(GL.MAP1_VERTEX_3)
    columns = _points(gl, ("EvalCoord1f", 0.25))
    assert columns["positions"][0][:3] == _quadratic(0.25).tolist()
    # Two dimensions, v the slower: R(i, j) lies at 12 i + 3 j in one map, and at 3 i + 6 j in the other.
    grid = np.arange(24.0)
    for strides in ((12, 3), (3, 6)):
        gl.Map2f(GL.MAP2_VERTEX_3, 0.0, 1.0, strides[0], 2, 0.0, 1.0, strides[1], 3, grid.tolist())
        gl.Enable(GL.MAP2_VERTEX_3)
        corners = [("EvalCoord2f", u, v) for u in (0.0, 1.0) for v in (0.0, 1.0)]
        first = [strides[0] * u + strides[1] * 2 * v for u in (0, 1) for v in (0, 1)]
        assert [p[0] for p in _points(gl, *corners)["positions"]] == first


def test_initial_maps_are_constant():
    gl = context()
    textured(gl, 0)
    for token in (GL.MAP1_VERTEX_4, GL.MAP1_COLOR_4, GL.MAP1_TEXTURE_COORD_3):
        gl.Enable(token)
    gl.Color3f(0.5, 0.5, 0.5)
    gl.TexCoord2f(0.5, 0.5)
    columns = _points(gl, ("EvalCoord1f", 0.3))
    assert columns["positions"] == [[0.0, 0.0, 0.0, 1.0]]
    assert columns["colors"] == [[1.0, 1.0, 1.0, 1.0]]
    assert columns["texture 0"] == [[0.0, 0.0, 0.0, 1.0]]


def test_evaluated_values_do_not_become_current():
    gl = _curved()
    gl.Map1f(GL.MAP1_COLOR_4, 0.0, 1.0, 4, 2, [0.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.25, 1.0])
    gl.Enable(GL.MAP1_COLOR_4)
    gl.Color3f(0.0, 1.0, 0.0)
    columns = _points(gl, ("EvalCoord1f", 0.5), ("Vertex2f", 0.0, 0.0))
    assert columns["colors"] == [[0.5, 0.25, 0.125, 0.5], [0.0, 1.0, 0.0, 1.0]]
    assert gl.current.color == (0.0, 1.0, 0.0, 1.0)


def test_the_map_with_most_components_counts():
    gl = _curved()
    textured(gl, 0)
    gl.Map1f(GL.MAP1_VERTEX_4, 0.0, 1.0, 4, 1, [1.0, 2.0, 3.0, 4.0])
    gl.Map1f(GL.MAP1_TEXTURE_COORD_1, 0.0, 1.0, 1, 1, [9.0])
    gl.Map1f(GL.MAP1_TEXTURE_COORD_2, 0.0, 1.0, 2, 1, [0.5, 0.75])
    for token in (GL.MAP1_VERTEX_4, GL.MAP1_TEXTURE_COORD_1, GL.MAP1_TEXTURE_COORD_2):
        gl.Enable(token)
    columns = _points(gl, ("EvalCoord1f", 0.5))
    assert columns["positions"] == [[1.0, 2.0, 3.0, 4.0]]
    assert columns["texture 0"] == [[0.5, 0.75, 0.0, 1.0]]


def test_without_a_map_of_vertices_nothing_happens():
    gl = context()
    gl.Enable(GL.MAP1_COLOR_4)
    gl.Begin(GL.POINTS)
    gl.EvalCoord1f(0.5)
    gl.EvalCoord2f(0.5, 0.5)
    gl.EvalPoint1(0)
    gl.End()
    gl.EvalMesh1(GL.LINE, 0, 1)
    gl.EvalMesh2(GL.FILL, 0, 1, 0, 1)
    assert not gl.take_commands()
    assert not refusals(gl)


# ------------------------------------------------------------------------------------------------- normals


def _lit(gl):
    gl.Enable(GL.LIGHTING)
    gl.Enable(GL.LIGHT0)
    gl.Normal3f(1.0, 0.0, 0.0)
    return gl


@pytest.mark.parametrize("domain", [(0.0, 1.0, 0.0, 1.0), (2.0, 5.0, -1.0, 1.0), (1.0, 0.0, 0.0, 1.0)])
def test_normals_of_a_saddle(domain):
    # (x, y, x y) over the unit square has the normal (-y, -x, 1).
    gl = _lit(context())
    u1, u2, v1, v2 = domain
    saddle = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]
    gl.Map2f(GL.MAP2_VERTEX_3, u1, u2, 6, 2, v1, v2, 3, 2, saddle)
    gl.Enable(GL.MAP2_VERTEX_3)
    gl.Enable(GL.AUTO_NORMAL)
    x, y = 0.25, 0.625
    columns = _points(gl, ("EvalCoord2f", u1 + x * (u2 - u1), v1 + y * (v2 - v1)))
    sign = 1.0 if u2 > u1 else -1.0  # a domain that runs backwards turns the surface over
    expected = sign * np.array([-y, -x, 1.0]) / math.sqrt(x * x + y * y + 1.0)
    assert np.allclose(columns["positions"], [[x, y, x * y, 1.0]])
    assert np.allclose(columns["normals"], [expected])


def test_normals_of_a_rational_cylinder():
    # A quarter of a circle as a rational quadratic, moved along z: normals are the positions without z.
    gl = _lit(context())
    w = math.sqrt(0.5)
    arc = [(1.0, 0.0, 1.0), (w, w, w), (0.0, 1.0, 1.0)]
    points = [value for x, y, c in arc for z in (0.0, 1.0) for value in (x, y, z * c, c)]
    gl.Map2d(GL.MAP2_VERTEX_4, 0.0, 1.0, 8, 3, 0.0, 1.0, 4, 2, points)
    gl.Enable(GL.MAP2_VERTEX_4)
    gl.Enable(GL.AUTO_NORMAL)
    places = [(u, 0.5) for u in (0.0, 0.2, 0.5, 1.0)]
    columns = _points(gl, *[("EvalCoord2d", *place) for place in places])
    positions = np.array(columns["positions"])
    flat = positions[:, :2] / positions[:, 3:]
    assert np.allclose((flat * flat).sum(axis=1), 1.0)
    assert np.allclose(np.array(columns["normals"])[:, :2], flat)
    assert np.allclose(np.array(columns["normals"])[:, 2], 0.0)


def test_normals_by_a_map_and_where_there_are_none():
    gl = _lit(context())
    gl.Map2f(GL.MAP2_VERTEX_3, 0.0, 1.0, 3, 1, 0.0, 1.0, 3, 1, [1.0, 2.0, 3.0])
    gl.Enable(GL.MAP2_VERTEX_3)
    assert _points(gl, ("EvalCoord2f", 0.5, 0.5))["normals"] == [[1.0, 0.0, 0.0]]  # the current one
    gl.Map2f(GL.MAP2_NORMAL, 0.0, 1.0, 3, 1, 0.0, 1.0, 3, 1, [0.0, 0.5, 0.5])
    gl.Enable(GL.MAP2_NORMAL)
    assert _points(gl, ("EvalCoord2f", 0.5, 0.5))["normals"] == [[0.0, 0.5, 0.5]]
    gl.Enable(GL.AUTO_NORMAL)  # of a point: no tangents
    assert _points(gl, ("EvalCoord2f", 0.5, 0.5))["normals"] == [[0.0, 0.0, 0.0]]


# -------------------------------------------------------------------------------------------------- meshes


def _surface():
    gl = _lit(context())
    textured(gl, 0, 1)
    random = np.random.default_rng(5)
    gl.Map2f(GL.MAP2_VERTEX_3, 0.0, 1.0, 12, 3, 0.0, 1.0, 3, 4, random.random(36).tolist())
    gl.Map2f(GL.MAP2_TEXTURE_COORD_2, 0.0, 1.0, 4, 2, 0.0, 1.0, 2, 2, random.random(8).tolist())
    gl.Map2f(GL.MAP2_COLOR_4, 0.0, 1.0, 8, 2, 0.0, 1.0, 4, 2, random.random(16).tolist())
    gl.MapGrid2f(5, 0.1, 0.9, 4, 1.0, 0.0)
    gl.MultiTexCoord2f(GL.TEXTURE1, 0.5, 0.25)
    for token in (GL.MAP2_VERTEX_3, GL.MAP2_TEXTURE_COORD_2, GL.MAP2_COLOR_4, GL.AUTO_NORMAL):
        gl.Enable(token)
    return gl


def _strips(gl):
    """The vertices of each strip that was drawn."""
    found = []
    for primitive, counts, columns, _ in draws(gl):
        count = len(columns["positions"])
        ends = np.cumsum(counts or (count,)).tolist()
        for first, last in zip([0, *ends], ends, strict=False):
            found.append((primitive, {name: column[first:last] for name, column in columns.items()}))
    return found


def _assert_alike(found, expected):
    assert [primitive for primitive, _ in found] == [primitive for primitive, _ in expected]
    for (_, ours), (_, theirs) in zip(found, expected, strict=True):
        for name, column in theirs.items():
            assert np.allclose(ours[name], column, rtol=1e-12, atol=1e-12), name


def _by_the_specification(gl, mode, i1, i2, j1, j2):
    """Section 5.1's fragment of code, with points of the grid."""
    if mode == GL.FILL:
        for j in range(j1, j2):
            gl.Begin(GL.QUAD_STRIP)
            for i in range(i1, i2 + 1):
                gl.EvalPoint2(i, j)
                gl.EvalPoint2(i, j + 1)
            gl.End()
    elif mode == GL.LINE:
        for j in range(j1, j2 + 1):
            gl.Begin(GL.LINE_STRIP)
            for i in range(i1, i2 + 1):
                gl.EvalPoint2(i, j)
            gl.End()
        for i in range(i1, i2 + 1):
            gl.Begin(GL.LINE_STRIP)
            for j in range(j1, j2 + 1):
                gl.EvalPoint2(i, j)
            gl.End()
    else:
        gl.Begin(GL.POINTS)
        for j in range(j1, j2 + 1):
            for i in range(i1, i2 + 1):
                gl.EvalPoint2(i, j)
        gl.End()


@pytest.mark.parametrize("mode", [GL.FILL, GL.LINE, GL.POINT])
@pytest.mark.parametrize(
    "part", [(0, 5, 0, 4), (1, 3, 2, 4), (-1, 6, 0, 1), (2, 2, 0, 4), (0, 5, 3, 3), (3, 2, 0, 4)]
)
def test_a_mesh_is_its_points(mode, part):
    expected, found = _surface(), _surface()
    _by_the_specification(expected, mode, *part)
    found.EvalMesh2(mode, *part)
    assert not refusals(found)
    _assert_alike(_strips(found), _strips(expected))


@pytest.mark.parametrize(("mode", "primitive"), [(GL.POINT, GL.POINTS), (GL.LINE, GL.LINE_STRIP)])
def test_a_mesh_of_one_dimension_is_its_points(mode, primitive):
    expected, found = _curved(), _curved()
    for gl in (expected, found):
        gl.MapGrid1d(7, 0.2, 0.8)
    expected.Begin(primitive)
    for i in range(2, 8):
        expected.EvalPoint1(i)
    expected.End()
    found.EvalMesh1(mode, 2, 7)
    _assert_alike(_strips(found), _strips(expected))


def test_the_ends_of_a_grid_are_exact():
    gl = context()
    gl.Map1d(GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 2, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    gl.Enable(GL.MAP1_VERTEX_3)
    low, high = -0.7, 0.1  # 49 ((0.1 - -0.7) / 49) + -0.7 is not 0.1
    gl.MapGrid1d(49, low, high)
    columns = _points(gl, ("EvalPoint1", 0), ("EvalPoint1", 49))
    assert [p[0] for p in columns["positions"]] == [low, high]


def test_the_grid_and_what_is_enabled_are_pushed_and_popped():
    gl = _curved()
    gl.PushAttrib(GL.EVAL_BIT)
    gl.MapGrid1f(3, 5.0, 6.0)
    gl.MapGrid2f(3, 5.0, 6.0, 7, 8.0, 9.0)
    gl.Disable(GL.MAP1_VERTEX_3)
    gl.Enable(GL.AUTO_NORMAL)
    gl.PopAttrib()
    assert gl.values["map_grid1"] == (1, 0.0, 1.0)
    assert gl.values["map_grid2"] == (1, 0.0, 1.0, 1, 0.0, 1.0)
    assert gl.IsEnabled(GL.MAP1_VERTEX_3)
    assert not gl.IsEnabled(GL.AUTO_NORMAL)


def test_a_list_keeps_control_points():
    gl = context()
    points = np.array(_CURVE)
    gl.NewList(1, GL.COMPILE)
    gl.Map1d(GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 3, points)
    gl.EndList()
    points[:] = 77.0
    gl.Enable(GL.MAP1_VERTEX_3)
    gl.CallList(1)
    assert _points(gl, ("EvalCoord1f", 0.5))["positions"][0][:3] == _quadratic(0.5).tolist()


def test_a_mesh_again_is_the_same_mesh():
    gl = _surface()
    gl.EvalMesh2(GL.FILL, 0, 5, 0, 4)
    gl.EvalMesh2(GL.FILL, 0, 5, 0, 4)
    first, second = meshes(gl)
    assert first is second


# ----------------------------------------------------------------------------------------- what goes wrong


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("Map1f", (GL.MAP2_VERTEX_3, 0.0, 1.0, 3, 1, [0.0] * 3), "INVALID_ENUM"),
        ("Map1f", (GL.MAP1_VERTEX_3, 1.0, 1.0, 3, 1, [0.0] * 3), "INVALID_VALUE"),
        ("Map1f", (GL.MAP1_VERTEX_3, 0.0, 1.0, 2, 1, [0.0] * 3), "INVALID_VALUE"),
        ("Map1f", (GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 0, [0.0] * 3), "INVALID_VALUE"),
        ("Map1f", (GL.MAP1_VERTEX_3, 0.0, 1.0, 3, MAX_EVAL_ORDER + 1, [0.0] * 300), "INVALID_VALUE"),
        ("Map2f", (GL.MAP2_VERTEX_3, 0.0, 1.0, 3, 1, 2.0, 2.0, 3, 1, [0.0] * 3), "INVALID_VALUE"),
        ("Map2f", (GL.MAP2_VERTEX_3, 0.0, 1.0, 3, 1, 2.0, 3.0, 1, 1, [0.0] * 3), "INVALID_VALUE"),
        ("MapGrid1f", (0, 0.0, 1.0), "INVALID_VALUE"),
        ("MapGrid2f", (1, 0.0, 1.0, -1, 0.0, 1.0), "INVALID_VALUE"),
        ("EvalMesh1", (GL.FILL, 0, 1), "INVALID_ENUM"),
        ("EvalMesh2", (GL.POLYGON, 0, 1, 0, 1), "INVALID_ENUM"),
    ],
)
def test_errors(call, arguments, kind):
    gl = context()
    gl.call(f"gl{call}", arguments)
    ((sentence, _),) = refusals(gl)
    assert sentence.startswith(f"gl{call}: GL_{kind}")


def test_maps_belong_to_the_first_unit():
    gl = context()
    gl.ActiveTexture(GL.TEXTURE1)
    gl.Map1f(GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 1, [0.0] * 3)
    assert counted(gl, "error") == [("glMap1f: GL_INVALID_OPERATION, the active texture unit is not 0", 1)]


@pytest.mark.parametrize(
    ("call", "arguments", "sentence"),
    [
        ("Map1f", (GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 2, [0.0] * 5), "it has 5 numbers, where 6 are read"),
        ("Map1f", (GL.MAP1_VERTEX_3, 0.0, 1.0, 2**31 - 1, 30, [0.0] * 5), "it has 5 numbers, where"),
        ("Map1f", (GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 2, 4711), "its control points were not recorded"),
        ("EvalMesh1", (GL.LINE, 0, 2**31 - 1), "it has 2147483648 points in a row"),
        ("EvalMesh2", (GL.LINE, 0, 99_999, 0, 99_999), "it has 10000000000 points"),
    ],
)
def test_refusals(call, arguments, sentence):
    gl = context()
    gl.call(f"gl{call}", arguments)
    ((said, _),) = counted(gl, "refused")
    assert said.startswith(f"gl{call}: {sentence}")


def test_control_points_that_are_no_numbers():
    gl = context()
    gl.Map1f(GL.MAP1_VERTEX_3, 0.0, 1.0, 3, 1, [math.nan] * 3)
    gl.Enable(GL.MAP1_VERTEX_3)
    gl.EvalMesh1(GL.POINT, 0, 1)
    assert counted(gl, "left out") == [("glEvalMesh1: a vertex's position is infinite or no number", 1)]

"""Matrix stacks: products and inverses in a fixed order, rotations that are the same everywhere, errors."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.opengl.matrices import inverse_modelview, multiplied, rounded, top
from fixedpipe.pipeline.opengl.outcomes import LeftOut
from fixedpipe.pipeline.state import IDENTITY
from tests.pipeline.opengl.drawn import context

_number = st.floats(-8.0, 8.0, width=32)
_matrices = st.tuples(*[st.tuples(*[_number] * 4)] * 4)


def modelview(gl):
    return top(gl, "modelview")


@given(_matrices, _matrices)
def test_a_product_is_summed_from_the_first_term_to_the_last(a, b):
    found = multiplied(a, b)
    for i in range(4):
        for j in range(4):
            total = a[i][0] * b[0][j]
            for k in range(1, 4):
                total = total + a[i][k] * b[k][j]
            assert found[i][j] == total
            exact = sum(Fraction(a[i][k]) * Fraction(b[k][j]) for k in range(4))
            most = sum(abs(Fraction(a[i][k]) * Fraction(b[k][j])) for k in range(4))
            assert abs(Fraction(found[i][j]) - exact) <= 4 * most / 2**52  # three sums, four products


@given(_matrices)
def test_an_inverse_gives_the_identity(matrix):
    assume(abs(np.linalg.det(np.array(matrix))) > 1.0)
    gl = context()
    gl.LoadTransposeMatrixd([c for row in matrix for c in row])
    product = np.array(multiplied(inverse_modelview(gl), matrix))
    # The condition is bounded: the elements, and the determinant from below.
    assert np.abs(product - np.eye(4)).max() < 1e-8


@pytest.mark.parametrize("matrix", [np.zeros((4, 4)), np.ones((4, 4)), np.full((4, 4), np.nan)])
def test_a_plane_under_a_matrix_without_inverse_is_left_out(matrix):
    gl = context()
    gl.LoadMatrixd(matrix.reshape(-1))
    with pytest.raises(LeftOut, match="no inverse"):
        inverse_modelview(gl)
    gl.ClipPlane(t.CLIP_PLANE0, [1.0, 0.0, 0.0, 0.0])
    assert [outcome.what for outcome in gl.tally.of("left out")] == [
        "glClipPlane: the modelview matrix has no inverse"
    ]


def test_quarter_turns_are_exact():
    gl = context()
    gl.Rotatef(90.0, 0.0, 0.0, 2.0)
    assert modelview(gl) == ((0.0, -1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), IDENTITY[3])
    gl.Rotatef(float("nan"), 0.0, 0.0, 1.0)
    gl.Rotatef(30.0, 0.0, 0.0, 0.0)  # no axis: undefined, and nothing happens
    assert modelview(gl)[0] == (0.0, -1.0, 0.0, 0.0)


@given(st.floats(-1e3, 1e3))
def test_a_rounded_value_is_the_nearest_multiple(value):
    found = rounded(value)
    assert (found * 2.0**32).is_integer() and abs(found - value) <= 2.0**-33
    # A last bit that differs makes no difference, but where the value lies between two multiples.
    between = abs(value * 2.0**32 % 1.0 - 0.5) < 1e-3
    assert between or rounded(float(np.nextafter(value, np.inf))) == found


def test_rows_first_and_columns_first():
    columns = [float(n) for n in range(16)]
    gl, other = context(), context()
    gl.LoadMatrixf(columns)
    other.LoadTransposeMatrixf(np.array(columns).reshape(4, 4).T)
    assert modelview(gl) == modelview(other) and modelview(gl)[0] == (0.0, 4.0, 8.0, 12.0)
    gl.MultMatrixf(columns)
    other.MultTransposeMatrixf(np.array(columns).reshape(4, 4).T)
    assert modelview(gl) == modelview(other)


def test_stacks_and_arguments_that_opengl_refuses():
    gl = context()
    gl.PopMatrix()
    assert gl.GetError() == t.STACK_UNDERFLOW
    for _ in range(32):
        gl.PushMatrix()
    assert gl.GetError() == t.STACK_OVERFLOW
    gl.Frustum(-1.0, 1.0, -1.0, 1.0, 0.0, 5.0)
    assert gl.GetError() == t.INVALID_VALUE
    gl.Ortho(1.0, 1.0, -1.0, 1.0, 0.0, 5.0)
    assert gl.GetError() == t.INVALID_VALUE
    gl.MatrixMode(t.LIGHT0)
    assert gl.GetError() == t.INVALID_ENUM
    gl.Viewport(0, 0, -1, 4)
    assert gl.GetError() == t.INVALID_VALUE
    assert modelview(gl) == IDENTITY


def test_vectors_are_lists_tuples_or_arrays():
    gl = context()
    for given_color in ([0.25, 0.5, 0.75], (0.25, 0.5, 0.75), np.array([0.25, 0.5, 0.75], np.float32)):
        gl.Color3f(0.0, 0.0, 0.0)
        gl.Color3fv(given_color)
        gl.MultiTexCoord2fv(t.TEXTURE1, given_color)
        assert gl.current.color == (0.25, 0.5, 0.75, 1.0)
        assert gl.current.texture_coordinates[1] == (0.25, 0.5, 0.0, 1.0)
    assert gl.tally.count("refused") == 0


def test_a_viewport_is_at_most_the_machines_largest():
    gl = context("GEFORCE_256")
    gl.Viewport(-3, 5, 2560, 1440)
    viewport = gl.state().vertex.viewport
    assert (viewport.x, viewport.y, viewport.width, viewport.height) == (-3, 5, 2048, 1440)


def test_matrices_of_vertex_programs_are_no_modelview():
    gl = context()
    for mode in (t.MATRIX0_NV, t.MATRIX0_ARB + 7):
        gl.MatrixMode(mode)
        assert gl.GetIntegerv(t.MATRIX_MODE) == mode
        gl.Translatef(1.0, 2.0, 3.0)
    assert modelview(gl) == IDENTITY
    gl.MatrixMode(t.MATRIX0_ARB + 8)
    assert gl.error == t.INVALID_ENUM

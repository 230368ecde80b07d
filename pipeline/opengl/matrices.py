"""Matrix stacks (OpenGL 1.2.1 section 2.10.2).

Assumed: products are computed in float64. Drivers used float32 or the processor's 80 bits; a state dump of a
driver would settle it.
"""

import math
from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import IDENTITY, Matrix, Viewport

# How many matrices each stack holds. Assumed: all hold the specification's minimum for MODELVIEW.
_DEPTH = 32

declare("matrix_mode", tokens.MODELVIEW, tokens.TRANSFORM_BIT)
declare("active_texture", 0, tokens.TEXTURE_BIT)
for _stack in ("modelview", "modelview1", "projection", "color matrix"):
    declare(_stack, (IDENTITY,))  # the top of a stack is the last element
for _unit in range(COORDINATE_SETS):
    declare(("texture matrix", _unit), (IDENTITY,))
# The matrices that only vertex programs read (NV_vertex_program, ARB_vertex_program), by the names of both.
PROGRAM_MATRICES = 8
_NAMED = {
    tokens.MODELVIEW: "modelview",
    tokens.MODELVIEW1_EXT: "modelview1",
    tokens.PROJECTION: "projection",
    tokens.COLOR: "color matrix",
}
for _number in range(PROGRAM_MATRICES):
    declare(("program matrix", _number), (IDENTITY,))
    for _first in (tokens.MATRIX0_NV, tokens.MATRIX0_ARB):
        _NAMED[_first + _number] = "program matrix", _number
declare("viewport", lambda gl: (0, 0, gl.drawable.width, gl.drawable.height), tokens.VIEWPORT_BIT)
declare("depth_range", (0.0, 1.0), tokens.VIEWPORT_BIT)


@section("viewport section", "viewport", "depth_range")
def _viewport(gl, viewport, depth_range):
    # Clamped to the machine's largest; queries answer with the size that was given.
    largest = gl.profile.framebuffers.max_viewport
    x, y, width, height = viewport
    return Viewport(x, y, min(width, largest), min(height, largest), *depth_range)


def _stack_key(gl):
    mode = gl.values["matrix_mode"]
    if mode == tokens.TEXTURE:
        return "texture matrix", gl.values["active_texture"]
    return _NAMED[mode]


def top(gl, key):
    """The top of a stack, as rows."""
    return gl.values[key][-1]


# Mathematical libraries differ in the last bits of results.
_STEP = 2.0**-32


def rounded(value: float) -> float:
    """The value of a transcendental function, rounded to 2^-32, so that all computers give the same value."""
    return math.floor(value / _STEP + 0.5) * _STEP


def multiplied(a, b):
    """The product of two matrices. Each element is summed from the first term to the last.

    NumPy's products fuse and reorder operations, so their bits differ between processors.
    """
    columns = tuple(zip(*b, strict=True))
    return tuple(
        [tuple([((r[0] * c[0] + r[1] * c[1]) + r[2] * c[2]) + r[3] * c[3] for c in columns]) for r in a]
    )


def inverse_modelview(gl) -> Matrix:
    """The inverse of the modelview matrix. Raises LeftOut if there is none in float64."""
    found = inverse(top(gl, "modelview"))
    if found is None:
        raise LeftOut("the modelview matrix has no inverse")
    return found


@lru_cache(maxsize=64)
def inverse(matrix: Matrix) -> Matrix | None:
    """The inverse of a matrix, by Gauss-Jordan elimination with the largest pivot of each column; None if
    there is none in float64.
    """
    rows = [[*map(float, row), *IDENTITY[i]] for i, row in enumerate(matrix)]
    for k in range(4):
        pivot = max(range(k, 4), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        divisor = rows[k][k]
        if divisor == 0.0 or not math.isfinite(divisor):
            return None
        rows[k] = [value / divisor for value in rows[k]]
        for i in range(4):
            if i != k:
                factor = rows[i][k]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    found = tuple([tuple(row[4:]) for row in rows])
    return found if all(math.isfinite(value) for row in found for value in row) else None


def times_inverse_modelview(gl, plane):
    """A plane in eye coordinates: its four coefficients times the inverse modelview matrix."""
    columns = zip(*inverse_modelview(gl), strict=True)
    return tuple([((plane[0] * c[0] + plane[1] * c[1]) + plane[2] * c[2]) + plane[3] * c[3] for c in columns])


def _rows(matrix):
    return tuple(map(tuple, np.asarray(matrix, float).tolist()))


def _columns(values):
    return _rows(np.array(values, float).reshape(4, 4).T)


def _load(gl, matrix):
    key = _stack_key(gl)
    gl.values.set(key, (*gl.values[key][:-1], matrix))


def _multiply(gl, matrix):
    _load(gl, multiplied(top(gl, _stack_key(gl)), matrix))


@entry("MatrixMode")
def matrix_mode(gl, mode):
    """Choose the stack that matrix calls change."""
    if mode != tokens.TEXTURE and mode not in _NAMED:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(mode)} is no matrix")
    gl.values.set("matrix_mode", mode)


@entry("LoadIdentity")
def load_identity(gl):
    """Replace the top of the stack by the identity."""
    _load(gl, IDENTITY)


@entry("LoadMatrixf", "LoadMatrixd")
def load_matrix(gl, values):
    """Replace the top of the stack by 16 numbers, column by column."""
    _load(gl, _columns(values))


@entry("MultMatrixf", "MultMatrixd")
def mult_matrix(gl, values):
    """Multiply the top of the stack by 16 numbers, column by column."""
    _multiply(gl, _columns(values))


@entry("LoadTransposeMatrixf", "LoadTransposeMatrixd")
def load_transpose_matrix(gl, values):
    """Replace the top of the stack by 16 numbers, row by row (ARB_transpose_matrix)."""
    _load(gl, _rows(np.array(values, float).reshape(4, 4)))


@entry("MultTransposeMatrixf", "MultTransposeMatrixd")
def mult_transpose_matrix(gl, values):
    """Multiply the top of the stack by 16 numbers, row by row (ARB_transpose_matrix)."""
    _multiply(gl, _rows(np.array(values, float).reshape(4, 4)))


@entry("PushMatrix")
def push_matrix(gl):
    """Push a copy of the top."""
    key = _stack_key(gl)
    stack = gl.values[key]
    if len(stack) >= _DEPTH:
        raise GLError(tokens.STACK_OVERFLOW)
    gl.values.set(key, (*stack, stack[-1]))


@entry("PopMatrix")
def pop_matrix(gl):
    """Remove the top."""
    key = _stack_key(gl)
    stack = gl.values[key]
    if len(stack) == 1:
        raise GLError(tokens.STACK_UNDERFLOW)
    gl.values.set(key, stack[:-1])


@entry("Translatef", "Translated")
def translate(gl, x, y, z):
    """Multiply by a translation."""
    _multiply(gl, ((1, 0, 0, x), (0, 1, 0, y), (0, 0, 1, z), (0, 0, 0, 1)))


@entry("Scalef", "Scaled")
def scale(gl, x, y, z):
    """Multiply by a scale."""
    _multiply(gl, ((x, 0, 0, 0), (0, y, 0, 0), (0, 0, z, 0), (0, 0, 0, 1)))


@entry("Rotatef", "Rotated")
def rotate(gl, angle, x, y, z):
    """Multiply by a rotation of ``angle`` degrees. An axis of length 0 does not change the matrix."""
    length = math.sqrt(x * x + y * y + z * z)
    if not length or not math.isfinite(length) or not math.isfinite(angle):
        return
    x, y, z = x / length, y / length, z / length
    cosine, sine = (rounded(of(math.radians(angle))) for of in (math.cos, math.sin))
    rest = 1 - cosine
    _multiply(
        gl,
        (
            (x * x * rest + cosine, x * y * rest - z * sine, x * z * rest + y * sine, 0),
            (y * x * rest + z * sine, y * y * rest + cosine, y * z * rest - x * sine, 0),
            (z * x * rest - y * sine, z * y * rest + x * sine, z * z * rest + cosine, 0),
            (0, 0, 0, 1),
        ),
    )


@entry("Frustum")
def frustum(gl, left, right, bottom, top, near, far):
    """Multiply by a perspective projection."""
    if near <= 0 or far <= 0 or left == right or bottom == top or near == far:
        raise GLError(tokens.INVALID_VALUE)
    _multiply(
        gl,
        (
            (2 * near / (right - left), 0, (right + left) / (right - left), 0),
            (0, 2 * near / (top - bottom), (top + bottom) / (top - bottom), 0),
            (0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)),
            (0, 0, -1, 0),
        ),
    )


@entry("Ortho")
def ortho(gl, left, right, bottom, top, near, far):
    """Multiply by a parallel projection."""
    if left == right or bottom == top or near == far:
        raise GLError(tokens.INVALID_VALUE)
    _multiply(
        gl,
        (
            (2 / (right - left), 0, 0, -(right + left) / (right - left)),
            (0, 2 / (top - bottom), 0, -(top + bottom) / (top - bottom)),
            (0, 0, -2 / (far - near), -(far + near) / (far - near)),
            (0, 0, 0, 1),
        ),
    )


@entry("Viewport")
def viewport(gl, x, y, width, height):
    """Set the viewport (section 2.10.1)."""
    if width < 0 or height < 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.values.set("viewport", (int(x), int(y), int(width), int(height)))


@entry("DepthRange", "DepthRangef")
def depth_range(gl, near, far):
    """Set the depths of the near and far plane, clamped to [0, 1]."""
    gl.values.set("depth_range", (min(max(float(near), 0.0), 1.0), min(max(float(far), 0.0), 1.0)))

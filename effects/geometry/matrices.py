"""Projection and viewing matrices as tuples of rows (OpenGL 1.2.1 section 2.10.2; GLU's perspective and
look-at).

Sines, cosines and the numbers derived from them are rounded so that they have the same bits everywhere.
"""

import math
from functools import reduce
from operator import add

import numpy as np

from fixedpipe.effects.geometry.vectors import cosine, cross, dot, sine, unit_vector


def _rows(array):
    return tuple(tuple(float(v) for v in row) for row in array)


def orthographic(left, right, bottom, top, near=-1.0, far=1.0):
    """Ortho of OpenGL 1.2.1 section 2.10.2: the box becomes the view volume; near and far are distances."""
    return _rows(
        (
            (2.0 / (right - left), 0, 0, -(right + left) / (right - left)),
            (0, 2.0 / (top - bottom), 0, -(top + bottom) / (top - bottom)),
            (0, 0, -2.0 / (far - near), -(far + near) / (far - near)),
            (0, 0, 0, 1),
        )
    )


def product(first, *others):
    """The product of 4x4 matrices, the leftmost first; sums in a fixed order, which ``sum`` has not."""
    for other in others:
        first = _rows(
            [reduce(add, (row[k] * other[k][column] for k in range(4)), 0.0) for column in range(4)]
            for row in first
        )
    return first


def perspective(field_of_view, aspect, near, far):
    """A perspective projection: vertical field of view in degrees, aspect = width / height, plane
    distances.
    """
    half = math.radians(field_of_view) / 2
    f = float(cosine(half) / sine(half))
    return _rows(
        (
            (f / aspect, 0, 0, 0),
            (0, f, 0, 0),
            (0, 0, (far + near) / (near - far), 2.0 * far * near / (near - far)),
            (0, 0, -1, 0),
        )
    )


def look_at(eye, center, up=(0.0, 1.0, 0.0)):
    """The viewing matrix of an eye that looks at ``center``. Raises ValueError when ``up`` lies along the
    view.
    """
    eye, center = np.asarray(eye, np.float64), np.asarray(center, np.float64)
    forward = unit_vector(center - eye, "The direction from the eye to the centre")
    side = unit_vector(cross(forward, np.asarray(up, np.float64)), "The view direction x the up vector")
    above = cross(side, forward)
    rows = [(*axis, -float(dot(axis, eye))) for axis in (side, above, -forward)]
    return _rows((*rows, (0, 0, 0, 1)))


def rigid_inverse(matrix):
    """The inverse of a viewing matrix that only turns and moves."""
    turned = [[matrix[j][i] for j in range(3)] for i in range(3)]
    moved = [matrix[i][3] for i in range(3)]
    rows = [(*row, -((row[0] * moved[0] + row[1] * moved[1]) + row[2] * moved[2])) for row in turned]
    return _rows((*rows, (0, 0, 0, 1)))


def transform(matrix, point):
    """A 4x4 matrix applied to (x, y, z, w): four floats, or arrays of them, sums in a fixed order."""
    x, y, z, w = point
    return tuple(((a * x + b * y) + c * z) + d * w for a, b, c, d in matrix)


def eye_plane(plane, modelview):
    """A plane of world coordinates (a, b, c, d) in the eye coordinates of a rigid viewing matrix: what OpenGL
    does when an EYE_PLANE is specified (section 2.10.4).
    """
    inverse = rigid_inverse(modelview)
    return tuple(
        ((plane[0] * inverse[0][k] + plane[1] * inverse[1][k]) + plane[2] * inverse[2][k])
        + plane[3] * inverse[3][k]
        for k in range(4)
    )


def rotation(axis, degrees):
    """A 3x3 rotation about a coordinate axis 'x', 'y' or 'z', counter-clockwise seen from its tip: float64
    array.
    """
    i = "xyz".index(axis)
    c, s = float(cosine(math.radians(degrees))), float(sine(math.radians(degrees)))
    j, k = (i + 1) % 3, (i + 2) % 3
    out = np.eye(3)
    out[j, j], out[j, k], out[k, j], out[k, k] = c, -s, s, c
    return out


def rotate(matrix, vectors):
    """A 3x3 matrix applied to vectors [..., 3], in a fixed order of operations."""
    return np.stack([dot(vectors, row) for row in matrix], axis=-1)

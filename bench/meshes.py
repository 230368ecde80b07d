"""The meshes that the scenes draw, and the matrices that show them."""

import math
from functools import cache

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import PrimitiveType

# Light vectors as colours, lower left, lower right, upper left, upper right. Scenes without a bump map show
# them as Gouraud colours.
_LIGHTS = ((0.3, 0.3, 0.9, 1.0), (0.8, 0.3, 0.85, 1.0), (0.3, 0.8, 0.85, 1.0), (0.7, 0.7, 0.9, 1.0))


def quad(w_far=1.0, z=0.0, scale=1.0, colors=_LIGHTS, units=0):
    """A strip of two triangles over the whole screen, in clip coordinates.

    w runs from 1 at the bottom to ``w_far`` at the top; z/w is ``z``. s and t are affine in clip x and y, so
    that both triangles carry one perspective mapping, ``scale`` repeats of the texture along an affine edge.
    """
    corners = np.array([(-1, -1, 1, 1), (1, -1, 1, 1), (-1, 1, 1, 1), (1, 1, 1, 1)], np.float64)
    corners[:, 2] = z
    corners[2:] *= w_far
    repeats = scale if w_far == 1.0 else 0.75 * scale
    st = (corners[:, :2] + 1) / 2 * repeats
    return Mesh(corners, PrimitiveType.TRIANGLE_STRIP, colors=colors, texture_coordinates=(st,) * units)


def tiles(size, number=11, w_far=2.5, scale=1.0):
    """``quad``'s surface in perspective as ``number`` x ``number`` Meshes of two triangles, row by row.

    Their edges lie at whole pixels of ``size``, where no renderer's snapping moves them. z/w is 1 - 1/w. The
    second set of coordinates is the first with s and t exchanged.
    """
    edges = 2 * np.rint(np.linspace(0, size, number + 1)) / size - 1
    found = []
    for row in range(number):
        for column in range(number):
            x, y = (a.ravel() for a in np.meshgrid(edges[column : column + 2], edges[row : row + 2]))
            w = 1 / (1 - (1 - 1 / w_far) * (y + 1) / 2)
            corners = np.stack([x * w, y * w, w - 1, w], axis=-1)
            st = (corners[:, :2] + 1) / 2 * 0.75 * scale
            strip = PrimitiveType.TRIANGLE_STRIP
            found.append(Mesh(corners, strip, texture_coordinates=(st, st[:, ::-1].copy())))
    return tuple(found)


def grid_triangles(rows, columns):
    """Vertex numbers int64 [2 * rows * columns, 3] of a grid's triangles, two a cell, row by row.

    The grid has (``rows`` + 1) x (``columns`` + 1) vertices; row and column turn counterclockwise.
    """
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    next_row, next_column, opposite = first + columns + 1, first + 1, first + columns + 2
    return np.stack([first, next_row, next_column, next_column, next_row, opposite], axis=-1).reshape(-1, 3)


@cache
def torus(around=200, across=200, major=1.0, minor=0.45):
    """A torus of 2 · ``around`` · ``across`` indexed triangles with (s, t) repeating 4 and 2 times."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, around + 1), np.linspace(0, 2 * np.pi, across + 1), indexing="ij"
    )
    radius = major + minor * np.cos(v)
    positions = np.stack([np.cos(u) * radius, np.sin(u) * radius, minor * np.sin(v)], axis=-1)
    st = np.stack([u / (2 * np.pi) * 4, v / (2 * np.pi) * 2], axis=-1)
    indices = grid_triangles(around, across).ravel()
    return Mesh(positions.reshape(-1, 3), indices=indices, texture_coordinates=(st.reshape(-1, 2),))


def perspective(degrees, near, far):
    """Make gluPerspective's matrix for a square viewport, as rows."""
    f = 1 / math.tan(math.radians(degrees) / 2)
    depth = near - far
    return (
        (f, 0.0, 0.0, 0.0),
        (0.0, f, 0.0, 0.0),
        (0.0, 0.0, (far + near) / depth, 2 * far * near / depth),
        (0.0, 0.0, -1.0, 0.0),
    )


def look_at(eye, target, up=(0.0, 0.0, 1.0)):
    """Make gluLookAt's matrix, as rows."""
    eye = np.asarray(eye, np.float64)
    forward = np.asarray(target) - eye
    forward /= np.linalg.norm(forward)
    side = np.cross(forward, up)
    side /= np.linalg.norm(side)
    rows = [side, np.cross(side, forward), -forward]
    return (*((*map(float, row), float(-row @ eye)) for row in rows), (0.0, 0.0, 0.0, 1.0))

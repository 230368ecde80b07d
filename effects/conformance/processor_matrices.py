"""Matrices as the suites' programs compute them on the processor: single precision, row vectors from the
left, every sum from left to right.

Source: xbox_math3d (xbox_math_matrix, _vector, _d3d, _util) and NV2AState of pbkitplusplus, which the
programs of nxdk_pgraph_tests call.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.pipeline.state import Composite, VertexState

single = np.float32
NEAR, FAR = single(1.0), single(200.0)  # eye distances of the default view volume's planes
EYE = (0.0, 0.0, -7.0)
FARTHEST_16_BIT_FLOAT = 511.9375  # the library's limits of float depth: of the pattern 0x43FFF800,
FARTHEST_24_BIT_FLOAT = float(single(1e30))  # and of 0x7149F2CA


def times(vector, matrix):
    """A row vector [4] times a matrix [4, 4]."""
    terms = [single(vector[k]) * matrix[k] for k in range(4)]
    return ((terms[0] + terms[1]) + terms[2]) + terms[3]


def product(left, right):
    """Matrix times matrix."""
    return np.array([times(row, right) for row in left], single)


def determinant(m):
    """Along the first row."""
    if len(m) == 1:
        return m[0][0]
    minors = (determinant(np.delete(m[1:], column, axis=1)) for column in range(len(m)))
    terms = [m[0][column] * minor for column, minor in enumerate(minors)]
    total = terms[0]
    for column, term in enumerate(terms[1:], 1):
        total = total - term if column % 2 else total + term
    return total


def inverse(m):
    """By cofactors, each times the determinant's reciprocal.

    Measured: Specular/ControlFlagsLightDisable_VS, 300970 of 300970 pixels.
    """
    adjoint = np.empty((4, 4), single)
    for row in range(4):
        for column in range(4):
            minor = np.delete(np.delete(m, row, axis=0), column, axis=1)
            adjoint[column, row] = single((-1) ** (row + column)) * determinant(minor)
    return adjoint * (single(1) / determinant(m))


def _dot(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def _normalized(v):
    """By the reciprocal of the length. Measured: W_buffering ZBuf24D_FloorQuad_V0, 161641 of 161700 depths;
    divided by the length, 2.
    """
    return v * (single(1) / np.sqrt(_dot(v, v)))


def _cross(a, b):
    return np.array([a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))], single)


def look_at(eye, at=(0.0, 0.0, 0.0)):
    """The model view matrix of an eye that looks at a point, y up (CreateD3DLookAtLH)."""
    eye = np.array(eye, single)
    z = _normalized(np.array(at, single) - eye)
    x = _normalized(_cross(np.array((0, 1, 0), single), z))
    y = _cross(z, x)
    matrix = np.eye(4, dtype=single)
    for column, axis in enumerate((x, y, z)):
        matrix[:3, column], matrix[3, column] = axis, single(-1) * _dot(axis, eye)
    return matrix


def viewport(depth_maximum):
    """From the view volume to device pixels and depth units (CreateD3DStandardViewport...)."""
    matrix = np.eye(4, dtype=single)
    matrix[0, 0] = matrix[3, 0] = WIDTH / 2
    matrix[1, 1], matrix[3, 1] = -HEIGHT / 2, HEIGHT / 2
    matrix[2, 2] = depth_maximum
    return matrix


def projection(depth_maximum):
    """The default view's projection, 45 degrees and 4:3, and its viewport."""
    matrix = np.eye(4, dtype=single)
    y_scale = single(1) / np.tan(single(np.pi / 4) * single(0.5))
    adjustment = FAR / (FAR - NEAR)
    matrix[0, 0], matrix[1, 1] = y_scale / single(WIDTH / HEIGHT), y_scale
    matrix[2, 2:] = adjustment, 1
    matrix[3, 2:] = single(-1) * NEAR * adjustment, 0
    return product(matrix, viewport(depth_maximum))


@dataclass(frozen=True, eq=False)
class View:
    """What the programs set for the fixed-function stage: single [4, 4] matrices for row vectors."""

    model_view: np.ndarray
    projection: np.ndarray
    offset: float = scenes.XDK_OFFSET  # of the viewport in x and y, device pixels

    @property
    def composite(self):
        """The chip's matrix."""
        return product(self.model_view, self.projection)

    def vertex_state(self):
        """The same as vertex state."""
        return VertexState(
            modelview=scenes.rows_of(self.model_view.T),
            composite=Composite(scenes.rows_of(self.composite.T), (self.offset, self.offset, 0.0)),
        )

    def unprojected(self, x, y, z):
        """The point [3] that the program takes for device pixel (x, y) and depth ``z``, in depth units."""
        point = times((x, y, z, 1), inverse(self.composite))
        return point[:3] / point[3]

    def unprojected_at(self, x, y, z):
        """The same for a point of a given z of the world: where a line through the pixel comes by."""
        inverted = inverse(self.composite)
        near, far = (times((x, y, depth, 1), inverted) for depth in (0, 64000))
        near, far = near[:3] / near[3], far[:3] / far[3]
        point = near + (far - near) * ((single(z) - near[2]) / (far[2] - near[2]))
        return np.array((point[0], point[1], z), single)


def default_view(depth_maximum=16777215.0, model_view=None):
    """The XDK's default view, its eye at z = -7."""
    return View(look_at(EYE) if model_view is None else model_view, projection(depth_maximum))

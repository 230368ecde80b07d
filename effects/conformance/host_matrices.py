"""The matrices that the suites' programs compute on the console's processor: single precision, its order.

Vectors are rows: ``times(a, b)`` is a, then b. Source: xbox_math3d (xbox_math_matrix, xbox_math_d3d,
xbox_math_util) and pbkitplusplus (NV2AState, ProjectionVertexShader), which the programs call.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.pipeline.state import Composite, VertexState

EYE_DISTANCE, NEAR, FAR = 7.0, 1.0, 200.0
EYE, OFFSET = (0.0, 0.0, -EYE_DISTANCE), 17 / 32  # the latter: the XDK's viewport's, device pixels
FARTHEST_16_BIT_FLOAT = 511.9375  # the library's limits of float depth: of the pattern 0x43FFF800,
FARTHEST_24_BIT_FLOAT = float(np.float32(1e30))  # and of 0x7149F2CA
Z16, Z24 = 65535.0, 16777215.0  # the farthest word of a fixed depth format
FAR_PROBE = 64000.0  # the second of the two depths through which a ray of unproject goes

_f = np.float32


def times(a, b, wide=False):
    """Row vectors or a matrix times a matrix, float32: each sum's four terms from left to right.

    ``wide``: rounded once, when the sum is stored. Measured: the program of Depth_buffer_fixed_function's
    captures rounds every step (40 of 47 exact; rounded once, 25). That of Texture_cubemap's rounds once, as
    the x87 does (DotReflectDiffuse_-1to1GL, all pixels; rounded at every step, all but 70).
    """
    a, b = (np.asarray(m, _f).astype(np.float64 if wide else _f) for m in (a, b))
    terms = [a[..., k, None] * b[k] for k in range(4)]
    return (((terms[0] + terms[1]) + terms[2]) + terms[3]).astype(_f)


def view(eye=EYE_DISTANCE):
    """Looking along z from z = -eye."""
    matrix = np.eye(4, dtype=_f)
    matrix[3, 2] = eye
    return matrix


def projection(near=NEAR, far=FAR):
    """45 degrees high, of the screen's shape, z forwards."""
    y_scale = _f(1) / np.tan(_f(np.pi / 8))
    depth = _f(far) / (_f(far) - _f(near))
    matrix = np.zeros((4, 4), _f)
    matrix[0, 0], matrix[1, 1] = y_scale / _f(WIDTH / HEIGHT), y_scale
    matrix[2, 2:] = depth, 1
    matrix[3, 2] = -_f(near) * depth
    return matrix


def viewport(z_scale, z_offset=0.0):
    """To device pixels, y down, and depth words."""
    matrix = np.eye(4, dtype=_f)
    matrix[0, 0], matrix[1, 1], matrix[2, 2] = WIDTH / 2, -HEIGHT / 2, z_scale
    matrix[3, :3] = WIDTH / 2, HEIGHT / 2, z_offset
    return matrix


def _determinant_3(m):
    (a, b, c), (d, e, f), (g, h, i) = m
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _determinant_4(m):
    """The first row's elements times products of the last two rows, in the library's order."""
    (a, b, c, d), (e, f, g, h), (i, j, k, q), (m_, n, o, p) = m
    kp_lo, jp_ln, jo_kn = k * p - q * o, j * p - q * n, j * o - k * n
    ip_lm, io_km, in_jm = i * p - q * m_, i * o - k * m_, i * n - j * m_
    return (
        (a * ((f * kp_lo - g * jp_ln) + h * jo_kn) - b * ((e * kp_lo - g * ip_lm) + h * io_km))
        + c * ((e * jp_ln - f * ip_lm) + h * in_jm)
    ) - d * ((e * jo_kn - f * io_km) + g * in_jm)


def inverse(matrix, wide=False):
    """By cofactors, times the reciprocal of the determinant. ``wide``: as in ``times``."""
    matrix, out = np.asarray(matrix, np.float64 if wide else _f), np.empty((4, 4), _f)
    for row in range(4):
        for column in range(4):
            minor = np.delete(np.delete(matrix, row, axis=0), column, axis=1)
            out[column, row] = (-1) ** (row + column) * _determinant_3(minor)
    return out * _f(1 / _determinant_4(matrix))


def turned(about_y, about_x, place):
    """A model matrix: turned about y, then about x (MatrixRotate), and moved; its sums are ``wide``."""
    matrix = np.eye(4, dtype=_f)
    for angle, i, j in ((about_y, 2, 0), (about_x, 1, 2)):
        rotation, angle = np.eye(4, dtype=_f), np.float64(_f(angle))
        rotation[i, i] = rotation[j, j] = np.cos(angle)
        rotation[i, j], rotation[j, i] = np.sin(angle), -np.sin(angle)
        matrix = times(matrix, rotation, wide=True)
    moved = np.eye(4, dtype=_f)
    moved[3, :3] = place
    return times(matrix, moved, wide=True)


@cache
def fixed_function(z_maximum=Z16, near=NEAR, far=FAR):
    """The composite matrix of the XDK's default view, and its inverse; not to be written to.

    Measured: depths of 16 bits (Fog_gen's radial captures; with 24 bits 34 pixels of one are lost, not 0),
    and an inverse whose sums are ``wide`` (Viewport, 7 of 7 captures; rounded at every step, 5).
    """
    composite = times(view(), times(projection(near, far), viewport(_f(z_maximum))))
    return composite, inverse(composite, wide=True)


@cache
def programmed(z_maximum=Z24, near=NEAR, far=FAR):
    """The composite matrix of a perspective vertex program's default view, whose depth range is -1 to 1, and
    its inverse; not to be written to. Measured: depths of 24 bits (Fog_exceptional_value, 44 of 44).
    """
    half = _f(z_maximum) * _f(0.5)
    composite = times(view(), times(projection(near, far), viewport(half, half)))
    return composite, inverse(composite)


def unproject(inverse_composite, x, y, z):
    """World positions [n, 3], float32: where the ray through device pixels x, y meets the world's depth z."""
    x, y, z = (np.atleast_1d(np.asarray(v, _f)) for v in (x, y, z))
    planes = []
    for depth in (0.0, FAR_PROBE):
        screen = np.stack([x, y, np.full_like(x, depth), np.ones_like(x)], axis=-1)
        world = times(screen, inverse_composite)
        planes.append(world[:, :3] / world[:, 3:])
    near, far = planes
    t = (z - near[:, 2]) / (far[:, 2] - near[:, 2])
    return np.stack([near[:, i] + (far[:, i] - near[:, i]) * t for i in (0, 1)] + [z], axis=-1)


def xdk_vertex(z_maximum=Z16, near=NEAR, far=FAR, offset=OFFSET):
    """The XDK's default view as vertex state, in the programs' own numbers; ``offset``: the viewport's."""
    composite, _ = fixed_function(z_maximum, near, far)
    return VertexState(
        modelview=_rows(view().T),
        composite=Composite(_rows(composite.T), (offset, offset, 0.0)),
    )


def _rows(matrix):
    return tuple(tuple(row) for row in matrix.tolist())


def uploaded(*matrices):
    """Constants of a vertex program from c[96] on: matrices of the programs, transposed, four rows each."""
    rows = [row for matrix in matrices for row in np.asarray(matrix, _f).T]
    return {96 + i: row for i, row in enumerate(rows)}


def perspective_constants(z_maximum=Z24, near=NEAR, far=FAR, half_range=True):
    """The model, view and projection matrices of a perspective vertex program's default view, as uploaded.

    ``half_range``: the viewport's depth range is -1 to 1; else 0 to 1, in the D3D style.
    """
    half = _f(z_maximum) * _f(0.5)
    device = viewport(half, half) if half_range else viewport(_f(z_maximum))
    return uploaded(np.eye(4), view(), times(projection(near, far), device))


# ------------------------------------------------------------------------------- views by their matrices


def _dot(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def _normalized(v):
    """By the reciprocal of the length. Measured: W_buffering ZBuf24D_FloorQuad_V0, 161641 of 161700 depths;
    divided by the length, 2.
    """
    return v * (_f(1) / np.sqrt(_dot(v, v)))


def _cross(a, b):
    return np.array([a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))], _f)


def look_at(eye, at=(0.0, 0.0, 0.0)):
    """The model view matrix of an eye that looks at a point, y up (CreateD3DLookAtLH)."""
    eye = np.array(eye, _f)
    z = _normalized(np.array(at, _f) - eye)
    x = _normalized(_cross(np.array((0, 1, 0), _f), z))
    y = _cross(z, x)
    matrix = np.eye(4, dtype=_f)
    for column, axis in enumerate((x, y, z)):
        matrix[:3, column], matrix[3, column] = axis, _f(-1) * _dot(axis, eye)
    return matrix


@dataclass(frozen=True, eq=False)
class View:
    """What the programs set for the fixed-function stage: single [4, 4] matrices for row vectors."""

    model_view: np.ndarray
    projection: np.ndarray
    offset: float = OFFSET  # of the viewport in x and y, device pixels

    @property
    def composite(self):
        """The chip's matrix."""
        return times(self.model_view, self.projection)

    def vertex_state(self):
        """The same as vertex state."""
        return VertexState(
            modelview=_rows(self.model_view.T),
            composite=Composite(_rows(self.composite.T), (self.offset, self.offset, 0.0)),
        )

    def unprojected(self, x, y, z):
        """The point [3] that the program takes for device pixel (x, y) and depth ``z``, in depth units."""
        point = times(np.array((x, y, z, 1)), inverse(self.composite))
        return point[:3] / point[3]

    def unprojected_at(self, x, y, z):
        """The same for a point of a given z of the world: where a line through the pixel comes by."""
        inverted = inverse(self.composite)
        near, far = (times(np.array((x, y, depth, 1)), inverted) for depth in (0, 64000))
        near, far = near[:3] / near[3], far[:3] / far[3]
        point = near + (far - near) * ((_f(z) - near[2]) / (far[2] - near[2]))
        return np.array((point[0], point[1], z), _f)


def default_view(depth_maximum=16777215.0, model_view=None):
    """The XDK's default view, its eye at z = -7."""
    return View(
        look_at(EYE) if model_view is None else model_view, times(projection(), viewport(depth_maximum))
    )

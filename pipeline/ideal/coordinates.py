"""Where fragments read textures.

Coordinates are divided by q, placed on a face of a cube, made by a texture shader, or turned along an arc
from vertex to vertex.
"""

from dataclasses import dataclass, replace

import numpy as np
from numba import float64, int32, int64, types, uint64, void

from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.raster import codes as C
from fixedpipe.raster.fixed import projected
from fixedpipe.raster.floats import LEAST_Q, SINGLE_BITS, TAU
from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.portable.interpolate import coordinate_difference, product_step, product_sum

_ROWS, _TRIANGLES = (types.Array(kind, 2, "C", readonly=True) for kind in (float64, int32))
_UNIT_OF_ONE = 2.0 ** (1 - SINGLE_BITS)
_ALONG = types.Tuple((_TRIANGLES, int32[::1], float64[:, ::1]))  # triangles; each fragment's one; weights


@dataclass(frozen=True, eq=False)
class TextureCoordinates:
    """Where fragments read a texture image.

    position  float64 [k, 2], or [k, 3] in a volume; 1.0 = the whole image. slip, dx and dy use the same unit
    face      int64 [k], a cube map's face; otherwise 0
    slip      float64 [k, 2], the machines' coordinates minus ``position``, without their bias
    bias      float64 [k, 1], the texels that the machines add to coordinates that a stage made: TAU or 0
    dx, dy    float64 [k, 2], derivatives of ``position`` per pixel
    """

    position: np.ndarray
    face: np.ndarray
    slip: np.ndarray
    bias: np.ndarray
    dx: np.ndarray
    dy: np.ndarray


@kernel
def _divisor(q):
    return LEAST_Q if q == 0.0 else q


@kernel(void(_ALONG, _ROWS, int64, float64[:, ::1]))
def _divide(along, rows, first, position):
    """Iterate s, t (and r) and divide them by q where some vertex's is not 1."""
    separate_loop()
    triangles, triangle, weights = along
    axes, last = position.shape[1], uint64(first + 3)
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        w0, w2 = weights[0, i], weights[2, i]
        q0, q1, q2 = rows[v0, last], rows[v1, last], rows[v2, last]
        q = ((q0 - q1) * w0 + q1) + (q2 - q1) * w2
        divided = q0 != 1.0 or q1 != 1.0 or q2 != 1.0
        for c in range(axes):
            k = uint64(first + c)
            v = rows[v1, k]
            value = ((rows[v0, k] - v) * w0 + v) + (rows[v2, k] - v) * w2
            position[i, c] = value / _divisor(q) if divided else value


@kernel(void(_ALONG, _ROWS, int64, float64[:, ::1], float64[:, ::1], float64[:, ::1]))
def _divided_change(along, rows, first, step, position, out):
    """The change of ``position`` for a change ``step`` [2, k] of the weights, by the quotient rule."""
    separate_loop()
    triangles, triangle, weights = along
    axes, last = position.shape[1], uint64(first + 3)
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        d0, d2 = step[0, i], step[1, i]
        q1 = rows[v1, last]
        q = ((rows[v0, last] - q1) * weights[0, i] + q1) + (rows[v2, last] - q1) * weights[2, i]
        change_of_q = d0 * (rows[v0, last] - q1) + d2 * (rows[v2, last] - q1)
        for c in range(axes):
            k = uint64(first + c)
            v = rows[v1, k]
            change = d0 * (rows[v0, k] - v) + d2 * (rows[v2, k] - v)
            out[i, c] = (change - position[i, c] * change_of_q) / _divisor(q)


@kernel
def _as_machines(v0, v1, v2, q0, q2):
    """A coordinate by docs/numbers.md, section 6, and the unit to which its terms are truncated."""
    d0, d2 = coordinate_difference(v0, v1), coordinate_difference(v2, v1)
    if not (np.isfinite(v1) and np.isfinite(q0 * d0) and np.isfinite(q2 * d2)):
        return np.nan, _UNIT_OF_ONE
    unit, _ = product_step(v1, 1.0, q0, d0, q2, d2)
    return product_sum(v1, 1.0, q0, d0, q2, d2), unit


@kernel(void(_ALONG, float64[:, ::1], _ROWS, int64, float64[:, ::1], float64[:, ::1]))
def _slip(along, weights, rows, first, position, slip):
    """The machines' s, t, r over q, by their ``weights`` [2, k], minus ``position``.

    A coordinate lies on an exact boundary up to float64's error, or at least one unit away: of a divided
    one, its own last bit.
    """
    separate_loop()
    triangles, triangle, _ = along
    for i in range(len(position)):
        t = uint64(triangle[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        q0, q2, k = weights[0, i], weights[1, i], uint64(first + 3)
        divided = rows[v0, k] != 1.0 or rows[v1, k] != 1.0 or rows[v2, k] != 1.0
        q = _as_machines(rows[v0, k], rows[v1, k], rows[v2, k], q0, q2)[0] if divided else 1.0
        for c in range(position.shape[1]):
            k = uint64(first + c)
            value, unit = _as_machines(rows[v0, k], rows[v1, k], rows[v2, k], q0, q2)
            if divided:
                value = projected(value, q)
                unit = abs(value) * _UNIT_OF_ONE / 2
            value = value - position[i, c]
            slip[i, c] = 0.0 if abs(value) < unit / 2 else value


@kernel(void(_ALONG, float64[:, ::1], _ROWS, int64, float64[:, ::1]))
def _directions_as_machines(along, weights, rows, first, out):
    """The machines' s, t and r, by their ``weights`` [2, k]."""
    separate_loop()
    triangles, triangle, _ = along
    for i in range(len(out)):
        t = uint64(triangle[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        for c in range(3):
            k = uint64(first + c)
            value, _ = _as_machines(rows[v0, k], rows[v1, k], rows[v2, k], weights[0, i], weights[1, i])
            out[i, c] = value


def place(target, weights, rows, first=0, nearest=True, changing=True):
    """TextureCoordinates of fragments whose vertices have s, t, r, q from place ``first`` of ``rows`` on.

    nearest   whether a nearest filter reads them; if not, slip is 0
    changing  whether something needs their derivatives; if not, dx and dy are 0

    Each of the two takes a third of the work.
    """
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        direction = weights.iterate(rows, first)
        on_cube = project_on_cube(direction, *(weights.changes_of(rows, first) if changing else ()))
        if not nearest:
            return on_cube
        machine, slip = np.empty((len(weights), 3)), np.empty_like(on_cube.position)
        _directions_as_machines(weights.along, weights.machine, rows, first, machine)
        _place_on_face(machine, on_cube.face, slip)
        return replace(on_cube, slip=slip - on_cube.position)
    count, axes = len(weights), _axes(target)
    position, bias, none = np.empty((count, axes)), np.zeros((count, 1)), _nothing(count, axes)
    _divide(weights.along, rows, first, position)
    slip = dx = dy = none
    if nearest:
        slip = np.empty_like(position)
        _slip(weights.along, weights.machine, rows, first, position, slip)
    if changing:
        dx, dy = np.empty((2, count, axes))
        for step, change in zip(weights.changes, (dx, dy), strict=True):
            _divided_change(weights.along, rows, first, step, position, change)
    return TextureCoordinates(position, np.zeros(count, np.int64), slip, bias, dx, dy)


def _axes(target):
    """The number of texture coordinates that address an image which is not a cube map."""
    return 3 if target is TextureTarget.TEXTURE_3D else 2


def _nothing(count, axes):
    return np.broadcast_to(0.0, (count, axes))


@kernel
def _on_face(s, t, r, face):
    """(sc, tc) of a vector on a face, and its component along the face's axis. Source:
    EXT_texture_cube_map.
    """
    if face == C.FACE_POSITIVE_X or face == C.FACE_NEGATIVE_X:
        return (-r if face == C.FACE_POSITIVE_X else r), -t, s
    if face == C.FACE_POSITIVE_Y or face == C.FACE_NEGATIVE_Y:
        return s, (r if face == C.FACE_POSITIVE_Y else -r), t
    return (s if face == C.FACE_POSITIVE_Z else -s), -t, r  # that, or FACE_NEGATIVE_Z


@kernel
def _ratio(value, magnitude):
    """A place along an edge of a face; 0 if the major component is 0. docs/numbers.md, section 6."""
    return 0.0 if magnitude == 0.0 else (value / magnitude + 1.0) * 0.5


@kernel(void(float64[:, ::1], int64[::1], float64[:, ::1]))
def _place_on_face(direction, face, position):
    """The places of directions on given faces. Source: EXT_texture_cube_map, section 3.8.6."""
    separate_loop()
    for i in range(len(face)):
        sc, tc, along = _on_face(direction[i, 0], direction[i, 1], direction[i, 2], face[i])
        position[i, 0], position[i, 1] = _ratio(sc, abs(along)), _ratio(tc, abs(along))


@kernel
def _beyond(value, most):
    """Whether a magnitude is larger than ``most``, or the first NaN."""
    return not (value <= most or np.isnan(most))


@kernel(void(float64[:, ::1], int64[::1]))
def _major_face(direction, face):
    """The face of the component with the largest magnitude; equal ones in the order x, y, z."""
    separate_loop()
    for i in range(len(face)):
        most, axis = abs(direction[i, 0]), 0
        for c in (1, 2):
            if _beyond(abs(direction[i, c]), most):
                most, axis = abs(direction[i, c]), c
        face[i] = 2 * axis + (1 if direction[i, axis] < 0.0 else 0)


@kernel(void(float64[:, ::1], float64[:, ::1], int64[::1], float64[:, ::1]))
def _change_on_face(direction, step, face, out):
    """The change of places on faces for a change ``step`` of the directions."""
    separate_loop()
    for i in range(len(face)):
        sc, tc, major = _on_face(direction[i, 0], direction[i, 1], direction[i, 2], face[i])
        d_sc, d_tc, d_major = _on_face(step[i, 0], step[i, 1], step[i, 2], face[i])
        magnitude, sign = abs(major) if major != 0.0 else 1.0, -1.0 if major < 0.0 else 1.0
        out[i, 0] = 0.5 * (d_sc - sc / magnitude * sign * d_major) / magnitude
        out[i, 1] = 0.5 * (d_tc - tc / magnitude * sign * d_major) / magnitude


def project_on_cube(direction, dx=None, dy=None):
    """TextureCoordinates of directions [k, 3 or 4] with their derivatives (None: 0).

    The face is that of the component with the largest magnitude; equal ones in the order x, y, z. Source:
    EXT_texture_cube_map, section 3.8.6.
    """
    direction, count = np.ascontiguousarray(direction), len(direction)
    face, position = np.empty(count, np.int64), np.empty((count, 2))
    _major_face(direction, face)
    _place_on_face(direction, face, position)
    changes = [_nothing(count, 2)] * 2
    if dx is not None:
        changes = np.empty((2, count, 2))
        for step, change in zip((dx, dy), changes, strict=True):
            _change_on_face(direction, np.ascontiguousarray(step), face, change)
    return TextureCoordinates(position, face, _nothing(count, 2), np.full((count, 1), TAU), *changes)


def turned_place(target, weights, corners):
    """Where unit vectors that turn steadily read a texture: the fields of TextureCoordinates to replace."""
    turned = spherical(weights.perspective.T, corners)
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        on_cube = project_on_cube(turned)
        return {"position": on_cube.position, "face": on_cube.face, "slip": on_cube.slip}
    axes = _axes(target)
    return {"position": np.ascontiguousarray(turned[:, :axes]), "slip": _nothing(len(turned), axes)}


def spherical(weights, corners):
    """Unit vectors [k, 3] between those at corners [k, 3, 3]: along the arc from vertex 0 to 1, then from
    there to 2. Source: docs/numbers.md, section 20; Shoemake 1985.
    """
    v0, v1, v2 = (corners[:, i] / np.linalg.norm(corners[:, i], axis=1, keepdims=True) for i in range(3))
    edge = _arc(v0, v1, weights[:, 1] / np.maximum(weights[:, 0] + weights[:, 1], TAU))
    return _arc(edge, v2, weights[:, 2])


def _arc(a, b, t):
    angle = np.arccos(np.clip((a * b).sum(axis=1), -1.0, 1.0))
    sine = np.sin(angle)
    straight = sine < TAU
    divisor = np.where(straight, 1.0, sine)
    first = np.where(straight, 1.0 - t, np.sin((1.0 - t) * angle) / divisor)
    second = np.where(straight, t, np.sin(t * angle) / divisor)
    return first[:, None] * a + second[:, None] * b


def made_place(texture, str_, lifted=True):
    """TextureCoordinates that a stage made, [k, 3]. ``lifted``: with the machines' bias."""
    return _unmoving(texture.target, str_, TAU if lifted else 0.0)


def still_place(strq, target):
    """TextureCoordinates at s, t, r, float64 [k, 4], that are the same in neighbouring pixels."""
    return _unmoving(target, strq, 0.0)


def _unmoving(target, str_, lift):
    if target is TextureTarget.TEXTURE_CUBE_MAP:
        return project_on_cube(str_)
    count, axes = len(str_), _axes(target)
    few, bias = _nothing(count, axes), np.full((count, 1), lift)
    # Always a copy: ascontiguousarray gives one row back as it is, and broadcast coordinates are read-only.
    position = np.array(str_[:, :axes], order="C")
    return TextureCoordinates(position, np.zeros(count, np.int64), few, bias, few, few)


def reference_of(strq):
    """The reference of a depth comparison: r over q, float64 [k]."""
    return strq[:, 2] / np.where(strq[:, 3] == 0.0, LEAST_Q, strq[:, 3])

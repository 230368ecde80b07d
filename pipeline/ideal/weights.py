"""Barycentric weights of fragments, and values iterated with them.

The weights are real numbers. The machines' truncated weights are computed too, where only their bits decide
between two texels. Fragments are columns: the triangle and the pixel, int32 [k] each. Values at vertices are
rows, float64 [n, m]; a function iterates the numbers from place ``first`` on.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import float64, int32, int64, types, uint8, uint64, void

from fixedpipe.pipeline.enums import FrontFace
from fixedpipe.pipeline.native.pack_fragments import pack_lines
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.portable.interpolate import iteration_weights, weight_factors
from fixedpipe.raster.primitives.strokes import along_line, lowest_pixel

# Subpixels in a pixel, in all compiled kernels. Not from the profile: kernels would not notice a change.
PIXEL = 1 << 4

# A Draw's arrays are read only; a chunk's columns are not.
_INTS, _REALS = (types.Array(kind, 1, "C", readonly=True) for kind in (int32, float64))
_ROWS, _TRIANGLES = (types.Array(kind, 2, "C", readonly=True) for kind in (float64, int32))
# triangles, x, y, 1/w, strokes, and the part of a row of ``fixedpipe.raster.rows`` on how lines are drawn
_MESH = types.Tuple((_TRIANGLES, _INTS, _INTS, _REALS, _TRIANGLES, types.Array(int64, 1, "C", readonly=True)))
_WHERE = types.UniTuple(int32[::1], 3)


@kernel
def _inverse_w(mesh, t):
    """The vertices' 1/w; 1 each if the three are equal."""
    triangles, inverse_w = mesh[0], mesh[3]
    w0, w1, w2 = (
        inverse_w[uint64(triangles[t, 0])],
        inverse_w[uint64(triangles[t, 1])],
        inverse_w[uint64(triangles[t, 2])],
    )
    if w0 == w1 and w1 == w2:
        return 1.0, 1.0, 1.0
    return w0, w1, w2


@kernel
def _corners(mesh, v0, v1, v2):
    """x0, y0, and the sides x10, y10, x20, y20 of a triangle, in subpixels."""
    x, y = mesh[1], mesh[2]
    x0, y0 = int64(x[v0]), int64(y[v0])
    return x0, y0, (int64(x[v1]) - x0, int64(y[v1]) - y0, int64(x[v2]) - x0, int64(y[v2]) - y0)


@kernel
def _is_line(mesh, t):
    strokes = mesh[4]
    return strokes.shape[0] > 0 and strokes[t, R.KIND] == C.PRIMITIVE_LINE


@kernel
def _ends(mesh, t):
    """A line's second end and its first: x0, y0, x1, y1."""
    triangles, x, y = mesh[0], mesh[1], mesh[2]
    b, a = uint64(triangles[t, 0]), uint64(triangles[t, 1])
    return int64(x[b]), int64(y[b]), int64(x[a]), int64(y[a])


@kernel
def _edges_of_line(mesh, t, px, py):
    """n0, n1, n2 at a pixel of a line: docs/numbers.md, section 11.

    In a wide line with diamond exit they are those of the pixel that this one repeats.
    """
    draw = mesh[5]
    x0, y0, x1, y1 = _ends(mesh, t)
    x, y = int64(px), int64(py)
    if draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS and draw[R.LINE_WIDTH] > R.PIXEL_WIDE:
        if abs(x0 - x1) >= abs(y0 - y1):
            y = lowest_pixel(draw, x0, y0, x1, y1, x)
        else:
            x = lowest_pixel(draw, x0, y0, x1, y1, y)
    half = PIXEL >> 1
    n0, n2 = along_line(draw, x0, y0, x1, y1, PIXEL * x + half, PIXEL * y + half)
    return float64(n0), 0.0, float64(n2)


@kernel
def _edges(mesh, t, px, py):
    """The edge functions n0, n1, n2 at a pixel, and the area, signed subpixels.

    A line's area is positive. docs/numbers.md, sections 3 and 11.
    """
    if _is_line(mesh, t):
        n0, n1, n2 = _edges_of_line(mesh, t, px, py)
        return (n0, n1, n2), int64(n0 + n2)
    triangles = mesh[0]
    v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
    x0, y0, (x10, y10, x20, y20) = _corners(mesh, v0, v1, v2)
    dx = PIXEL * int64(px) + (PIXEL >> 1) - x0
    dy = PIXEL * int64(py) + (PIXEL >> 1) - y0
    area = x10 * y20 - x20 * y10
    n1, n2 = dx * y20 - x20 * dy, x10 * dy - dx * y10
    if area < 0:
        n1, n2 = -n1, -n2
    return (float64(abs(area) - n1 - n2), float64(n1), float64(n2)), area


@kernel
def _steps(mesh, t, area):
    """The change of the edge functions one subpixel to the right, and one down."""
    if _is_line(mesh, t):
        x0, y0, x1, y1 = _ends(mesh, t)
        dx, dy = x0 - x1, y0 - y1
        if mesh[5][R.LINE_STEPS] == C.LINE_IN_STEPS:  # along the longer axis alone, a subpixel at a time
            level = abs(dx) >= abs(dy)
            dx, dy = (np.sign(dx), int64(0)) if level else (int64(0), np.sign(dy))
        return (float64(dx), 0.0, float64(-dx)), (float64(dy), 0.0, float64(-dy))
    triangles = mesh[0]
    v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
    _, _, (x10, y10, x20, y20) = _corners(mesh, v0, v1, v2)
    sign = -1 if area < 0 else 1
    across = float64(sign * (y10 - y20)), float64(sign * y20), float64(-sign * y10)
    along = float64(sign * (x20 - x10)), float64(-sign * x20), float64(sign * x10)
    return across, along


@kernel(void(_MESH, _WHERE, int64, float64[:, ::1], uint8[::1]))
def _weigh(mesh, where, counterclockwise, perspective, front):
    """Perspective weights [3, k], and whether each primitive takes its front colour."""
    separate_loop()
    triangle, px, py = where
    strokes = mesh[4]
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        (n0, n1, n2), area = _edges(mesh, t, px[i], py[i])
        w0, w1, w2 = _inverse_w(mesh, t)
        e0, e1, e2 = n0 * w0, n1 * w1, n2 * w2
        total = (e0 + e1) + e2
        perspective[0, i] = e0 / total
        perspective[1, i] = e1 / total
        perspective[2, i] = e2 / total
        if strokes.shape[0] > 0 and strokes[t, R.KIND] != C.PRIMITIVE_TRIANGLE:
            front[i] = strokes[t, R.BACK] == 0
            continue
        turned = (w0 < 0.0) ^ (w1 < 0.0) ^ (w2 < 0.0)
        front[i] = ((area < 0) ^ turned) == (counterclockwise != 0)


@kernel
def _change(steps, weights, inverse_w, total):
    """The change of the perspective weights of vertices 0 and 2 when the edge functions change by
    ``steps``.
    """
    (s0, s1, s2), (p0, p2), (w0, w1, w2) = steps, weights, inverse_w
    d0, d1, d2 = float64(PIXEL) * s0 * w0, float64(PIXEL) * s1 * w1, float64(PIXEL) * s2 * w2
    change = (d0 + d1) + d2
    return (d0 - p0 * change) / total, (d2 - p2 * change) / total


@kernel(void(_MESH, _WHERE, float64[:, ::1], float64[:, ::1], float64[:, ::1]))
def _derivatives(mesh, where, perspective, right, down):
    """The change of the perspective weights of vertices 0 and 2 over one pixel, float64 [2, k] each."""
    separate_loop()
    triangle, px, py = where
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        (n0, n1, n2), area = _edges(mesh, t, px[i], py[i])
        w = _inverse_w(mesh, t)
        total = (n0 * w[0] + n1 * w[1]) + n2 * w[2]
        across, along = _steps(mesh, t, area)
        p = perspective[0, i], perspective[2, i]
        right[0, i], right[1, i] = _change(across, p, w, total)
        down[0, i], down[1, i] = _change(along, p, w, total)


@kernel(void(_MESH, _WHERE, float64[:, ::1]))
def _machine_weights(mesh, where, q):
    """The machines' weights q0 and q2, [2, k] (docs/numbers.md, section 4)."""
    separate_loop()
    triangle, px, py = where
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        (n0, n1, n2), _ = _edges(mesh, t, px[i], py[i])
        w0, w1, w2 = _inverse_w(mesh, t)
        q[0, i], q[1, i] = iteration_weights(n0, n1, n2, weight_factors(w0, w1, w2))


@kernel
def _slope(mesh, v0, v1, v2, z):
    """A triangle's larger absolute change of depth over a pixel, to the right or down."""
    _, _, (x10, y10, x20, y20) = _corners(mesh, v0, v1, v2)
    z10, z20, area = z[v1] - z[v0], z[v2] - z[v0], float64(x10 * y20 - x20 * y10)
    slope_x = abs((z10 * float64(y20) - z20 * float64(y10)) * float64(PIXEL) / area)
    slope_y = abs((z20 * float64(x10) - z10 * float64(x20)) * float64(PIXEL) / area)
    return slope_x if slope_x >= slope_y or np.isnan(slope_x) else slope_y


@kernel(void(_MESH, _WHERE, _REALS, types.UniTuple(int64, 3), float64, float64, float64[::1]))
def _depths(mesh, where, z, moved, units, factor, out):
    """Window depths in [0, 1].

    Primitives of the kinds in ``moved`` are offset by ``units`` plus ``factor`` times the slope of their
    polygon: the primitive itself, or the polygon that it came from.
    """
    separate_loop()
    triangle, px, py = where
    triangles, strokes = mesh[0], mesh[4]
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        (n0, _, n2), area = _edges(mesh, t, px[i], py[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        whole = float64(abs(area))
        depth = ((z[v0] - z[v1]) * (n0 / whole) + z[v1]) + (z[v2] - z[v1]) * (n2 / whole)
        kind, is_polygon_s = int64(C.PRIMITIVE_TRIANGLE), True
        if strokes.shape[0] > 0 and strokes[t, R.KIND] != C.PRIMITIVE_TRIANGLE:
            kind, is_polygon_s = int64(strokes[t, R.KIND]), strokes[t, R.SOURCE] >= 0
            if is_polygon_s:
                v0 = uint64(strokes[t, R.SOURCE])
                v1, v2 = uint64(strokes[t, R.SOURCE + 1]), uint64(strokes[t, R.SOURCE + 2])
        if moved[kind] and is_polygon_s:
            depth = (depth + units) + factor * _slope(mesh, v0, v1, v2, z)
        out[i] = 0.0 if depth < 0.0 else (1.0 if depth > 1.0 else depth)


@kernel(void(_TRIANGLES, int32[::1], float64[:, ::1], _ROWS, int64, uint8[::1], int64, float64[:, ::1]))
def _iterate_four(triangles, triangle, perspective, rows, first, front, back, out):
    """Iterate four numbers of the vertices' rows. A triangle that faces away reads them ``back``
    places on.
    """
    separate_loop()
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        at = uint64(first if front[i] else first + back)
        w0, w2 = perspective[0, i], perspective[2, i]
        for c in range(4):
            k = at + uint64(c)
            v = rows[v1, k]
            out[i, c] = ((rows[v0, k] - v) * w0 + v) + (rows[v2, k] - v) * w2


@kernel(void(_TRIANGLES, int32[::1], _ROWS, int64, uint8[::1], int64, float64[:, ::1]))
def _provoking_four(triangles, triangle, rows, first, front, back, out):
    """Four numbers of the provoking vertices' rows."""
    separate_loop()
    for i in range(len(triangle)):
        v = uint64(triangles[uint64(triangle[i]), 3])
        at = uint64(first if front[i] else first + back)
        for c in range(4):
            out[i, c] = rows[v, at + uint64(c)]


@kernel(void(_TRIANGLES, int32[::1], float64[:, ::1], _REALS, float64[::1]))
def _iterate_one(triangles, triangle, perspective, values, out):
    """Iterate one number of each vertex."""
    separate_loop()
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        v = values[uint64(triangles[t, 1])]
        first = (values[uint64(triangles[t, 0])] - v) * perspective[0, i] + v
        out[i] = first + (values[uint64(triangles[t, 2])] - v) * perspective[2, i]


@kernel(void(_TRIANGLES, int32[::1], float64[:, ::1], _ROWS, int64, float64[:, ::1]))
def _changes_of_four(triangles, triangle, step, rows, first, out):
    """The change of four iterated numbers of the vertices' rows for a change ``step`` [2, k] of
    the weights.
    """
    separate_loop()
    at = uint64(first)
    for i in range(len(triangle)):
        t = uint64(triangle[i])
        v0, v1, v2 = uint64(triangles[t, 0]), uint64(triangles[t, 1]), uint64(triangles[t, 2])
        d0, d2 = step[0, i], step[1, i]
        for c in range(4):
            k = at + uint64(c)
            v = rows[v1, k]
            out[i, c] = d0 * (rows[v0, k] - v) + d2 * (rows[v2, k] - v)


_RECORD = types.UniTuple(_INTS, 4)  # triangle, x, y, passed


@kernel(int64(_RECORD, int64, int64, int32[:, ::1]))
def _passed(record, first, last, out):
    """Copy a record's fragments from ``first`` to ``last`` that passed. Returns their number."""
    separate_loop()
    triangle, x, y, passed = record
    count = 0
    for i in range(first, last):
        out[0, count], out[1, count], out[2, count] = triangle[i], x[i], y[i]
        count += 1 if passed[i] else 0
    return count


@kernel(void(int32[::1], int32[::1], int64, int64[::1]))
def _pixels(x, y, width, out):
    separate_loop()
    for i in range(len(out)):
        out[i] = int64(y[i]) * width + int64(x[i])


@dataclass(frozen=True, eq=False)
class Weights:
    """Barycentric weights of fragments, from the exact edge functions of the snapped vertices.

    perspective  float64 [3, k], (n_i / w_i) / sum: for every iterated value but window depth
    front        uint8 [k], 1: front-facing

    Properties that few states read are computed on first use.
    """

    perspective: np.ndarray
    front: np.ndarray
    _mesh: tuple  # from ``mesh_of``
    _where: tuple  # triangle, x, y

    def __len__(self):
        return len(self.front)

    @property
    def along(self):
        """The triangles, the fragments' triangles and ``perspective``, as the iterating kernels take them."""
        return self._mesh[0], self._where[0], self.perspective

    @cached_property
    def changes(self):
        """The derivatives of the perspective weights of vertices 0 and 2: per pixel to the right, then down.

        Each is float64 [2, k].
        """
        right, down = np.empty((2, 2, len(self)))
        _derivatives(self._mesh, self._where, self.perspective, right, down)
        return right, down

    @cached_property
    def machine(self):
        """The machines' weights q0 and q2, float64 [2, k], which decide at exact texel boundaries."""
        q = np.empty((2, len(self)))
        _machine_weights(self._mesh, self._where, q)
        return q

    def depths(self, z, polygon, bits):
        """Window depth in [0, 1], float64 [k], from the vertices' ``z``, with an exact polygon offset.

        The offset's unit is the smallest step of a depth buffer of ``bits`` bits.
        """
        out = np.empty(len(self))
        units, factor = polygon.offset_units / (2**bits - 1), float(polygon.offset_factor)
        moved = [0, 0, 0]
        moved[C.PRIMITIVE_TRIANGLE], moved[C.PRIMITIVE_LINE] = polygon.offset_fill, polygon.offset_line
        moved[C.PRIMITIVE_POINT] = polygon.offset_point
        _depths(self._mesh, self._where, fixed(z), tuple(map(int, moved)), units, factor, out)
        return out

    def corners(self, values):
        """Values [n, ...] at the vertices of each fragment's triangle: [k, 3, ...]."""
        return values[self._mesh[0][self._where[0], :3]]

    def iterate(self, rows, first=0, back=0):
        """Iterate numbers ``first`` to ``first + 3`` of rows, float64 [n, m]: float64 [k, 4].

        A triangle that faces away reads them ``back`` places on.
        """
        out = np.empty((len(self), 4))
        _iterate_four(*self.along, rows, first, self.front, back, out)
        return out

    def provoking(self, rows, first=0, back=0):
        """The provoking vertices' numbers ``first`` to ``first + 3``: float64 [k, 4]. ``back``: as in
        ``iterate``.
        """
        out = np.empty((len(self), 4))
        _provoking_four(self._mesh[0], self._where[0], rows, first, self.front, back, out)
        return out

    def iterate_one(self, values):
        """Iterate values, float64 [n]: float64 [k]."""
        out = np.empty(len(self))
        _iterate_one(*self.along, values, out)
        return out

    def changes_of(self, rows, first=0):
        """The derivatives of ``iterate(rows, first)``, float64 [2, k, 4]: to the right, and down."""
        out = np.empty((2, len(self), 4))
        for step, changed in zip(self.changes, out, strict=True):
            _changes_of_four(self._mesh[0], self._where[0], step, rows, first, changed)
        return out


def fixed(array):
    """An array as kernels take a Draw's: C-contiguous and read only. A contiguous array is not copied."""
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def mesh_of(primitives, line, machine):
    """The mesh of a WindowPrimitives, for ``weigh``. ``line``: a LineState; ``machine``: the Profile that
    draws its lines.
    """
    p, draw = primitives, np.zeros(R.DRAW_SIZE, np.int64)
    if len(p.strokes):
        pack_lines(line, machine, draw)
    return tuple(map(fixed, (p.triangles, p.x, p.y, p.inverse_w, p.strokes, draw)))


def weigh(mesh, front_face, triangle, x, y):
    """The Weights of the fragments (triangle, x, y), int32 [k] each. ``mesh``: from ``mesh_of``.

    Source: docs/numbers.md, sections 3 to 5; derivatives by the quotient rule.
    """
    perspective, front = np.empty((3, len(triangle))), np.empty(len(triangle), np.uint8)
    _weigh(mesh, (triangle, x, y), front_face is FrontFace.CCW, perspective, front)
    return Weights(perspective, front, mesh, (triangle, x, y))


def share_covered(record, part, passed, samples):
    """The share of each pixel of ``fragments_of`` that a smooth primitive covers, float64 [k].

    It is 1 for a primitive that is not smooth. ``samples``: the number of samples that the record counts.
    None: no primitive of the slice is smooth.
    """
    # Of the slice alone: a Draw may have millions of fragments, and thousands of slices.
    if record.covered is None or not (covered := record.covered[part]).any():
        return None
    if passed:
        covered = covered[record.passed[part] != 0]
    return np.where(covered == 0, 1.0, covered / samples)


def fragments_of(record, part, passed):
    """Triangles, x and y, int32 [k] each, of a slice of Fragments: all, or those that ``passed`` alone."""
    columns = record.triangle, record.x, record.y
    if not passed:
        return tuple(np.ascontiguousarray(column[part]) for column in columns)
    first, last, _ = part.indices(len(record.triangle))
    out = np.empty((3, last - first), np.int32)
    count = _passed(tuple(map(fixed, (*columns, record.passed))), first, last, out)
    return tuple(out[:, :count])


def pixels_of(where, width):
    """The pixels of a result of ``fragments_of``, int64 [k]: flat indices in a framebuffer of
    this ``width``.
    """
    out = np.empty(len(where[0]), np.int64)
    _pixels(where[1], where[2], width, out)
    return out

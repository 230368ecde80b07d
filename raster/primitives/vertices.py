"""Vertices to window coordinates: sums of columns, then the division by w, the viewport and snapping.

docs/numbers.md section 2 fixes the operations and their order. ``fixedpipe.pipeline.vertices.stage`` does the
same in NumPy, column by column, for every mesh. These kernels take vertices inside every clipping plane:
nearly all are.
"""

from numba import float32, float64, int32, int64, types

from fixedpipe.raster.floats import LEAST_SINGLE
from fixedpipe.raster.kernel import kernel, separate_loop

CHUNK = 128  # vertices: some 20 columns of them stay in the first level cache

# The columns of a chunk, rows of the scratch that kernels take: two constants, then those given, then sums.
ZEROS, ONES, FIRST_GIVEN = range(3)

# parameters: float64[PARAMETERS]; sizes in pixels
(
    HALF_X,  # half the viewport's size
    HALF_Y,
    CENTER_X,  # and its middle in window coordinates
    CENTER_Y,
    LOW_X,  # the guard band's planes: x HALF_X + LOW_X w >= 0, HIGH_X w - x HALF_X >= 0
    HIGH_X,
    LOW_Y,
    HIGH_Y,
    DEPTH_SCALE,
    DEPTH_OFFSET,
    SNAP_LOW,  # device coordinates are clamped to these
    SNAP_HIGH_X,
    SNAP_HIGH_Y,
    STEPS,  # of the subpixel grid in a pixel
    HEIGHT,
    UPPER_LEFT,  # 1.0: rows are counted from the top before snapping
    PERSPECTIVE,  # 0.0: 1/w is 1 everywhere
    PARAMETERS,
) = range(18)

# What transform_vertices returns, bits; those of the units follow: their q is not 1 everywhere.
CLIPPED, UNUSUAL_W, FIRST_PROJECTIVE = 1, 2, 2

# 1/w beyond these would overflow the weights' products; such a triangle is dropped and counted.
W_SMALLEST, W_LARGEST = 2.0**-400, 2.0**400
_INFINITY = float("inf")
_LARGEST_SINGLE = (2.0 - 2.0**-23) * 2.0**127


@kernel
def _sum_1(out, a, c0):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i] * c0


@kernel
def _sum_2(out, a, b, c0, c1):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i] * c0 + b[i] * c1


@kernel
def _sum_3(out, a, b, c, c0, c1, c2):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = (a[i] * c0 + b[i] * c1) + c[i] * c2


@kernel
def _sum_4(out, a, b, c, d, coefficients):
    separate_loop()
    c0, c1, c2, c3 = coefficients
    for i in range(out.shape[0]):
        out[i] = ((a[i] * c0 + b[i] * c1) + c[i] * c2) + d[i] * c3


@kernel
def to_window(cx, cy, cz, cw, parameters):
    """Window x, y, z and 1/w of clip coordinates, and whether they can be drawn."""
    lowest, steps, height = parameters[SNAP_LOW], parameters[STEPS], parameters[HEIGHT]
    upper_left, perspective = parameters[UPPER_LEFT] != 0.0, parameters[PERSPECTIVE] != 0.0
    xw = (cx / cw) * parameters[HALF_X] + parameters[CENTER_X]
    yw = (cy / cw) * parameters[HALF_Y] + parameters[CENTER_Y]
    zw = (cz / cw) * parameters[DEPTH_SCALE] + parameters[DEPTH_OFFSET]
    w = 1.0 / cw
    drawable = (w > 0.0) & (w < _INFINITY)
    drawable &= (abs(xw) < _INFINITY) & (abs(yw) < _INFINITY) & (abs(zw) < _INFINITY)
    w = w if perspective else 1.0
    yw = height - yw if upper_left else yw
    xw = xw if xw > lowest else lowest
    yw = yw if yw > lowest else lowest
    xw = xw if xw < parameters[SNAP_HIGH_X] else parameters[SNAP_HIGH_X]
    yw = yw if yw < parameters[SNAP_HIGH_Y] else parameters[SNAP_HIGH_Y]
    row = int32(yw * steps)
    row = row if upper_left else int32(height * steps) - row
    zw = zw if zw > 0.0 else 0.0
    zw = zw if zw < 1.0 else 1.0
    return int32(xw * steps), row, zw, w, drawable


@kernel
def is_unusual(w):
    """Whether a 1/w is too large or too small to be drawn."""
    return not ((w >= W_SMALLEST) & (w <= W_LARGEST))


@kernel
def _project(clip, parameters, x, y, z, inverse_w):
    """Window coordinates of a chunk; returns the bits CLIPPED and UNUSUAL_W."""
    separate_loop()
    clip_x, clip_y, clip_z, clip_w = clip
    half_x, half_y = parameters[HALF_X], parameters[HALF_Y]
    low_x, high_x = parameters[LOW_X], parameters[HIGH_X]
    low_y, high_y = parameters[LOW_Y], parameters[HIGH_Y]
    clipped, unusual = int64(0), int64(0)
    for i in range(x.shape[0]):
        cx, cy, cz, cw = clip_x[i], clip_y[i], clip_z[i], clip_w[i]
        # As in fixedpipe.pipeline.vertices.clip: a NaN is outside.
        inside = (cz + cw >= 0.0) & (cw - cz >= 0.0)
        inside &= (cx * half_x + low_x * cw >= 0.0) & (high_x * cw - cx * half_x >= 0.0)
        inside &= (cy * half_y + low_y * cw >= 0.0) & (high_y * cw - cy * half_y >= 0.0)
        x[i], y[i], z[i], w, drawable = to_window(cx, cy, cz, cw, parameters)
        inside &= drawable
        clipped |= int64(0) if inside else int64(CLIPPED)
        unusual |= int64(0) if (not inside) | (not is_unusual(w)) else int64(UNUSUAL_W)
        inverse_w[i] = w if inside else 0.0
    return clipped | unusual


@kernel
def _copy(out, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i]


@kernel
def _interleave(out, unit, first, n, a, b, c, d):
    """Four columns of n vertices into a unit's ``out[first:]``; 1 if some d is not 1, else 0."""
    separate_loop()
    projective = int64(0)
    for i in range(n):
        out[first + i, unit, 0], out[first + i, unit, 1] = a[i], b[i]
        out[first + i, unit, 2], out[first + i, unit, 3] = c[i], d[i]
        projective |= int64(0) if d[i] == 1.0 else int64(1)
    return projective


_GIVEN = types.Array(types.float64, 2, "C", readonly=True)
_INTS, _FLOATS = types.int32[::1], types.float64[::1]
_PLAN = types.Tuple((types.int32[:, ::1], types.float64[:, ::1], _INTS, _FLOATS))
_MADE = types.Tuple((_INTS, _INTS, _FLOATS, _FLOATS, types.float64[:, :, ::1], types.float64[:, ::1]))


@kernel(int64(_GIVEN, _PLAN, _MADE, types.float64[:, ::1]))
def transform_vertices(given, plan, made, columns):
    """Window coordinates and texture coordinates of all vertices.

    given    float64[k, n]: columns of the mesh, the rows FIRST_GIVEN ... of a chunk's columns
    plan     (sums, coefficients, results, parameters):
             int32[m, 6]: weighted sums in order: the row of the result, how many terms, their rows;
             float64[m, 4]: of the terms; none is 0;
             int32[4 + 4 * units + j]: rows of clip x, y, z, w, of s, t, r, q of every unit, and of what is
             kept;
             float64[PARAMETERS]
    made     (x, y, z, inverse_w, coordinates, kept), which receive them:
             int32[n] twice and float64[n] twice, as WindowPrimitives has them;
             float64[n, units, 4];
             float64[j, n]: columns that the caller wants
    columns  float64[rows, CHUNK]: scratch

    Returns bits: CLIPPED if some vertices lie outside a clipping plane or have no usable window coordinates:
    their ``inverse_w`` is 0; UNUSUAL_W if the 1/w of another is too large or too small to be drawn; from
    FIRST_PROJECTIVE on, one for each unit some of whose q are not 1.
    """
    (sums, coefficients, results, parameters), (x, y, z, inverse_w, coordinates, kept) = plan, made
    vertices, units = x.shape[0], coordinates.shape[1]
    for i in range(CHUNK):
        columns[ZEROS, i], columns[ONES, i] = 0.0, 1.0
    bits = int64(0)
    for first in range(0, vertices, CHUNK):
        last = min(first + CHUNK, vertices)
        n = last - first
        for k in range(given.shape[0]):
            _copy(columns[FIRST_GIVEN + k, :n], given[k, first:last])
        for k in range(sums.shape[0]):
            out, terms, c = columns[sums[k, 0], :n], sums[k, 1], coefficients[k]
            a, b = columns[sums[k, 2]], columns[sums[k, 3]]
            if terms == 1:
                _sum_1(out, a, c[0])
            elif terms == 2:
                _sum_2(out, a, b, c[0], c[1])
            elif terms == 3:
                _sum_3(out, a, b, columns[sums[k, 4]], c[0], c[1], c[2])
            else:
                _sum_4(out, a, b, columns[sums[k, 4]], columns[sums[k, 5]], (c[0], c[1], c[2], c[3]))
        clip = columns[results[0]], columns[results[1]], columns[results[2]], columns[results[3]]
        of_chunk = x[first:last], y[first:last], z[first:last], inverse_w[first:last]
        bits |= _project(clip, parameters, *of_chunk)
        for unit in range(units):
            r = results[4 + 4 * unit : 8 + 4 * unit]
            projective = _interleave(
                coordinates, unit, first, n, columns[r[0]], columns[r[1]], columns[r[2]], columns[r[3]]
            )
            bits |= projective << (FIRST_PROJECTIVE + unit)
        for k in range(kept.shape[0]):
            _copy(kept[k, first:last], columns[results[4 + 4 * units + k], :n])
    return bits


@kernel("void(f8[::1],f8,f8[::1])")
def single_depths(depths, scale, out):
    """``depths * scale`` in single precision, rounded to nearest: what is too large is the largest, what is
    below the smallest normal number is 0, what is no number is the lowest.
    """
    separate_loop()
    for i in range(out.shape[0]):
        depth = depths[i] * scale
        depth = depth if depth > -_LARGEST_SINGLE else -_LARGEST_SINGLE
        depth = depth if depth < _LARGEST_SINGLE else _LARGEST_SINGLE
        single = float64(float32(depth))
        out[i] = 0.0 if abs(single) < LEAST_SINGLE else single

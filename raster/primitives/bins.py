"""Sorting primitives into bands of rows, in draw order; a band is what one thread draws at a time."""

from numba import int32, int64, types, uint32, uint64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.primitives.strokes import stroke_box, triangle_box
from fixedpipe.raster.primitives.triangle import Corners, reaches_infinity, side_of
from fixedpipe.raster.primitives.vertices import W_LARGEST, W_SMALLEST

BAND_SHIFT = 5
BAND_HEIGHT = 1 << BAND_SHIFT  # rows; any height gives the same bits
CHUNK = 256  # triangles that sort_triangles takes at a time: their corners stay in the first level cache


@kernel
def sane(triangles, t, vertices, inverse_w, kind):
    """Whether a primitive's indices lie in range and its 1/w are ordinary (NaN fails) and positive, a
    triangle's of either sign.
    """
    for k in range(4):
        if triangles[t, k] < 0 or triangles[t, k] >= vertices:
            return False
    for k in range(3):
        w = inverse_w[triangles[t, k]]
        w = abs(w) if kind == C.PRIMITIVE_TRIANGLE else w
        if not (w >= W_SMALLEST and w <= W_LARGEST):
            return False
    return True


@kernel
def band_range(triangles, strokes, t, x, y, inverse_w, kind, draw):
    """First and last band that a primitive's samples can touch; first > last: none."""
    v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    x0, x1, x2 = int64(x[v0]), int64(x[v1]), int64(x[v2])
    y0, y1, y2 = int64(y[v0]), int64(y[v1]), int64(y[v2])
    corners = Corners(x0, y0, x1, y1, x2, y2)
    if kind == C.PRIMITIVE_TRIANGLE:
        left, top, right, bottom = triangle_box(draw, corners)
    else:
        left, top, right, bottom = stroke_box(draw, corners, kind)
    top, bottom = max((top + 7) >> 4, draw[R.Y0]), min((bottom - 8) >> 4, draw[R.Y1] - 1)
    left, right = max((left + 7) >> 4, draw[R.X0]), min((right - 8) >> 4, draw[R.X1] - 1)
    if kind == C.PRIMITIVE_TRIANGLE and reaches_infinity(inverse_w, v0, v1, v2):
        top, bottom, left, right = draw[R.Y0], draw[R.Y1] - 1, draw[R.X0], draw[R.X1] - 1
    if top > bottom or left > right:
        return int64(1), int64(0)
    if kind != C.PRIMITIVE_TRIANGLE:
        nothing = x0 == x1 and (y0 == y1 or kind == C.PRIMITIVE_POINT)
        return (int64(1), int64(0)) if nothing else (top >> BAND_SHIFT, bottom >> BAND_SHIFT)
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    area *= side_of(inverse_w[v0]) * side_of(inverse_w[v1]) * side_of(inverse_w[v2])
    if area == 0 or (draw[R.CULL_POSITIVE] and area > 0) or (draw[R.CULL_NEGATIVE] and area < 0):
        return int64(1), int64(0)
    return top >> BAND_SHIFT, bottom >> BAND_SHIFT


@kernel("i8(i4[::1],i4[::1],i4[:,::1],i4[::1],i4[::1],i8[::1],i8[::1])")
def most_fragments(order, ends, triangles, x, y, draw, firsts):
    """The most fragments that triangles make which are sorted into bands: ``order`` and ``ends`` are those of
    ``fill_bins`` or ``sort_triangles``. They are the pixels of the triangles' boxes.

    ``firsts`` int64[bands] takes how many of them the bands before each have.
    """
    total, begin = int64(0), int64(0)
    for band in range(ends.shape[0]):
        firsts[band] = total
        first = max(int64(band) << BAND_SHIFT, draw[R.Y0])
        last = min(int64(band + 1) << BAND_SHIFT, draw[R.Y1]) - 1
        for k in range(begin, int64(ends[band])):
            t = order[k]
            v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
            corners = Corners(
                int64(x[v0]), int64(y[v0]), int64(x[v1]), int64(y[v1]), int64(x[v2]), int64(y[v2])
            )
            left, top, right, bottom = triangle_box(draw, corners)
            rows = min((bottom - 8) >> 4, last) - max((top + 7) >> 4, first) + 1
            columns = min((right - 8) >> 4, draw[R.X1] - 1) - max((left + 7) >> 4, draw[R.X0]) + 1
            if rows > 0 and columns > 0:
                total += rows * columns
        begin = int64(ends[band])
    return total


@kernel("i8(i4[:,::1],i4[:,::1],i4[::1],i4[::1],f8[::1],i8[::1],i4[::1],i4[:,::1])")
def count_bins(triangles, strokes, x, y, inverse_w, draw, counts, spans):
    """Bands of every primitive into ``spans`` int32[primitives, 2] and primitives per band into ``counts``.

    Culling, empty areas and what lies outside the scissor box end here. Returns how many primitives were
    dropped because a position was not usable: all of them where the box reaches over the bands, or where
    strokes are missing (``fixedpipe.raster.portable.check``).
    """
    dropped = int64(0)
    usable = draw[R.Y0] >= 0 and 0 <= draw[R.Y1] <= counts.shape[0] << BAND_SHIFT
    usable = usable and (not draw[R.STROKES] or strokes.shape[0] >= triangles.shape[0])
    for band in range(counts.shape[0]):
        counts[band] = 0
    for t in range(triangles.shape[0]):
        spans[t, 0], spans[t, 1] = int32(1), int32(0)
        if not usable:
            dropped += 1
            continue
        kind = int64(strokes[t, 0]) if draw[R.STROKES] else int64(C.PRIMITIVE_TRIANGLE)
        if not sane(triangles, t, x.shape[0], inverse_w, kind):
            dropped += 1
            continue
        first, last = band_range(triangles, strokes, t, x, y, inverse_w, kind, draw)
        if first <= last:
            spans[t, 0], spans[t, 1] = int32(first), int32(last)
            for band in range(first, last + 1):
                counts[band] += int32(1)
    return dropped


@kernel("void(i4[:,::1],i4[::1],i4[::1])")
def fill_bins(spans, ends, order):
    """Primitive numbers of every band, in draw order. ``ends`` int32[bands]: where each band begins; moved to
    its end.
    """
    for t in range(spans.shape[0]):
        for band in range(spans[t, 0], spans[t, 1] + 1):
            order[ends[band]] = int32(t)
            ends[band] += int32(1)


@kernel
def _join(x, y, points):
    separate_loop()
    for i in range(x.shape[0]):
        points[i] = (int64(y[i]) << int64(32)) | int64(uint32(x[i]))


@kernel
def _collect(triangles, first, n, points, a, b, c):
    """The vertices of ``n`` triangles, by one scalar load each: gathers take three times as long (Measured:
    EPYC of family 26), and LLVM makes none as long as the arrays may overlap.
    """
    separate_function()
    for i in range(n):
        a[i] = points[uint32(triangles[first + i, 0])]
        b[i] = points[uint32(triangles[first + i, 1])]
        c[i] = points[uint32(triangles[first + i, 2])]


@kernel
def _bands(n, corners, box, drawn_faces, bands):
    """2**16 times the first band of every triangle plus its last, -1 if none: ``band_range``, no branches.

    ``drawn_faces``: whether triangles of a positive area are drawn, and of a negative one.
    """
    separate_loop()
    (a, b, c), (x_first, x_last, y_first, y_last), (positive, negative) = corners, box, drawn_faces
    for i in range(n):
        x0, x1, x2 = int32(a[i]), int32(b[i]), int32(c[i])
        y0, y1, y2 = int32(a[i] >> int64(32)), int32(b[i] >> int64(32)), int32(c[i] >> int64(32))
        top = max(int32(min(y0, min(y1, y2)) + int32(7)) >> int32(4), y_first)
        bottom = min(int32(max(y0, max(y1, y2)) - int32(8)) >> int32(4), y_last)
        left = max(int32(min(x0, min(x1, x2)) + int32(7)) >> int32(4), x_first)
        right = min(int32(max(x0, max(x1, x2)) - int32(8)) >> int32(4), x_last)
        ahead = int64(int32(x1 - x0)) * int64(int32(y2 - y0))
        behind = int64(int32(x2 - x0)) * int64(int32(y1 - y0))
        drawn = (top <= bottom) & (left <= right)
        drawn &= ((ahead > behind) & positive) | ((ahead < behind) & negative)
        first, last = int32(top >> int32(BAND_SHIFT)), int32(bottom >> int32(BAND_SHIFT))
        bands[i] = int64(int32(first << int32(16)) | last) if drawn else int64(-1)


@kernel
def _gather_left(n, first, bands, left, count):
    """Append what is drawn to ``left[count:]``: 2**32 times the entry of ``bands``, plus the number."""
    separate_loop()
    for i in range(n):
        # Written in any case: which triangles are drawn cannot be guessed, and a wrong guess costs more.
        left[count] = (bands[i] << int64(32)) | int64(first + i)
        count += uint64(bands[i] >= int64(0))
    return count


@kernel
def _fill(left, ends, order):
    for band in range(ends.shape[0]):
        ends[band] = 0
    needed = int64(0)
    for k in range(left.shape[0]):
        first, last = left[k] >> int64(48), (left[k] >> int64(32)) & int64(0xFFFF)
        needed += last - first + 1
        for band in range(first, last + 1):
            ends[uint64(band)] += int32(1)
    if needed > order.shape[0]:
        return needed
    begin = int32(0)
    for band in range(ends.shape[0]):
        begin, ends[band] = begin + ends[band], begin
    for k in range(left.shape[0]):
        first, last = left[k] >> int64(48), (left[k] >> int64(32)) & int64(0xFFFF)
        for band in range(first, last + 1):
            order[uint64(ends[uint64(band)])] = int32(left[k])
            ends[uint64(band)] += int32(1)
    return needed


_INTS, _SCRATCH = types.int32[::1], types.Tuple((types.int64[::1], types.int64[:, ::1], types.int64[::1]))


@kernel(int64(types.int32[:, ::1], _INTS, _INTS, types.int64[::1], _SCRATCH, _INTS, _INTS))
def sort_triangles(triangles, x, y, draw, scratch, ends, order):
    """What ``count_bins`` and ``fill_bins`` do together, of triangles alone, all of whose indices, positions
    and 1/w are known to be usable (``fixedpipe.pipeline.vertices.primitives.WindowPrimitives.orderly``).

    ``scratch``: int64[vertices], int64[4, CHUNK], int64[triangles]. Returns how many entries ``order`` needs;
    where it has fewer, it is not written and ``ends`` is void.
    """
    points, corners, left = scratch
    drawn_faces = draw[R.CULL_POSITIVE] == 0, draw[R.CULL_NEGATIVE] == 0
    x_first, x_last = int32(draw[R.X0]), int32(draw[R.X1] - 1)
    y_first = int32(max(draw[R.Y0], 0))
    y_last = int32(min(max(draw[R.Y1], 0), ends.shape[0] << BAND_SHIFT) - 1)
    a, b, c, bands = corners[0], corners[1], corners[2], corners[3]
    _join(x, y, points)
    count = uint64(0)
    for first in range(0, triangles.shape[0], CHUNK):
        n = min(CHUNK, triangles.shape[0] - first)
        _collect(triangles, first, n, points, a, b, c)
        _bands(n, (a, b, c), (x_first, x_last, y_first, y_last), drawn_faces, bands)
        count = _gather_left(n, first, bands, left, count)
    return _fill(left[:count], ends, order)

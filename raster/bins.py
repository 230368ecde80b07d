"""Sorting primitives into bands of rows, in draw order; a band is what one thread draws at a time."""

from numba import int32, int64

from raster import rows as R
from raster.kernel import kernel
from raster.strokes import stroke_margin

BAND_SHIFT = 5
BAND_HEIGHT = 1 << BAND_SHIFT  # rows; any height gives the same bits

# 1/w beyond these would overflow the weights' products; such a triangle is dropped and counted.
W_SMALLEST, W_LARGEST = 2.0**-400, 2.0**400


@kernel
def sane(triangles, t, vertices, inverse_w):
    """Whether a primitive's indices lie in range and its 1/w are positive and ordinary (NaN fails)."""
    for k in range(4):
        if triangles[t, k] < 0 or triangles[t, k] >= vertices:
            return False
    for k in range(3):
        w = inverse_w[triangles[t, k]]
        if not (w >= W_SMALLEST and w <= W_LARGEST):
            return False
    return True


@kernel
def band_range(triangles, strokes, t, x, y, draw):
    """First and last band that a primitive's samples can touch; first > last: none."""
    v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    y0, y1, y2 = int64(y[v0]), int64(y[v1]), int64(y[v2])
    kind = int64(strokes[t, 0]) if draw[R.STROKES] else int64(R.TRIANGLE)
    margin = stroke_margin(draw, kind) if kind != R.TRIANGLE else int64(0)
    top = max((min(y0, min(y1, y2)) - margin + 7) >> 4, draw[R.Y0])
    bottom = min((max(y0, max(y1, y2)) + margin - 8) >> 4, draw[R.Y1] - 1)
    x0, x1, x2 = int64(x[v0]), int64(x[v1]), int64(x[v2])
    left = max((min(x0, min(x1, x2)) - margin + 7) >> 4, draw[R.X0])
    right = min((max(x0, max(x1, x2)) + margin - 8) >> 4, draw[R.X1] - 1)
    if top > bottom or left > right:
        return int64(1), int64(0)
    if kind != R.TRIANGLE:
        nothing = x0 == x1 and (y0 == y1 or kind == R.POINT)
        return (int64(1), int64(0)) if nothing else (top >> BAND_SHIFT, bottom >> BAND_SHIFT)
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if area == 0 or (draw[R.CULL_POSITIVE] and area > 0) or (draw[R.CULL_NEGATIVE] and area < 0):
        return int64(1), int64(0)
    return top >> BAND_SHIFT, bottom >> BAND_SHIFT


@kernel("i8(i4[:,::1],i4[:,::1],i4[::1],i4[::1],f8[::1],i8[::1],i4[::1],i4[:,::1])")
def count_bins(triangles, strokes, x, y, inverse_w, draw, counts, spans):
    """Bands of every primitive into ``spans`` int32[primitives, 2] and primitives per band into ``counts``.

    Culling, empty areas and what lies outside the scissor box end here. Returns how many primitives were
    dropped because a position was not usable.
    """
    dropped = int64(0)
    for band in range(counts.shape[0]):
        counts[band] = 0
    for t in range(triangles.shape[0]):
        spans[t, 0], spans[t, 1] = int32(1), int32(0)
        if not sane(triangles, t, x.shape[0], inverse_w):
            dropped += 1
            continue
        first, last = band_range(triangles, strokes, t, x, y, draw)
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

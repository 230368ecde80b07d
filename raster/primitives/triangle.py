"""Triangles: the span of a row inside one, and what polygon offset adds to one's depths."""

from typing import NamedTuple

from numba import float64, int64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel

NARROW = 16  # pixels: boxes up to this wide are searched pixel by pixel, wider ones by division


class Corners(NamedTuple):
    """A row's three vertices in the window, int64, 1/16 pixel."""

    x0: int
    y0: int
    x1: int
    y1: int
    x2: int
    y2: int


@kernel
def corners_of(vertices, v0, v1, v2):
    """The Corners of three vertices."""
    x, y = vertices.x, vertices.y
    return Corners(int64(x[v0]), int64(y[v0]), int64(x[v1]), int64(y[v1]), int64(x[v2]), int64(y[v2]))


class Edges(NamedTuple):
    """A triangle's three edge functions, int64, in 1/256 square pixel: edge k's grows toward vertex k.

    n            at the middle of a pixel
    right, down  what they grow by from pixel to pixel and from row to row
    area         their sum, at every pixel; not negative
    sign         -1: they are negated, because the corners turn the other way; else 1
    """

    n: tuple
    right: tuple
    down: tuple
    area: int
    sign: int


@kernel(inlined=True)
def edges_of(corners, x, y):
    """The Edges of three corners at pixel (x, y)."""
    x0, y0, x1, y1, x2, y2 = corners
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    sign = int64(-1) if area < 0 else int64(1)
    area *= sign
    right1, down1 = (y2 - y0) * 16 * sign, -(x2 - x0) * 16 * sign
    right2, down2 = -(y1 - y0) * 16 * sign, (x1 - x0) * 16 * sign
    right0, down0 = -(right1 + right2), -(down1 + down2)
    sx, sy = x * 16 + 8, y * 16 + 8
    n1 = ((sx - x0) * (y2 - y0) - (x2 - x0) * (sy - y0)) * sign
    n2 = ((x1 - x0) * (sy - y0) - (sx - x0) * (y1 - y0)) * sign
    return Edges((area - n1 - n2, n1, n2), (right0, right1, right2), (down0, down1, down2), area, sign)


@kernel(inlined=True)
def edges_after(n, step, times):
    """Edge functions ``times`` pixels, or rows, further on."""
    return n[0] + times * step[0], n[1] + times * step[1], n[2] + times * step[2]


@kernel(inlined=True)
def edges_at(edges, x, y):
    """Edge functions at pixel (x, y), from the Edges at pixel (0, 0)."""
    return edges_after(edges_after(edges.n, edges.right, x), edges.down, y)


@kernel(inlined=True)
def as_floats(numbers):
    """Three integers as float64."""
    return float64(numbers[0]), float64(numbers[1]), float64(numbers[2])


@kernel
def reaches_infinity(inverse_w, v0, v1, v2):
    """Whether a vertex has a negative w: the triangle goes through infinity, and may be anywhere."""
    return (inverse_w[v0] < 0.0) | (inverse_w[v1] < 0.0) | (inverse_w[v2] < 0.0)


@kernel
def side_of(inverse_w):
    """By what an edge function is multiplied for coverage: beyond infinity, the side outside is inside.

    Measured: W_param, all pixels of 29 captures of triangles with vertices of a negative w.
    """
    return int64(-1) if inverse_w < 0.0 else int64(1)


@kernel
def edge_tie(right, down):
    """What an edge function may fall short of 0: the interior lies right of a left edge, below a top one."""
    return int64(0) if right > 0 or (right == 0 and down > 0) else int64(-1)


@kernel
def row_span(n0, n1, n2, step0, step1, step2, first, last):
    """The pixels [from, to) of a row, first..last, where all three biased edge functions are >= 0.

    n0, n1, n2: biased values at pixel ``first``; the functions are linear and the span convex.
    """
    if last - first < NARROW:
        start = first
        while start <= last and (n0 | n1 | n2) < 0:
            n0, n1, n2 = n0 + step0, n1 + step1, n2 + step2
            start += 1
        end = start
        while end <= last and (n0 | n1 | n2) >= 0:
            n0, n1, n2 = n0 + step0, n1 + step1, n2 + step2
            end += 1
        return start, end
    start, end = first, last + 1
    for k in range(3):
        n = n0 if k == 0 else (n1 if k == 1 else n2)
        step = step0 if k == 0 else (step1 if k == 1 else step2)
        if step > 0:
            if n < 0:
                start = max(start, first + (-n + step - 1) // step)
        elif n < 0:
            return first, first
        elif step < 0:
            end = min(end, first + n // (-step) + 1)
    return start, max(start, end)


@kernel
def polygon_offset(state, vertices, v0, v1, v2):
    """What a polygon adds to its depths, of their slope; one without an area has none.

    A whole number in a fixed format, unless the machine keeps its fraction.
    """
    draw, draw_float, z = state.draw, state.draw_float, vertices.z
    x0, y0, x1, y1, x2, y2 = corners_of(vertices, v0, v1, v2)
    area = float64((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0))
    steep = 0.0
    if area != 0.0:
        d1, d2 = z[v1] - z[v0], z[v2] - z[v0]
        dx = (d1 * float64(y2 - y0) - d2 * float64(y1 - y0)) * 16.0 / area
        dy = (d2 * float64(x1 - x0) - d1 * float64(x2 - x0)) * 16.0 / area
        steep = draw_float[R.OFFSET_FACTOR] * max(abs(dx), abs(dy))
    offset = limited_offset(draw_float[R.OFFSET_UNITS] + steep)
    if draw[R.DEPTH_FORMAT] == C.DEPTH_FIXED and not draw[R.OFFSET_FRACTION]:
        offset = float64(int64(min(max(offset, -(2.0**30)), 2.0**30)))
    return offset


@kernel
def limited_offset(offset):
    """Assumed: the limit, far beyond every depth."""
    return min(max(offset, -(2.0**128)), 2.0**128)

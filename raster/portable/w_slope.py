"""The slope of w that W buffering's polygon offset takes: one number of a triangle, from one 2x2 block
(docs/numbers.md, N5.9).
"""

from numba import float64, int64

from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import reciprocal_24, truncate_24
from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.portable.interpolate import depth_difference, weight_factors, weight_sum
from fixedpipe.raster.primitives.triangle import (
    corners_of,
    edge_tie,
    edges_at,
    edges_of,
    reaches_infinity,
    row_span,
    side_of,
)

TILE = 4  # pixels
NOWHERE = 1 << 40  # tiles: farther than any


@kernel
def _pixel_weights(n0, n1, n2, factors):
    """(q0, q2) of a pixel, and whether it has them."""
    e0 = truncate_24(truncate_24(float64(n0)) * factors[0])
    e1 = truncate_24(truncate_24(float64(n1)) * factors[1])
    e2 = truncate_24(truncate_24(float64(n2)) * factors[2])
    total = weight_sum(e0, e1, e2)
    if not total > 0.0:
        return 0.0, 0.0, False
    reciprocal = reciprocal_24(total)
    return truncate_24(e0 * reciprocal), truncate_24(e2 * reciprocal), True


@kernel
def _block_slope(n, right, down, factors, d0, d2):
    """A block's larger slope along x and y, -1.0 where a pixel has no weights.

    ``n``: edge functions of its upper left pixel.
    """
    a0, a2, a = _pixel_weights(n[0], n[1], n[2], factors)
    _, b2, b = _pixel_weights(n[0] + right[0], n[1] + right[1], n[2] + right[2], factors)
    below = n[0] + down[0], n[1] + down[1], n[2] + down[2]
    c0, _, c = _pixel_weights(below[0], below[1], below[2], factors)
    e0, e2, e = _pixel_weights(below[0] + right[0], below[1] + right[1], below[2] + right[2], factors)
    if not (a and b and c and e):
        return -1.0
    along_x, along_y = (e0 - c0) * d0 + (b2 - a2) * d2, (c0 - a0) * d0 + (e2 - b2) * d2
    return truncate_24(max(abs(along_x), abs(along_y)))


@kernel
def _covered(draw, n, right, down, sides, ties, x, y):
    """Which of a tile's 16 pixels are drawn: bits, row by row; ``n``: edge functions of the first."""
    found = int64(0)
    for j in range(TILE):
        for i in range(TILE):
            across = draw[R.X0] <= x + i and x + i < draw[R.X1]
            inside = across and draw[R.Y0] <= y + j and y + j < draw[R.Y1]
            n0 = sides[0] * (n[0] + i * right[0] + j * down[0]) + ties[0]
            n1 = sides[1] * (n[1] + i * right[1] + j * down[1]) + ties[1]
            n2 = sides[2] * (n[2] + i * right[2] + j * down[2]) + ties[2]
            if inside and (n0 | n1 | n2) >= 0:
                found |= int64(1) << (TILE * j + i)
    return found


@kernel
def w_slope(draw, vertices, v0, v1, v2):
    """The slope in w per pixel; 0 for a triangle that draws nothing between X0, Y0, X1 and Y1 of ``draw``."""
    corners = corners_of(vertices, v0, v1, v2)
    x0, y0, x1, y1, x2, y2 = corners
    edges = edges_of(corners, int64(0), int64(0))
    if edges.area == 0 or draw[R.X0] >= draw[R.X1] or draw[R.Y0] >= draw[R.Y1]:
        return 0.0
    right, down, inverse_w = edges.right, edges.down, vertices.inverse_w
    sides = side_of(inverse_w[v0]), side_of(inverse_w[v1]), side_of(inverse_w[v2])
    ties = (
        edge_tie(sides[0] * right[0], sides[0] * down[0]),
        edge_tie(sides[1] * right[1], sides[1] * down[1]),
        edge_tie(sides[2] * right[2], sides[2] * down[2]),
    )
    # Where the search begins: the topmost vertex, moved into the box.
    x_top, y_top = x0, y0
    if y1 < y_top:
        x_top, y_top = x1, y1
    if y2 < y_top:
        x_top, y_top = x2, y2
    left, last_column = draw[R.X0], draw[R.X1] - 1
    top, last_row = draw[R.Y0], draw[R.Y1] - 1
    start = min(max(x_top >> 4, int64(left)), int64(last_column)) // TILE
    if not reaches_infinity(inverse_w, v0, v1, v2):
        top = min(max(y_top >> 4, int64(top)), int64(last_row))
        last_row = min(int64(last_row), (max(y0, max(y1, y2)) - 8) >> 4)
        left = max(int64(left), (min(x0, min(x1, x2)) + 7) >> 4)
        last_column = min(int64(last_column), (max(x0, max(x1, x2)) - 8) >> 4)
    for row in range(top // TILE, last_row // TILE + 1):
        column, distance = int64(0), int64(NOWHERE)
        for y in range(max(TILE * row, int64(draw[R.Y0])), min(TILE * (row + 1), int64(draw[R.Y1]))):
            n = edges_at(edges, left, y)
            first, end = row_span(
                sides[0] * n[0] + ties[0],
                sides[1] * n[1] + ties[1],
                sides[2] * n[2] + ties[2],
                sides[0] * right[0],
                sides[1] * right[1],
                sides[2] * right[2],
                left,
                last_column,
            )
            if first < end:
                k = min(max(start, first // TILE), (end - 1) // TILE)
                away = abs(k - start)
                if away < distance or (away == distance and k < column):
                    column, distance = k, away
        if distance < NOWHERE:
            n = edges_at(edges, TILE * column, TILE * row)
            drawn = _covered(draw, n, right, down, sides, ties, TILE * column, TILE * row)
            upper, z = row == 0 and y_top < 0, vertices.z
            factors = weight_factors(inverse_w[v0], inverse_w[v1], inverse_w[v2])
            d0, d2 = depth_difference(z[v0], z[v1]), depth_difference(z[v2], z[v1])
            return _nearest_slope(factors, d0, d2, n, right, down, drawn, upper)
    return 0.0


@kernel
def _nearest_slope(factors, d0, d2, n, right, down, drawn, upper):
    """The slope of the tile's block that lies nearest to the eye, among those with a drawn pixel; the last of
    equal ones. ``upper``: among the upper two blocks, if either has a drawn pixel.
    """
    found, nearest, slope = False, 0.0, 0.0
    for j in range(2):
        if j == 1 and found and upper:
            break
        for i in range(2):
            if drawn & (int64(0x33) << (8 * j + 2 * i)):
                found = True
                at = (
                    n[0] + 2 * (i * right[0] + j * down[0]),
                    n[1] + 2 * (i * right[1] + j * down[1]),
                    n[2] + 2 * (i * right[2] + j * down[2]),
                )
                over_w = (at[0] * factors[0] + at[1] * factors[1]) + at[2] * factors[2]
                here = _block_slope(at, right, down, factors, d0, d2)
                if here >= 0.0 and over_w >= nearest:
                    nearest, slope = over_w, here
    return slope

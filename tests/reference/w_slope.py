"""The slope of w that W buffering's polygon offset takes: one number of a triangle, from one 2x2 block.

Source: docs/numbers.md N5.9, and the captures that it names.
"""

from itertools import product

from tests.reference import coverage, depth, fixed, interpolate

TILE = 4  # pixels: Inferred from TriH and TriV, whose blocks are the second of a tile


def weights(n, inverse_w):
    """q0 and q2 of a pixel, without a vertex that takes the rest; None where the sum is not above 0.

    Measured: slopes of W_buffering captures; Assumed: the limit.
    """
    e = interpolate.weighed_edges(n, interpolate.weight_factors(inverse_w))
    total = interpolate.weight_sum(e)
    if not total > 0.0:
        return None
    inverse = interpolate.reciprocal(total)
    return tuple(fixed.keep_significant_bits(e[i] * inverse, depth.WEIGHT_BITS) for i in (0, 2))


def block_slope(triangle, w, inverse_w, x, y):
    """The block at (x, y): the larger of the slopes along x and y; None where it has none.

    Measured: as ``slope``: of vertex 0's weight along x the lower row, of vertex 2's the upper, along y the
    left and the right column; Inferred: vertex 0's column, which no capture tells, and the maximum norm.
    """
    places = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)]
    pixels = [weights(coverage.edge_values(triangle, *place), inverse_w) for place in places]
    if None in pixels:
        return None
    (a0, a2), (_, b2), (c0, _), (d0, d2) = pixels
    first, last = depth.difference(w[0], w[1]), depth.difference(w[2], w[1])
    along_x, along_y = (d0 - c0) * first + (b2 - a2) * last, (c0 - a0) * first + (d2 - b2) * last
    return fixed.keep_significant_bits(max(abs(along_x), abs(along_y)), depth.WEIGHT_BITS)


def nearness(triangle, inverse_w, x, y):
    """A pixel's sum of weights before they are divided, uncut: the larger, the nearer to the eye. Inferred:
    that it chooses the block (TriH, TriV, RoofQuad, ClipF, ClipW).
    """
    factors = interpolate.weight_factors(inverse_w)
    a, b, c = (n_i * f for n_i, f in zip(coverage.edge_values(triangle, x, y), factors, strict=True))
    return (a + b) + c


def slope(triangle, w, inverse_w, columns, rows):
    """The slope, in w a pixel; 0 where the triangle draws none of ``columns`` and ``rows``, two ranges.

    Measured: all depths of 31 of 32 W_buffering captures; Inferred: which tile and block; Assumed: what is
    left.
    """
    if triangle.area == 0 or not columns or not rows:
        return 0.0
    top = min(triangle.vertices, key=lambda vertex: vertex[1])
    start = fixed.clamp(top[0] // coverage.SUBPIXELS, columns[0], columns[-1]) // TILE
    first = fixed.clamp(top[1] // coverage.SUBPIXELS, rows[0], rows[-1]) // TILE
    if any(triangle.behind):  # it is anywhere
        first = 0
    columns, rows = coverage.spanned(triangle, columns, rows)
    inside = {
        (px, py)
        for px, py in product(columns, rows)
        if py // TILE >= first and coverage.covers(triangle, px, py)
    }
    if not inside:
        return 0.0
    row = min(py // TILE for _, py in inside)
    column = min({px // TILE for px, py in inside if py // TILE == row}, key=lambda k: (abs(k - start), k))
    found = []
    for y in (TILE * row, TILE * row + 2):
        for x in (TILE * column, TILE * column + 2):
            if any((x + right, y + below) in inside for right in (0, 1) for below in (0, 1)):
                found.append((x, y))
        if found and row == 0 and top[1] < 0:
            break
    nearest, slope_there = 0.0, 0.0
    for x, y in found:  # the nearest to the eye, of equal ones the last
        here, near = block_slope(triangle, w, inverse_w, x, y), nearness(triangle, inverse_w, x, y)
        if here is not None and near >= nearest:
            nearest, slope_there = near, here
    return slope_there

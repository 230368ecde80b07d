"""The slope of w that W buffering's polygon offset takes: one number of a triangle, from one 2x2 block.

Source: docs/numbers.md N5.9, and the captures that it names.
"""

import math
from itertools import product

from tests.reference import coverage, depth, fixed

TILE = 4  # pixels: Inferred from TriH and TriV, whose blocks are the second of a tile


def floor_significant_bits(value, bits):
    """The greatest number of ``bits`` significant bits that is not above. Measured: WBuf24F_TriH."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(math.floor(math.ldexp(mantissa, bits)), exponent - bits)


def block_reciprocal(inverse):
    """N5.8's reciprocal to the nearest of 24 bits. Measured: 15 of 16 triangles' slopes."""
    return fixed.keep_significant_bits(fixed.from_pattern(fixed.to_pattern(inverse) - 11 * 2**23 + 2**28), 24)


def weights(n, w):
    """q0 and q2 of a pixel, without a vertex that takes the rest; None where the sum is not above 0.

    Measured: as ``block_reciprocal``; Assumed: the limit.
    """
    e = depth.edge_terms(n, depth.w_factors(w))
    total = (e[0] + e[1]) + e[2]
    if not total > 0.0:
        return None
    reciprocal = block_reciprocal(1.0 / total)
    return tuple(floor_significant_bits(e[i] * reciprocal, depth.WEIGHT_BITS) for i in (0, 2))


def block_slope(triangle, w, x, y):
    """The block at (x, y): the larger of the slopes along x and y; None where it has none.

    Measured: as ``slope``; Inferred: the lesser of two rows or columns, the maximum norm.
    """
    pixels = [
        weights(coverage.edge_values(triangle, x + right, y + below), w)
        for below in (0, 1)
        for right in (0, 1)
    ]
    if None in pixels:
        return None
    d = depth.difference(w[0], w[1]), depth.difference(w[2], w[1])

    def along(pairs):
        """Inferred: as above."""
        steps = [min((pixels[b][i] - pixels[a][i] for a, b in pairs), key=abs) for i in (0, 1)]
        return abs(steps[0] * d[0] + steps[1] * d[1])

    steepest = max(along([(0, 1), (2, 3)]), along([(0, 2), (1, 3)]))
    return fixed.keep_significant_bits(steepest, depth.WEIGHT_BITS)


def slope(triangle, w, columns, rows):
    """The slope, in w a pixel; 0 where the triangle draws none of ``columns`` and ``rows``, two ranges.

    Measured: all depths of 18 W_buffering captures; Inferred: which tile and block; Assumed: what is left.
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
                found.append(block_slope(triangle, w, x, y))
        if found and row == 0 and top[1] < 0:
            break
    return min((s for s in found if s is not None), default=0.0)

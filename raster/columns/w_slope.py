"""The slope of w that W buffering's polygon offset takes, in float64 columns (docs/numbers.md, N5.9)."""

import numpy as np

from fixedpipe.raster.columns.interpolate import (
    covered_pixels,
    depth_difference,
    edge_functions,
    reciprocal_24,
    weighed_edges,
    weight_factors,
)
from fixedpipe.raster.floats import SINGLE_BITS
from fixedpipe.raster.floats import keep_significant_bits as cut

TILE = 4  # pixels


def _block_slopes(x, y, w, inverse_w, left, top, subpixel_bits):
    """The slopes of the blocks at pixels (left, top), int64 [k], and the sums of their first pixels' weights
    before they are divided; those that have no weights are left out.
    """
    px, py = left[:, None] + np.array([0, 1, 0, 1]), top[:, None] + np.array([0, 0, 1, 1])
    n, _ = edge_functions(np.array([x]), np.array([y]), px.ravel(), py.ravel(), subpixel_bits)
    of_vertices = np.broadcast_to(inverse_w, (px.size, 3))
    e, total = weighed_edges(n, of_vertices)
    good = (total.reshape(px.shape) > 0.0).all(axis=1)
    reciprocal = reciprocal_24(np.where(total > 0.0, total, 1.0))
    f = weight_factors(of_vertices)
    over_w = ((n[0] * f[:, 0] + n[1] * f[:, 1]) + n[2] * f[:, 2]).reshape(px.shape)[good, 0]
    a, b, c, d = cut(e[0] * reciprocal, SINGLE_BITS).reshape(px.shape)[good].T
    along_x, along_y = d - c, c - a
    step = depth_difference(w[:1], w[1:2])
    a, b, c, d = cut(e[2] * reciprocal, SINGLE_BITS).reshape(px.shape)[good].T
    other = depth_difference(w[2:], w[1:2])
    along_x, along_y = along_x * step + (b - a) * other, along_y * step + (d - b) * other
    return cut(np.maximum(np.abs(along_x), np.abs(along_y)), SINGLE_BITS), over_w


def w_slope(x, y, w, inverse_w, box, subpixel_bits):
    """The slope of one triangle, in w a pixel; 0 of one that draws nothing in ``box``, x0, y0, x1, y1.

    x, y: int64 [3], subpixels; w: float64 [3], singles; inverse_w: float64 [3].
    """
    px, py = covered_pixels(x.tolist(), y.tolist(), w.tolist(), box, subpixel_bits)
    first = int(np.argmin(y))
    at = np.clip(int(x[first]) >> subpixel_bits, box[0], box[2] - 1) // TILE
    if (w >= 0.0).all():
        below = py // TILE >= np.clip(int(y[first]) >> subpixel_bits, box[1], box[3] - 1) // TILE
        px, py = px[below], py[below]
    if len(px) == 0:
        return 0.0
    row = (py // TILE).min()
    columns = np.unique(px[py // TILE == row] // TILE)
    column = columns[np.argmin(np.abs(columns - at))]
    here = (py // TILE == row) & (px // TILE == column)
    blocks = np.unique(np.stack([py[here] // 2, px[here] // 2], axis=1), axis=0)
    if row == 0 and y[first] < 0 and (blocks[:, 0] == 0).any():
        blocks = blocks[blocks[:, 0] == 0]
    slopes, over_w = _block_slopes(x, y, w, inverse_w, 2 * blocks[:, 1], 2 * blocks[:, 0], subpixel_bits)
    if len(slopes) == 0:
        return 0.0
    return float(slopes[np.flatnonzero(over_w == over_w.max())[-1]])  # nearest to the eye; of equal ones last

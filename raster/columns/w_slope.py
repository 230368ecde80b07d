"""The slope of w that W buffering's polygon offset takes, in float64 columns (docs/numbers.md, N5.9)."""

import numpy as np

from fixedpipe.raster.columns.interpolate import (
    covered_pixels,
    depth_difference,
    edge_functions,
    w_edge_terms,
)
from fixedpipe.raster.floats import SINGLE_BITS, kept
from fixedpipe.raster.floats import keep_significant_bits as cut

TILE = 4  # pixels
DROPPED = ~np.int64(kept(SINGLE_BITS))  # of a float64 that keeps 24 significant bits


def _down(values):
    """To the numbers of 24 significant bits that are not above."""
    patterns = values.view(np.int64)
    return ((patterns + np.where(patterns < 0, DROPPED, 0)) & ~DROPPED).view(np.float64)


def _reciprocals(totals):
    """1/D of positive D, reduced and then to the nearest of 24 significant bits."""
    patterns = (1.0 / totals).view(np.int64)
    return cut((patterns - (11 << 23) + (1 << 28)).view(np.float64), SINGLE_BITS)


def _lesser(a, b):
    return np.where(np.abs(b) < np.abs(a), b, a)


def _block_slopes(x, y, w, left, top, subpixel_bits):
    """The slopes of the blocks at pixels (left, top), int64 [k]; those that have none are left out."""
    px, py = left[:, None] + np.array([0, 1, 0, 1]), top[:, None] + np.array([0, 0, 1, 1])
    n, _ = edge_functions(np.array([x]), np.array([y]), px.ravel(), py.ravel(), subpixel_bits)
    e = w_edge_terms(n, np.broadcast_to(w, (px.size, 3)))
    total = ((e[0] + e[1]) + e[2]).reshape(px.shape)
    good = (total > 0.0).all(axis=1)
    reciprocal = _reciprocals(total[good])
    along_x, along_y = 0.0, 0.0
    for i in (0, 2):
        a, b, c, d = _down(e[i].reshape(px.shape)[good] * reciprocal).T
        step = depth_difference(w[i : i + 1], w[1:2])
        along_x = along_x + _lesser(b - a, d - c) * step
        along_y = along_y + _lesser(c - a, d - b) * step
    return cut(np.maximum(np.abs(along_x), np.abs(along_y)), SINGLE_BITS)


def w_slope(x, y, w, box, subpixel_bits):
    """The slope of one triangle, in w a pixel; 0 of one that draws nothing in ``box``, x0, y0, x1, y1.

    x, y: int64 [3], subpixels; w: float64 [3], singles.
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
    slopes = _block_slopes(x, y, w, 2 * blocks[:, 1], 2 * blocks[:, 0], subpixel_bits)
    return float(slopes.min()) if len(slopes) else 0.0

"""Pixel transfer's arithmetic on whole images: float64 elementwise, each sum in the specification's order.

Groups are float64 [height, width, 4], R, G, B, A, bottom row first. Nothing is clamped but where OpenGL
clamps: an index into a table, and the final conversion. Which component of a table's or filter's entry goes
with R, G, B and A is a tuple of four, None where the pixel's component stays (``components``). No matrix
product takes part: libraries add in orders of their own. docs/numbers.md has the rule.

Source: OpenGL 1.2.1 section 3.6.5; SGI_color_table, SGI_color_matrix, EXT_convolution, EXT_histogram,
SGI_texture_color_table.
"""

import numpy as np

from fixedpipe.raster import codes as C

MOST = 2**32 - 1  # of a histogram's counter. Assumed: it stays there; OpenGL leaves the value undefined


def nearest(values):
    """To the nearest integer, halves up: int64."""
    return np.floor(values + 0.5).astype(np.int64)


def fixed(values, bits):
    """Components in fixed point, 0 .. 2**bits - 1, int64: clamped to [0, 1], to nearest (section 2.13.9)."""
    return nearest(np.clip(values, 0.0, 1.0) * (2**bits - 1))


def scaled(values, scale, bias):
    """Arithmetic on Components: ``values`` times ``scale``, plus ``bias``, of each component."""
    return values * np.asarray(scale, np.float64) + np.asarray(bias, np.float64)


def indexed(indices, shift, offset):
    """Arithmetic on Indices, int64: shifted left by ``shift`` (negative: right), plus ``offset``."""
    return (indices << shift if shift > 0 else indices >> -shift) + offset


def table_at(table, indices):
    """The entries of a table of 2**n at the indices' lowest n bits."""
    return table[indices & (len(table) - 1)]


def stored_entries(entries, bits):
    """A colour table's entries [n, 4] as it holds them: in [0, 1], of ``bits`` a component unless None."""
    entries = np.clip(np.asarray(entries, np.float64), 0.0, 1.0)
    return entries if bits is None else fixed(entries, bits) / (2**bits - 1)


def _addresses(values, size):
    return nearest(np.clip(values, 0.0, 1.0) * (size - 1))


def texture_color_table(texels, one, entries, components):
    """SGI_texture_color_table, between a unit's filter and what reads its result.

    ``texels``: int64 [k, 4] in units of ``one``, outside [0, one] taken as its ends; ``entries``: stored,
    float64 [n, 4]. Returns int64 [k, 4]: entries rounded to units of ``one``, other components as they were.
    """
    values = nearest(entries * one)
    found = texels.copy()
    for k, component in enumerate(components):
        if component is not None:
            inside = np.clip(texels[:, k], 0, one)
            found[:, k] = values[(2 * inside * (len(entries) - 1) + one) // (2 * one), component]
    return found


def convolved(groups, row, column, weights, components, border_mode, border_color):
    """Convolution; under CONVOLUTION_REDUCE the image becomes smaller, to nothing perhaps.

    ``weights``: float64 [filter height, filter width, 4] of a filter; or None and ``row`` [filter width, 4],
    ``column`` [filter height, 4] of a separable one. The sum begins at zero and runs over columns, and in
    each over rows upwards; a separable term is pixel times row, times column.
    """
    high, wide = (len(column), len(row)) if weights is None else weights.shape[:2]
    reduces = border_mode == C.CONVOLUTION_REDUCE
    source = groups if reduces else _bordered(groups, high, wide, border_mode, border_color)
    height, width = max(source.shape[0] - high + 1, 0), max(source.shape[1] - wide + 1, 0)
    result = groups[:height, :width].copy()
    for k, component in enumerate(components):
        if component is None:
            continue
        total = np.zeros((height, width))
        for n in range(wide):
            for m in range(high):
                pixels = source[m : m + height, n : n + width, k]
                if weights is None:
                    total += pixels * row[n, component] * column[m, component]
                else:
                    total += pixels * weights[m, n, component]
        result[..., k] = total
    return result


def _bordered(groups, high, wide, border_mode, border_color):
    """The image with what a filter reads around it, so that it gives as many pixels as the image has."""
    height, width = groups.shape[:2]
    rows, columns = np.arange(height + high - 1) - high // 2, np.arange(width + wide - 1) - wide // 2
    source = groups[np.clip(rows, 0, height - 1)][:, np.clip(columns, 0, width - 1)]
    if border_mode == C.CONVOLUTION_CONSTANT_BORDER:
        source[(rows < 0) | (rows >= height)] = border_color
        source[:, (columns < 0) | (columns >= width)] = border_color
    return source


def counted(groups, counts, components):
    """Histogram: ``counts``, uint32 [width, c], with these groups' ``components`` counted; counters stop at
    ``MOST``.
    """
    width, result = len(counts), np.empty_like(counts)
    for k, component in enumerate(components):
        more = np.bincount(_addresses(groups[..., component], width).ravel(), minlength=width)
        result[:, k] = np.minimum(counts[:, k].astype(np.int64) + more, MOST)
    return result


def compared(groups, extremes, components):
    """Minmax: ``extremes``, float64 [2, c], least and greatest, with these groups' ``components`` seen."""
    seen = groups[..., list(components)].reshape(-1, len(components))
    if not len(seen):
        return extremes
    return np.stack([np.minimum(extremes[0], seen.min(0)), np.maximum(extremes[1], seen.max(0))])

"""Triangles with corners beyond a machine's guard band, replaced by polygons of their part near the screen.

Lines through infinity become lines that end outside the screen.

Measured: the chip keeps the direction of a corner at 1e35 pixels, which has no weight near the screen
(W_param rcc_w_zero_inf__z-3.08e-33, all pixels).
"""

from fractions import Fraction

import numpy as np

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.scenes import window_mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.profiles import NV2A

BAND = 8000  # pixels beyond the screen; less than the guard band, so that nothing moves there
# How far from the other ones a single far corner is put, in its direction, pixels: a power of two, so that
# edge functions keep few bits. Measured: W_param, 50 of 50 captures; with 2^14 1040 pixels of five are wrong,
# with 2^17 15 of one.
REACH = Fraction(2) ** 16
LEAST_W, MOST_W = 2.0**-64, 2.0**64  # Measured: w is clamped as RCC clamps (Front_face)
MOST = 2.0**124  # pixels; Inferred: in 1/16 pixel the largest number. From there on a corner is at (1, 1)


def _inside(axis, low, high):
    return (lambda v: v[axis] - low * v[3]), (lambda v: high * v[3] - v[axis])


_PLANES = (*_inside(0, -BAND, WIDTH + BAND), *_inside(1, -BAND, HEIGHT + BAND))


def _clipped(polygon):
    """A polygon of homogeneous corners inside the band, exactly."""
    for plane in _PLANES:
        kept, distances = [], [plane(v) for v in polygon]
        for i, (v, d) in enumerate(zip(polygon, distances, strict=True)):
            following, e = polygon[(i + 1) % len(polygon)], distances[(i + 1) % len(polygon)]
            if d >= 0:
                kept.append(v)
            if (d >= 0) != (e >= 0):
                kept.append([(d * b - e * a) / (d - e) for a, b in zip(v, following, strict=True)])
        polygon = kept
    return polygon


def _fan(polygon):
    return [[polygon[0], polygon[i], polygon[i + 1]] for i in range(1, len(polygon) - 1)]


def _shortened(triangle):
    """Two triangles in place of one with a single far corner. They end ``REACH`` pixels along its two edges.

    Returns None for any other triangle. Corners are homogeneous. The first triangle's are in the given order.
    The second covers a strip of the screen that is less than a pixel wide: the end of the first edge, the end
    of the second, and the last near corner.
    """
    far = [i for i, corner in enumerate(triangle) if not _is_near([c / corner[3] for c in corner])]
    if len(far) != 1 or any(corner[3] < 0 for corner in triangle):
        return None
    end, after, before = (triangle[(far[0] + k) % 3] for k in range(3))
    ends = []
    for start in (after, before):
        away = max(abs(end[axis] / end[3] - start[axis] / start[3]) for axis in range(2))
        share = REACH / away  # of the edge in device coordinates
        share = share * start[3] / (end[3] * (1 - share) + share * start[3])  # and in homogeneous ones
        ends.append([(1 - share) * a + share * b for a, b in zip(start, end, strict=True)])
    first = [ends[0], after, before]
    return [first[-far[0] :] + first[: -far[0]], [ends[1], ends[0], before]]


def _is_near(corner):
    return max(abs(corner[0]), abs(corner[1])) <= NV2A.arithmetic.guard_band


def _clamped(corner):
    x, y, z, w, *values = (float(v) for v in corner)
    size = min(max(abs(w), LEAST_W), MOST_W)
    x, y = (min(max(v, -MOST), MOST) for v in (x, y))
    return [x, y, z, float(np.copysign(size, w)), *values]


def _middle(ws):
    """A power of two in the middle of numbers: the weights depend on their quotients, and reciprocals of
    extreme ones are clamped.
    """
    exponents = [w.numerator.bit_length() - w.denominator.bit_length() for w in ws] or [0]
    return Fraction(2) ** ((min(exponents) + max(exponents)) // 2)


def outlines(corners, edges):
    """Ends of the lines between two corners (device x, y and w), one of which has a negative w.

    From the other corner the line leads away from the negative one, and leaves the screen. Its length is a
    whole multiple of the corners' distance, so its direction is exact.

    Measured: W_param w_neg_strip, whose lines the chip draws so.
    """
    ends = []
    for start, end in edges:
        a, b = corners[start], corners[end]
        if (a[2] < 0) == (b[2] < 0) or a[:2] == b[:2]:
            continue
        (x, y, _), (ahead_x, ahead_y, _) = (b, a) if a[2] < 0 else (a, b)
        away = x - ahead_x, y - ahead_y
        times = BAND // max(abs(away[0]), abs(away[1]))
        ray = (x, y), (x + times * away[0], y + times * away[1])
        ends += ray if a[2] > 0 else ray[::-1]
    return ends


def near_part(corners, name, split):
    """The mesh of triangles' parts near the screen.

    corners  rows of device x, y, z, w and of what varies; ``name``: the mesh's array of that
    split    which corners make each triangle
    """
    rows = []
    for order in split:
        triangle = [_clamped(corners[i]) for i in order]
        parts = [triangle]
        if not all(_is_near(corner) for corner in triangle):
            exact = [[Fraction(v) for v in corner] for corner in triangle]
            homogeneous = [[x * w, y * w, z * w, w, *values] for x, y, z, w, *values in exact]
            parts = _shortened(homogeneous) or _fan([v for v in _clipped(homogeneous) if v[3] > 0])
            unit = _middle([w for part in parts for _, _, _, w, *_ in part])
            parts = [
                [[float(v) for v in (x / w, y / w, z / w, w / unit, *values)] for x, y, z, w, *values in part]
                for part in parts
            ]
        rows += [corner for part in parts for corner in part]
    rows = np.array(rows).reshape(-1, len(corners[0]))
    values = rows[:, 4:]
    return window_mesh(
        rows[:, :4], PrimitiveType.TRIANGLES, **{name: (values,) if name.startswith("texture") else values}
    )

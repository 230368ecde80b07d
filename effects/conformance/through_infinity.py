"""Triangles whose corners have a w of either sign, or lie further off than a machine's guard band, as
polygons that have neither: what of them is near the screen.

Measured: the chip fills what the homogeneous triangle covers where w is positive (W_param: all pixels of 11
captures of quads that go through infinity), and keeps the direction of a corner at 1e35 pixels
(rcc_w_zero_inf__z-3.08e-33).
"""

from fractions import Fraction

import numpy as np

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.scenes import window_mesh
from fixedpipe.pipeline.enums import PrimitiveType

BAND = 8000  # pixels beyond the screen; less than the guard band, so that nothing moves there
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


def _is_near(corner):
    x, y, _, w = corner[:4]
    return w > 0 and -BAND <= x <= WIDTH + BAND and -BAND <= y <= HEIGHT + BAND


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


def near_part(corners, name, split):
    """The mesh of triangles' parts near the screen.

    corners  rows of device x, y, z, w and of what varies; ``name``: the mesh's array of that
    split    which corners make each triangle
    """
    rows = []
    for triangle in split:
        polygon = [_clamped(corners[i]) for i in triangle]
        if not all(_is_near(corner) for corner in polygon):
            exact = [[Fraction(v) for v in corner] for corner in polygon]
            homogeneous = [[x * w, y * w, z * w, w, *values] for x, y, z, w, *values in exact]
            clipped = [v for v in _clipped(homogeneous) if v[3] > 0]
            unit = _middle([w for _, _, _, w, *_ in clipped])
            polygon = [
                [float(v) for v in (x / w, y / w, z / w, w / unit, *values)]
                for x, y, z, w, *values in clipped
            ]
        for i in range(1, len(polygon) - 1):
            rows += [polygon[0], polygon[i], polygon[i + 1]]
    rows = np.array(rows).reshape(-1, len(corners[0]))
    values = rows[:, 4:]
    return window_mesh(
        rows[:, :4], PrimitiveType.TRIANGLES, **{name: (values,) if name.startswith("texture") else values}
    )

"""Depth: a plane in screen space, floored to an integer, plus the polygon offset."""

import math

from tests.reference import fixed

OFFSET_LIMIT = 2**30  # Assumed: far above any depth unit


def full_scale(depth_bits):
    """The depth unit of window depth 1. Source: OpenGL 1.2.1 section 2.10.1."""
    return 2**depth_bits - 1


def depth_to_units(depth, depth_bits):
    """A Clear's depth. Source: OpenGL 1.2.1 sections 4.2.3 and 2.13.9 (to nearest)."""
    return math.floor(fixed.clamp(depth, 0.0, 1.0) * full_scale(depth_bits) + 0.5)


def polygon_offset(vertices, area, window_z, depth_bits, factor, units):
    """The integer that a primitive adds to its depths.

    Measured: for slopes along an axis; Inferred: the maximum norm of others, one of the two that
    OpenGL 1.2.1 allows (equation 3.6).
    """
    (x0, y0), (x1, y1), (x2, y2) = vertices
    z0, z1, z2 = (z * full_scale(depth_bits) for z in window_z)
    along_x = ((z1 - z0) * float(y2 - y0) - (z2 - z0) * float(y1 - y0)) * 16.0 / float(area)
    along_y = ((z2 - z0) * float(x1 - x0) - (z1 - z0) * float(x2 - x0)) * 16.0 / float(area)
    offset = units + factor * max(abs(along_x), abs(along_y))
    return math.trunc(fixed.clamp(offset, -OFFSET_LIMIT, OFFSET_LIMIT))


def fragment_depth(n, area, window_z, depth_bits, offset):
    """Depth units of a fragment from its edge values and the area without sign.

    Measured: floor, 153600 of 153600 pixels at 16 bits; within one unit at 24.
    """
    inverse_area = 1.0 / float(area)
    a0, a2 = float(n[0]) * inverse_area, float(n[2]) * inverse_area
    z0, z1, z2 = (z * full_scale(depth_bits) for z in window_z)
    z = (z1 + a0 * (z0 - z1)) + a2 * (z2 - z1)
    return fixed.clamp(math.floor(z + 2.0 ** (depth_bits - 47)) + offset, 0, full_scale(depth_bits))

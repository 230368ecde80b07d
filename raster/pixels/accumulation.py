"""The accumulation buffer's integers: signed, ``full`` = 1.0, between -full and full.

Source: OpenGL 1.2.1 section 4.2.4. Assumed: every result is rounded to nearest, halves up, and clamped (the
specification leaves results beyond [-1, 1] undefined). docs/numbers.md has the order of operations.
"""

import numpy as np


def _stored(values, full):
    """float64 in units of 1 / full to int32."""
    return np.clip(np.floor(values + 0.5), -full, full).astype(np.int32)


def from_value(value, full):
    """A number as the buffer holds it, for ADD and Clear."""
    return int(_stored(np.float64(value) * full, full))


def from_colors(colors, one, value, full):
    """LOAD: ``((c / one) * value) * full`` of integer components, any shape, as int32."""
    if colors.dtype != np.uint8:
        return _stored(((colors / one) * value) * full, full)
    return _stored(((np.arange(256) / one) * value) * full, full)[colors]


def added(accumulation, more, full):
    """ACCUM, ADD: the clamped sum with int32 of the same shape, or with one integer."""
    return np.clip(accumulation.astype(np.int64) + more, -full, full).astype(np.int32)


def multiplied(accumulation, value, full):
    """MULT: ``a * value``."""
    return _stored(accumulation * np.float64(value), full)


def to_colors(accumulation, one, value, full):
    """RETURN: ``(a / full) * value``, clamped to [0, 1], as components of ``one``, int32."""
    unit = np.clip((accumulation / full) * value, 0.0, 1.0)
    return np.floor(unit * one + 0.5).astype(np.int32)

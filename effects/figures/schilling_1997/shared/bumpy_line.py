"""F001-3's and F001-5's bumps on a line: heights and slopes as sums of waves, and rays that they mirror.

Assumed: the waves, few enough to be seen separately, and many enough for slopes that are nearly normally
distributed.
"""

import math

import numpy as np

from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.vectors import cosine, sine


def waves(count, longest, shortest, slope, seed):
    """(numbers of turns for a unit of length, heights, phases) of waves whose slopes have the deviation
    ``slope`` together, from the longest wave to the shortest: float64 [count] each.
    """
    place = np.arange(count)
    turns = 1.0 / longest + (1.0 / shortest - 1.0 / longest) * (place + 0.5) / count
    phases = hashed(place, place + 3, seed) / 65536.0
    # A wave's slope has the deviation 2 pi turns height / sqrt(2).
    return turns, slope / math.sqrt(count) * math.sqrt(2.0) / (2.0 * math.pi * turns), phases


def _sum(function, factors, waves_of_it, x):
    turns, _, phases = waves_of_it
    out = np.zeros(np.shape(x))
    for t, factor, phase in zip(turns, factors, phases, strict=True):
        angle = t * np.asarray(x, np.float64) + phase
        out = out + factor * function(2.0 * math.pi * (angle - np.floor(angle)))
    return out


def heights(waves_of_it, x):
    """Heights at x: float64 of its shape."""
    return _sum(sine, waves_of_it[1], waves_of_it, x)


def slopes(waves_of_it, x):
    """dh/dx at x: float64 of its shape."""
    turns, high, _ = waves_of_it
    return _sum(cosine, 2.0 * math.pi * turns * high, waves_of_it, x)


def mean_slopes(waves_of_it, x, width):
    """Means of the slopes over ``width`` round x: the height that is gained there over the width."""
    return (heights(waves_of_it, x + 0.5 * width) - heights(waves_of_it, x - 0.5 * width)) / width


def mirrored(incoming, slope):
    """Where lines of slopes [...] mirror a ray (dx, dy) of length one: float64 [..., 2], of length one."""
    dx, dy = incoming
    # N = (-slope, 1), not of unit length.
    scale = 2.0 * (dy - dx * slope) / (slope * slope + 1.0)
    return np.stack([dx + scale * slope, dy - scale], axis=-1)


def turned(directions, axis):
    """By how many degrees directions [..., 2] are turned from ``axis``, to the right: float64 [...]."""
    across = directions[..., 0] * axis[1] - directions[..., 1] * axis[0]
    along = directions[..., 0] * axis[0] + directions[..., 1] * axis[1]
    return np.degrees(np.arctan2(across, along))

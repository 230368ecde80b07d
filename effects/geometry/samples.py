"""Rays through a view's pixels, and the places of samples in a pixel, for supersampled pictures."""

import numpy as np

from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.matrices import rotate

# Positions of samples within their cells, which repeat so many samples on.
_JITTER = 256


def rays(view):
    """Rays through a perspective view: three vectors [3, 3], the ray through the panel's lower left corner
    and its changes by a pixel to the right and upwards. Rays are not of unit length.
    """
    projection, to_world = np.array(view.projection), np.array(view.modelview)[:3, :3].T
    half = 1.0 / projection[0, 0], 1.0 / projection[1, 1]
    corner = np.array([-half[0], -half[1], -1.0])
    right = np.array([2.0 * half[0] / view.panel.width, 0.0, 0.0])
    up = np.array([0.0, 2.0 * half[1] / view.panel.height, 0.0])
    return rotate(to_world, np.stack([corner, right, up]))


def sample_places(side):
    """Where samples lie in their cells, ``side`` along a pixel's edge: float64 [256, 256, 2] from 0 to 1,
    computed by integers, so that they are the same on every computer; a single sample is in the middle.
    """
    if side == 1:
        return np.full((_JITTER, _JITTER, 2), 0.5)
    x, y = np.meshgrid(np.arange(_JITTER), np.arange(_JITTER))
    return np.stack([(hashed(x, y, seed) + 0.5) / 65536.0 for seed in (1, 2)], axis=-1)

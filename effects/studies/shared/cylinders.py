"""A cylinder of few or many slices, on which studies see what interpolation between vertices does (P2,
P19).
"""

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cosine, sine


def cylinder(slices, turn, faceted=False):
    """The front of a cylinder about the y axis, turned by ``turn`` radians; with ``faceted`` every slice's
    frame is that of its middle.
    """
    step = 2.0 * np.pi / slices
    count = int(np.ceil(np.pi / step)) + 2
    edges = (np.arange(count + 1) - count // 2) * step + turn
    ends = np.stack([edges[:-1], edges[1:], edges[1:], edges[:-1]], axis=1)
    frames = np.repeat((edges[:-1] + edges[1:])[:, None] / 2.0, 4, axis=1) if faceted else ends
    height = np.tile(np.array([-1.0, -1.0, 1.0, 1.0]), count)
    ends, frames = ends.ravel(), frames.ravel()
    zero, one = np.zeros(ends.shape), np.ones(ends.shape)
    positions = np.stack([sine(ends), height, cosine(ends)], axis=-1)
    normals = np.stack([sine(frames), zero, cosine(frames)], axis=-1)
    tangents = np.stack([cosine(frames), zero, -sine(frames)], axis=-1)
    binormals = np.stack([zero, one, zero], axis=-1)
    first = 4 * np.arange(count)[:, None]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])], axis=1)
    return Surface(
        positions, normals, tangents, binormals, np.full((4 * count, 2), 0.5), triangles.reshape(-1, 3)
    )

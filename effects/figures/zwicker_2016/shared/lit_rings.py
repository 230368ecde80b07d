"""Rings for shadow volumes: the silhouette that the light sees lies along edges of the mesh.

Where a silhouette runs to and fro between edges, each step throws a thin wall of its own. The walls are
right, but they clutter a picture of the volumes, or of their counts.
"""

import numpy as np

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotate


def ring(around, across, radius, tube_radius, *, turns, place, light):
    """A torus as a Surface, as ``surfaces.torus`` has it about the y axis, turned and moved.

    turns  3x3 rotations, the first one first
    place  where its centre is, world coordinates
    light  where the light is, world coordinates
    """
    seen_from = np.array(light) - np.array(place)
    for turn in reversed(turns):
        seen_from = rotate(turn.T, seen_from)
    out = surfaces.torus(around, across, radius, tube_radius, tuple(seen_from.tolist()))
    for turn in turns:
        out = out.rotated(turn)
    return out.moved(*place)

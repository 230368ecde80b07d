"""The bumpy sphere of Z05 and Z06: its normals in tangent space and in object space, and its maps' names."""

import numpy as np

from fixedpipe.effects.bump_mapping import lighting_spaces
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import map_normals, own_normals
from fixedpipe.effects.geometry import height_fields, surfaces

FOR_DOT_PRODUCTS, FOR_OBJECT, FOR_TANGENT = (
    "normal map for dot products",
    "normal map in object space",
    "normal map in tangent space",
)


def bump_normals(edge, relief, height_field=None, height_scale=0.0):
    """Round bumps, or a height field twice, for a whole sphere, float64 [edge, 2 edge, 3]: normals in tangent
    space.
    """
    if height_field is not None:
        return np.tile(own_normals(height_field, edge, edge, height_scale), (1, 2, 1))
    heights = height_fields.smooth(height_fields.pebbles(edge, edge, 6, 12), 3)
    return np.tile(map_normals(relief * heights), (1, 2, 1))


def object_normals(normals):
    """The sphere's map in object space."""
    s, t = height_fields.texel_centers(normals.shape[1], normals.shape[0])
    return lighting_spaces.object_space_normals(normals, surfaces.sphere_frames(s, t))

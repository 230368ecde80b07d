"""G22: a height field as geometry: the mesh of the field's own triangles (``height_field``).

So visibility and shadows are the same for the depth buffer, for rays and for S_i.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 2 and 6 (displacement mapping); sequence A-G22.
"""

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface, plane
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("G22", "the height field as geometry, lit by textures of its light", "2, 6"),)


def relief(field, level_border=False):
    """One period of a HeightField as a Surface, with a vertex at each texel's centre: x and y from -1 to 1, z
    in the same scale; texture coordinates are the texels'.

    level_border  whether vertices along the border are as low as the lowest. Then the outline of the border
                  is straight even where a bump reaches it, and no background shows below the bump
    """
    flat = plane(field.columns, field.rows)
    rows, columns = np.arange(field.rows + 1) % field.rows, np.arange(field.columns + 1) % field.columns
    positions = flat.positions.copy()
    heights = field.heights[np.ix_(rows, columns)]
    if level_border:
        heights[[0, -1]] = heights[:, [0, -1]] = heights.min()
    positions[:, 2] = 2.0 * heights.ravel()
    half = np.array([0.5 / field.columns, 0.5 / field.rows])
    return Surface(
        positions,
        flat.normals,
        flat.tangents,
        flat.binormals,
        flat.texture_coordinates + half,
        flat.triangles,
    )

"""A height field as a mesh, lit by a texture: how light that was computed in texture space is shown."""

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface, plane
from fixedpipe.effects.geometry.views import perspective_view
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit


def relief(field):
    """One period of a HeightField as a Surface, a vertex at each texel's centre: x and y from -1 to 1, z as
    many times as high; texture coordinates are the texels'.
    """
    flat = plane(field.columns, field.rows)
    rows, columns = np.arange(field.rows + 1) % field.rows, np.arange(field.columns + 1) % field.columns
    positions = flat.positions.copy()
    positions[:, 2] = 2.0 * field.heights[np.ix_(rows, columns)].ravel()
    half = np.array([0.5 / field.columns, 0.5 / field.rows])
    return Surface(
        positions,
        flat.normals,
        flat.tangents,
        flat.binormals,
        flat.texture_coordinates + half,
        flat.triangles,
    )


def oblique_view(panel, elevation_eye):
    """The relief from the side: ``elevation_eye`` is the eye's position."""
    return perspective_view(panel, elevation_eye, (0.0, -0.06, 0.0), 29.0, 2.0)


def lit_relief(label, surface, view, texture):
    """Draw a relief with a texture of its light."""
    units = (unit(texture, REPEATED, environment=REPLACE),)
    return draw(label, surface.mesh(), view, None, units, depth_test=FIRST_PASS)

"""How a height field that is drawn as geometry is seen, and lit by a texture of its light."""

from fixedpipe.effects.geometry.views import perspective_view
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit


def oblique_view(panel, elevation_eye):
    """The relief from the side: ``elevation_eye`` is the eye's position."""
    return perspective_view(panel, elevation_eye, (0.0, -0.06, 0.0), 29.0, 2.0)


def lit_relief(label, surface, view, texture):
    """Draw a relief with a texture of its light."""
    units = (unit(texture, REPEATED, environment=REPLACE),)
    return draw(label, surface.mesh(), view, None, units, depth_test=FIRST_PASS)

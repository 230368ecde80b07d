"""The sphere of document 004 that fills a picture."""

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import orthographic_view, row_of_panels


def leaning_sphere(size, *, slices, stacks, repeats, lean, radius, tilt=0.0):
    """The panel, the view and the sphere of a picture of ``size`` pixels: (Panel, View, Surface).

    repeats  how often a texture comes around the sphere, and from pole to pole
    lean     degrees by which the axis leans to the side, so that the texture's poles lie at the rim
    tilt     degrees by which the axis' upper end is turned away from the viewer before it leans
    radius   of the sphere, over the panel's half edge
    """
    (panel,) = row_of_panels(1, size)
    surface = surfaces.sphere(slices, stacks).with_repeats(*repeats)
    if tilt:
        surface = surface.rotated(rotation("x", -tilt))
    return panel, orthographic_view(panel, half_height=1.0 / radius), surface.rotated(rotation("z", lean))

"""The spheres of document 004: one that fills a picture, and how a brushed one is made."""

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import orthographic_view, row_of_panels

# What F004-4 and K04 have in common: how finely the sphere is cut, and how ``material_textures.brushed`` is
# asked to brush it.
BRUSHED_SPHERE = {
    "slices": 50,
    "stacks": 26,
    "map_columns": 512,
    "map_rows": 256,
    "spread": 8.0,
    "depth": 0.25,
    "k_s": (0.5, 1.0),
}


def leaning_sphere(size, *, slices, stacks, repeats, lean, radius):
    """The panel, the view and the sphere of a picture of ``size`` pixels: (Panel, View, Surface).

    repeats  how often a texture comes around the sphere, and from pole to pole
    lean     degrees by which the axis leans to the side, so that the texture's poles lie at the rim
    radius   of the sphere, over the panel's half edge
    """
    (panel,) = row_of_panels(1, size)
    surface = surfaces.sphere(slices, stacks).with_repeats(*repeats).rotated(rotation("z", lean))
    return panel, orthographic_view(panel, half_height=1.0 / radius), surface

"""The bed of stones of the figures about shadows of bumps: its field, its visibility, its light by rays."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.effects.reflectance.evaluate_then_interpolate import at_texels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipse_passes, ellipses, visibility
from fixedpipe.effects.scattering.height_field import HeightField, height_field
from fixedpipe.effects.scattering.visibility import Visibility
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

# Light that is this share of what (n.l)+ gives is seen; what is darker tells no shadow.
CLEARLY_LIT = 0.1
PARAMETERS = {
    "texels": word.FITTED_TEXELS(None, "The edge of the bump map and of what is known of its visibility."),
    "stones": word.EVEN(6, "Stones along an edge."),
    "buried": word.NUMBER(
        0.3,
        "How deep the stones' middles lie in the ground, of a stone's share of an edge.",
        low=0.0,
        high=0.6,
    ),
    "height": word.NUMBER(1.2, "How high the stones are, of balls.", low=0.05, high=3.0),
    "directions": word.of(
        word.Whole(8, 1000), 200, "Directions over the whole sphere along which rays are cast."
    ),
    "smoothing": word.of(
        word.Whole(0, 8), 1, "How often the ellipses' forms are filtered before they are stored."
    ),
    "light": word.LIGHT((-0.72, 0.46, 0.50)),
    "color": word.DIFFUSE((0.86, 0.80, 0.70)),
    "ambient": word.AMBIENT((0.13, 0.145, 0.19)),
    "height_field": own_maps.height_field("the stones"),
    "height_scale": own_maps.HEIGHT_SCALE(0.1),
}


@dataclass(frozen=True, eq=False)
class Bed:
    """A height field, its visibility, its ellipses as forms that may be filtered, and its colours."""

    field: HeightField
    visibility: Visibility
    forms: tuple
    colors: np.ndarray


@lru_cache(2)
def _bed(texels, stones, buried, height, directions, smoothing, own, scale):
    if own is None:
        # Of every stone the part above the ground is seen, so that shadows have a ground to fall on.
        heights = np.maximum(height_fields.pebbles(texels, texels, stones, 4) - buried / stones, 0.0)
        heights = height_fields.smooth(heights) * height
    else:
        heights = own.fitted(texels, texels, scale, repeated=True)
    field = height_field(heights)
    seen = visibility.precompute(field, sphere.spiral(directions))
    forms = ellipses.smoothed(ellipses.rooted(ellipses.of_visibility(seen)), smoothing)
    tone = 0.5 + 0.5 * height_fields.value_noise(texels, texels, stones, stones, 11)[..., None]
    grain = 1.0 + 0.1 * height_fields.value_noise(texels, texels, texels // 2, texels // 2, 5)[..., None]
    colors = (np.array((0.62, 0.60, 0.58)) * (1.0 - tone) + np.array((0.88, 0.68, 0.46)) * tone) * grain
    return Bed(field, seen, forms, np.clip(colors, 0.0, 1.0))


def bed_of(size, p):
    """The Bed of ``PARAMETERS`` for panels of ``size`` pixels: one texel for two pixels, a power of two from
    32 to 256, unless the parameters give the number.
    """
    edge = 32
    while 2 * edge <= min(size // 2, 256):
        edge *= 2
    shape, fit = (p["stones"], p["buried"], p["height"]), (p["directions"], p["smoothing"])
    return _bed(p["texels"] or edge, *shape, *fit, p["height_field"], p["height_scale"])


def load(bed, profile):
    """The commands that load the normals as "normals", and the ellipses, for combiners."""
    normals = texture_2d(vector_texels(bed.field.normals, profile))
    return (
        *ellipse_passes.load(bed.forms, profile),
        TexImage(label="load n", texture="normals", image=normals),
    )


def with_shadows(bed, p, share):
    """The light that texels send if the lamp reaches the ``share`` [rows, columns] of each: RGB [rows,
    columns, 3].
    """
    vector = unit_vector(p["light"], "The light's direction")
    lit = np.maximum(dot(bed.field.normals, vector), 0.0) * share
    return bed.colors * (np.array(p["ambient"]) + lit[..., None] * np.array(p["color"]))


def by_rays(bed, p):
    """The same with shadows cast by rays."""
    return with_shadows(bed, p, visibility.free_view(bed.field, p["light"]))


def sampled(values, size):
    """Values of texels [rows, columns, ...] at a panel's pixels, filtered: [size, size, ...], bottom row
    first.
    """
    x, y = pixel_grid(size, 1.0)
    rows, columns = values.shape[:2]
    return at_texels(lambda row, column: values[row, column], rows, columns, 0.5 * x + 0.5, 0.5 * y + 0.5)

"""G15: bumps without and with the shadows that ellipses tell, beside the rays'."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_texels
from fixedpipe.effects.reflectance.evaluate_then_interpolate import at_texels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipse_passes, ellipses, visibility
from fixedpipe.effects.scattering.height_field import HeightField, height_field
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

_BLACK = (0.0, 0.0, 0.0)
# Light that is this share of what (n.l)+ gives is seen; what is darker tells no shadow.
_CLEARLY_LIT = 0.1


@dataclass(frozen=True, eq=False)
class Bed:
    """A height field, its ellipses as forms that may be filtered, and its colours."""

    field: HeightField
    forms: tuple
    ellipses: ellipses.Ellipses
    colors: np.ndarray


@lru_cache(4)
def _bed(texels, stones, buried, height, directions, own, scale):
    if own is None:
        # Of every stone the part above the ground is seen, so that shadows have a ground to fall on.
        heights = np.maximum(height_fields.pebbles(texels, texels, stones, 4) - buried / stones, 0.0)
        heights = height_fields.smooth(heights) * height
    else:
        heights = own.fitted(texels, texels, scale, repeated=True)
    field = height_field(heights)
    fitted = ellipses.of_visibility(visibility.precompute(field, sphere.spiral(directions)))
    tone = 0.5 + 0.5 * height_fields.value_noise(texels, texels, stones, stones, 11)[..., None]
    grain = 1.0 + 0.1 * height_fields.value_noise(texels, texels, texels // 2, texels // 2, 5)[..., None]
    colors = (np.array((0.62, 0.60, 0.58)) * (1.0 - tone) + np.array((0.88, 0.68, 0.46)) * tone) * grain
    return Bed(field, ellipses.rooted(fitted), fitted, np.clip(colors, 0.0, 1.0))


def _by_rays(bed, light, color, ambient):
    """What texels send with shadows cast by rays: float64 [rows, columns, 3]."""
    vector = unit_vector(light, "The light's direction")
    lit = np.maximum(dot(bed.field.normals, vector), 0.0) * visibility.free_view(bed.field, vector)
    return bed.colors * (np.array(ambient) + lit[..., None] * np.array(color))


def _fitting(size):
    """Texels along an edge for a panel: one for two pixels, a power of two from 32 to 256."""
    edge = 32
    while 2 * edge <= min(size // 2, 256):
        edge *= 2
    return edge


def _scene(
    load, passes, profile, size, *,
    texels, stones, buried, height, directions, light, color, ambient, height_field, height_scale,
):  # fmt: skip
    """The bed without shadows, with those of the ellipses, and by rays."""
    bed = _bed(texels or _fitting(size), stones, buried, height, directions, height_field, height_scale)
    plain, shadowed, rays = map(orthographic_view, row_of_panels(3, size))
    surface, toward = surfaces.plane(), Light(light)
    colors = factor_texels(bed.colors, profile)
    by_rays = factor_texels(_by_rays(bed, light, color, ambient), profile)
    out = [
        TexImage(label="load the colours", texture="colours", image=texture_2d(colors)),
        TexImage(label="load the light by rays", texture="rays", image=texture_2d(by_rays)),
        *load(bed, profile),
    ]
    for view, shadows in ((plain, False), (shadowed, True)):
        settings = {"color": color, "ambient": ambient, "color_map": "colours", "shadows": shadows}
        out += (view.panel.clear(_BLACK), *passes(bed, surface, view, toward, profile, **settings))
    units = (unit("rays", environment=REPLACE),)
    shown = draw("show the light by rays", surface.mesh(), rays, None, units, depth_test=FIRST_PASS)
    return (*out, rays.panel.clear(_BLACK), shown)


def _load_for_combiners(bed, profile):
    normals = texture_2d(vector_texels(bed.field.normals, profile))
    return (
        *ellipse_passes.load(bed.forms, profile),
        TexImage(label="load n", texture="normals", image=normals),
    )


def _with_combiners(bed, surface, view, light, profile, **settings):
    return ellipse_passes.combiner_passes(
        surface, bed.forms, view, light, profile, normal_map="normals", **settings
    )


def _with_the_imaging_subset(bed, surface, view, light, profile, **settings):
    return ellipse_passes.imaging_passes(
        surface, bed.forms, bed.field.normals, view, light, profile, **settings
    )


def combiner_scene(profile, size, **parameters):
    """G15, without it, and the light by rays."""
    return _scene(_load_for_combiners, _with_combiners, profile, size, **parameters)


def imaging_scene(profile, size, **parameters):
    """G16, without it, and the light by rays."""
    return _scene(lambda bed, profile: (), _with_the_imaging_subset, profile, size, **parameters)


def reference(
    size, *, texels, stones, buried, height, directions, light, color, ambient, height_field, height_scale
):
    """The middle panel by rays, between texels as a texture has it."""
    bed = _bed(texels or _fitting(size), stones, buried, height, directions, height_field, height_scale)
    picture = _sampled(_by_rays(bed, light, color, ambient), size)[::-1]
    out = np.zeros((size, 3 * size, 4))
    out[:, size : 2 * size, :3], out[:, size : 2 * size, 3] = np.clip(picture, 0.0, 1.0), 1.0
    return out


def _sampled(values, size):
    """Values of texels [rows, columns, ...] at a panel's pixels, filtered: [size, size, ...], bottom row
    first.
    """
    x, y = pixel_grid(size, 1.0)
    rows, columns = values.shape[:2]
    return at_texels(lambda row, column: values[row, column], rows, columns, 0.5 * x + 0.5, 0.5 * y + 0.5)


def checks(figure, renderer):
    """The shadows against Eq. 4 at every pixel, in float64, and against rays."""
    size, texels = 256, 128
    values = figure.values_of(renderer.method)
    own = [values[name] for name in ("height_field", "height_scale")]
    bed = _bed(texels, values["stones"], values["buried"], values["height"], values["directions"], *own)
    vector = unit_vector(values["light"], "The light's direction")
    white = {"color": (1.0, 1.0, 1.0), "ambient": (0.0, 0.0, 0.0), "texels": texels}
    test = ellipses.tested(*(_sampled(form, size) for form in bed.forms), *vector[:2])
    if renderer.method.scene is imaging_scene:
        squares = [np.minimum(1.0 - ellipses.tested(f, 0.0 * f, *vector[:2]), 1.0) for f in bed.forms]
        test = (1.0 - _sampled(squares[0], size)) - _sampled(squares[1], size)
    for on in Answer:
        plain, shadowed, rays = (
            panel_of(renderer.window(on, figure, size, **white), k).max(axis=-1) for k in range(3)
        )
        clear = plain > _CLEARLY_LIT
        lit, free = shadowed > 0.5 * plain, rays > 0.5 * plain
        told = clear & (np.abs(test) > (0.15 if on is Answer.MACHINE else 1e-3))
        yield Check(
            "pixels that are lit where Eq. 4 says so, away from the ellipses' edges",
            float((lit == (test >= 0.0))[told].mean()),
            at_least=0.998 if on is Answer.MACHINE else 0.9999,
            on=on,
            reason="the same forms, filtered in float64 at the pixel's centre; a byte of the forms is a "
            "thirtieth of the ellipse's radius, its square twice that",
        )
        yield Check(
            "pixels whose shadow is the rays'",
            float((lit == free)[clear].mean()),
            at_least=0.9,
            on=on,
            reason="the catalogue's bound for V-grooves: an ellipse is not the horizon",
        )
        yield Check(
            "pixels that rays leave in shadow and the ellipses too, of all in shadow",
            float((~lit & ~free)[clear].sum() / (~free & clear).sum()),
            at_least=0.75,
            on=on,
            reason="agreement of lit pixels alone would be had without any shadow",
        )


FIGURE = Figure(
    id="G15",
    title="Shadows of bumps by ellipses",
    caption=(
        "A bed of stones that is a flat square with a bump map, under a low light. Left: bump mapping. "
        "Middle: the same where the light lies in the ellipse that was fitted to each texel's free "
        "directions. Right: where rays reach it."
    ),
    must_see=(
        "Left every stone has its own light and dark side and throws no shadow. In the middle each throws "
        "one on the ground and on its neighbours, of the same place and length as on the right, with "
        "ragged edges."
    ),
    source="HeidrichDaubertKautzSeidel2000",
    techniques=("G14", "G15", "G16"),
    panels=("without shadows", "ellipses", "rays"),
    parameters={
        "texels": word.FITTED_TEXELS(None, "The edge of the bump map and of the ellipses' textures."),
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
        "light": word.LIGHT((-0.72, 0.46, 0.50)),
        "color": word.DIFFUSE((0.86, 0.80, 0.70)),
        "ambient": word.AMBIENT((0.13, 0.145, 0.19)),
        "height_field": own_maps.height_field("the stones"),
        "height_scale": own_maps.HEIGHT_SCALE(0.1),
    },
    methods=(
        Method("register combiners", combiner_scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),
        Method("imaging subset", imaging_scene, ("OCTANE", "OPENGL_1_2_IMAGING")),
    ),
    acceptance=checks,
    reference=reference,
)

"""G15: bumps without and with shadows by ellipses, next to those by rays."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import stones
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import ellipse_passes, ellipses
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "G15")

_BLACK = (0.0, 0.0, 0.0)


def _scene(load, passes, profile, size, p):
    """The bed without shadows, with those of the ellipses, and by rays."""
    bed = stones.bed_of(size, p)
    plain, shadowed, rays = map(orthographic_view, row_of_panels(3, size))
    surface, toward = surfaces.plane(), Light(p["light"])
    colors, by_rays = (factor_texels(values, profile) for values in (bed.colors, stones.by_rays(bed, p)))
    out = [
        TexImage(label="load the colours", texture="colours", image=texture_2d(colors)),
        TexImage(label="load the light by rays", texture="rays", image=texture_2d(by_rays)),
        *load(bed, profile),
    ]
    settings = {"color": p["color"], "ambient": p["ambient"], "color_map": "colours"}
    for view, shadows in ((plain, False), (shadowed, True)):
        out.append(view.panel.clear(_BLACK))
        out += passes(bed, surface, view, toward, profile, shadows=shadows, **settings)
    units = (unit("rays", environment=REPLACE),)
    shown = draw("show the light by rays", surface.mesh(), rays, None, units, depth_test=FIRST_PASS)
    return (*out, rays.panel.clear(_BLACK), shown)


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
    return _scene(stones.load, _with_combiners, profile, size, parameters)


def imaging_scene(profile, size, **parameters):
    """G16, without it, and the light by rays."""
    return _scene(lambda bed, profile: (), _with_the_imaging_subset, profile, size, parameters)


def reference(size, **parameters):
    """The middle panel by rays, interpolated between texels like a texture."""
    bed = stones.bed_of(size, parameters)
    picture = stones.sampled(stones.by_rays(bed, parameters), size)[::-1]
    out = np.zeros((size, 3 * size, 4))
    out[:, size : 2 * size, :3], out[:, size : 2 * size, 3] = np.clip(picture, 0.0, 1.0), 1.0
    return out


def checks(figure, renderer):
    """What the first panel shows; the shadows against Eq. 4 at every pixel, in float64, and against rays."""
    own = figure.values_of(renderer.method)
    bed = stones.bed_of(figure.size, own)
    lit = stones.sampled(stones.with_shadows(bed, own, 1.0), figure.size)
    whole = np.ones(lit.shape[:2], np.bool_)
    for on, share in seen_places.shares_alike(figure, renderer, {0: (whole, lit[whole])}):
        yield DATA.check("left: pixels that show n.l and no shadow within 8/255", share, on)
    size, texels = 256, 128
    values = {**figure.values_of(renderer.method), "texels": texels}
    bed = stones.bed_of(size, values)
    vector = unit_vector(values["light"], "The light's direction")
    white = {"color": (1.0, 1.0, 1.0), "ambient": (0.0, 0.0, 0.0), "texels": texels}
    test = ellipses.tested(*(stones.sampled(form, size) for form in bed.forms), *vector[:2])
    if renderer.method.scene is imaging_scene:
        squares = [np.minimum(1.0 - ellipses.tested(f, 0.0 * f, *vector[:2]), 1.0) for f in bed.forms]
        test = (1.0 - stones.sampled(squares[0], size)) - stones.sampled(squares[1], size)
    for on in Answer:
        plain, shadowed, rays = (
            panel_of(renderer.window(on, figure, size, **white), k).max(axis=-1) for k in range(3)
        )
        clear = plain > stones.CLEARLY_LIT
        lit, free = shadowed > 0.5 * plain, rays > 0.5 * plain
        told = clear & (np.abs(test) > (0.15 if on is Answer.MACHINE else 1e-3))
        yield DATA.check(
            "pixels that are lit where Eq. 4 says so, away from the ellipses' edges",
            float((lit == (test >= 0.0))[told].mean()),
            on,
        )
        yield DATA.check("pixels whose shadow is the rays'", float((lit == free)[clear].mean()), on)
        yield DATA.check(
            "pixels that rays leave in shadow and the ellipses too, of all in shadow",
            float((~lit & ~free)[clear].sum() / (~free & clear).sum()),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    parameters=stones.PARAMETERS,
    methods=(
        Method("register combiners", combiner_scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),
        Method("imaging subset", imaging_scene, ("OCTANE", "OPENGL_1_2_IMAGING")),
    ),
    acceptance=checks,
    reference=reference,
)

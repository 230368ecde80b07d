"""G31: one ball of ridges as geometry, as a bump map and by its BRDF, and halfway between them."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import ridged_body
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.scattering import levels

DATA = figure_data(__file__, "G31")

PANELS = ("geometry", "half and half", "bump map", "half and half", "BRDF")
# Texels a pixel, for which the levels are chosen: well within each, and at the limits.
TEXELS_A_PIXEL = (0.05, levels.BUMP_MAP, 1.0, levels.BRDF, 20.0)


def scene(profile, size, **values):
    """G31: five panels, each with the levels for a number of texels a pixel."""
    body = ridged_body.Body(**values)
    out = []
    for k, (panel, texels) in enumerate(zip(row_of_panels(len(PANELS), size), TEXELS_A_PIXEL, strict=True)):
        geometry, bump_map, brdf = levels.shares(texels)
        view, name = orthographic_view(panel), f"{geometry:g} / {bump_map:g} / {brdf:g}"
        surface = ridged_body.displaced(body, size, geometry)
        out += (
            panel.clear(BACKGROUND),
            ridged_body.load_level(body, view, brdf, f"light {k}", profile),
            ridged_body.textured(f"geometry / bump map / BRDF: {name}", surface, view, f"light {k}"),
        )
    return tuple(out)


def _checks_by_pixels(figure, renderer):
    """What each displayed panel shows, by the texels that rays meet on its ball."""
    size, body, true = figure.size, ridged_body.Body(**figure.values), []
    for texels in TEXELS_A_PIXEL:
        geometry, _, brdf = levels.shares(texels)
        light = ridged_body.level(body, brdf, (0.0, 0.0, 1.0))
        true.append(ridged_body.by_rays(body, size, geometry, light))
    for on, share in seen_places.shares_alike(figure, renderer, dict(enumerate(true))):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )


def checks(figure, renderer):
    """The panels' pixels; the light that the levels send, and where they differ."""
    yield from _checks_by_pixels(figure, renderer)
    size = figure.size // 2
    above, below, ball = ridged_body.regions(size, 1.0)
    for on in Answer:
        window = renderer.window(on, figure, size)
        panels = [panel_of(window, k) for k in range(len(PANELS))]
        energy = [ridged_body.luminance(panel[ball].mean(axis=0)) for panel in panels]
        for k, name in ((2, "the bump map"), (4, "the BRDF")):
            yield DATA.check(
                "mean luminance of {name} by that of geometry, from one",
                abs(energy[k] / energy[0] - 1.0),
                on,
                name=name,
            )
        for k, (a, b) in ((1, (0, 2)), (3, (2, 4))):
            low, high = sorted((energy[a], energy[b]))
            yield DATA.check(
                "luminance of panel {n} outside of its neighbours', a share",
                max(low - energy[k], energy[k] - high, 0.0) / energy[0],
                on,
                n=k + 1,
            )
        for part, where in ((above, "above"), (below, "below")):
            red = [float(panel[part][:, 0].sum() / panel[part][:, 1].sum()) for panel in panels]
            yield DATA.check(
                "red over green {where}: geometry and BRDF differ by a share of",
                abs(red[4] / red[0] - 1.0),
                on,
                where=where,
            )
        rough = [float(np.diff(panel.mean(axis=-1), axis=0)[ball[1:]].std()) for panel in panels]
        yield DATA.check("detail of the BRDF by that of the bump map", rough[4] / rough[2], on)
    yield arithmetic_check(figure, renderer, 0.02, "bytes of a texture, filtered with weights of 8 bits")


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    size=384,
    parameters={**ridged_body.PARAMETERS, "light": word.LIGHT((-0.28, 0.53, 0.8))},
    methods=(Method("light of the texels by rays, as a texture", scene, ("OPENGL_1_2", "GEFORCE_256")),),
    acceptance=checks,
)

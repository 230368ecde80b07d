"""F002-9: a ball with ridges, one flank red and one white, as geometry and by the BRDF of its ridges."""

import math

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import ridged_body
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels

DATA = figure_data(__file__, "F002-9")

PANELS = ("geometry without", "geometry with scattering", "BRDF without", "BRDF with scattering")


def scene(profile, size, **values):
    """F002-9: two panels of geometry, two of the BRDF."""
    body = ridged_body.Body(**values)
    out = []
    for panel, name in zip(row_of_panels(4, size), PANELS, strict=True):
        view = orthographic_view(panel)
        bounces = body.bounces if "with s" in name else 0
        out.append(panel.clear(BACKGROUND))
        if name.startswith("geometry"):
            surface = ridged_body.displaced(body, size)
            out.append(ridged_body.load(body, bounces, name, profile))
            out.append(ridged_body.textured(name, surface, view, name))
        else:
            surface = ridged_body.smooth(body, size)
            out.append(ridged_body.reflected(name, body, bounces, surface, view, profile, size))
    return tuple(out)


def separation(above, below):
    """|log(R/G) above - log(R/G) below|."""
    return abs(math.log(above[0] / above[1]) - math.log(below[0] / below[1]))


def _checks_by_pixels(figure, renderer):
    """What the two displayed panels of geometry show, by the texels that rays meet on it."""
    size, body = figure.size, ridged_body.Body(**figure.values)
    true = [
        ridged_body.by_rays(body, size, 1.0, ridged_body.radiance_map(body, bounces))
        for bounces in (0, body.bounces)
    ]
    for on, share in seen_places.shares_alike(figure, renderer, dict(enumerate(true))):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )


def checks(figure, renderer):
    """What geometry shows by pixels; its colours against those of the BRDF; what scattering does to both."""
    yield from _checks_by_pixels(figure, renderer)
    size = figure.size // 2
    above, below, ball = ridged_body.regions(size, 1.0)
    for on in Answer:
        window = renderer.window(on, figure, size)
        panels = [panel_of(window, k) for k in range(4)]
        means = [[ridged_body.region_mean(panel, part) for part in (above, below)] for panel in panels]
        for k, what in enumerate(("without", "with")):
            for part, where in enumerate(("above", "below")):
                geometry, brdf = (means[panel][part] for panel in (k, k + 2))
                yield DATA.check(
                    "red over green {where} {what} scattering: geometry and BRDF differ by a share of",
                    abs((geometry[0] / geometry[1]) / (brdf[0] / brdf[1]) - 1.0),
                    on,
                    where=where,
                    what=what,
                )
            energies = [ridged_body.luminance(panels[panel][ball].mean(axis=0)) for panel in (k, k + 2)]
            yield DATA.check(
                "mean luminance {what} scattering: geometry and BRDF differ by a share of",
                abs(energies[0] / energies[1] - 1.0),
                on,
                what=what,
            )
        for first, name in ((0, "geometry"), (2, "the BRDF")):
            yield DATA.check(
                "how much scattering brings the colours of {name} together, a share",
                1.0 - separation(*means[first + 1]) / separation(*means[first]),
                on,
                name=name,
            )
    yield DATA.check(
        "red over green above, of the BRDF without scattering, by that below",
        float((means[2][0][0] / means[2][0][1]) / (means[2][1][0] / means[2][1][1])),
        Answer.MACHINE,
    )


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    size=512,
    parameters=ridged_body.PARAMETERS,
    methods=(
        Method(
            "light of the texels by rays, as a texture and at vertices", scene, ("OPENGL_1_2", "GEFORCE_256")
        ),
    ),
    acceptance=checks,
)

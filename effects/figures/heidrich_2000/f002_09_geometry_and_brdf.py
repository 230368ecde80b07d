"""F002-9: a ball with ridges, one flank red and one white, as geometry and by the BRDF of its ridges."""

import math
from dataclasses import replace

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import ridged_body
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, orthographic_view, row_of_panels

DATA = figure_data(__file__, "F002-9")

ASPECT = (1, 2)
# Texels of a ridge where its BRDF is simulated, as shadows end at texels and their steps are seen on a large
# smooth ball; and balls so small, in pixels, that fewer do.
_BRDF_TEXELS, _SMALL = 128, 100
PANELS = ("without scattering", "with scattering")


def balls_of(panel):
    """The two squares of a Panel that is twice as high as wide: geometry above, the BRDF below."""
    return tuple(
        Panel(panel.x, panel.y + y, panel.width, panel.width) for y in (panel.height - panel.width, 0)
    )


def scene(profile, size, **values):
    """F002-9: a ball of geometry above one of the BRDF, without and with scattering."""
    body, out = ridged_body.Body(**values), []
    for panel, what in zip(row_of_panels(2, size, ASPECT), PANELS, strict=True):
        out.append(panel.clear(BACKGROUND))
        bounces = body.bounces if what.startswith("with ") else 0
        above, below = (orthographic_view(ball) for ball in balls_of(panel))
        edge, name = panel.width, f"geometry {what}"
        out.append(ridged_body.load(body, bounces, name, profile))
        out.append(ridged_body.textured(name, ridged_body.displaced(body, edge), above, name))
        surface = ridged_body.smooth(body, edge)
        texels = ridged_body.FINE_TEXELS if edge < _SMALL else _BRDF_TEXELS
        out.append(
            ridged_body.reflected(f"BRDF {what}", body, bounces, surface, below, profile, edge, texels)
        )
    return tuple(out)


def _balls(window):
    """The squares of a window, bottom row first: geometry without and with scattering, then the BRDF."""
    edge = window.shape[0] // 2
    return [
        window[rows, k * edge : (k + 1) * edge] for rows in (slice(edge, None), slice(edge)) for k in (0, 1)
    ]


def separation(above, below):
    """|log(R/G) above - log(R/G) below|."""
    return abs(math.log(above[0] / above[1]) - math.log(below[0] / below[1]))


def _checks_by_pixels(figure, renderer):
    """What the two displayed balls of geometry show, by the texels that rays meet on them."""
    edge, body = figure.size // 2, ridged_body.Body(**figure.values)
    true = [
        ridged_body.by_rays(body, edge, 1.0, ridged_body.radiance_map(body, bounces))
        for bounces in (0, body.bounces)
    ]
    for on in Answer:
        balls = _balls(renderer.window(on, figure, figure.size))
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels",
            min(
                seen_places.alike(ball[where], light, 8.0 / 255.0)
                for ball, (where, light) in zip(balls[:2], true, strict=True)
            ),
            on,
        )


def checks(figure, renderer):
    """The geometry's pixels; its colours against those of the BRDF; the effect of scattering on both."""
    yield from _checks_by_pixels(figure, renderer)
    above, below, ball = ridged_body.regions(figure.size // 2, 1.0)
    for on in Answer:
        panels = _balls(renderer.window(on, figure, figure.size))
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
    size=1024,
    aspect=ASPECT,
    parameters={
        **ridged_body.PARAMETERS,
        "light": replace(ridged_body.PARAMETERS["light"], default=(-0.28, 0.48, 0.83)),
        "ridges": replace(ridged_body.PARAMETERS["ridges"], default=64),
        "intensity": replace(ridged_body.PARAMETERS["intensity"], default=0.88),
    },
    methods=(
        Method(
            "light of the texels by rays, as a texture and at vertices", scene, ("OPENGL_1_2", "GEFORCE_256")
        ),
    ),
    acceptance=checks,
)

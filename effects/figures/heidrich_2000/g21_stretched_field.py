"""G21: one height field, pressed together and drawn apart across its grooves, and what scatters between the
flanks.
"""

import math
from itertools import pairwise

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import bent_ridges
from fixedpipe.effects.figures.heidrich_2000.shared.bent_ridges import Ridges, flank_means
from fixedpipe.effects.scattering.curved_base import Base

DATA = figure_data(__file__, "G21")

_ABOVE = 0.0


def bases_of(stretches):
    """Flat, stretched across the ridges."""
    return [Base(stretch=(stretch, 1.0)) for stretch in stretches]


def make(profile, size, *, stretches, texels, directions, bounces, exposure, red, white):
    """Each panel's light is computed on the host, and is a texture on the ridges that the machine draws."""
    ridges, bases = Ridges(texels, red, white), bases_of(stretches)
    lights = [exposure * bent_ridges.radiance(ridges, base, directions, _ABOVE, bounces) for base in bases]
    return bent_ridges.commands(profile, size, ridges, bases, lights)


def reference(size, *, stretches, texels, directions, bounces, exposure, red, white):
    """The same ridges, whose light is found by rays among the stretched triangles."""
    del directions
    ridges, bases = Ridges(texels, red, white), bases_of(stretches)
    lights = [exposure * bent_ridges.radiance_by_rays(ridges, base, _ABOVE, bounces) for base in bases]
    return bent_ridges.picture_by_rays(size, ridges, bases, lights)


def closed_form(stretch, own, other):
    """A flank's mean after one reflection, light from above: rho_own c (1 + rho_other F).

    c is the cosine of the flank's slope 1 / stretch. F is 1 minus the sine of half the angle between the
    flanks; c is the same sine.
    """
    cosine = stretch / math.hypot(stretch, 1.0)
    return [a * cosine * (1.0 + b * (1.0 - cosine)) for a, b in zip(own, other, strict=True)]


def checks(figure, renderer):
    """Both flanks of each panel against closed forms."""
    values, size = figure.values, figure.size
    stretches, texels = values["stretches"], values["texels"]
    red, white = values["red"], values["white"]
    ridges, bases = Ridges(texels, red, white), bases_of(stretches)
    for on in Answer:
        image = renderer.window(on, figure, size, bounces=1, exposure=1.0)
        for name, own, other, left in (("red", red, white, True), ("white", white, red, False)):
            for stretch, found in zip(stretches, flank_means(image, ridges, bases, left), strict=True):
                expected = closed_form(stretch, own, other)
                step = 0.0 if on is Answer.IDEAL else 1.0 / 255.0
                apart = max(abs(f - e) - step for f, e in zip(found.tolist(), expected, strict=True))
                yield DATA.check(
                    (
                        "stretch {stretch:g}, one reflection: the {name} flank beside the closed form, "
                        "relative error"
                    ),
                    max(apart, 0.0) / max(expected),
                    on,
                    stretch=stretch,
                    name=name,
                )
        if on is Answer.IDEAL:
            direct = renderer.window(on, figure, size, bounces=0, exposure=1.0)
            lights = (flank_means(window, ridges, bases, left=False) for window in (image, direct))
            for stretch, after, before in zip(stretches, *lights, strict=True):
                expected = closed_form(stretch, white, red)[0] - closed_form(stretch, white, (0.0,) * 3)[0]
                yield DATA.check(
                    (
                        "stretch {stretch:g}: red that the white flank gets by one reflection beside the "
                        "closed form, relative error"
                    ),
                    abs(float(after[0] - before[0]) / expected - 1.0),
                    on,
                    stretch=stretch,
                )
        bled = [
            float(color[0] / color[1])
            for color in flank_means(renderer.window(on, figure, size), ridges, bases, left=False)
        ]
        yield DATA.check(
            "red over green of the white flanks: the least fall from one stretch to the next",
            min(a - b for a, b in pairwise(bled)),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "stretches": word.of(
            word.Several((word.Number(0.25, 2.0),) * 3, what="three numbers from 0.25 to 2"),
            (0.6, 1.0, 1.5),
            "By what the field's lengths across the grooves are multiplied, a panel each.",
        ),
        "texels": word.of(word.Whole(8, 128, power=True), 32, "Texels of a period.", "texels"),
        "directions": word.of(word.Whole(20, 1000), 400, "Directions along which visibility is kept."),
        "bounces": word.of(word.Whole(0, 8), 4, "Reflections after the first."),
        "exposure": word.NUMBER(1.15, "What all radiances are multiplied by.", low=0.0, high=8.0),
        "red": word.COLOR((0.8, 0.1, 0.1), "The albedo of the flanks on the right of each groove."),
        "white": word.COLOR((0.8, 0.8, 0.8), "The albedo of the flanks on the left."),
    },
    methods=(Method("a texture that is computed on the host", make, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
    reference=reference,
)

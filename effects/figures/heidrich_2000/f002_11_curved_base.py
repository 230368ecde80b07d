"""F002-11: ridges with a red and a white flank, on bases of different curvature; red gets only indirect
light.
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import bent_ridges
from fixedpipe.effects.figures.heidrich_2000.shared.bent_ridges import (
    Ridges,
    aside,
    flank_colors,
    flank_means,
)
from fixedpipe.effects.scattering.curved_base import Base

DATA = figure_data(__file__, "F002-11")

# The red flank's share of a period, and the ridge's height in periods: a steep flank is dark in a high light,
# whose shadows are short, and sees much of a wide white one.
_CLIMB, _HEIGHT = 0.3125, 0.45


def bases_of(curvatures):
    """Cylinders."""
    return [Base((curvature, 0.0)) for curvature in curvatures]


def ridges_of(texels, red, white):
    """A red flank that is steep and faces away from the light, and a white one."""
    return Ridges(texels, red, white, _CLIMB, _HEIGHT)


def make(profile, size, *, curvatures, light, texels, directions, bounces, exposure, gamma, red, white):
    """Each panel's light is computed on the host, and is a texture on the bent ridges that the machine
    draws.
    """
    ridges, bases = ridges_of(texels, red, white), bases_of(curvatures)
    lights = [bent_ridges.radiance(ridges, base, directions, light, bounces) for base in bases]
    shown = [np.minimum(exposure * lit, 1.0) ** (1.0 / gamma) for lit in lights]
    return bent_ridges.commands(profile, size, ridges, bases, shown, aside)


def reference(size, *, curvatures, light, texels, directions, bounces, exposure, gamma, red, white):
    """The same ridges, whose light is found by rays among the bent triangles."""
    del directions
    ridges, bases = ridges_of(texels, red, white), bases_of(curvatures)
    lights = [bent_ridges.radiance_by_rays(ridges, base, light, bounces) for base in bases]
    shown = [np.minimum(exposure * lit, 1.0) ** (1.0 / gamma) for lit in lights]
    return bent_ridges.picture_by_rays(size, ridges, bases, shown, aside)


# Light along the red flanks meets all of the white ones.
_ALONG = math.degrees(math.atan2(_CLIMB, _HEIGHT))


def closed_form(ridges):
    """The flanks' means on a flat base, light along the red ones, after one reflection: red and white.

    White sends rho_white c, where c is the cosine of the light's angle there. Red gets F of that, by crossed
    strings. White gets none back, because after one reflection red has sent nothing.
    """
    red, white = ridges.lengths
    angle = math.radians(_ALONG) - math.atan2(ridges.height, 1.0 - ridges.climb)
    sent = math.cos(angle) * np.array(ridges.right)
    return (red + white - 1.0) / (2.0 * red) * np.array(ridges.left) * sent, sent


# Curvatures of which the light is asked beside the figure's three.
_SERIES = (-0.4, -0.2, 0.0, 0.2, 0.4)
# Of the height of a flank: next to the crest, and next to the valley.
_NEXT_TO = 0.2


def checks(figure, renderer):
    """Red against the closed form where the base is flat, against rays where it is bent; shadows by rays."""
    values, size = figure.values, figure.size
    ridges = ridges_of(values["texels"], values["red"], values["white"])
    bases, series = bases_of(values["curvatures"]), bases_of(_SERIES)
    light, count, gamma = values["light"], values["directions"], values["gamma"]
    yield DATA.check(
        "direct light on the red flanks of three panels, greatest",
        max(float(bent_ridges.radiance(ridges, k, count, light, 0)[:, ridges.fallen :].max()) for k in bases),
        Answer.IDEAL,
    )
    for on in Answer:
        changes = {"light": _ALONG, "bounces": 1, "exposure": 1.0, "gamma": 1.0}
        image = renderer.window(on, figure, size, **changes)
        for name, left, expected in zip(("red", "white"), (True, False), closed_form(ridges), strict=True):
            step = 0.0 if on is Answer.IDEAL else 1.0 / 255.0
            found = flank_means(image, ridges, bases, left, aside)[1]
            yield DATA.check(
                "flat, light along the red flanks, one reflection: the {name} flank beside the closed form, "
                "relative error",
                float(np.maximum(np.abs(found - expected) - step, 0.0).max() / expected.max()),
                on,
                name=name,
            )
        yield from _displayed(renderer.window(on, figure, size), ridges, bases, light, gamma, on)
    found, truth = (
        np.array([float(lit[0, lit.shape[1] * ridges.fallen // ridges.texels :, 0].mean()) for lit in lights])
        for lights in (
            [bent_ridges.radiance(ridges, k, count, light, 1) for k in series],
            [bent_ridges.radiance_by_rays(ridges, k, light, 1) for k in series],
        )
    )
    yield DATA.check(
        "red glow at curvatures of -0.4 to 0.4, one reflection: the least fall from one to the next",
        float((1.0 - found[1:] / found[:-1]).min()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "the same beside rays among the bent triangles, largest relative error",
        float(np.abs(found / truth - 1.0).max()),
        Answer.IDEAL,
    )
    lit, truly = (
        np.array([float(of(ridges, k, light)[0].mean()) for k in series])
        for of in (bent_ridges.lit_share, bent_ridges.lit_by_rays)
    )
    yield DATA.check(
        "lit share of a period at curvatures of -0.4 to 0.4, beside rays: largest difference in texels",
        float(np.abs(lit - truly).max()) * ridges.texels,
        Answer.IDEAL,
    )


def _displayed(window, ridges, bases, light, gamma, on):
    """The Checks of what the three panels show."""

    def linear(colors):
        return colors**gamma

    reds = [linear(colors) for colors in flank_colors(window, ridges, bases, True, aside)]
    whites = flank_colors(window, ridges, bases, False, aside)
    glow = [float(colors[:, 0].mean()) for colors in reds]
    yield DATA.check(
        "red glow of the concave base over that of the flat one, less one", glow[0] / glow[1] - 1.0, on
    )
    yield DATA.check(
        "red glow of the flat base over that of the convex one, less one", glow[1] / glow[2] - 1.0, on
    )
    ends, shadows, wide = [], [], []
    for where, base, red, white in zip(("concave", "flat", "convex"), bases, reds, whites, strict=True):
        part = max(round(_NEXT_TO * len(red)), 1)
        ends.append(float(red[-part:, 0].mean() / red[:part, 0].mean()))
        # The flank's texel at the valley is not read, nor that at the crest.
        lit = bent_ridges.lit_by_rays(ridges, base, light)[0, : bent_ridges.FINER * ridges.fallen]
        shadows.append(float((lit == 0.0).sum()) / bent_ridges.FINER - 1.0)
        wide.append(float((linear(white)[:, 1] < 0.5 * linear(white)[:, 1].max()).sum()))
        yield DATA.check(
            "{where}: the shadow at the foot of the white flank, beside rays', in texels",
            abs(wide[-1] - max(shadows[-1], 0.0)),
            on,
            where=where,
        )
    yield DATA.check(
        "red next to the crest by red next to the valley, concave by convex", ends[0] / ends[2], on
    )
    dark = linear(whites[0])[:, 1]
    yield DATA.check(
        "concave: the foot of the white flank by the rest of it, green", float(dark[0] / dark.max()), on
    )
    yield DATA.check(
        "the shadow at the foot: what it is wider on the concave base than on the flat one, in texels",
        wide[0] - wide[1],
        on,
        true=shadows[0] - shadows[1],
    )
    tinge = [float((c[:, 0] / c[:, 1])[c[:, 1] > 0.5 * c[:, 1].max()].mean()) for c in map(linear, whites)]
    yield DATA.check("lit white: red over green on the concave base, less one", tinge[0] - 1.0, on)
    yield DATA.check("the same: how much more than on the convex base", tinge[0] - tinge[2], on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "curvatures": word.of(
            word.Several((word.Number(-0.9, 0.9),) * 3, what="three numbers from -0.9 to 0.9"),
            (-0.4, 0.0, 0.4),
            "The base's curvature across the ridges, a panel each; positive is convex.",
            "1 / period",
        ),
        "light": word.DEGREES(37.5, "The light's angle from the base's normal, towards the white flanks."),
        "texels": word.of(word.Whole(8, 128, power=True), 64, "Texels of a period.", "texels"),
        "directions": word.of(word.Whole(20, 1000), 1000, "Directions along which visibility is kept."),
        "bounces": word.of(word.Whole(0, 8), 4, "Reflections after the first."),
        "exposure": word.NUMBER(1.05, "What all radiances are multiplied by.", low=0.0, high=8.0),
        "gamma": word.NUMBER(
            2.2, "The display's: the texture holds light to the power 1 / gamma.", low=0.5, high=4.0
        ),
        "red": word.COLOR((0.9, 0.1, 0.08), "The albedo of the flanks that are turned away from the light."),
        "white": word.COLOR((0.85, 0.85, 0.85), "The albedo of the flanks that face the light."),
    },
    methods=(Method("a texture that is computed on the host", make, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
    reference=reference,
)

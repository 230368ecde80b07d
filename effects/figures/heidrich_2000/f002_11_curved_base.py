"""F002-11: ridges with a red and a white flank, on bases of different curvature; red gets indirect light
alone.
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import bent_ridges
from fixedpipe.effects.figures.heidrich_2000.shared.bent_ridges import flank_means, lamp
from fixedpipe.effects.scattering.curved_base import Base

DATA = figure_data(__file__, "F002-11")


def bases_of(curvatures):
    """Cylinders."""
    return [Base((curvature, 0.0)) for curvature in curvatures]


def make(profile, size, *, curvatures, light, texels, directions, bounces, exposure, red, white):
    """Each panel's light is computed on the host, and is a texture on the bent ridges that the machine
    draws.
    """
    bases = bases_of(curvatures)
    lights = [
        exposure * bent_ridges.radiance(base, texels, directions, light, bounces, red, white)
        for base in bases
    ]
    return bent_ridges.commands(profile, size, bases, lights)


def reference(size, *, curvatures, light, texels, directions, bounces, exposure, red, white):
    """The same ridges, whose light is found by rays among the bent triangles."""
    bases = bases_of(curvatures)
    lights = [
        exposure * bent_ridges.radiance_by_rays(base, texels, light, bounces, red, white) for base in bases
    ]
    return bent_ridges.picture_by_rays(size, bases, texels, lights)


# A form factor F of two flanks that meet at a right angle, and what the albedos make of it, in units of a
# white surface that faces the light.
_FORM_FACTOR = 1.0 - math.sin(math.radians(45.0))
_SERIES = (-0.5, -0.25, 0.0, 0.25, 0.5)


def _red_series(make, arguments):
    """The red flank's mean after one reflection, at each of ``_SERIES``; ``make`` finds the light."""
    out = []
    for base in bases_of(_SERIES):
        lit = make(base, *arguments)
        out.append(float(lit[0, : lit.shape[1] // 2, 0].mean()))
    return np.array(out)


def checks(figure, renderer):
    """Red against the closed form where the base is flat, against rays where it is bent; shadows by rays."""
    size = figure.size
    values = figure.values
    bases, texels, light = bases_of(values["curvatures"]), values["texels"], values["light"]
    red, white, exposure = values["red"], values["white"], values["exposure"]
    yield DATA.check(
        "direct light on the red flanks of three panels, greatest",
        max(
            float(
                bent_ridges.radiance(k, texels, values["directions"], light, 0, red, white)[
                    :, : texels // 2
                ].max()
            )
            for k in bases
        ),
        Answer.IDEAL,
    )
    for on in Answer:
        image = renderer.window(on, figure, size, light=bent_ridges.FLANKS, bounces=1, exposure=1.0)
        for name, found, expected in (
            ("red", flank_means(image, bases, texels)[1], _FORM_FACTOR * np.array(red) * white),
            ("white", flank_means(image, bases, texels, left=False)[1], np.array(white)),
        ):
            step = 0.0 if on is Answer.IDEAL else 1.0 / 255.0
            yield DATA.check(
                (
                    "flat, light straight on the white flanks, one reflection: the {name} flank beside "
                    "the closed form, relative error"
                ),
                float(np.maximum(np.abs(found - expected) - step, 0.0).max() / expected.max()),
                on,
                name=name,
            )
        glow = [float(c[0]) / exposure for c in flank_means(renderer.window(on, figure, size), bases, texels)]
        yield DATA.check(
            "red glow of the flat base over that of the convex one, less one", glow[1] / glow[2] - 1.0, on
        )
        yield DATA.check(
            "red glow of the concave base over that of the flat one, less one", glow[0] / glow[1] - 1.0, on
        )
    found = _red_series(bent_ridges.radiance, (texels, values["directions"], light, 1, red, white))
    yield DATA.check(
        ("red glow at curvatures of -0.5 to 0.5, one reflection: the least fall from one to the next"),
        float((1.0 - found[1:] / found[:-1]).min()),
        Answer.IDEAL,
    )
    truth = _red_series(bent_ridges.radiance_by_rays, (texels, light, 1, red, white))
    yield DATA.check(
        "the same beside rays among the bent triangles, largest relative error",
        float(np.abs(found / truth - 1.0).max()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "the same at a curvature of 0.25 and less",
        float(np.abs(found / truth - 1.0)[1:-1].max()),
        Answer.IDEAL,
    )
    for name, found in (
        ("by rays", [bent_ridges.lit_by_rays(k, texels, lamp(light)) for k in bases_of(_SERIES)]),
        (
            "by what is kept",
            [
                bent_ridges.lit_by_kept(k, texels, values["directions"], lamp(light))
                for k in bases_of(_SERIES)
            ],
        ),
    ):
        shares = np.array([float(lit[0, lit.shape[1] // 2 :].mean()) for lit in found])
        yield DATA.check(
            "lit share of the white flanks at curvatures of -0.5 to 0.5, {name}: what it grows by",
            float(shares[-1] - shares[0]),
            Answer.IDEAL,
            name=name,
        )
        yield DATA.check(
            "the same, {name}: the least growth from one to the next",
            float(np.diff(shares).min()),
            Answer.IDEAL,
            name=name,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "curvatures": word.of(
            word.Several((word.Number(-0.9, 0.9),) * 3, what="three numbers from -0.9 to 0.9"),
            (-0.5, 0.0, 0.5),
            "The base's curvature across the ridges, a panel each; positive is convex.",
            "1 / period",
        ),
        "light": word.DEGREES(50.0, "The light's angle from the base's normal, towards the white flanks."),
        "texels": word.of(word.Whole(8, 128, power=True), 32, "Texels of a period.", "texels"),
        "directions": word.of(word.Whole(20, 1000), 400, "Directions along which visibility is kept."),
        "bounces": word.of(word.Whole(0, 8), 4, "Reflections after the first."),
        "exposure": word.NUMBER(1.15, "What all radiances are multiplied by.", low=0.0, high=8.0),
        "red": word.COLOR((0.8, 0.1, 0.1), "The albedo of the flanks that are turned away from the light."),
        "white": word.COLOR((0.8, 0.8, 0.8), "The albedo of the flanks that face the light."),
    },
    methods=(Method("a texture that is computed on the host", make, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
    reference=reference,
)

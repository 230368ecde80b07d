"""G20: the shadows of ridges on bases of different curvature, by five ellipses for every texel."""

from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import bent_ridges
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.effects.scattering import (
    curved_base,
    curved_ellipses,
    ellipse_passes,
    ellipses,
    visibility,
)
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import WrapMode
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "G20")

# What is darker tells no shadow.
_CLEARLY_LIT = 0.1
# How many ridges a panel shows.
_REPEATS = 3.0
# Between the flanks of a ridge there is no normal and no ellipse of both.
_TEXELS = replace(NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)


@cache
def ellipses_of(texels, directions):
    """The ridges' five ellipses."""
    field = bent_ridges.ridges(texels, 1.0, 1.0)
    seen = visibility.precompute(field, spiral(directions))
    return curved_ellipses.five_ellipses(field, seen)


def make(profile, size, *, curvatures, texels, directions, light, color, ambient):
    """Each panel's forms are linear in its curvature, which the host computes; the test and the light are
    the machine's.
    """
    field, five = bent_ridges.ridges(texels, 1.0, 1.0), ellipses_of(texels, directions)
    surface, out = surfaces.plane().with_repeats(_REPEATS, 1.0), []
    lamp = Light(tuple(bent_ridges.lamp(light)))
    for number, (panel, curvature) in enumerate(zip(row_of_panels(3, size), curvatures, strict=True), 1):
        forms = tuple(np.clip(form, -4.0, 4.0) for form in five.packed(curvature, 0.0))
        normals = curved_base.bent_normals(field, Base((curvature, 0.0)))
        names = f"ellipses {number}", f"normals {number}"
        out += [
            panel.clear(BACKGROUND),
            *ellipse_passes.load(forms, profile, names[0]),
            TexImage(
                label=f"load n, curvature {curvature:g}",
                texture=names[1],
                image=texture_2d(vector_texels(normals, profile)),
            ),
            *ellipse_passes.combiner_passes(
                surface, forms, orthographic_view(panel), lamp, profile,
                name=names[0], sampler=_TEXELS, normal_map=names[1], color=color, ambient=ambient,
            ),
        ]  # fmt: skip
    return tuple(out)


@cache
def by_rays(curvature, texels, light):
    """The light that reaches the texels of the bent ridges, by rays, and (n.l)+: two float64 [2, texels]."""
    base, vector = Base((curvature, 0.0)), bent_ridges.lamp(light)
    caster = BentCaster(bent_ridges.ridges(texels, 1.0, 1.0), base, (1, 6))
    return caster.lit(vector), np.maximum(dot(caster.normals, vector), 0.0)


def _sampled(values, size):
    """Values of texels at a panel's pixels, the nearest: [size, size], bottom row first."""
    x, y = pixel_grid(size, 1.0)
    rows, columns = values.shape
    column = np.floor(_REPEATS * (0.5 * x + 0.5) * columns).astype(np.int64) % columns
    return values[np.floor((0.5 * y + 0.5) * rows).astype(np.int64), column]


def reference(size, *, curvatures, texels, directions, light, color, ambient):
    """The same by rays among the bent triangles."""
    del directions
    out = np.ones((size, 3 * size, 4))
    for panel, curvature in zip(row_of_panels(3, size), curvatures, strict=True):
        lit, facing = by_rays(curvature, texels, light)
        share = _sampled(lit * facing, size)[::-1, :, None]
        picture = np.array(ambient) + share * np.array(color)
        out[:, panel.x : panel.x + size, :3] = np.clip(picture, 0.0, 1.0)
    return out


def checks(figure, renderer):
    """Lit shares of the panels, and each pixel beside rays."""
    values, size = figure.values, 256
    curvatures, texels, light = values["curvatures"], values["texels"], values["light"]
    vector, five = bent_ridges.lamp(light), ellipses_of(texels, values["directions"])
    order = np.argsort(curvatures)
    for on in Answer:
        window = renderer.window(on, figure, size, color=(1.0, 1.0, 1.0), ambient=(0.0, 0.0, 0.0))
        shares, truths = [], []
        for number, curvature in enumerate(curvatures):
            picture = panel_of(window, number).max(axis=-1)
            lit, facing = by_rays(curvature, texels, light)
            clear = _sampled(facing, size) > _CLEARLY_LIT
            told, truly = picture > 0.5 * _sampled(facing, size), _sampled(lit, size) > 0.5
            test = [_sampled(form[..., k], size) for form in five.packed(curvature, 0.0) for k in range(3)]
            value = 1.0 - sum(
                (test[k] * vector[0] + test[k + 1] * vector[1] + test[k + 2]) ** 2 for k in (0, 3)
            )
            away = clear & (np.abs(value) > (0.15 if on is Answer.MACHINE else 1e-3))
            yield DATA.check(
                ("curvature {curvature:g}: pixels lit where the packed numbers say so, away from the edge"),
                float((told == (value > 0.0))[away].mean()),
                on,
                curvature=curvature,
            )
            yield DATA.check(
                "curvature {curvature:g}: pixels that are lit as rays say",
                float((told == truly)[clear].mean()),
                on,
                curvature=curvature,
            )
            shares.append(float(told[clear].mean()))
            truths.append(float(truly[clear].mean()))
        growth, truth = np.diff(np.array(shares)[order]), np.diff(np.array(truths)[order])
        yield DATA.check(
            "lit share: the least growth from one curvature to the next", float(growth.min()), on
        )
        yield DATA.check("lit share: its growth over that of rays", float(growth.sum() / truth.sum()), on)
    flat = ellipses.rooted(five.flat)
    yield DATA.check(
        "no curvature: largest difference of the packed numbers from the flat ellipses'",
        max(float(np.abs(a - b).max()) for a, b in zip(five.packed(0.0, 0.0), flat, strict=True)),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "curvatures": word.of(
            word.Several((word.Number(-0.9, 0.9),) * 3, what="three numbers from -0.9 to 0.9"),
            (-0.4, 0.0, 0.4),
            "The base's curvature across the ridges, a panel each; positive is convex.",
            "1 / period",
        ),
        "texels": word.of(word.Whole(16, 128, power=True), 64, "Texels of a period.", "texels"),
        "directions": word.of(word.Whole(20, 1000), 400, "Directions along which visibility is kept."),
        "light": word.DEGREES(
            65.0, "The light's angle from the base's normal, to the right.", low=0.0, high=85.0
        ),
        "color": word.DIFFUSE((0.86, 0.80, 0.70)),
        "ambient": word.AMBIENT((0.13, 0.145, 0.19)),
    },
    methods=(Method("register combiners", make, ("GEFORCE_256", "GEFORCE_3")),),
    acceptance=checks,
    reference=reference,
)

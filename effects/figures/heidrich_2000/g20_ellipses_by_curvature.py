"""G20: the shadows of ridges on bases of different curvature, by five ellipses for every texel."""

from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import bent_ridges
from fixedpipe.effects.figures.heidrich_2000.shared.bent_ridges import Ridges
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, row_of_panels
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
# Between the flanks of a ridge there is no normal and no ellipse of both.
_TEXELS = replace(NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)


@cache
def ellipses_of(texels, directions):
    """The ridges' five ellipses."""
    field = Ridges(texels).field()
    seen = visibility.precompute(field, spiral(directions))
    return curved_ellipses.five_ellipses(field, seen)


def _in_own_frames(surface):
    """The bent ridges with the world's axes as the frame of each vertex: a light is then in one direction in
    the base's frame everywhere, as on a small piece of a large body.
    """
    tangents, binormals, normals = (np.tile(axis, (len(surface.positions), 1)) for axis in np.eye(3))
    return replace(surface, tangents=tangents, binormals=binormals, normals=normals)


def make(profile, size, *, curvatures, texels, directions, light, color, ambient):
    """Each panel's forms are linear in its curvature, which the host computes; the test and the light are
    the machine's.
    """
    ridges, five, out = Ridges(texels), ellipses_of(texels, directions), []
    lamp = Light(tuple(bent_ridges.lamp(light)))
    for number, (panel, curvature) in enumerate(zip(row_of_panels(3, size), curvatures, strict=True), 1):
        base, view = Base((curvature, 0.0)), bent_ridges.along(panel)
        surface, cut = bent_ridges.strip(ridges, base)
        forms = tuple(np.clip(form, -4.0, 4.0) for form in five.packed(curvature, 0.0))
        normals = curved_base.bent_normals(ridges.field(), base)
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
                _in_own_frames(surface), forms, view, lamp, profile,
                name=names[0], sampler=_TEXELS, normal_map=names[1], color=color, ambient=ambient,
            ),
            bent_ridges.cut_draw(cut, view),
        ]  # fmt: skip
    return tuple(out)


@cache
def by_rays(curvature, texels, light):
    """The light that reaches the texels of the bent ridges, by rays, and (n.l)+: two float64 [2, texels]."""
    base, vector = Base((curvature, 0.0)), bent_ridges.lamp(light)
    caster = BentCaster(Ridges(texels).field(), base, (1, 6))
    return caster.lit(vector), np.maximum(dot(caster.normals, vector), 0.0)


def reference(size, *, curvatures, texels, directions, light, color, ambient):
    """The same by rays among the bent triangles."""
    del directions
    bases, lights = [], []
    for curvature in curvatures:
        lit, facing = by_rays(curvature, texels, light)
        bases.append(Base((curvature, 0.0)))
        lights.append(np.array(ambient) + (lit * facing)[..., None] * np.array(color))
    return bent_ridges.picture_by_rays(size, Ridges(texels), bases, lights, nearest=True)


def _columns_of(ridges, base, size):
    """Which texel of the ridges each pixel of a panel shows, or -1: int64 [size, size], bottom row first."""
    (panel,) = row_of_panels(1, size)
    seen = seen_places.surface(bent_ridges.strip(ridges, base)[0], bent_ridges.along(panel))
    out = np.full(seen.where.shape, -1)
    out[seen.where] = seen_places.nearest(np.arange(ridges.texels)[None], seen)
    return out


def checks(figure, renderer):
    """Lit shares of the panels, and each pixel beside rays."""
    values, size = figure.values, figure.size
    curvatures, texels, light = values["curvatures"], values["texels"], values["light"]
    vector, five = bent_ridges.lamp(light), ellipses_of(texels, values["directions"])
    order, ridges = np.argsort(curvatures), Ridges(texels)
    columns = [_columns_of(ridges, Base((curvature, 0.0)), size) for curvature in curvatures]
    ambient, color = np.array(values["ambient"]), np.array(values["color"])
    for on in Answer:
        window = renderer.window(on, figure, size)
        shares, truths = [], []
        for number, curvature in enumerate(curvatures):
            lit, facing = (row[0] for row in by_rays(curvature, texels, light))
            clear = (columns[number] >= 0) & (facing > _CLEARLY_LIT)[columns[number]]
            at = columns[number][clear]
            picture = ((panel_of(window, number)[clear] - ambient) / color).mean(axis=-1)
            told, truly = picture > 0.5 * facing[at], lit[at] > 0.5
            test = [form[0, :, k] for form in five.packed(curvature, 0.0) for k in range(3)]
            value = 1.0 - sum(
                (test[k] * vector[0] + test[k + 1] * vector[1] + test[k + 2]) ** 2 for k in (0, 3)
            )
            away = (np.abs(value) > (0.15 if on is Answer.MACHINE else 1e-3))[at]
            yield DATA.check(
                ("curvature {curvature:g}: pixels lit where the packed numbers say so, away from the edge"),
                float((told == (value > 0.0)[at])[away].mean()),
                on,
                curvature=curvature,
            )
            yield DATA.check(
                "curvature {curvature:g}: pixels that are lit as rays say",
                float((told == truly).mean()),
                on,
                curvature=curvature,
            )
            # Every texel of the flank counts alike, however the camera sees it.
            parts = [(told[at == k].mean(), truly[at == k].mean()) for k in np.unique(at)]
            share, truth = np.array(parts).mean(axis=0)
            shares.append(share)
            truths.append(truth)
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
        "texels": word.of(word.Whole(16, 128, power=True), 32, "Texels of a period.", "texels"),
        "directions": word.of(word.Whole(20, 1000), 1000, "Directions along which visibility is kept."),
        "light": word.DEGREES(
            60.0, "The light's angle from the base's normal, to the right.", low=0.0, high=85.0
        ),
        "color": word.DIFFUSE((0.72, 0.66, 0.56)),
        "ambient": word.AMBIENT((0.24, 0.26, 0.33)),
    },
    methods=(Method("register combiners", make, ("GEFORCE_256", "GEFORCE_3")),),
    acceptance=checks,
    reference=reference,
)

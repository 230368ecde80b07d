"""F002-11: ridges with a red and a white flank, on bases of different curvature; red gets indirect light
alone.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.diagrams.drawing import project
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import curved_base, height_field, visibility
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.textures.images import texture_2d

# Periods of the field to either side of the valley in the middle, across the ridges and along them.
_ACROSS, _ALONG = 1.5, 1.0
# How far the body's cut reaches below the valleys, in periods.
_BODY = 0.25
_BODY_COLOR = (0.20, 0.21, 0.24)
_FLANKS = 45.0
# Rays of the truth at every texel, and its texels for one of the figure's: shadows by rays end at texels.
_RAYS, _FINER = 800, 4


def ridges(texels, red, white):
    """One ridge a period, its heights measured from their middle: a bend then makes a flank as much steeper
    below as flatter above.
    """
    field = height_field.ridges(texels, 2, _FLANKS, 1, red, white)
    return replace(field, heights=field.heights - 0.5 * (field.heights.min() + field.heights.max()))


def lamp(angle):
    """The direction to the light, ``angle`` degrees from the base's normal, towards the white flanks."""
    return np.array([float(sine(math.radians(angle))), 0.0, float(cosine(math.radians(angle)))])


@cache
def radiance(curvature, texels, directions, light, count, red, white):
    """What the texels send with ``count`` reflections, by visibility that is kept: float64 [2, texels, 3]."""
    field = ridges(texels, red, white)
    seen = visibility.precompute(field, spiral(directions))
    bent = curved_base.bend(field, seen, Base((curvature, 0.0)))
    return curved_base.bounces(field, bent, lamp(light), count)[-1]


@cache
def radiance_by_rays(curvature, texels, light, count, red, white):
    """The same by rays among the bent triangles, with ``_FINER`` times the texels: float64 [2, n, 3]."""
    field = ridges(_FINER * texels, red, white)
    caster = BentCaster(field, Base((curvature, 0.0)), (2, 6))
    bent = caster.bent(spiral(_RAYS))
    return curved_base.bounces(field, bent, lamp(light), count, caster.lit(lamp(light)))[-1]


def strip(curvature, texels):
    """The mesh of the ridges, and of the cut below its near edge: two Surfaces."""
    field, base = ridges(texels, 1.0, 1.0), Base((curvature, 0.0))
    half = round(_ACROSS * texels)
    rows = round(2 * _ALONG)
    top = curved_base.bent_surface(field, base, (-half, half - 1), (-rows, rows - 1), (0.0, 0.0))
    edge = top.positions[: 2 * half]
    x = (np.arange(-half, half) + 0.5) / texels
    y = np.full_like(x, edge[0, 1])
    floor = base.placed(np.stack([x, y, np.full_like(x, field.heights.min() - _BODY)], axis=-1))
    k = np.arange(2 * half - 1)
    quads = np.stack([k, k + 1, k + 1 + 2 * half, k, k + 1 + 2 * half, k + 2 * half], axis=-1)
    flat = np.zeros((4 * half, 3))
    cut = Surface(
        np.concatenate([floor, edge]), flat, flat, flat, np.zeros((4 * half, 2)), quads.reshape(-1, 3)
    )
    return top, cut


def camera(panel):
    """Along the ridges from above."""
    return perspective_view(panel, (0.0, -6.2, 5.0), (0.0, -0.12, 0.02), 25.5, 4.0)


def make(profile, size, *, curvatures, light, texels, directions, bounces, exposure, red, white):
    """Each panel's light is computed on the host, and is a texture on the bent ridges that the machine
    draws.
    """
    commands = []
    for number, (panel, curvature) in enumerate(zip(row_of_panels(3, size), curvatures, strict=True)):
        view, name = camera(panel), f"light {number + 1}"
        lit = exposure * radiance(curvature, texels, directions, light, bounces, red, white)
        top, cut = strip(curvature, texels)
        body = Mesh(
            positions=cut.positions,
            indices=cut.triangles.ravel(),
            colors=np.tile(np.array(_BODY_COLOR), (len(cut.positions), 1)),
        )
        image = texture_2d(factor_texels(np.minimum(lit, 1.0), profile))
        units = (unit(name, REPEATED, environment=REPLACE),)
        commands += [
            panel.clear(BACKGROUND),
            TexImage(label=f"load {name}", texture=name, image=image),
            draw(f"ridges, curvature {curvature:g}", top.mesh(), view, None, units, depth_test=FIRST_PASS),
            draw("the cut below them", body, view, None, depth_test=FIRST_PASS),
        ]
    return tuple(commands)


def reference(size, *, curvatures, light, texels, directions, bounces, exposure, red, white):
    """The same ridges, whose light is found by rays among the bent triangles."""
    out = np.ones((size, 3 * size, 4))
    for panel, curvature in zip(row_of_panels(3, size), curvatures, strict=True):
        lit = exposure * radiance_by_rays(curvature, texels, light, bounces, red, white)
        parts = strip(curvature, texels)
        corners = [part.positions[part.triangles] for part in parts]
        caster = RayCaster(
            np.concatenate(corners), np.repeat((0, 1), [len(triangles) for triangles in corners])
        )
        hits = caster.nearest(*primary_rays(camera(panel)), 1.0)
        at = np.concatenate([part.texture_coordinates[part.triangles] for part in parts])[hits.triangle]
        at = (at[..., 0] * hits.barycentrics).sum(axis=-1) * lit.shape[1] - 0.5
        first = np.floor(at).astype(np.int64)
        share = (at - first)[:, None]
        color = (1.0 - share) * lit[0, first % lit.shape[1]] + share * lit[0, (first + 1) % lit.shape[1]]
        color[caster.objects[hits.triangle] == 1] = _BODY_COLOR
        color[hits.triangle < 0] = BACKGROUND
        out[::-1, panel.x : panel.x + size, :3] = np.minimum(color, 1.0).reshape(size, size, 3)
    return out


def flank_means(image, figure, curvatures, red=True):
    """The mean colour of the middle valley's red flank, or the white one, of each panel, as the picture has
    it: list of float64 [3]. Texels are read at their centres, but for those at the flank's ends, whose colour
    the filter mixes with the other flank's.
    """
    texels = figure.values["texels"]
    out = []
    for number, (panel, curvature) in enumerate(
        zip(row_of_panels(3, image.shape[0]), curvatures, strict=True)
    ):
        field = ridges(texels, 1.0, 1.0)
        at = np.arange(1, texels // 2 - 1) if red else np.arange(texels // 2 + 1, texels - 1)
        x = (at + 0.5) / texels - (0.0 if red else 1.0)
        points = Base((curvature, 0.0)).placed(np.stack([x, 0.0 * x, field.heights[0, at]], axis=-1))
        places = np.floor(project(camera(panel), points)[:, :2]).astype(int)
        colors = panel_of(image, number)[places[:, 1], places[:, 0]]
        out.append(colors.mean(axis=0))
    return out


# A form factor F of two flanks that meet at a right angle, and what the albedos make of it, in units of a
# white surface that faces the light.
_FORM_FACTOR = 1.0 - math.sin(math.radians(45.0))
_SERIES = (-0.5, -0.25, 0.0, 0.25, 0.5)


def _lit_by_rays(curvature, texels, light):
    field = ridges(_FINER * texels, 1.0, 1.0)
    return BentCaster(field, Base((curvature, 0.0)), (2, 6)).lit(light)


def _lit_by_kept(curvature, texels, directions, light):
    field = ridges(texels, 1.0, 1.0)
    bent = curved_base.bend(field, visibility.precompute(field, spiral(directions)), Base((curvature, 0.0)))
    return curved_base.free_share(field, bent, light)


def _red_series(make, arguments):
    """The red flank's mean after one reflection, at each of ``_SERIES``; ``make`` as ``radiance``."""
    out = []
    for curvature in _SERIES:
        lit = make(curvature, *arguments)
        out.append(float(lit[0, : lit.shape[1] // 2, 0].mean()))
    return np.array(out)


def checks(figure, renderer):
    """Red against the closed form where the base is flat, against rays where it is bent; shadows by rays."""
    size = figure.size
    values = figure.values
    curvatures, texels, light = values["curvatures"], values["texels"], values["light"]
    red, white, exposure = values["red"], values["white"], values["exposure"]
    yield Check(
        "direct light on the red flanks of three panels, greatest",
        max(
            float(radiance(k, texels, values["directions"], light, 0, red, white)[:, : texels // 2].max())
            for k in curvatures
        ),
        at_most=0.0,
        on=Answer.IDEAL,
        reason="the flanks are turned away from the light, exactly",
    )
    for on in Answer:
        image = renderer.window(on, figure, size, light=_FLANKS, bounces=1, exposure=1.0)
        for name, found, expected in (
            ("red", flank_means(image, figure, curvatures)[1], _FORM_FACTOR * np.array(red) * white),
            ("white", flank_means(image, figure, curvatures, red=False)[1], np.array(white)),
        ):
            step = 0.0 if on is Answer.IDEAL else 1.0 / 255.0
            yield Check(
                f"flat, light straight on the white flanks, one reflection: the {name} flank beside the "
                "closed form, relative error",
                float(np.maximum(np.abs(found - expected) - step, 0.0).max() / expected.max()),
                at_most=0.06,
                on=on,
                reason="rho_red F rho_white, F = 1 - sin 45; texels, directions and the flank's ends that "
                "are not read make 6 %",
            )
        glow = [
            float(c[0]) / exposure for c in flank_means(renderer.window(on, figure, size), figure, curvatures)
        ]
        yield Check(
            "red glow of the flat base over that of the convex one, less one",
            glow[1] / glow[2] - 1.0,
            at_least=0.1,
            on=on,
            reason="valleys widen: less light is scattered",
        )
        yield Check(
            "red glow of the concave base over that of the flat one, less one",
            glow[0] / glow[1] - 1.0,
            at_least=0.1,
            on=on,
            reason="valleys narrow: more light is scattered",
        )
    found = _red_series(radiance, (texels, values["directions"], light, 1, red, white))
    yield Check(
        "red glow at curvatures of -0.5 to 0.5, one reflection: the least fall from one to the next",
        float((1.0 - found[1:] / found[:-1]).min()),
        at_least=0.02,
        on=Answer.IDEAL,
        reason="it falls steadily",
    )
    truth = _red_series(radiance_by_rays, (texels, light, 1, red, white))
    yield Check(
        "the same beside rays among the bent triangles, largest relative error",
        float(np.abs(found / truth - 1.0).max()),
        at_most=0.15,
        on=Answer.IDEAL,
        reason="what is seen is kept from the flat base: good where curvature is small",
    )
    yield Check(
        "the same at a curvature of 0.25 and less",
        float(np.abs(found / truth - 1.0)[1:-1].max()),
        at_most=0.1,
        on=Answer.IDEAL,
        reason="small curvature",
    )
    for name, found in (
        ("by rays", [_lit_by_rays(k, texels, lamp(light)) for k in _SERIES]),
        ("by what is kept", [_lit_by_kept(k, texels, values["directions"], lamp(light)) for k in _SERIES]),
    ):
        shares = np.array([float(lit[0, lit.shape[1] // 2 :].mean()) for lit in found])
        yield Check(
            f"lit share of the white flanks at curvatures of -0.5 to 0.5, {name}: what it grows by",
            float(shares[-1] - shares[0]),
            at_least=0.02,
            on=Answer.IDEAL,
            reason="where valleys widen less of them is in shadow, under one light in the ridges' frames",
        )
        yield Check(
            f"the same, {name}: the least growth from one to the next",
            float(np.diff(shares).min()),
            at_least=0.0,
            on=Answer.IDEAL,
            reason="it never shrinks",
        )


FIGURE = Figure(
    id="F002-11",
    title="Ridges on curved bases",
    caption=(
        "One height field, whose flanks are white towards the light and red away from it, on a concave, a "
        "flat and a convex base. Each ridge is lit as a small piece of a large body is, from one direction "
        "in its own frame; red gets what white scatters, and nothing else."
    ),
    must_see=(
        "The red flanks glow most on the concave base, whose valleys are narrow, less on the flat one, least "
        "on the convex one, where they fade to black at the top. The foot of the white flanks is in shadow, "
        "which is widest where the valleys are narrow; white beside bright red is tinged with it."
    ),
    source="HeidrichDaubertKautzSeidel2000",
    techniques=("G18", "G19"),
    panels=("concave: valleys narrow", "flat", "convex: valleys widen"),
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

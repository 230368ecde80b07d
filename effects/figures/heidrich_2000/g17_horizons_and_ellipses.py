"""G17: five ways to tell the shadows of bumps."""

from itertools import combinations

import numpy as np

from fixedpipe.effects.acceptance import bump_shadows, seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import stones
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import (
    ellipse_passes,
    ellipses,
    horizon_maps,
    visibility,
    visibility_shadows,
)
from fixedpipe.effects.scattering.height_field import ridges
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "G17")

_BLACK = (0.0, 0.0, 0.0)
_NAMES = ("rays", "nearest direction", "three directions", "ellipses", "horizons")
_PARAMETERS = {
    **stones.PARAMETERS,
    "stones": word.EVEN(4, "Stones along an edge."),
    "buried": word.NUMBER(
        0.38,
        "How deep the stones' middles lie in the ground, of a stone's share of an edge.",
        low=0.0,
        high=0.6,
    ),
    "height": word.NUMBER(1.7, "How high the stones are, of balls.", low=0.05, high=3.0),
    # Between three of the hundred directions, 13 degrees from the nearest.
    "light": word.LIGHT((-0.54, 0.70, 0.46)),
    "directions": word.of(
        word.Whole(8, 1000), 100, "Directions over the whole sphere along which rays are cast."
    ),
}


def _by_the_host(bed, p):
    """What texels send with shadows by rays, by the nearest direction, between three: three RGB arrays."""
    near = visibility_shadows.nearest_free(bed.visibility, p["light"])
    between = visibility_shadows.free_share(bed.visibility, p["light"])
    return stones.by_rays(bed, p), stones.with_shadows(bed, p, near), stones.with_shadows(bed, p, between)


def scene(profile, size, **p):
    """Three ways by the host, as textures; two by register combiners, G15 and G17."""
    bed, surface, light = stones.bed_of(size, p), surfaces.plane(), Light(p["light"])
    horizons = horizon_maps.horizon_map(bed.field)
    colors = factor_texels(bed.colors, profile)
    *host, elliptic, horizontal = map(orthographic_view, row_of_panels(len(_NAMES), size))
    out = [
        TexImage(label="load the colours", texture="colours", image=texture_2d(colors)),
        *stones.load(bed, profile),
        *horizon_maps.load(horizons, profile),
    ]
    for name, view, values in zip(_NAMES, host, _by_the_host(bed, p), strict=False):
        image = texture_2d(factor_texels(values, profile))
        units = (unit(name, environment=REPLACE),)
        shown = draw(f"show the light by {name}", surface.mesh(), view, None, units, depth_test=FIRST_PASS)
        load = TexImage(label=f"load the light by {name}", texture=name, image=image)
        out += (load, view.panel.clear(_BLACK), shown)
    settings = {"normal_map": "normals", "color_map": "colours", "color": p["color"], "ambient": p["ambient"]}
    toward = unit_vector(p["light"], "The light's direction")
    for view, mark in (
        (elliptic, ellipse_passes.marking_pass(surface, bed.forms, elliptic, light, profile)),
        (horizontal, horizon_maps.marking_pass(surface, horizons, horizontal, toward)),
    ):
        out.append(view.panel.clear(_BLACK))
        out += ellipse_passes.light_where_marked(surface, view, light, profile, mark, **settings)
    return tuple(out)


def reference(size, **p):
    """Every panel by rays, interpolated between texels like a texture."""
    picture = stones.sampled(stones.by_rays(stones.bed_of(size, p), p), size)[::-1]
    out = np.ones((size, len(_NAMES) * size, 4))
    out[..., :3] = np.clip(np.tile(picture, (1, len(_NAMES), 1)), 0.0, 1.0)
    return out


def _three_around(directions, vector):
    """The numbers of the three directions between which a vector lies and no other does, and its weights."""
    for three in combinations(np.argsort(-(directions @ vector))[:8].tolist(), 3):
        corners = directions[list(three)]
        weights = np.linalg.solve(corners.T, vector)
        # The plane through the three has all others behind it.
        if weights.min() >= 0.0 and (directions @ np.linalg.solve(corners, np.ones(3))).max() <= 1.0 + 1e-9:
            return three, weights / weights.sum()
    raise ValueError(f"No three directions have {vector} between them.")


def _third_panel_check(figure, renderer):
    """The displayed third panel against shadows by rays along three directions, as weak as their weights."""
    p, size = figure.values_of(renderer.method), figure.size
    bed = stones.bed_of(size, p)
    directions = bed.visibility.directions
    three, weights = _three_around(directions, unit_vector(p["light"], "The light's direction"))
    lit, counted = np.zeros(bed.field.heights.shape), np.zeros(bed.field.heights.shape)
    for number, weight in zip(three, weights, strict=True):
        # A texel that is turned away from a direction learns nothing of it.
        faces = dot(bed.field.normals, directions[number]) > 0.0
        lit += weight * (faces & visibility.free_view(bed.field, directions[number]))
        counted += weight * faces
    share = np.where(counted > 0.0, lit / np.where(counted > 0.0, counted, 1.0), 1.0)
    picture = stones.sampled(stones.with_shadows(bed, p, share), size)
    whole = np.ones((size, size), np.bool_)
    for on, alike in seen_places.shares_alike(figure, renderer, {2: (whole, picture[whole])}):
        yield DATA.check(
            "three directions: pixels with the light of rays along them by weight, within 8/255", alike, on
        )


def checks(figure, renderer):
    """Each way against rays, on grooves under many lights and in the picture."""
    yield from _third_panel_check(figure, renderer)
    groove = ridges(32, 32)
    found = bump_shadows.agreement(groove, bump_shadows.ways(groove, figure.values["directions"]))
    for name, share in found.items():
        yield DATA.check(
            "texels of a V-groove that {name} light as rays do, mean of 32 lights",
            share,
            Answer.IDEAL,
            name=name,
        )
    size, changes = 128, {"color": (1.0, 1.0, 1.0), "ambient": _BLACK, "texels": 128}
    p = {**figure.values_of(renderer.method), **changes}
    bed, vector = stones.bed_of(size, p), unit_vector(p["light"], "The light's direction")
    facing = np.maximum(dot(bed.field.normals, vector), 0.0)
    plain = stones.sampled(bed.colors * facing[..., None], size).max(axis=-1)
    clear = plain > stones.CLEARLY_LIT
    test = ellipses.tested(*(stones.sampled(form, size) for form in bed.forms), *vector[:2])
    nearest = bed.visibility.directions[sphere.nearest(bed.visibility.directions, vector)]
    for on in Answer:
        window = renderer.window(on, figure, size, **changes)
        lit = [panel_of(window, k).max(axis=-1) > 0.5 * plain for k in range(len(_NAMES))]
        for name, way, bound in zip(_NAMES[1:], lit[1:], (0.74, 0.91, 0.84, 0.94), strict=True):
            yield DATA.check(
                "pixels that {name} light as rays do",
                float((way == lit[0])[clear].mean()),
                on,
                at_least=bound,
                name=name,
            )
        told = clear & (np.abs(test) > (0.15 if on is Answer.MACHINE else 1e-3))
        yield DATA.check(
            "pixels that ellipses light where Eq. 4 says so, away from the ellipses' edges",
            float((lit[3] == (test >= 0.0))[told].mean()),
            on,
        )
        other = stones.sampled(visibility.free_view(bed.field, nearest).astype(float), size) > 0.5
        yield DATA.check(
            "pixels that the nearest direction lights as rays along it do",
            float((lit[1] == other)[clear].mean()),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    panels=_NAMES,
    size=384,
    parameters=_PARAMETERS,
    methods=(Method("host and register combiners", scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)

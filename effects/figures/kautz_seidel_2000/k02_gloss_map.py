"""K02: a gloss map next to a constant k_s."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import POWER_8, arithmetic_check
from fixedpipe.effects.bump_mapping import gloss_map
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import BACKGROUND, Light, Panel, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import material_textures

DATA = figure_data(__file__, "K02")


def _checkered_gloss(size, cells, dull, polished):
    cell = np.arange(size) * cells // size
    return np.where((cell[:, None] + cell[None, :]) % 2 == 0, polished, dull)


def scene(
    profile, size, *, cells, depth, dull, polished, light, diffuse, ambient, background, height_field,
    height_scale, photograph,
):  # fmt: skip
    """K02: a bumpy sphere with the same exponent everywhere; left k_s = 1, right k_s from a checkered gloss
    map.
    """
    surface, out = surfaces.sphere().with_repeats(4, 2), []
    if height_field is None:
        slope_s, slope_t = height_fields.pebble_slopes(256, cells, depth)
    else:
        slope_s, slope_t = height_field.slopes(256, height_scale, repeated=True)
    gloss = {"constant": 1.0, "checkered": _checkered_gloss(256, 4, dull, polished)}
    if photograph is not None:
        gloss["checkered"] = dull + (polished - dull) * photograph.brightness(256, 256, repeated=True)
    for panel, (name, k_s) in zip(row_of_panels(2, size), gloss.items(), strict=True):
        material = material_textures.from_slopes(slope_s, slope_t, 1.0, 1.0, k_s)
        view = orthographic_view(panel, half_height=1.1)
        loading, names = material_textures.load(material, f"{name} gloss", profile)
        passes = gloss_map.commands(
            surface, names.normal, view, Light(light), profile, color=diffuse, ambient=ambient
        )
        out += (panel.clear(background), loading[0], *passes)
    return tuple(out)


def _by_pixels(size, p):
    """Both spheres in float64, by rays: of each which pixels show it, and their colours."""
    view = orthographic_view(Panel(0, 0, size, size), half_height=1.1)
    seen = seen_places.surface(surfaces.sphere().with_repeats(4, 2), view)
    toward = seen_places.unit(np.array(p["light"]))
    half = seen_places.unit(toward + np.array([0.0, 0.0, 1.0]))
    normals, _, _ = height_fields.frames(*height_fields.pebble_slopes(256, p["cells"], p["depth"]))
    found = seen_places.looked_up(normals, seen)
    cosine, power = ((found * (seen.frames @ vector)).sum(axis=-1) for vector in (toward, half))
    # The highlight ends where the sphere itself turns away from the light.
    highlight = np.clip(8.0 * (seen.frames[:, 2] @ toward), 0.0, 1.0) * np.maximum(power, 0.0) ** 8
    lit = np.maximum(cosine, 0.0)[:, None] * np.array(p["diffuse"]) + np.array(p["ambient"])
    for gloss in (np.ones((256, 256)), _checkered_gloss(256, 4, p["dull"], p["polished"])):
        yield seen.where, lit + (seen_places.looked_up(gloss, seen) * highlight)[:, None]


def checks(figure, renderer):
    """Both spheres by rays; the highlight under the gloss map is the plain one times k_s."""
    true = dict(enumerate(_by_pixels(figure.size, figure.values)))
    size = 256
    parameters = figure.values
    image = renderer.ideal_window(figure, size, **DARK)[..., 0]
    plain, glossy = image[:, :size], image[:, size:]
    ratio = glossy[plain > 0.05] / plain[plain > 0.05]
    return (
        *(
            DATA.check(
                "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
            )
            for on, share in seen_places.shares_alike(figure, renderer, true)
        ),
        DATA.check(
            "smallest ratio of highlights - k_s of dull checks",
            abs(ratio.min() - parameters["dull"]),
            Answer.IDEAL,
        ),
        DATA.check(
            "largest ratio of highlights - k_s of polished checks",
            abs(ratio.max() - parameters["polished"]),
            Answer.IDEAL,
        ),
        arithmetic_check(figure, renderer, 0.0075, POWER_8),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "cells": word.EVEN(
            12, "Pebbles along an edge of the texture, which comes four times around the sphere."
        ),
        "depth": word.SLOPE(0.25, "The pebbles' height over half balls."),
        "dull": word.SHARE(
            0.1, "The highlight's strength in one kind of the gloss map's squares.", word.FULL
        ),
        "polished": word.SHARE(1.0, "The highlight's strength in the other.", word.FULL),
        "light": word.LIGHT((0.6, 0.5, 0.5)),
        "diffuse": word.DIFFUSE((0.12, 0.22, 0.24)),
        "ambient": word.AMBIENT((0.02, 0.03, 0.04)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles"),
        "height_scale": own_maps.HEIGHT_SCALE(0.05),
        "photograph": own_maps.photograph(
            "the gloss map's squares, its brightness from the one strength to the other"
        ),
    },
    methods=(Method("register combiners", scene, COMBINER_MACHINES),),
    acceptance=checks,
)

"""F004-6: a marble sphere with elevated veins."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, IMAGING_MACHINES_8, Figure, Method
from fixedpipe.effects.figures.kautz_seidel_2000.shared.brushed_sphere import leaning_seen
from fixedpipe.effects.figures.kautz_seidel_2000.shared.own_marble import OWN, marble
from fixedpipe.effects.geometry.views import BACKGROUND, Light
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, imaging_subset, material_textures
from fixedpipe.effects.scenes.marble import MAP_SIZE, MARBLE
from fixedpipe.effects.scenes.spheres import leaning_sphere

DATA = figure_data(__file__, "F004-6")

# The method that draws flat triangles.
FLAT = "imaging subset"


def _ball(size, map_size, repeats, lean, slices, stacks, radius, **veins):
    """The panel, the view, the sphere and the marble."""
    sphere = leaning_sphere(size, slices=slices, stacks=stacks, repeats=repeats, lean=lean, radius=radius)
    return *sphere, marble(map_size, **veins)


_COLORS = "colour map of marble"


def scene(profile, size, *, light, diffuse, ambient, specular, background, **ball):
    """F004-6: a diffuse pass with the marble's colours, then Eq. 1 with alpha_y larger in the dark parts."""
    panel, view, surface, stone = _ball(size, **ball)
    loading, names = material_textures.load(stone.material, "marble", profile)
    toward = Light(light)
    return (
        panel.clear(background),
        *loading,
        material_textures.load_colors(stone.colors, _COLORS, profile),
        *diffuse_bump.diffuse_pass(
            surface, names.normal, view, toward, profile, color=diffuse, ambient=ambient, color_map=_COLORS
        ),
        *anisotropic_blinn_phong.specular_pass(surface, names, view, toward, profile, specular=specular),
    )


def imaging_scene(profile, size, *, light, diffuse, ambient, specular, background, **ball):
    """The same with the imaging subset (K08), flat triangles."""
    panel, view, surface, stone = _ball(size, **ball)
    return (
        panel.clear(background),
        material_textures.load_colors(stone.colors, _COLORS, profile),
        *imaging_subset.commands(
            surface,
            stone.material,
            view,
            Light(light),
            profile,
            color=diffuse,
            ambient=ambient,
            color_map=_COLORS,
            specular=specular,
            name="marble",
        ),
    )


_OF_MARBLE = ("cells", "width", "relief", "alpha_x", "alpha_y", "k_s", "light_color", "dark_color")


@computed_once
def _by_pixels(values, size, flat):
    """The sphere's ``material_reference.pictures``."""
    stone = material_textures.marble(values["map_size"], **{name: values[name] for name in _OF_MARBLE})
    seen = leaning_seen(values, size, flat)
    return material_reference.pictures(
        material_reference.fields(stone.material),
        seen,
        values,
        color=seen_places.looked_up(stone.colors, seen),
        squared_first=flat,
    )


def _checks_by_pixels(figure, renderer):
    """The displayed sphere against Eq. 1 at every pixel, and what each field does to it."""
    size, flat, values = figure.size, renderer.method.name == FLAT, dict(figure.values)
    where, found = leaning_seen(values, size, flat).where, {0: _by_pixels(values, size, flat)}
    return material_reference.checks(DATA, figure, renderer, where, found)


def darkness(figure, renderer, size):
    """How dark each pixel's stone is: float64 [size, size], 1 in the veins, NaN off the sphere.

    From the ideal's picture of the colour map alone: black veins in white stone, ambient light only.
    """
    image = renderer.ideal_window(
        figure,
        size,
        **{**DARK, "ambient": (1.0, 1.0, 1.0), "specular": (0.0, 0.0, 0.0)},
        light_color=(1.0, 1.0, 1.0),
        dark_color=(0.1, 0.1, 0.1),
    )[..., 0]
    return np.where(image > 0.05, (1.0 - image) / 0.9, np.nan)


def checks(figure, renderer):
    """The highlight's areas in dark and in light stone, the veins' relief, and the arithmetic."""
    yield from _checks_by_pixels(figure, renderer)
    size = 256
    shade = darkness(figure, renderer, size)
    dark, light, edges = shade > 0.5, shade < 0.35, (shade > 0.35) & (shade < 0.85)
    for on in Answer:
        for what, changes in (("", {}), (", veins made flat", {"relief": 0.0})):
            bright = (
                renderer.window(on, figure, size, **DARK, **{"specular": (1.0, 1.0, 1.0), **changes})[..., 0]
                > 0.5
            )
            yield DATA.check(
                "area of the highlight, share of the dark stone / share of the light{what}",
                float(bright[dark].mean() / bright[light].mean()),
                on,
                what=what,
            )
    white = {
        **DARK,
        "diffuse": (1.0, 1.0, 1.0),
        "specular": (0.0, 0.0, 0.0),
        "light_color": (1.0, 1.0, 1.0),
        "dark_color": (1.0, 1.0, 1.0),
    }
    for on in Answer:
        raised, level = (
            renderer.window(on, figure, size, **white, **c)[..., 0] for c in ({}, {"relief": 0.0})
        )
        change = raised - level
        yield DATA.check(
            "RMS of the change of (n.l)+ by the veins' relief, at their edges / in the light stone",
            root_mean_square(change[edges]) / root_mean_square(change[shade < 0.1]),
            on,
        )
        yield DATA.check(
            "RMS of the change of (n.l)+ by the veins' relief, at their edges",
            root_mean_square(change[edges]),
            on,
        )
    error = renderer.machine_window(figure, size) - np.clip(renderer.ideal_window(figure, size), 0.0, 1.0)
    yield DATA.check(
        "RMS of machine - ideal on the sphere", root_mean_square(error[~np.isnan(shade)]), Answer.MACHINE
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "map_size": word.TEXELS(MAP_SIZE),
        "repeats": word.REPEATS((4, 2)),
        "cells": word.COUNT(MARBLE["cells"], "Veins across an edge of the texture, about."),
        "width": word.NUMBER(
            MARBLE["width"], "The veins' width from their middle.", "texels", low=0.0, high=64.0
        ),
        "relief": word.NUMBER(MARBLE["relief"], "How high the veins stand.", "texels", low=0.0, high=16.0),
        "alpha_x": word.ALPHA_X(MARBLE["alpha_x"]),
        "alpha_y": word.of(
            word.Several((word.ALPHA_KIND,) * 2, "two numbers from 0.05 to 1"),
            MARBLE["alpha_y"],
            "The highlight's width along the binormals in the light stone, then in the veins.",
        ),
        "k_s": word.SHARE(MARBLE["k_s"], "The strength of the highlights.", word.FULL),
        "light_color": word.COLOR(MARBLE["light_color"], "The colour of the stone."),
        "dark_color": word.COLOR(MARBLE["dark_color"], "The colour of the veins."),
        "lean": word.LEAN(-25.0),
        "light": word.LIGHT((-0.5, 0.5, 0.72)),
        "slices": word.SLICES(50),
        "stacks": word.STACKS(26),
        "radius": word.RADIUS(0.92),
        "diffuse": word.DIFFUSE((0.62, 0.62, 0.62)),
        "ambient": word.AMBIENT((0.07, 0.075, 0.085)),
        "specular": word.SPECULAR((0.60, 0.60, 0.58)),
        "background": word.BACKDROP(BACKGROUND),
        **OWN,
    },
    methods=(
        Method("register combiners", scene, COMBINER_MACHINES),
        Method(FLAT, imaging_scene, IMAGING_MACHINES_8),
    ),
    acceptance=checks,
)

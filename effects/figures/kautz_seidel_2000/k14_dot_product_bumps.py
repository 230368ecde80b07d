"""K14: dot-product bump mapping of a pebbled torus."""

import math

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import POWER_8, arithmetic_check
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import BACKGROUND, Light, Panel, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import material_textures

DATA = figure_data(__file__, "K14")


def scene(
    profile, size, *, cells, depth, tilt, light, diffuse, ambient, background, height_field, height_scale
):
    """K14: a pebbled torus under a white light."""
    (panel,) = row_of_panels(1, size)
    surface = surfaces.torus(96, 48).with_repeats(5, 2).rotated(rotation("x", tilt))
    if height_field is None:
        slopes = height_fields.pebble_slopes(256, cells, depth)
    else:
        slopes = height_field.slopes(256, height_scale, repeated=True)
    material = material_textures.from_slopes(*slopes, 1.0, 1.0)
    view = orthographic_view(panel, half_height=1.1)
    loading, names = material_textures.load(material, "pebbles", profile)
    return (
        panel.clear(background),
        loading[0],  # the normal map; the other two material textures are not read
        *diffuse_bump.commands(
            surface, names.normal, view, Light(light), profile, color=diffuse, ambient=ambient
        ),
    )


def _by_pixels(size, p):
    """The torus in float64, by rays: which pixels show it, bool [size, size], and their colours, [n, 3]."""
    torus = surfaces.torus(96, 48).with_repeats(5, 2).rotated(rotation("x", p["tilt"]))
    seen = seen_places.surface(torus, orthographic_view(Panel(0, 0, size, size), half_height=1.1))
    toward = seen_places.unit(np.array(p["light"]))
    half = seen_places.unit(toward + np.array([0.0, 0.0, 1.0]))
    normals, _, _ = height_fields.frames(*height_fields.pebble_slopes(256, p["cells"], p["depth"]))
    found = seen_places.looked_up(normals, seen)
    cosine, power = ((found * (seen.frames @ vector)).sum(axis=-1) for vector in (toward, half))
    highlight = np.clip(4.0 * cosine, 0.0, 1.0) * np.maximum(power, 0.0) ** 8
    lit = np.maximum(cosine, 0.0)[:, None] * np.array(p["diffuse"]) + np.array(p["ambient"])
    return seen.where, lit + highlight[:, None]


def longest_row(mask):
    """The greatest number of true pixels side by side in one row of a bool image [h, w]."""
    beyond = np.pad(~mask, ((0, 0), (1, 1)), constant_values=True)
    return max(int(np.diff(np.flatnonzero(row)).max()) - 1 for row in beyond)


def checks(figure, renderer):
    """The torus pixel by pixel and against the ideal; that every pebble has its own highlight."""
    size = figure.size // 2
    image = renderer.machine_window(figure, size)
    # Five beds of pebbles lie round the circle of tube centres, of radius 0.7; 2.2 units fill the picture.
    pebble = 2.0 * math.pi * 0.7 / (5 * figure.values["cells"]) * size / 2.2
    true = {0: _by_pixels(figure.size, figure.values)}
    return (
        *(
            DATA.check(
                "pixels that show what a ray finds there within 8/255, the least of the panels",
                share,
                on,
            )
            for on, share in seen_places.shares_alike(figure, renderer, true)
        ),
        DATA.check(
            "longest row of pixels brighter than 0.7, in widths of a pebble",
            longest_row(image.mean(axis=-1) > 0.7) / pebble,
            Answer.MACHINE,
        ),
        arithmetic_check(figure, renderer, 0.0083, POWER_8),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "cells": word.EVEN(
            6, "Pebbles along an edge of the texture, which comes five times around the torus."
        ),
        "depth": word.SLOPE(0.8, "The pebbles' height over half balls."),
        "tilt": word.DEGREES(50.0, "How far the torus's axis leans towards the viewer."),
        "light": word.LIGHT((0.6, 0.6, 0.5)),
        "diffuse": word.DIFFUSE((0.42, 0.28, 0.17)),
        "ambient": word.AMBIENT((0.04, 0.03, 0.03)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles"),
        "height_scale": own_maps.HEIGHT_SCALE(0.08),
    },
    methods=(Method("register combiners", scene, COMBINER_MACHINES),),
    acceptance=checks,
)

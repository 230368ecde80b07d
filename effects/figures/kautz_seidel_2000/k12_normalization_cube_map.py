"""K12: vectors from the normalization cube map, next to vectors as vertex colours."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump, normalization_cube_map
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, brdfs, material_textures

DATA = figure_data(__file__, "K12")


def _pebbles(cells, depth, alpha_x, alpha_y, height_field, height_scale):
    """The square's material: pebbles, or a height field in their place."""
    if height_field is None:
        slopes = height_fields.pebble_slopes(256, cells, depth)
    else:
        slopes = height_field.slopes(256, height_scale, repeated=False)
    return material_textures.from_slopes(*slopes, alpha_x, alpha_y, 0.8)


def scene(profile, size, *, cube_map_size, light, diffuse, ambient, specular, background, **pebbles):
    """K12: a single square under a close light; left vectors as vertex colours, right from the cube map."""
    left, right = row_of_panels(2, size)
    surface = surfaces.plane()
    near = Light(light, point=True)
    loading, names = material_textures.load(_pebbles(**pebbles), "pebbles", profile)
    views = [orthographic_view(panel, half_height=1.06) for panel in (left, right)]
    # The vector to a point light, and twice the halfway vector's direction, at full length.
    to_light = surface.to_local(np.array(light) - surface.positions)
    toward_viewer = surface.to_local(views[1].view_vectors(surface.positions))
    halfway = normalize(to_light) + toward_viewer
    return (
        left.clear(background),
        right.clear(background),
        *loading,
        *diffuse_bump.diffuse_pass(
            surface, names.normal, views[0], near, profile, color=diffuse, ambient=ambient
        ),
        *anisotropic_blinn_phong.specular_pass(surface, names, views[0], near, profile, specular=specular),
        normalization_cube_map.load(cube_map_size, profile),
        *normalization_cube_map.commands(
            surface, to_light, halfway, names, views[1], color=diffuse, specular=specular, ambient=ambient
        ),
    )


def checks(figure, renderer):
    """A flat square under a close light: the cube map gives (n.l)+, the vertex colours far less in the
    middle.
    """
    size = 256
    changes = {
        **DARK,
        "depth": 0.0,
        "specular": (0.0, 0.0, 0.0),
        "diffuse": (1.0, 1.0, 1.0),
    }
    x, y = pixel_grid(size, 1.0 / 1.06)
    inside = np.maximum(np.abs(x), np.abs(y)) < 0.98
    to_light = normalize(np.array(figure.values["light"]) - np.stack([x, y, np.zeros_like(x)], axis=-1))
    true = brdfs.lambert(np.array([0.0, 0.0, 1.0]), to_light)
    for on in Answer:
        image = renderer.window(on, figure, size, **changes)[..., 0]
        error = (image[:, size:] - true)[inside]
        yield DATA.check("RMS of (n.l)+ with the cube map - Lambert's law", root_mean_square(error), on)
        yield DATA.check(
            "(n.l)+ below the light with vertex colours, of a true value of one",
            float(image[size // 2, size // 2]),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "cube_map_size": word.TEXELS(64, "The edge of the cube map's faces."),
        "light": word.POSITION(
            (0.0, 0.0, 0.7), "Where the light is: the square reaches from -1 to 1 in x and y, at z = 0."
        ),
        "cells": word.EVEN(10, "Pebbles along an edge of the square."),
        "depth": word.SLOPE(0.15, "The pebbles' height over half balls."),
        "alpha_x": word.ALPHA_X(0.4),
        "alpha_y": word.ALPHA_Y(0.4),
        "diffuse": word.DIFFUSE((0.55, 0.42, 0.28)),
        "ambient": word.AMBIENT((0.03, 0.03, 0.03)),
        "specular": word.SPECULAR((0.5, 0.5, 0.5)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(0.02),
    },
    methods=(Method("register combiners", scene, COMBINER_MACHINES),),
    acceptance=checks,
)

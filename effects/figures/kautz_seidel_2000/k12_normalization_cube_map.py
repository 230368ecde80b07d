"""K12: vectors from the normalization cube map, next to vectors as vertex colours."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump, normalization_cube_map
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
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


def _in_float(values, seen, normalized):
    """A panel's pixels in float64, then without each of the material's fields: [1 + fields, n, 3].

    ``normalized``: both vectors have length one at each pixel. Otherwise they are the corners', which are as
    high as each other under a light above the middle, and go straight between them.
    """
    xy = np.stack([2.0 * seen.s - 1.0, 2.0 * seen.t - 1.0], axis=-1)
    near, viewer = np.array(values["light"]), np.array([0.0, 0.0, 1.0])

    def straight(corner):
        return np.concatenate([xy * corner[:2], np.full((len(xy), 1), corner[2])], axis=-1)

    at_corner = seen_places.unit(near - np.array([1.0, 1.0, 0.0]))
    lamp, half = straight(at_corner), straight(seen_places.unit(at_corner + viewer))
    if normalized:
        lamp, half = seen_places.unit(near - straight(np.array([1.0, 1.0, 0.0]))), seen_places.unit(half)

    def picture(fields):
        n, t, b = (seen_places.looked_up(fields[name], seen) for name in ("normals", "tangents", "binormals"))
        cosine = (n * lamp).sum(axis=-1)
        squares = (t[:, :3] * half).sum(axis=-1) ** 2 + (b * half).sum(axis=-1) ** 2
        shine = t[:, 3] * np.maximum(1.0 - squares, 0.0) * np.clip(4.0 * cosine, 0.0, 1.0)
        parts = np.maximum(cosine, 0.0), shine
        diffuse, specular = (
            part[:, None] * np.array(values[k])
            for part, k in zip(parts, ("diffuse", "specular"), strict=True)
        )
        return np.clip(diffuse + np.array(values["ambient"]) + specular, 0.0, 1.0)

    pebbles = ("cells", "depth", "alpha_x", "alpha_y", "height_field", "height_scale")
    fields = material_reference.fields(_pebbles(*(values[name] for name in pebbles)))
    flat = {name: np.broadcast_to(field.mean(axis=(0, 1)), field.shape) for name, field in fields.items()}
    return np.stack([picture(fields), *(picture({**fields, name: flat[name]}) for name in fields)])


def _displayed_checks(figure, renderer):
    """Both displayed squares beside those without a field, and beside the other one."""
    seen = seen_places.square(figure.size, 1.0 / 1.06)
    found = [_in_float(figure.values, seen, normalized) for normalized in (False, True)]
    found = [(*one, other[0]) for one, other in (found, found[::-1])]
    for on in Answer:
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        panels = [panel_of(window, k)[seen.where] for k in (0, 1)]
        yield DATA.check(
            "of what pebbles and the vectors' length change, the least share that is seen",
            min(
                material_reference.least_share(*pair)
                for pair in ((panel, *of) for panel, of in zip(panels, found, strict=True))
            ),
            on,
        )


def checks(figure, renderer):
    """A flat square under a close light: the cube map gives (n.l)+, the vertex colours far less in the
    middle.
    """
    yield from _displayed_checks(figure, renderer)
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

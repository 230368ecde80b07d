"""F003-1: a sphere of bricks without and with bump mapping."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import (
    BRICK_COLORS,
    BRICK_NORMALS,
    FLAT,
    load_wall,
    silhouette_check,
    slices,
    texels,
)
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels

DATA = figure_data(__file__, "F003-1")

ACROSS, COURSES = 5, 10


def scene(profile, size, *, tilt, turn, light, diffuse, ambient, background, shown, **of_wall):
    """F003-1: the same sphere, colour map and light twice; ``shown``: the normal map of each."""
    n = slices(size)
    surface = surfaces.sphere(n, n // 2).with_repeats(2, 1)
    surface = surface.rotated(rotation("y", turn)).rotated(rotation("x", tilt))
    colors = {"color": diffuse, "ambient": ambient, "color_map": BRICK_COLORS, "self_shadow": True}
    out = load_wall(profile, texels(size), ACROSS, COURSES, **of_wall)
    for panel, normal_map in zip(row_of_panels(2, size), shown, strict=True):
        view = orthographic_view(panel, half_height=1.1)
        out.append(panel.clear(background))
        out += diffuse_bump.diffuse_pass(surface, normal_map, view, Light(light), profile, **colors)
    return tuple(out)


def checks(figure, renderer):
    """That the bumps change the shading and not the silhouette."""
    size = 192
    image = renderer.machine_window(figure, size)
    smooth, bumped = (panel_of(image, k).mean(axis=-1) for k in (0, 1))
    seen = np.abs(smooth - bumped)[size // 4 : -size // 4, size // 4 : -size // 4]
    return (
        *silhouette_check(figure, renderer, 128, {"shown": (FLAT, FLAT)}, {"shown": (BRICK_NORMALS, FLAT)}),
        DATA.check(
            "share of the middle's pixels that the bumps change by more than 0.05",
            float((seen > 0.05).mean()),
            Answer.MACHINE,
        ),
        DATA.check(
            "mean brightness with bumps over that without",
            float(bumped.mean() / smooth.mean()),
            Answer.MACHINE,
        ),
        arithmetic_check(figure, renderer, 0.0029, "8-bit normals and vectors; a third of slack"),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "relief": word.RELIEF(1.6),
        "tilt": word.DEGREES(0.0, "How far the sphere's upper pole leans towards the viewer."),
        "turn": word.DEGREES(20.0, "How far the sphere is turned about its axis."),
        "light": word.LIGHT((-0.62, 0.55, 0.56)),
        "diffuse": word.DIFFUSE(
            (1.0, 1.0, 1.0), "The colour of the light, which the bricks' colours multiply."
        ),
        "ambient": word.AMBIENT((0.10, 0.10, 0.11)),
        "background": word.BACKDROP(BACKGROUND),
        "shown": word.of(
            word.Several((word.Choice({"flat": FLAT, "bricks": BRICK_NORMALS}),) * 2),
            (FLAT, BRICK_NORMALS),
            "The normal map of each panel.",
        ),
        "height_field": own_maps.height_field("the bricks' relief"),
        "height_scale": own_maps.HEIGHT_SCALE(0.05),
        "photograph": own_maps.photograph("the bricks' colours"),
    },
    methods=(Method("register combiners", scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),),
    acceptance=checks,
)

"""F003-1: a sphere of bricks without and with bump mapping."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
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
    map_normals,
    silhouette_check,
    slices,
    texels,
)
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    Panel,
    orthographic_view,
    panel_of,
    row_of_panels,
)
from fixedpipe.effects.scenes import brick_wall

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


def _by_pixels(size, p):
    """Both spheres in float64, by rays: of each which pixels show it, and their colours."""
    n, edge = slices(size), texels(size)
    sphere = surfaces.sphere(n, n // 2).with_repeats(2, 1).rotated(rotation("y", p["turn"]))
    view = orthographic_view(Panel(0, 0, size, size), half_height=1.1)
    seen = seen_places.surface(sphere.rotated(rotation("x", p["tilt"])), view)
    toward = seen.frames @ seen_places.unit(np.array(p["light"]))
    painted = seen_places.looked_up(brick_wall.colors(edge, ACROSS, COURSES), seen)
    bricks = map_normals(p["relief"] * brick_wall.heights(edge, ACROSS, COURSES))
    for normals in (np.array([0.0, 0.0, 1.0]), seen_places.looked_up(bricks, seen)):
        # No light beyond the sphere's own terminator, and none that begins there at once.
        lit = np.maximum((normals * toward).sum(axis=-1), 0.0) * np.clip(8.0 * toward[:, 2], 0.0, 1.0)
        yield seen.where, painted * (lit[:, None] * np.array(p["diffuse"]) + np.array(p["ambient"]))


def checks(figure, renderer):
    """The spheres pixel by pixel; that the bumps change the shading and not the silhouette."""
    size = 192
    image = renderer.machine_window(figure, size)
    smooth, bumped = (panel_of(image, k).mean(axis=-1) for k in (0, 1))
    seen = np.abs(smooth - bumped)[size // 4 : -size // 4, size // 4 : -size // 4]
    true = dict(enumerate(_by_pixels(figure.size, figure.values)))
    return (
        *(
            DATA.check(
                "pixels that show what a ray finds there within 8/255, the least of the panels",
                share,
                on,
            )
            for on, share in seen_places.shares_alike(figure, renderer, true)
        ),
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
    # Turned so that no upright joint lies on the outline: the outermost pixel would hold the whole of it, or
    # nothing, from row to row.
    parameters={
        "relief": word.RELIEF(1.6),
        "tilt": word.DEGREES(0.0, "How far the sphere's upper pole leans towards the viewer."),
        "turn": word.DEGREES(29.0, "How far the sphere is turned about its axis."),
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

"""F003-2: a plane without and with bump mapping, and the bump texture."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check, root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import (
    BRICK_COLORS,
    BRICK_NORMALS,
    FLAT,
    angles,
    load_wall,
    map_normals,
    recovered_normals,
    silhouette_check,
    texel_combiners,
    texels,
)
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    Panel,
    orthographic_view,
    panel_of,
    perspective_view,
    row_of_panels,
)
from fixedpipe.effects.passes.draws import draw, unit
from fixedpipe.effects.scenes import brick_wall

DATA = figure_data(__file__, "F003-2")

ACROSS, COURSES = 4, 8
# Three lights 25 degrees off the plane's normal: every normal that leans by less than 65 degrees sees them.
LIGHTS = normalize(np.array([(0.4663, 0.0, 1.0), (-0.2332, 0.4038, 1.0), (-0.2332, -0.4038, 1.0)]))


def scene(profile, size, *, light, diffuse, ambient, background, painted, frontal, maps, shown, **of_wall):
    """F003-2: a wall, flat and with bumps, and its normal map.

    ``frontal``: seen straight on and filling its panel. ``maps``: the maps' edge, None: fit for the panel.
    ``painted``: times the bricks' colours. ``shown``: the first two panels' normal maps.
    """
    edge = 2 * texels(size) if maps is None else maps
    surface = surfaces.plane(8, 8)
    out = load_wall(profile, edge, ACROSS, COURSES, repeated=False, **of_wall)
    colors = {"color": diffuse, "ambient": ambient, "color_map": BRICK_COLORS if painted else None}
    for number, panel in enumerate(row_of_panels(3, size)):
        straight = orthographic_view(panel, half_height=1.0 if frontal or number < 2 else 1.06)
        view = (
            straight
            if frontal or number == 2
            else perspective_view(panel, (-1.25, 0.55, 2.9), field_of_view=42.0)
        )
        out.append(panel.clear(background))
        if number < 2:
            out += diffuse_bump.diffuse_pass(surface, shown[number], view, Light(light), profile, **colors)
        else:
            shows = (unit(BRICK_NORMALS),)
            out.append(
                draw("the bump texture", surface.mesh(), view, texel_combiners(), shows, depth_test=None)
            )
    return tuple(out)


def _by_pixels(size, p):
    """The three panels in float64, by rays: of each which pixels show the wall, and their colours."""
    edge, panel, wall = 2 * texels(size), Panel(0, 0, size, size), surfaces.plane(8, 8)
    seen = seen_places.surface(wall, perspective_view(panel, (-1.25, 0.55, 2.9), field_of_view=42.0))
    toward = seen.frames @ normalize(np.array(p["light"]))
    painted = seen_places.looked_up(brick_wall.colors(edge, ACROSS, COURSES), seen)
    bricks = map_normals(p["relief"] * brick_wall.heights(edge, ACROSS, COURSES))
    for normals in (np.array([0.0, 0.0, 1.0]), seen_places.looked_up(bricks, seen)):
        lit = np.maximum((normals * toward).sum(axis=-1), 0.0)[:, None] * np.array(p["diffuse"])
        yield seen.where, painted * (lit + np.array(p["ambient"]))
    seen = seen_places.surface(wall, orthographic_view(panel, half_height=1.06))
    yield seen.where, 0.5 + 0.5 * seen_places.looked_up(bricks, seen)


def _measured(figure, renderer, on, size, panel):
    """Normals that the pictures of a panel under three lights show: float64 [size, size, 3]."""
    white, black = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
    changes = {"painted": False, "frontal": True, "maps": size, "diffuse": white, "ambient": black}
    pictures = [
        panel_of(renderer.window(on, figure, size, light=tuple(light), **changes), panel)[..., 0]
        for light in LIGHTS.tolist()
    ]
    return recovered_normals(pictures, LIGHTS)


def checks(figure, renderer):
    """The normal field recovered from pictures under three lights, and that no pixel of the outline moved."""
    size = 128
    heights = figure.values["relief"] * brick_wall.heights(size, ACROSS, COURSES)
    true = height_fields.frames(*height_fields.slopes(heights))[0]
    error = {on: angles(_measured(figure, renderer, on, size, 1), true) for on in Answer}
    flat = angles(_measured(figure, renderer, Answer.MACHINE, size, 0), np.array([0.0, 0.0, 1.0]))
    by_pixels = dict(enumerate(_by_pixels(figure.size, figure.values)))
    return (
        *(
            DATA.check(
                "pixels that show what a ray finds there within 8/255, the least of the panels",
                share,
                on,
            )
            for on, share in seen_places.shares_alike(figure, renderer, by_pixels)
        ),
        DATA.check(
            "normals recovered from three pictures, RMS degrees",
            root_mean_square(error[Answer.IDEAL]),
            Answer.IDEAL,
        ),
        DATA.check(
            "normals recovered from three pictures, RMS degrees",
            root_mean_square(error[Answer.MACHINE]),
            Answer.MACHINE,
        ),
        DATA.check(
            "the same of the plane without bumps, RMS degrees", root_mean_square(flat), Answer.MACHINE
        ),
        DATA.check(
            "the bumps' RMS lean, degrees",
            root_mean_square(angles(true, np.array([0.0, 0.0, 1.0]))),
            Answer.IDEAL,
        ),
        *silhouette_check(figure, renderer, 128, {"shown": (FLAT, FLAT)}, {"shown": (BRICK_NORMALS, FLAT)}),
        arithmetic_check(figure, renderer, 0.0029, "8-bit normals and vectors; a third of slack"),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "relief": word.RELIEF(0.8),
        "light": word.LIGHT((-0.75, 0.35, 0.56)),
        "diffuse": word.DIFFUSE(
            (1.0, 1.0, 1.0), "The colour of the light, which the bricks' colours multiply."
        ),
        "ambient": word.AMBIENT((0.10, 0.10, 0.11)),
        "background": word.BACKDROP(BACKGROUND),
        "painted": word.FLAG(True, "Whether the bricks have colours."),
        "frontal": word.FLAG(False, "Whether the wall is seen straight on and fills its panel."),
        "maps": word.FITTED_TEXELS(None, "The edge of the wall's maps."),
        "shown": word.of(
            word.Several((word.Choice({"flat": FLAT, "bricks": BRICK_NORMALS}),) * 2),
            (FLAT, BRICK_NORMALS),
            "The normal map of the first two panels.",
        ),
        "height_field": own_maps.height_field("the bricks' relief", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(0.03),
        "photograph": own_maps.photograph("the bricks' colours", repeats=False),
    },
    methods=(Method("register combiners", scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),),
    acceptance=checks,
)

"""H21: a parabolic map, its two discs and the passes that draw with them."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bumped_reflections, environments, reflections
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import reflecting
from fixedpipe.effects.geometry import parabolic_maps, surfaces
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.state import AlphaTest

DATA = figure_data(__file__, "H21")

DISCS = "first disc", "second disc"
# Boards with one unit, or none of REFLECTION_MAP and combiners.
PLAIN_MACHINES = ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY", "G400")


def _shown(panel, name):
    """A disc as a picture, without what is beyond it."""
    read = unit(name, EDGE, environment=REPLACE)
    inside = AlphaTest(ComparisonFunction.GREATER, 0.5)
    view, square = orthographic_view(panel, half_height=1.02), surfaces.plane()
    return draw(f"show {name}", square.mesh(), view, None, (read,), depth_test=FIRST_PASS, alpha_test=inside)


def _scene(profile, size, passes, *, eye, environment, edge, photograph):
    surface = reflecting.ball_in_ring(size)
    room = photograph.panorama if photograph else reflecting.ENVIRONMENTS[environment]
    edge = reflecting.texels(size) if edge is None else edge
    panels = row_of_panels(4, size)
    views = [reflecting.camera(panel, eye) for panel in panels]
    load, _ = bumped_reflections.picture_backdrop(views[0], edge, profile, room)
    out = [*reflections.load_discs(DISCS, environments.discs(edge, room), profile), load]
    for panel, name in zip(panels, DISCS, strict=False):
        out += (panel.clear(BACKGROUND), _shown(panel, name))
    for number in (2, 3):
        _, backdrop = bumped_reflections.picture_backdrop(views[number], edge, profile, room)
        out += (panels[number].clear(BACKGROUND), backdrop)
        out += passes(surface, views[number], edge, number == 3)
    return tuple(out)


def one_unit_scene(profile, size, **values):
    """H21 by two passes: a disc, and over it the other by the alpha test."""

    def passes(surface, view, edge, whole):
        both = reflections.parabolic_passes(surface, view, DISCS, edge)
        return both if whole else both[:1]

    return _scene(profile, size, passes, **values)


def two_units_scene(profile, size, **values):
    """H21 by one pass: both discs, which combiners mix; next to it one disc alone."""

    def passes(surface, view, edge, whole):
        if whole:
            return (reflections.parabolic_pass(surface, view, DISCS, edge),)
        below = 1 - reflections.over(view)
        return (reflections.disc_pass(surface, view, DISCS[below], below, edge),)

    return _scene(profile, size, passes, **values)


@lru_cache(maxsize=1)
def _by_rays(size, eye):
    """Of parts of the panels: the panel's number, which pixels, bool [size, size], and the room there,
    float64 [n, 3]. The discs by the paraboloid's formula, and what mirrors and the room behind by rays. The
    last part is where the third panel lacks the first disc.
    """
    view, surface = reflecting.camera(row_of_panels(4, size)[3], eye), reflecting.ball_in_ring(size)
    toward, known = reflecting.reflections_by_rays(surface, view, 0.3)
    back, behind = reflecting.backdrop_by_rays(surface, view)
    x, y = pixel_grid(size, parabolic_maps.margin(reflecting.texels(size)) / 1.02)
    square = x * x + y * y
    discs = [np.stack([2.0 * x, 2.0 * y, z], axis=-1) for z in (square - 1.0, 1.0 - square)]
    # The second disc has the directions towards +z.
    parts = [(k, square < 0.97, discs[k]) for k in (0, 1)]
    parts += [(2, known & (toward[..., 2] > 0.1), toward), (3, known, toward)]
    parts += [(k, behind, back) for k in (2, 3)]
    parts.append((2, known & (toward[..., 2] < -0.3), toward))
    return [(k, where, np.minimum(environments.room(along[where]), 1.0)) for k, where, along in parts]


def _displayed_checks(figure, renderer):
    """The displayed room in the discs, mirrored and behind."""
    size, parts = figure.size, _by_rays(figure.size, figure.values["eye"])
    for on in (Answer.MACHINE, Answer.IDEAL):
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        *shares, beyond = (
            least_share(panel_of(window, k)[where], true, np.broadcast_to(true.mean(axis=0), true.shape))
            for k, where, true in parts
        )
        yield DATA.check(
            "of the room in the discs, mirrored and behind, the least share that is seen", min(shares), on
        )
        yield DATA.check(
            "of the room where the third panel lacks the first disc, the share that is seen", beyond, on
        )


def checks(figure, renderer):
    """Directions as colours: in the discs by the paraboloid's formula, in the pictures by rays."""
    yield from _displayed_checks(figure, renderer)
    size, edge = 128, 256
    panels = row_of_panels(4, size)
    surface, view = (
        reflecting.ball_in_ring(size),
        reflecting.camera(panels[3], figure.values["eye"]),
    )
    toward, known = reflecting.reflections_by_rays(surface, view, 0.3)
    x, y = pixel_grid(size, parabolic_maps.margin(edge) / 1.02)
    square = x * x + y * y
    inside = square < 0.97
    for on in (Answer.IDEAL, Answer.MACHINE):
        image = renderer.window(on, figure, size, environment="directions", edge=edge)
        for disc, z in enumerate((square - 1.0, 1.0 - square)):
            true = np.stack([2.0 * x, 2.0 * y, z], axis=-1) / (1.0 + square)[..., None]
            yield DATA.check(
                "{which} against the paraboloid's formula, largest error in degrees",
                float(reflecting.degrees_off(panel_of(image, disc), true)[inside].max()),
                on,
                which=DISCS[disc],
            )
        off = reflecting.degrees_off(panel_of(image, 3), toward)
        for name, where in (
            ("", known),
            (" within 6 degrees of the discs' edge", known & (np.abs(toward[..., 2]) < 0.1)),
        ):
            yield DATA.check(
                "both discs against reflections by rays{name}, degrees at 99 pixels of 100",
                float(np.percentile(off[where], 99.0)),
                on,
                name=name,
            )
        behind = known & (toward[..., 2] < -0.3)
        wrong = reflecting.degrees_off(panel_of(image, 2), toward)
        yield DATA.check(
            "the second disc alone, where the first belongs, RMS degrees", root_mean_square(wrong[behind]), on
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "eye": word.POSITION(
            (1.2, 0.6, -2.5), "The eye; behind the ball, at negative z, the second disc is drawn first."
        ),
        "environment": reflecting.ENVIRONMENT,
        "edge": word.FITTED_TEXELS(None, "The edge of each disc's map."),
        "photograph": own_maps.PANORAMA,
    },
    methods=(
        Method("two units and combiners", two_units_scene, COMBINER_MACHINES),
        Method("two passes and the alpha test", one_unit_scene, PLAIN_MACHINES),
    ),
    acceptance=checks,
)

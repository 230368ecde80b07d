"""F000-4: a teapot that is blue from one side and red from the other, by factors of a simulated BRDF."""

import math
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.heidrich_2001.shared import factored_teapot as the
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    panel_width,
    row_of_panels,
)
from fixedpipe.effects.reflectance import factored_passes, separable_factors
from fixedpipe.effects.scattering import goniometer, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scenes.teapot import framed_along, teapot

DATA = figure_data(__file__, "F000-4")

# Texels across the grooves, and rows, which are all alike: two stand for the 32.
TEXELS, ROWS = 32, 2
# Degrees round the teapot from which it is seen: 0 is where its spout points to the left.
SIDES = (0.0, 90.0, 180.0)
# Of the teapot's own axes the one that grooves run across.
AXIS = (0.0, 0.0, 1.0)
# Directions of the reference at once: arrays of all vertices would be large.
_AT_ONCE = 1024


@lru_cache(maxsize=4)
def _simulated(blue, red, angle, directions):
    """The grooves' field, and what its texels see."""
    field = height_field.ridges(TEXELS, ROWS, angle, 1, blue, red)
    return field, visibility.precompute(field, spiral(directions))


@lru_cache(maxsize=4)
def table(blue, red, angle, bounces, directions, map_size):
    """f_r of the grooves at all pairs of a map's texels: a separable_factors.Table."""
    field, seen = _simulated(blue, red, angle, directions)
    texels = separable_factors.texels(map_size)
    return separable_factors.table_of(goniometer.brdf(field, seen, texels, texels, bounces), map_size)


@lru_cache(maxsize=8)
def factors(blue, red, angle, bounces, directions, map_size, terms):
    """The SeparableFactors of the grooves."""
    return separable_factors.factored(table(blue, red, angle, bounces, directions, map_size), terms)


def turned(size, side):
    """The teapot as it is seen from a side, its tangents across the grooves."""
    return framed_along(teapot(the.detail(size)), AXIS).rotated(rotation("y", 180.0 + side))


def make_scene(board):
    """A Scene that draws all sides by a Board's means."""

    def scene(profile, size, *, light, intensity, map_size, terms, **grooves):
        found = factors(*_grooves(grooves), map_size, terms)
        commands, loaded = factored_passes.load(found, "grooves", profile, intensity=intensity, board=board)
        out = [*commands]
        for side, panel in zip(SIDES, row_of_panels(len(SIDES), size, the.ASPECT), strict=True):
            out.append(panel.clear(BACKGROUND))
            out += factored_passes.passes(turned(size, side), loaded, the.view_of(panel), Light(light))
        return tuple(out)

    return scene


def _grooves(values):
    return tuple(values[name] for name in ("blue", "red", "angle", "bounces", "directions"))


def radiance(surface, view, light, grooves):
    """pi f_r (n.l)+ at the vertices by the goniometer, each with its own light and view: float64 [n, 3]."""
    blue, red, angle, bounces, directions = grooves
    field, seen = _simulated(blue, red, angle, directions)
    towards, views, above = the.lit_and_seen(surface, view, light)
    above = np.flatnonzero(above)
    out = np.zeros(towards.shape)
    for start in range(0, len(above), _AT_ONCE):
        some = above[start : start + _AT_ONCE]
        to, back = normalize(towards[some]), normalize(views[some])
        sent = goniometer.lights(field, seen, to, bounces)
        mean = goniometer.pair_means(goniometer.shares_in_texture_space(field, back), sent)
        out[some] = mean / goniometer.irradiance(field, to)[:, None] * towards[some, 2:]
    return out


def reference(size, *, light, intensity, map_size, terms, **grooves):
    """The grooves' own BRDF at the vertices, interpolated, without factors or textures."""
    del map_size, terms
    out = []
    for side, panel in zip(SIDES, row_of_panels(len(SIDES), size, the.ASPECT), strict=True):
        surface = turned(size, side)
        colors = intensity * radiance(surface, the.view_of(panel), Light(light), _grooves(grooves))
        out += the.colored(surface, panel, colors)
    picture = the.pictured(out, len(SIDES) * panel_width(size, the.ASPECT), size)
    return np.concatenate([picture, np.ones((*picture.shape[:2], 1))], axis=-1)


def mean_ratio(panel):
    """Mean blue over mean red of what is lit."""
    red, _, blue = panel[the.covered(panel)].mean(axis=0)
    return float(blue / red)


def checks(figure, renderer):
    """Colours of the sides, where they are equal, the factors' errors, and the BRDF itself at vertices."""
    size, values = figure.size // 4, figure.values
    grooves = _grooves(values)
    for on in Answer:
        window = renderer.window(on, figure, size)
        panels = np.split(window, 3, axis=1)
        yield DATA.check("blue over red seen from 0 degrees, mean of what is lit", mean_ratio(panels[0]), on)
        yield DATA.check("red over blue seen from 180 degrees", 1.0 / mean_ratio(panels[2]), on)
        yield DATA.check(
            ("degrees from 90 where both are equal, by how the ratio's logarithm goes from side to side"),
            abs(90.0 * math.log(mean_ratio(panels[1])) / math.log(mean_ratio(panels[0]))),
            on,
        )
        by_vertices = figure.reference_picture(size, renderer.method)[::-1, :, :3]
        covered = the.covered(by_vertices)
        yield DATA.check(
            "RMS of the teapots - the BRDF at their vertices",
            root_mean_square((np.clip(window, 0.0, 1.0) - np.clip(by_vertices, 0.0, 1.0))[covered]),
            on,
        )
    samples = table(*grooves, values["map_size"])
    for terms, bound in ((1, 0.15), (3, 0.05)):
        yield DATA.check(
            "error of {terms} separable term{n}, RMS over the table's",
            samples.error(factors(*grooves, values["map_size"], terms).values()),
            Answer.IDEAL,
            at_most=bound,
            terms=terms,
            n="s" * (terms > 1),
        )
    one, three = (renderer.window(Answer.IDEAL, figure, size, terms=terms) for terms in (1, 3))
    yield DATA.check(
        "RMS of one term - the BRDF at the vertices, over that of three",
        root_mean_square((one - by_vertices)[covered]) / root_mean_square((three - by_vertices)[covered]),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    aspect=the.ASPECT,
    parameters={
        "blue": word.COLOR((0.1, 0.1, 0.8), "The albedo of the flanks that look to one side."),
        "red": word.COLOR((0.8, 0.1, 0.1), "The albedo of the others."),
        "angle": word.NUMBER(45.0, "How steep the flanks are.", "degrees", low=5.0, high=75.0),
        "bounces": word.of(word.Whole(0, 16), 2, "Reflections in the grooves beyond the first."),
        "directions": word.of(word.Whole(20, 1000), 100, "Directions along which light is gathered."),
        "map_size": the.MAP_SIZE,
        "terms": word.of(word.Whole(1, 8), 3, "Products that are added."),
        "light": word.LIGHT((0.0, 0.55, 1.0)),
        "intensity": the.intensity(1.0),
    },
    methods=the.methods(
        make_scene,
        (
            "cube maps, register combiners on two units",
            "cube maps, two terms at once on four units",
            "parabolic maps, texture environments and inversions",
            "parabolic maps, one unit and the accumulation buffer",
        ),
        # The InfiniteReality could; with twelve bits three terms take it ten seconds (Measured).
        ("OPENGL_1_2", "OCTANE"),
    ),
    acceptance=checks,
    reference=reference,
)

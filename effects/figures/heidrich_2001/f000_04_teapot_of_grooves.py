"""F000-4: a teapot that is blue from one side and red from the other, by factors of a simulated BRDF.

A large view is above two small ones, from either side, and the grooves themselves. A lacquer's highlight,
computed at the vertices, is added to each view of the teapot: the factors have none.
"""

import math
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping.blinn import integer_power
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.heidrich_2001.shared import factored_teapot as the
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize, of_40_bits, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, Panel, perspective_view
from fixedpipe.effects.passes.draws import ADD, FIRST_PASS, LATER_PASS, draw
from fixedpipe.effects.reflectance import factored_passes, separable_factors
from fixedpipe.effects.scattering import goniometer, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scenes.teapot import framed_along, teapot
from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import PrimitiveType

DATA = figure_data(__file__, "F000-4")

# Texels across the grooves, and rows, which are all alike: two stand for the 32.
TEXELS, ROWS = 32, 2
# Degrees round the teapot from which the small views are: 0 is where its spout points to the left.
SIDES = (0.0, 180.0)
# The camera of every view, of a teapot that reaches one from its axis; angles of the large and small views.
EYE, FIELDS_OF_VIEW = (0.0, 1.5, 4.2), (17.0, 27.5)
CENTER = (0.0, -0.06, 0.0)
# A light for which the teapot is alike from the spout's either side.
EVEN_LIGHT = (0.0, 0.55, 1.0)
# From where the grooves are lit.
_GROOVES_LIGHT = unit_vector((0.2, 1.0, 0.6), "The grooves' light")
# Chosen: the exponent of the lacquer's highlight.
EXPONENT = 48
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
    """The teapot, turned as it is seen from a side, with tangents across the grooves."""
    return framed_along(teapot(the.detail(size)), AXIS).rotated(rotation("y", 180.0 + side))


def layout(size):
    """Panels of a picture of ``size`` pixels: the large view, two small ones, and the grooves below it."""
    small = size // 3
    large = Panel(0, small, size, size - small)
    return large, tuple(Panel(k * small, 0, small, small) for k in range(3))


def teapots(size, turn):
    """(view, surface) of the large teapot and of the small ones."""
    large, small = layout(size)
    panels = (
        (large, turn, FIELDS_OF_VIEW[0]),
        *((panel, side, FIELDS_OF_VIEW[1]) for panel, side in zip(small, SIDES, strict=False)),
    )
    for panel, side, field_of_view in panels:
        yield perspective_view(panel, EYE, CENTER, field_of_view), turned(size, side)


def lacquer(surface, view, light, strength):
    """The highlight of a lacquer at the vertices, by Blinn's halfway vector: float64 [n, 3]."""
    toward = light.light_vectors(surface.positions)
    half = normalize(toward + view.view_vectors(surface.positions))
    shine = strength * integer_power(np.maximum(dot(surface.normals, half), 0.0), EXPONENT)
    shine *= dot(surface.normals, toward) > 0.0
    return np.repeat(shine[:, None], 3, axis=-1)


def shown_grooves(panel, blue, red, angle):
    """Commands that draw four grooves, as a mesh that is lit from the viewer's side."""
    rise = float(of_40_bits(math.tan(math.radians(angle)))) * 0.5
    view = perspective_view(panel, (0.5, 2.8, 4.4), (-0.07, 0.2 * rise, 0.0), 58.0, radius=4.0)
    places, colors = [], []
    for x in range(-2, 2):
        for low, high, color in (((x, 0.0), (x + 0.5, rise), blue), ((x + 1.0, 0.0), (x + 0.5, rise), red)):
            run, climb = high[0] - low[0], high[1] - low[1]
            normal = normalize(np.array([-climb, run, 0.0]) * math.copysign(1.0, run))
            shade = 0.25 + 0.75 * max(0.0, float(dot(normal, _GROOVES_LIGHT)))
            places += [(*low, -1.4), (*low, 1.4), (*high, 1.4), (*high, -1.4)]
            colors += [[shade * c for c in color]] * 4
    mesh = Mesh(np.array(places), PrimitiveType.QUADS, colors=np.array(colors))
    return (
        panel.clear(BACKGROUND),
        draw("the grooves themselves", mesh, view, None, depth_test=FIRST_PASS),
    )


def make_scene(board):
    """A Scene that draws all views by a Board's means."""

    def scene(profile, size, *, light, intensity, lacquered, turn, map_size, terms, **grooves):
        found = factors(*_grooves(grooves), map_size, terms)
        commands, loaded = factored_passes.load(found, "grooves", profile, intensity=intensity, board=board)
        out = [*commands]
        for view, surface in teapots(size, turn):
            out.append(view.panel.clear(BACKGROUND))
            out += factored_passes.passes(surface, loaded, view, Light(light))
            mesh = surface.mesh(colors=lacquer(surface, view, Light(light), lacquered))
            out.append(draw("the lacquer's highlight", mesh, view, None, depth_test=LATER_PASS, blending=ADD))
        out += shown_grooves(layout(size)[1][2], *_grooves(grooves)[:3])
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


def reference(size, *, light, intensity, lacquered, turn, map_size, terms, **grooves):
    """The grooves' own BRDF at the vertices and the lacquer, interpolated, without factors or textures."""
    del map_size, terms
    out = []
    for view, surface in teapots(size, turn):
        colors = intensity * radiance(surface, view, Light(light), _grooves(grooves))
        colors = np.clip(colors, 0.0, 1.0) + lacquer(surface, view, Light(light), lacquered)
        out += the.colored(surface, view.panel, colors, view)
    out += shown_grooves(layout(size)[1][2], *_grooves(grooves)[:3])
    picture = the.pictured(out, size, size)
    return np.concatenate([picture, np.ones((*picture.shape[:2], 1))], axis=-1)


def mean_ratio(panel):
    """Mean blue over mean red of the lit pixels."""
    red, _, blue = panel[the.covered(panel)].mean(axis=0)
    return float(blue / red)


def _cell(window, panel):
    return window[panel.y : panel.y + panel.height, panel.x : panel.x + panel.width]


def checks(figure, renderer):
    """Colours of the sides, where they are equal, the factors' errors, and the BRDF itself at vertices."""
    size, values = figure.size // 2, figure.values
    grooves = _grooves(values)
    large, (first, second, inset) = layout(size)
    even = {"turn": 90.0, "light": EVEN_LIGHT, "lacquered": 0.0}
    by_vertices = figure.reference_picture(size, renderer.method)[::-1, :, :3]
    covered = the.covered(by_vertices)
    _cell(covered, inset)[...] = False
    for on in Answer:
        window = renderer.window(on, figure, size)
        dull = renderer.window(on, figure, size, **even)
        blue, red = (_cell(dull, panel) for panel in (first, second))
        yield DATA.check("blue over red seen from 0 degrees, mean of what is lit", mean_ratio(blue), on)
        yield DATA.check("red over blue seen from 180 degrees", 1.0 / mean_ratio(red), on)
        yield DATA.check(
            ("degrees from 90 where both are equal, by how the ratio's logarithm goes from side to side"),
            abs(90.0 * math.log(mean_ratio(_cell(dull, large))) / math.log(mean_ratio(blue))),
            on,
        )
        for side, (panel, main) in {"0 degrees": (first, 2), "180 degrees": (second, 0)}.items():
            seen = _cell(window, panel)[the.covered(_cell(window, panel))]
            yield DATA.check(
                "pixels of the small teapot from {side} that are more of its colour than of the other",
                float((seen[:, main] > seen[:, 2 - main]).mean()),
                on,
                side=side,
            )
        yield DATA.check(
            "the large teapot's brightest pixel, of its least component",
            _cell(window, large).min(-1).max(),
            on,
        )
        grooves_there = the.covered(_cell(window, inset))
        yield DATA.check(
            "pixels of the grooves in the outermost columns of their view",
            float(grooves_there[:, [0, -1]].sum()),
            on,
        )
        flanks = _cell(window, inset)[grooves_there]
        for name, main in (("blue", 2), ("red", 0)):
            yield DATA.check(
                "share of the grooves' pixels that are {name}",
                float((flanks[:, main] > 1.5 * flanks[:, 2 - main]).mean()),
                on,
                name=name,
            )
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
    one, three = (
        np.clip(renderer.window(Answer.IDEAL, figure, size, terms=terms), 0.0, 1.0) for terms in (1, 3)
    )
    by_vertices = np.clip(by_vertices, 0.0, 1.0)
    yield DATA.check(
        "RMS of one term - the BRDF at the vertices, over that of three",
        root_mean_square((one - by_vertices)[covered]) / root_mean_square((three - by_vertices)[covered]),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    size=768,
    parameters={
        "blue": word.COLOR((0.1, 0.22, 0.85), "The albedo of the flanks that look to one side."),
        "red": word.COLOR((0.85, 0.22, 0.1), "The albedo of the others."),
        "angle": word.NUMBER(45.0, "How steep the flanks are.", "degrees", low=5.0, high=75.0),
        "bounces": word.of(word.Whole(0, 16), 2, "Reflections in the grooves beyond the first."),
        "directions": word.of(word.Whole(20, 1000), 100, "Directions along which light is gathered."),
        "map_size": the.MAP_SIZE,
        "terms": word.of(word.Whole(1, 8), 3, "Products that are added."),
        "light": word.LIGHT((0.5, 1.0, 1.0)),
        "intensity": the.intensity(1.0),
        "lacquered": word.NUMBER(0.9, "How strong the lacquer's highlight is.", low=0.0, high=1.0),
        "turn": word.of(
            word.Number(-360.0, 360.0), 42.0, "From where round the teapot the large view is.", "degrees"
        ),
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

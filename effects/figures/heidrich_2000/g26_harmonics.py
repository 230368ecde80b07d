"""G26: one lobe of a BRDF four ways: counted in pictures, in texture space, on a dense grid, by harmonics."""

import math
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, draw
from fixedpipe.effects.passes.encoding import colors_of, factor_texels
from fixedpipe.effects.scattering import dense_brdf, goniometer, harmonics, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral

DATA = figure_data(__file__, "G26")

PANELS = ("pictures", "texture space", "16^4 samples", "512 samples, harmonics")
# Of a panel's half edge, the radius of the views' disc; and how far from the zenith its rim is, as a sine.
EXTENT, RIM = 0.92, 0.98
TEXELS, ROWS = 64, 2


def rings(size):
    """How many rings of views a panel of ``size`` pixels has; half as many as spokes."""
    return int(min(max(size // 16, 6), 24))


def views(count):
    """The disc of views seen from the zenith, of ``count`` rings: positions and directions, float64 [n, 3];
    triangles.
    """
    spokes = 2 * count
    ring, spoke = np.meshgrid(np.arange(count + 1) / count, np.arange(spokes + 1) / spokes, indexing="ij")
    angle = 2.0 * math.pi * spoke.ravel()
    x, y = ring.ravel() * cosine(angle), ring.ravel() * sine(angle)
    # At the zenith every spoke has the same view.
    height = np.sqrt(np.maximum(1.0 - RIM * RIM * (x * x + y * y), 0.0))
    i = (np.arange(count) * (spokes + 1))[:, None] + np.arange(spokes)
    a, b, c, d = i, i + spokes + 1, i + spokes + 2, i + 1
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    positions = EXTENT * np.stack([x, y, 0.0 * x], axis=-1)
    return positions, normalize(np.stack([RIM * x, RIM * y, height], axis=-1)), triangles


@lru_cache(maxsize=4)
def lobes(count, light, red, white, angle, bounces, directions, samples):
    """f_r(l, v) of the disc's views, in the panels' order: four float64 [n, 3]."""
    field = height_field.ridges(TEXELS, ROWS, angle, 1, red, white)
    seen = visibility.precompute(field, spiral(directions))
    towards = goniometer.upper(np.array([light]), "The light's direction")
    _, toward, _ = views(count)
    counted = goniometer.shares_in_pictures(field, toward, TEXELS)
    dense = dense_brdf.simulated(field, seen, 16, bounces)
    fitted = harmonics.fitted(*harmonics.sampled(field, seen, samples, bounces))
    lights = np.broadcast_to(towards, toward.shape)
    return (
        goniometer.brdf(field, seen, towards, toward, bounces, counted)[0],
        goniometer.brdf(field, seen, towards, toward, bounces)[0],
        dense.at(lights, toward),
        fitted.at(lights, toward),
    )


def scene(profile, size, *, intensity, **values):
    """G26: four discs of views, f_r pi at their vertices."""
    positions, toward, triangles = views(rings(size))
    x, y, z = (np.tile(row, (len(positions), 1)) for row in np.eye(3))
    disc = Surface(positions, z, x, y, toward[:, :2], triangles)
    out = []
    for panel, name, lobe in zip(row_of_panels(4, size), PANELS, lobes(rings(size), **values), strict=True):
        colors = colors_of(factor_texels(np.clip(intensity * math.pi * lobe, 0.0, 1.0), profile))
        mesh = disc.mesh(colors=colors)
        out += (
            panel.clear(BACKGROUND),
            draw(f"f_r: {name}", mesh, orthographic_view(panel), None, depth_test=FIRST_PASS),
        )
    return tuple(out)


def _checks_at_vertices(figure, renderer):
    """Each displayed panel against its own lobe, at the pixels in which vertices lie."""
    size, values = figure.size, dict(figure.values)
    intensity = values.pop("intensity")
    positions, _, _ = views(rings(size))
    # Those well within the rim, beyond which the background begins.
    inside = (positions * positions).sum(axis=-1) < (0.97 * EXTENT) ** 2
    x, y = (np.floor(0.5 * (positions[inside, k] + 1.0) * size).astype(np.int64) for k in (0, 1))
    true = [np.clip(intensity * math.pi * one[inside], 0.0, 1.0) for one in lobes(rings(size), **values)]
    for on in Answer:
        window = renderer.window(on, figure, size)
        errors = [panel_of(window, k)[y, x] - one for k, one in enumerate(true)]
        yield DATA.check(
            "RMS of a panel from its own f_r pi where vertices lie, the largest",
            max(map(root_mean_square, errors)),
            on,
        )


def checks(figure, renderer):
    """The four against each other over the disc's pixels, by the light that is sent: times the cosine."""
    yield from _checks_at_vertices(figure, renderer)
    size = figure.size // 2
    edge = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) / EXTENT * RIM
    x, y = np.meshgrid(edge, edge)
    on_disc = x * x + y * y < 0.9 * RIM * RIM
    facing = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))[..., None]
    window = renderer.window(Answer.IDEAL, figure, size)
    seen = [(panel_of(window, k) * facing)[on_disc] for k in range(4)]

    def error(a, b):
        return float(np.sqrt(((a - b) ** 2).mean()) / b.mean())

    yield DATA.check(
        "pictures and texture space differ, RMS by the mean", error(seen[0], seen[1]), Answer.IDEAL
    )
    yield DATA.check(
        "the dense grid and texture space differ, RMS by the mean", error(seen[2], seen[1]), Answer.IDEAL
    )
    yield DATA.check(
        "harmonics and texture space differ, RMS by the mean", error(seen[3], seen[1]), Answer.IDEAL
    )
    red = [float(part[:, 0].sum() / part[:, 1].sum()) for part in seen]
    yield DATA.check(
        "red over green of harmonics by that of texture space, from one",
        abs(red[3] / red[1] - 1.0),
        Answer.IDEAL,
    )
    yield arithmetic_check(figure, renderer, 0.01, "colours of vertices are bytes")


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    size=512,
    parameters={
        "light": word.of(
            word.DIRECTION_KIND, (0.35, 0.2, 0.9), "The direction to the light: across the ridges, along, up."
        ),
        "red": word.COLOR((0.9, 0.3, 0.2), "The albedo of the flanks to the left."),
        "white": word.COLOR((0.9, 0.9, 0.9), "The albedo of the flanks to the right."),
        "angle": word.NUMBER(50.0, "How steep the flanks are.", "degrees", low=5.0, high=75.0),
        "bounces": word.of(word.Whole(0, 16), 3, "Reflections beyond the first."),
        "directions": word.of(word.Whole(20, 1000), 200, "Directions along which light is gathered."),
        "samples": word.of(word.Whole(20, 5000), 512, "Random samples of the harmonics."),
        "intensity": word.NUMBER(0.85, "What is shown is so many times f_r pi.", low=0.0, high=4.0),
    },
    methods=(Method("f_r in float64, at vertices", scene, ("OPENGL_1_2", "GEFORCE_256")),),
    acceptance=checks,
)

"""F001-5: a rough surface reflects rays from a cone of directions into one pixel."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared.bumpy_line import (
    heights,
    mirrored,
    slopes,
    turned,
    waves,
)
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F001-5")

PANELS = ("smooth", "rough")
# Half of what the pixel's beam meets of the surface, and how far it comes from.
FOOTPRINT, FAR, RADIUS = 0.14, 1.2, 1.3
BASE = np.array([0.0, -0.62])
RAYS, SAMPLES = 18, 256


def bumps(slope):
    """Twelve waves, all far shorter than the footprint; None where the surface is smooth."""
    return waves(12, 0.09, 0.03, slope, 5) if slope else None


def incoming(angle):
    """The direction in which the beam runs, ``angle`` degrees from straight down: (dx, dy)."""
    return float(sine(np.radians(angle))), -float(cosine(np.radians(angle)))


def _feet(bumps_of_it, count):
    """Evenly spread places of the footprint, and the slopes there: float64 [count, 2], [count]."""
    x = FOOTPRINT * (2.0 * (np.arange(count) + 0.5) / count - 1.0)
    high, slope = (f(bumps_of_it, x) if bumps_of_it else 0.0 * x for f in (heights, slopes))
    return BASE + np.stack([x, high], axis=-1), slope


def mean_and_deviation(slope, count=SAMPLES):
    """(mean slope, its deviation) within the footprint, by the pyramid of roughness: two floats."""
    offsets = np.zeros((1, count, 2))
    offsets[0, :, 0] = _feet(bumps(slope), count)[1]
    top = rough.pyramid(offsets)[-1]
    return float(top.offsets[0, 0, 0]), float(rough.largest_deviation(top.covariance)[0, 0])


def cone(slope, angle):
    """Directions of the cone's edges and of its middle: float64 [3, 2]. Its edges are the directions that the
    mean slope mirrors, and that slopes one deviation more and less mirror.
    """
    mean, deviation = mean_and_deviation(slope)
    return mirrored(incoming(angle), np.array([mean - deviation, mean, mean + deviation]))


def _view(panel):
    return drawing.sheet(panel, 1.06)


def _edge_of_sky():
    return drawing.arc(tuple(BASE), 42.0, 138.0, (RADIUS, 0.0), (0.0, RADIUS), 64)


def _fan(first, last, pieces=12):
    """Triangles from the foot to the sky between two directions: a list of float64 [3, 2]."""
    share = np.arange(pieces + 1)[:, None] / pieces
    along = first + share * (last - first)
    along = along / np.sqrt((along * along).sum(axis=1, keepdims=True))
    tips = BASE + RADIUS * along
    return [np.array([BASE, tips[k], tips[k + 1]]) for k in range(pieces)]


def _panel(view, slope, angle):
    down, found = np.array(incoming(angle)), bumps(slope)
    x = np.linspace(-1.0, 1.0, 641)
    outline = BASE + np.stack([x, heights(found, x) if found else 0.0 * x], axis=-1)
    body = [np.array([outline[k], outline[k + 2], (x[k + 2], -0.9), (x[k], -0.9)]) for k in range(0, 640, 2)]
    feet, at = _feet(found, RAYS)
    rays = mirrored(incoming(angle), at)
    ends = [BASE + np.array([side, 0.0]) for side in (-FOOTPRINT, FOOTPRINT)]
    low, middle, high = cone(slope, angle)
    pixel = [end - FAR * down for end in ends]
    out = [
        drawing.stroke("what is around", view, _edge_of_sky(), FAINT, width=2.0),
        drawing.polygons("the surface", view, body, (0.13, 0.15, 0.20)),
        drawing.stroke("its outline", view, outline, INK, width=1.6),
        drawing.polygon("the pixel's beam", view, [pixel[0], ends[0], ends[1], pixel[1]], BLUE, alpha=0.3),
        drawing.strokes("its edges", view, list(zip(pixel, ends, strict=True)), BLUE),
        drawing.stroke("the pixel", view, pixel, BLUE, width=5.0),
    ]
    if slope:
        out.append(drawing.polygons("the cone, a deviation wide", view, _fan(low, high), VIOLET, alpha=0.35))
    tips = feet + _reach(feet, rays)[:, None] * rays
    out.append(
        drawing.strokes("rays that reach the pixel", view, list(np.stack([feet, tips], axis=1)), YELLOW)
    )
    out.append(drawing.dots("where they come from", view, tips, YELLOW, radius=2.5))
    if slope:
        # What the sky has of the cone.
        share = np.arange(17)[:, None] / 16.0
        along = low + share * (high - low)
        along = along / np.sqrt((along * along).sum(axis=1, keepdims=True))
        band = BASE + 1.03 * RADIUS * along
        out.append(drawing.stroke("the cone's part of what is around", view, band, VIOLET, width=5.0))
    axis = np.stack([BASE, BASE + 0.9 * middle])
    return [*out, drawing.arrow("the mean slope's ray", view, axis, GREEN, width=2.6)]


def _reach(feet, rays):
    """How far rays run to the sky's circle: float64 [n]."""
    off = feet - BASE
    along = off[:, 0] * rays[:, 0] + off[:, 1] * rays[:, 1]
    return np.sqrt(along * along + RADIUS * RADIUS - (off * off).sum(axis=1)) - along


def scene(profile, size, *, slope, angle, background):
    """F001-5: a pixel's beam on a smooth surface and on a rough one."""
    out = []
    for panel, of_it in zip(row_of_panels(2, size), (0.0, slope), strict=True):
        out += [panel.clear(background), *_panel(_view(panel), of_it, angle)]
    return tuple(out)


def checks(figure, renderer):
    """Shares and angles of 256 rays against the cone that the pyramid gives; marks."""
    slope, angle = figure.values["slope"], figure.values["angle"]
    low, middle, high = cone(slope, angle)
    _, at = _feet(bumps(slope), SAMPLES)
    turns = turned(mirrored(incoming(angle), at), middle)
    edges = sorted(float(turned(edge, middle)) for edge in (low, high))
    share = float(((turns >= edges[0]) & (turns <= edges[1])).mean())
    yield DATA.check(
        "share of 256 rays within the cone of a deviation, less 0.683", abs(share - 0.683), Answer.IDEAL
    )
    twice = float(np.radians(turns.std()) / (2.0 * at.std()))
    yield DATA.check(
        "deviation of the rays' angles over twice that of the slopes, less one",
        abs(twice - 1.0),
        Answer.IDEAL,
    )
    yield DATA.check(
        "I_1 of the pyramid - deviation of the slopes",
        abs(mean_and_deviation(slope)[1] - float(at.std())),
        Answer.IDEAL,
    )
    smooth = mirrored(incoming(angle), _feet(None, SAMPLES)[1])
    yield DATA.check(
        "rays of the smooth surface: largest angle between two, degrees",
        float(np.ptp(turned(smooth, smooth[0]))),
        Answer.IDEAL,
    )
    views = [_view(panel) for panel in row_of_panels(2, figure.size // 2)]
    flat = cone(0.0, angle)[1]
    marks = [(0, views[0], BASE + 0.6 * flat, GREEN), (1, views[1], BASE + 0.7 * middle, GREEN)]
    # Within the cone, beside its edge: the smooth surface has none there.
    low, _, high = cone(slope, angle)
    edge = low + 0.1 * (high - low)
    beside = BASE + 1.03 * RADIUS * edge / np.sqrt((edge * edge).sum())
    marks += [(1, views[1], beside, VIOLET), (0, views[0], beside, BACKGROUND)]
    marks += [(k, view, BASE - FAR * np.array(incoming(angle)), BLUE) for k, view in enumerate(views)]
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "slope": word.of(word.Number(0.01, 0.3), 0.09, "The deviation of the rough surface's slopes."),
        "angle": word.of(word.Number(0.0, 60.0), 24.0, "The beam's angle to the normal.", "degrees"),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

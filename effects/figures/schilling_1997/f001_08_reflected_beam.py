"""F001-8: a beam, the normals that it meets on a rough surface, and the cone that it is reflected into."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, VIOLET, YELLOW
from fixedpipe.effects.environment_maps.rough_mirrors import mirrored
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels

DATA = figure_data(__file__, "F001-8")

EYE, CENTER, FIELD = (0.25, 2.7, 2.7), (0.08, 0.42, 0.0), 36.0
FRAME = np.array([(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)])
SHOWN, COUNTED = 90, 40000
# How far a ray is drawn, and a normal.
_RAY, _NORMAL = 1.15, 0.72
SLOPE = word.Word(word.Number(0.01, 0.6))


def slopes(count, along, across, lean):
    """Offsets that are nearly normally distributed: float64 [count, 2]. Sums of twelve even numbers.

    along, across  deviations along the ellipse's axes
    lean           by how much the second goes with the first
    """
    number = np.arange(count)
    sums = [sum(hashed(number, number // 251, 12 * k + n) / 65536.0 for n in range(12)) - 6.0 for k in (0, 1)]
    return np.stack([along * sums[0], across * sums[1] + lean * sums[0]], axis=-1)


def ellipse(offsets):
    """The mean of offsets [n, 2], and the points of x^T K^-1 x = 1 about it: float64 [2] and [65, 2]."""
    mean = offsets.mean(axis=0)
    d_1, d_2, d_3 = rough.deviations(rough.products(offsets - mean).mean(axis=0))
    circle = drawing.arc((0.0, 0.0), 0.0, 360.0, segments=64)
    return mean, mean + np.stack([d_1 * circle[:, 0] + d_2 * circle[:, 1], d_3 * circle[:, 1]], axis=-1)


def _incoming(height):
    radians = math.radians(height)
    return normalize(np.array([math.cos(radians), -math.sin(radians), 0.0]))


def _rounded(vectors):
    """Places on the screen need no more; the same on every processor."""
    return np.floor(np.asarray(vectors) * 2.0**20 + 0.5) / 2.0**20


def reflected(offsets, height):
    """Unit vectors that a beam from ``height`` degrees is reflected along: float64 [n, 3]."""
    incoming = np.broadcast_to(_incoming(height), (len(offsets), 3))
    return _rounded(mirrored(incoming, offsets, FRAME)[0])


def _view(panel):
    return perspective_view(panel, EYE, CENTER, FIELD)


def _normals(offsets):
    """Ends of normals that lie in one plane above the surface, as slopes do: float64 [n, 3]."""
    return _NORMAL * (FRAME[2] + offsets[..., :1] * FRAME[0] + offsets[..., 1:] * FRAME[1])


def scene(profile, size, *, along, across, lean, height, background):
    """F001-8: the surface, a beam, normals with their ellipse, the cone."""
    (panel,) = row_of_panels(1, size)
    view, offsets = _view(panel), slopes(SHOWN, along, across, lean)
    _, outline = ellipse(slopes(COUNTED, along, across, lean))
    toward = -_rounded(_incoming(height))
    start = np.zeros(3)
    cone = _RAY * reflected(outline, height)
    ground = np.array([(-1.0, 0.0, 0.75), (1.0, 0.0, 0.75), (1.0, 0.0, -0.75), (-1.0, 0.0, -0.75)])
    spokes = [np.array([start, cone[k]]) for k in range(0, 64, 8)]
    rays = _RAY * reflected(offsets, height)
    return (
        drawing.load_font(),
        panel.clear(background),
        drawing.polygon("the surface", view, ground, (0.20, 0.21, 0.25)),
        drawing.polygon("within the cone", view, cone[:-1], YELLOW, alpha=0.25),
        drawing.polygon("within the ellipse", view, _normals(outline)[:-1], VIOLET, alpha=0.3),
        drawing.strokes("the cone", view, spokes, YELLOW, width=1.0),
        drawing.stroke("the cone's rim", view, cone, YELLOW, width=1.8),
        drawing.dots("reflected rays", view, rays, GREEN, radius=1.5),
        drawing.strokes("normals", view, [np.array([start, n]) for n in _normals(offsets[::6])], FAINT),
        drawing.dots("ends of normals", view, _normals(offsets), VIOLET, radius=1.0),
        drawing.stroke("the ellipse of K", view, _normals(outline), INK, width=1.4),
        drawing.arrow("the viewing beam", view, (_RAY * toward, start), BLUE, width=3.0),
        drawing.arrow("n", view, (start, _normals(np.zeros((1, 2)))[0]), INK, width=2.0),
        drawing.text("beam", view, _RAY * toward, BLUE, offset=(4.0, 8.0)),
        drawing.text("normals", view, _normals(outline)[16], VIOLET, offset=(-8.0, 12.0)),
        drawing.text("reflected beam", view, cone[32], YELLOW, align=(0, -1), offset=(-16.0, 26.0)),
    )


def checks(figure, renderer):
    """How much of the slopes the ellipse holds, of its mirrored image the rays, and where both are drawn."""
    values = dict(figure.values)
    background, height = values.pop("background"), values.pop("height")
    del background
    offsets = slopes(COUNTED, **values)
    mean = offsets.mean(axis=0)
    a, b, c = rough.products(offsets - mean).mean(axis=0)
    x, y = (offsets - mean).T
    square = (c * x * x - 2.0 * b * x * y + a * y * y) / (a * c - b * b)
    yield DATA.check(
        "share of normals within the ellipse, off 1 - exp(-1/2)",
        abs(float((square <= 1.0).mean()) - (1.0 - math.exp(-0.5))),
        Answer.IDEAL,
    )
    # To first order the cone's rim is the ellipse by J_r: rays within it are the same share.
    _, by_offset = mirrored(_incoming(height), mean, FRAME)
    apart = mirrored(np.broadcast_to(_incoming(height), (COUNTED, 3)), offsets, FRAME)[0]
    apart = apart - mirrored(_incoming(height), mean, FRAME)[0]
    frame = normalize(by_offset)
    lengths = np.sqrt(dot(by_offset, by_offset))
    u, v = dot(apart, frame[0]) / lengths[0], dot(apart, frame[1]) / lengths[1]
    square = (c * u * u - 2.0 * b * u * v + a * v * v) / (a * c - b * b)
    yield DATA.check(
        "share of reflected rays within the cone, off 1 - exp(-1/2)",
        abs(float((square <= 1.0).mean()) - (1.0 - math.exp(-0.5))),
        Answer.IDEAL,
    )
    view = _view(row_of_panels(1, figure.size // 2)[0])
    _, outline = ellipse(slopes(COUNTED, **values))
    marks = [(0, view, 0.75 * _RAY * -_rounded(_incoming(height)), BLUE)]
    rim = reflected(outline[::8], height)
    # Where no dot lies on the rim.
    dots = reflected(slopes(SHOWN, **values), height)
    free = max(rim, key=lambda r: float(dot(dots - r, dots - r).min()))
    marks += [(0, view, _RAY * free, YELLOW)]
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "along": SLOPE(0.14, "The normals' deviation along the first axis."),
        "across": SLOPE(0.07, "Their deviation along the second."),
        "lean": word.of(word.Number(-0.5, 0.5), 0.07, "By how much the second goes with the first."),
        "height": word.of(word.Number(10.0, 90.0), 58.0, "How high the beam comes from.", "degrees"),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

"""F000-1: the vectors and angles of reflection at a rough surface."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.reflectance.brdfs import half_vector

DATA = figure_data(__file__, "F000-1")

EYE, CENTER, FIELD = (0.9, 1.7, 4.4), (0.0, 0.38, 0.0), 25.0
NORMAL = np.array([0.0, 1.0, 0.0])
COLORS = {"n": VIOLET, "l": YELLOW, "v": BLUE, "h": GREEN}
# Which two vectors each angle lies between, and how far out its arc is drawn.
ANGLES = {
    "alpha": ("n", "l", 0.42),
    "beta": ("n", "v", 0.52),
    "theta": ("l", "h", 0.68),
    "delta": ("n", "h", 0.82),
}


def vectors(light, view):
    """n, l, v and h by name: float64 [3] each, of length one."""
    toward_light, toward_viewer = (
        unit_vector(light, "The light's direction"),
        unit_vector(view, "The viewer's"),
    )
    half = half_vector(toward_light, toward_viewer)
    return {"n": NORMAL, "l": toward_light, "v": toward_viewer, "h": half}


def angle(first, second):
    """Between two vectors of length one, degrees, by both sine and cosine."""
    across = cross(first, second)
    return math.degrees(math.atan2(math.sqrt(float(dot(across, across))), float(dot(first, second))))


def arc(first, second, radius):
    """Points of an angle's arc in the vectors' plane: float64 [33, 3]."""
    aside = normalize(second - dot(first, second) * first)
    return drawing.arc(np.zeros(3), 0.0, angle(first, second), radius * first, radius * aside)


def _view(panel):
    return perspective_view(panel, EYE, CENTER, FIELD)


def _rough(count=48):
    """A profile of facets along the surface's front edge: float64 [count, 3]."""
    x = np.linspace(-1.0, 1.0, count)
    height = 0.035 * (np.abs((np.arange(count) * 7) % 5 - 2.0) - 1.0)
    return np.stack([x, height, np.full(count, 0.6)], axis=-1)


def scene(profile, size, *, light, view, background):
    """F000-1: arrows, arcs and their names over a patch of rough surface."""
    (panel,) = row_of_panels(1, size)
    seen, named = _view(panel), vectors(light, view)
    patch = np.array([(-1.0, 0.0, 0.6), (1.0, 0.0, 0.6), (1.0, 0.0, -0.6), (-1.0, 0.0, -0.6)])
    out = [
        drawing.load_font(),
        panel.clear(background),
        drawing.polygon("the surface", seen, patch, (0.22, 0.23, 0.27)),
        drawing.stroke("its facets", seen, _rough(), FAINT, width=2.2),
    ]
    for name, (first, second, radius) in ANGLES.items():
        points = arc(named[first], named[second], radius)
        out.append(drawing.stroke(f"{name}, between {first} and {second}", seen, points, RED, width=1.6))
        # A narrow angle's name stands beside it.
        narrow = name == "delta"
        place, align = (points[-1], (1, 0)) if narrow else (points[len(points) // 2], (0, 0))
        offset = (-8.0, 4.0) if narrow else (0.0, 8.0)
        out.append(drawing.text(name, seen, place, RED, align=align, offset=offset, outline=background))
    for name, vector in named.items():
        out.append(drawing.arrow(name, seen, (np.zeros(3), vector), COLORS[name], width=2.8))
        out.append(
            drawing.text(name, seen, 1.06 * vector, COLORS[name], offset=(0.0, 4.0), outline=background)
        )
    return tuple(out)


def checks(figure, renderer):
    """The half vector, the angles, and the arcs that are drawn."""
    values = {k: figure.values[k] for k in ("light", "view")}
    named = vectors(**values)
    total = named["l"] + named["v"]
    length = math.sqrt(float(dot(total, total)))
    off = float(np.abs(named["h"] - total / length).max())
    yield DATA.check("h - (l + v)/|l + v|, largest", off, Answer.IDEAL)
    apart = math.radians(abs(angle(named["l"], named["h"]) - angle(named["v"], named["h"])))
    yield DATA.check("angle (l, h) - angle (v, h)", apart, Answer.IDEAL)
    marks, view = [], _view(row_of_panels(1, figure.size // 2)[0])
    for first, second, radius in ANGLES.values():
        # An arc's middle is along the sum of its two vectors; its ends lie on them.
        a, b = named[first], named[second]
        points = arc(a, b, radius)
        ends = max(float(np.abs(points[0] - radius * a).max()), float(np.abs(points[-1] - radius * b).max()))
        yield DATA.check(
            "the arc from {first} to {second}: its ends off both",
            ends,
            Answer.IDEAL,
            first=first,
            second=second,
        )
        # Three quarters of the way, where no name and no other arrow is.
        quarter = normalize(b + normalize(a + b))
        marks.append((0, view, radius * quarter, RED))
    marks += [(0, view, 0.93 * v if k in "lv" else 0.62 * v, COLORS[k]) for k, v in named.items()]
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.LIGHT((-0.88, 0.40, 0.25)),
        "view": word.of(word.DIRECTION_KIND, (0.55, 0.80, -0.25), "The direction to the viewer."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

"""F002-3: diagram: by dependent tests the pieces of a path, l, -d_i and v, are the same for every point."""

from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, RED, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F002-3")

_GROUND = (0.23, 0.25, 0.29)
# How long the pieces are that come from the light and go to the eye.
_LONG = 0.62
_STEPS = 240
# The ends of what is drawn of the ground.
_LEFT, _RIGHT = -0.98, 0.98


def ground(x):
    """The height of the ground at x: hills of two lengths."""
    x = np.asarray(x, np.float64)
    return -0.28 + 0.42 * sine(6.3 * x + 0.9) + 0.13 * sine(12.9 * x + 2.2)


def _along(degrees):
    return np.array([float(cosine(np.radians(degrees))), float(sine(np.radians(degrees)))])


def _profile():
    x = _LEFT + (_RIGHT - _LEFT) * np.arange(_STEPS + 1) / _STEPS
    return np.stack([x, ground(x)], axis=-1)


def seen_from(point, direction):
    """The point, [2], where a ray from a point of the ground meets it again; None: it does not.

    The ray is tested against every piece of the drawn profile.
    """
    line = _profile()
    a, along = line[:-1], line[1:] - line[:-1]
    across = direction[0] * along[:, 1] - direction[1] * along[:, 0]
    to = a - point
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (to[:, 0] * along[:, 1] - to[:, 1] * along[:, 0]) / across
        share = (to[:, 0] * direction[1] - to[:, 1] * direction[0]) / across
    met = (across != 0.0) & (share >= 0.0) & (share <= 1.0) & (distance > 0.03)
    return point + distance[met].min() * direction if met.any() else None


def paths(points, directions):
    """(p, direction, q or None) of each path: p on the drawn ground."""
    line = _profile()
    out = []
    for x, degrees in zip(points, directions, strict=True):
        p = np.array([x, np.interp(x, line[:, 0], line[:, 1])])
        out.append((p, _along(degrees), seen_from(p, _along(degrees))))
    return out


def _view(panel):
    return drawing.sheet(panel, 1.0)


def _label(name, view, place, color, align, background, offset=(0.0, 0.0)):
    return drawing.text(name, view, place, color, align=align, offset=offset, outline=background)


def _panel(view, drawn, light, eye, background):
    """One panel's commands: the ground, and every path's pieces."""
    line, to_light, to_eye = _profile(), _along(light), _along(eye)
    strips = [
        np.array([(x0, -0.97), (x1, -0.97), (x1, y1), (x0, y0)]) for (x0, y0), (x1, y1) in pairwise(line)
    ]
    out = [
        view.panel.clear(background),
        drawing.polygons("the ground", view, strips, _GROUND),
        drawing.stroke("the height field", view, line, FAINT, width=1.6),
    ]
    for p, d, q in drawn:
        out.append(drawing.arrow("v", view, (p, p + _LONG * to_eye), BLUE, width=2.0))
        if q is None:
            out.append(drawing.arrow("nothing is met", view, (p, p + _LONG * d), FAINT, dash=drawing.DASH))
        else:
            out.append(drawing.arrow("l", view, (q + _LONG * to_light, q), YELLOW, width=2.0))
            out.append(drawing.arrow("-d_i", view, (q, p), RED, width=2.0))
            out.append(drawing.dots("q", view, q, GREEN))
        out.append(drawing.dots("p", view, p, INK))
    p, _, q = drawn[0]
    if q is not None:
        # Above all arrows.
        out += (
            _label("p", view, p, INK, (1, 1), background, (-5.0, -4.0)),
            _label("q", view, q, GREEN, (-1, 1), background, (7.0, -5.0)),
            _label("l", view, q + 0.6 * _LONG * to_light, YELLOW, (-1, -1), background, (5.0, 2.0)),
            _label("-d_i", view, 0.72 * p + 0.28 * q, RED, (0, -1), background, (2.0, 5.0)),
            _label("v", view, p + 0.7 * _LONG * to_eye, BLUE, (1, 0), background, (-6.0, 0.0)),
        )
    return out


def both(values):
    """The paths of the two panels: directions of each point's own, and one for all."""
    points = values["points"]
    return paths(points, values["own"]), paths(points, (values["direction"],) * len(points))


def scene(profile, size, *, points, own, direction, light, eye, background):
    """Random paths, and the paths of dependent tests."""
    out = [drawing.load_font()]
    pairs = both({"points": points, "own": own, "direction": direction})
    for panel, drawn in zip(row_of_panels(2, size), pairs, strict=True):
        out += _panel(_view(panel), drawn, light, eye, background)
    return tuple(out)


# ---------------------------------------------------------------------------------------------- checks


def _first_below(point, direction):
    """Where a ray from a point of the ground is below it for the first time, by short steps on the
    equation: its length, or None.
    """
    t = np.arange(0.03, 3.0, 1e-4)
    x, y = point[0] + t * direction[0], point[1] + t * direction[1]
    below = np.flatnonzero((y < ground(x) - 1e-3) & (np.abs(x) < _RIGHT))
    return float(t[below[0]]) if len(below) else None


def checks(figure, renderer):
    """The rays by steps on the ground's equation, that all pieces are free, and the marks."""
    values = figure.values
    to_light, to_eye = _along(values["light"]), _along(values["eye"])
    apart, shut, missed = 0.0, 0, 0
    for p, d, q in (path for drawn in both(values) for path in drawn):
        length = _first_below(p, d)
        if (length is None) != (q is None):
            missed += 1
        elif q is not None:
            apart = max(apart, float(np.abs(p + length * d - q).max()))
            shut += _first_below(q, to_light) is not None
        shut += _first_below(p, to_eye) is not None
    yield DATA.check(
        "points q from where short steps on the ground's equation meet it, largest distance",
        apart,
        Answer.IDEAL,
    )
    yield DATA.check(
        (
            "paths that meet something in one way and nothing in the other, and pieces l and v "
            "that are not free"
        ),
        missed + shut,
        Answer.IDEAL,
    )
    own, same = both(values)
    angles = [{round(float(np.degrees(np.arctan2(*(q - p)[::-1]))), 6) for p, _, q in drawn if q is not None}
              for drawn in (own, same)]  # fmt: skip
    yield DATA.check("different directions from p to q by dependent tests", len(angles[1]), Answer.IDEAL)
    yield DATA.check("different directions from p to q of random paths", len(angles[0]), Answer.IDEAL)
    marks, size = [], figure.size // 2
    for number, drawn in enumerate((own, same)):
        view = _view(row_of_panels(2, size)[number])
        for p, _, q in drawn:
            marks.append((number, view, p, INK))
            if q is not None:
                marks.append((number, view, 0.35 * p + 0.65 * q, RED))
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "points": word.of(
            word.Several((word.Number(-0.95, 0.95),) * 4),
            (-0.62, -0.46, 0.40, 0.54),
            "Where the points p are.",
        ),
        "own": word.of(
            word.Several((word.Number(0.0, 180.0),) * 4),
            (6.0, 58.0, 14.0, 46.0),
            "Each point's own direction, from the right upwards.",
            "degrees",
        ),
        "direction": word.DEGREES(24.0, "The direction d_i of all.", low=0.0, high=180.0),
        "light": word.DEGREES(118.0, "The direction to the light.", low=0.0, high=180.0),
        "eye": word.DEGREES(75.0, "The direction to the eye.", low=0.0, high=180.0),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

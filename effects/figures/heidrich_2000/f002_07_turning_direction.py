"""F002-7, a diagram: a point sees another across a valley; where the base is bent the direction turns."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, DASH, FAINT, GREEN, INK, RED, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.scattering.curved_base import Base, moved

DATA = figure_data(__file__, "F002-7")

# Half the width of what is drawn of the ridges and their base, in periods; flanks of 45 degrees, one period.
_REACH, _STEPS = 0.98, 120
_BODY = (0.15, 0.16, 0.19)


def height(x):
    """The ridges at x [...], in periods: 0 in the valley at 0."""
    return np.abs(x - np.floor(x + 0.5))


def profile_of(base, h):
    """Points [n, 2] of the line at heights ``h(x)`` over the base."""
    x = np.linspace(-_REACH, _REACH, 2 * _STEPS + 1)
    # The ridges' corners are among them.
    x = np.sort(np.concatenate([x, (-0.5, 0.0, 0.5)]))
    return base.placed(np.stack([x, 0.0 * x, h(x)], axis=-1))[:, [0, 2]]


def places(base, at):
    """p and q on either side of the valley at the same height, and their bases: float64 [4, 2]."""
    points = [(-at, 0.0, at), (at, 0.0, at), (-at, 0.0, 0.0), (at, 0.0, 0.0)]
    return base.placed(points)[:, [0, 2]]


def turned(base, at):
    """The direction from p to q in p's frame on the bent base, as the visibility's direction (1, 0, 0) turns:
    float64 [3].
    """
    return moved(base, np.array([(1.0, 0.0, 0.0)]), np.array([2.0 * at]), np.array(at))[0]


def in_panel(base, vector, x):
    """A vector [3] of the frame at x in the panel's coordinates: float64 [2]."""
    t, b, n = base.frames(x, 0.0)
    return (vector[0] * t + vector[1] * b + vector[2] * n)[[0, 2]]


def make(profile, size, *, curvatures, at):
    """A panel for each curvature; p's frame and the points that p sees are drawn in the base's frame at the
    valley.
    """
    commands = [drawing.load_font()]
    for panel, curvature in zip(row_of_panels(3, size), curvatures, strict=True):
        base = Base((curvature, 0.0))
        view = drawing.sheet(panel, 0.95, (0.0, 0.17))
        p, q, p_base, q_base = places(base, at)
        surface, below = profile_of(base, height), profile_of(base, lambda x: 0.0 * x)
        deep = profile_of(base, lambda x: 0.0 * x - 0.3)
        up_p, up_q = (in_panel(base, (0.0, 0.0, 1.0), x) for x in (-at, at))
        level = in_panel(base, (1.0, 0.0, 0.0), -at)
        normal = 0.34
        # The label of d keeps out of the dashed direction's way.
        side = 1 if curvature >= 0.0 else -1
        quads = [
            np.array([deep[k], deep[k + 1], surface[k + 1], surface[k]]) for k in range(len(surface) - 1)
        ]
        commands += [
            panel.clear(BACKGROUND),
            drawing.polygons("what lies below", view, quads, _BODY),
            drawing.stroke("the base", view, below, FAINT, dash=DASH),
            drawing.strokes("heights", view, [(p_base, p), (q_base, q)], FAINT, width=1.0),
            drawing.stroke("the ridges", view, surface, INK, width=2.0),
            drawing.arrow("the base's normal at p", view, [p, p + normal * up_p], GREEN),
            drawing.arrow("the base's normal at q", view, [q, q + normal * up_q], GREEN),
        ]
        if curvature != 0.0:
            end = p + 1.05 * (q - p)[0] * level
            commands.append(drawing.arrow("the flat base's d", view, [p, end], BLUE, dash=DASH))
        commands += [
            drawing.arrow("d", view, [p, q], YELLOW, width=2.0),
            drawing.dots("p and q", view, [p, q], RED, radius=4.0),
            drawing.text("p", view, p, RED, align=(1, 1), offset=(-7.0, -5.0)),
            drawing.text("q", view, q, RED, align=(-1, 1), offset=(7.0, -5.0)),
            drawing.text("d", view, 0.5 * (p + q), YELLOW, align=(0, side), offset=(0.0, -6.0 * side)),
        ]
    return tuple(commands)


def _angle(a, b):
    """Between vectors, in radians, of their lengths and product alone."""
    return math.acos(float(dot(a, b)) / math.sqrt(float(dot(a, a)) * float(dot(b, b))))


# Curvature times distance in which the law is asked for: small angles, in radians.
_SMALL = (0.02, 0.05, 0.1, 0.2)


def checks(figure, renderer):
    """The law of small angles, the turn in the picture against it, and the marks."""
    at = figure.values["at"]
    apart, half = 0.0, 0.0
    for angle in _SMALL:
        for sign in (-1.0, 1.0):
            base = Base((sign * angle / (2.0 * at), 0.0))
            d = turned(base, at)
            # The same line, from q, beside q's own horizon.
            _, _, up = base.frames(2.0 * at, 0.0)
            at_p, at_q = -math.asin(d[2]), math.asin(float(dot(d, up)))
            apart = max(apart, abs((at_p + at_q) / (sign * angle) - 1.0))
            half = max(half, abs(at_p / (0.5 * sign * angle) - 1.0))
    yield DATA.check(
        (
            "turn of d against the horizons of p and q together, beside curvature times "
            "distance: largest relative error"
        ),
        apart,
        Answer.IDEAL,
    )
    yield DATA.check(
        "turn against the horizon of p alone, beside half of that: largest relative error", half, Answer.IDEAL
    )
    for curvature in figure.values["curvatures"]:
        base = Base((curvature, 0.0))
        p, q, _, _ = places(base, at)
        drawn = np.array([*(q - p), 0.0])
        expected = np.array([*in_panel(base, turned(base, at), -at), 0.0])
        yield DATA.check(
            ("curvature {curvature:g}: angle between the arrow drawn and the direction that has turned"),
            _angle(drawn, expected),
            Answer.IDEAL,
            curvature=curvature,
        )
    yield from drawn_check(figure, renderer, _marks(figure))


def _marks(figure):
    out = []
    for number, (panel, curvature) in enumerate(
        zip(row_of_panels(3, figure.size // 2), figure.values["curvatures"], strict=True)
    ):
        base = Base((curvature, 0.0))
        view = drawing.sheet(panel, 0.95, (0.0, 0.17))
        p, q, _, _ = places(base, figure.values["at"])
        up = in_panel(base, (0.0, 0.0, 1.0), -figure.values["at"])
        out += [(number, view, p, RED), (number, view, q, RED), (number, view, 0.5 * (p + q), YELLOW)]
        out.append((number, view, p + 0.2 * up, GREEN))
    return out


FIGURE = Figure(
    **DATA.words,
    parameters={
        "curvatures": word.of(
            word.Several((word.Number(-0.9, 0.9),) * 3, what="three numbers from -0.9 to 0.9"),
            (0.0, 0.6, -0.6),
            "The base's curvature across the valley, a panel each; positive is convex.",
            "1 / period",
        ),
        "at": word.of(
            word.Number(0.05, 0.45), 0.33, "How far p and q are from the valley's bottom.", "periods"
        ),
    },
    methods=(Method("strokes", make, DIAGRAM_MACHINES),),
    acceptance=checks,
)

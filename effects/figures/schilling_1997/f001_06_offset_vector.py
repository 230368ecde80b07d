"""F001-6: a bump's normal as the surface's and an offset vector, on a piece of a displaced surface."""

from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import offset_vectors
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, GREEN, INK, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels

DATA = figure_data(__file__, "F001-6")

EYE, CENTER, FIELD = (1.5, 1.9, 4.2), (-0.15, 0.45, 0.0), 32.0
_HILL, _LIGHT = (0.38, 0.42, 0.52), normalize(np.array([-0.5, 0.7, 0.5]))
_CELLS, _REACH = 16, 0.85


def _across(u, v):
    """Derivatives of a bent surface's points, p_u and p_v: float64 [..., 3], u to the right, v away."""
    u, v = np.broadcast_arrays(np.asarray(u, np.float64), np.asarray(v, np.float64))
    one, zero = np.ones(u.shape), np.zeros(u.shape)
    return np.stack([one, -0.3 * u, zero], axis=-1), np.stack([zero, -0.16 * v, -one], axis=-1)


def _height(u, v, height):
    """f, a bump of one round hill beside the point, and its derivatives f_u, f_v."""
    x, y = u + 0.24, v - 0.26
    left = np.maximum(1.0 - (x * x + y * y) / 0.55, 0.0)
    slope = -2.0 * left * 2.0 / 0.55 * height
    return height * left * left, slope * x, slope * y


def points(u, v, height):
    """Points of the surface and of the displaced one: float64 [..., 3] each."""
    u, v = np.broadcast_arrays(np.asarray(u, np.float64), np.asarray(v, np.float64))
    flat = np.stack([u, -0.15 * u * u - 0.08 * v * v, -v], axis=-1)
    frame = offset_vectors.normalized(*_across(u, v))
    return flat, flat + _height(u, v, height)[0][..., None] * frame.normal


def vectors(height):
    """n, f_u s_u, f_v s_v and n' at the point (0, 0): float64 [3] each."""
    frame = offset_vectors.natural(*_across(0.0, 0.0))
    _, f_u, f_v = _height(0.0, 0.0, height)
    along = f_u * frame.first, f_v * frame.second
    return frame.normal, *along, offset_vectors.bumped(frame, np.array([f_u, f_v]))


def _view(panel):
    return perspective_view(panel, EYE, CENTER, FIELD)


def _cells(height):
    """The displaced surface's cells, far ones first: outlines [4, 3] and their colours."""
    edge = np.arange(_CELLS + 1) / _CELLS * (2.0 * _REACH) - _REACH
    out = []
    for v, before in zip(edge[:0:-1], edge[-2::-1], strict=True):
        for u, after in pairwise(edge):
            corners = points(np.array([u, after, after, u]), np.array([before, before, v, v]), height)[1]
            normal = normalize(cross(corners[1] - corners[0], corners[3] - corners[0]))
            lit = 0.25 + 0.75 * max(float(dot(normal, _LIGHT)), 0.0)
            out.append((corners, tuple(lit * c for c in _HILL)))
    return out


def scene(profile, size, *, height, background):
    """F001-6: the surface, the bump over it, n, the offset in two parts, and n'."""
    (panel,) = row_of_panels(1, size)
    view = _view(panel)
    n, along_u, along_v, bumped = vectors(height)
    here = points(0.0, 0.0, height)[1]
    tip, corner = here + n, here + n + along_u
    beneath = points(np.linspace(-_REACH, _REACH, 49), 0.0, height)[0]
    foot = points(0.0, 0.0, height)[0]
    out = [
        drawing.load_font(),
        panel.clear(background),
        *(drawing.polygon("p + f n/|n|", view, outline, color) for outline, color in _cells(height)),
        drawing.stroke("the surface beneath", view, beneath, INK, width=1.3, dash=drawing.DASH),
        drawing.stroke("f", view, (foot, here), YELLOW, width=2.0),
        drawing.text("f", view, 0.5 * (foot + here), YELLOW, align=(1, 0), offset=(-4.0, 0.0)),
    ]
    for name, line, color, width in (
        ("n", (here, tip), VIOLET, 2.6),
        ("fu su", (tip, corner), BLUE, 2.4),
        ("fv sv", (corner, corner + along_v), GREEN, 2.4),
        ("n'", (here, here + bumped), RED, 2.8),
    ):
        out.append(drawing.arrow(name, view, line, color, width=width))
    out.append(
        drawing.stroke("the offset vector", view, (tip, here + bumped), YELLOW, width=1.4, dash=drawing.DASH)
    )
    for name, place, color, align, offset in (
        ("n", here + 0.6 * n, VIOLET, (1, 0), (-6.0, 0.0)),
        ("fu su", 0.5 * (tip + corner), BLUE, (0, -1), (0.0, 6.0)),
        ("fv sv", corner + 0.5 * along_v, GREEN, (-1, 1), (6.0, -4.0)),
        ("n'", here + 0.6 * bumped, RED, (-1, 0), (6.0, -3.0)),
    ):
        out.append(drawing.text(name, view, place, color, align=align, offset=offset, outline=background))
    sheet = drawing.sheet(panel, 0.5 * panel.height, (0.5 * panel.width, 0.5 * panel.height))
    for row, words in enumerate(("n' = n + fu su + fv sv", "su = n/|n| x pv,  sv = pu x n/|n|")):
        place = np.array((0.02, 0.105 - 0.06 * row)) * panel.height
        out.append(drawing.text(words, sheet, place, INK, align=(-1, 0)))
    out.append(drawing.dots("the point", view, here, INK, radius=3.4))
    return tuple(out)


# ---------------------------------------------------------------------------------------------- checks


def _by_differences(height, step=1e-5):
    """The displaced surface's normal by differences of its points, as long as n' is to be: float64 [3]."""
    along = points(step, 0.0, height)[1] - points(-step, 0.0, height)[1]
    away = points(0.0, step, height)[1] - points(0.0, -step, height)[1]
    return np.cross(along, away) / (4.0 * step * step)


def checks(figure, renderer):
    """Blinn's cross product, the surface by differences, and the arrows."""
    height = figure.values["height"]
    n, along_u, along_v, bumped = vectors(height)
    p_u, p_v = _across(0.0, 0.0)
    _, f_u, f_v = _height(0.0, 0.0, height)
    up = n / np.sqrt((n * n).sum())
    product = cross(p_u + f_u * up, p_v + f_v * up)
    yield DATA.check(
        "n' - (p_u + f_u n/|n|) x (p_v + f_v n/|n|), largest",
        float(np.abs(bumped - product).max()),
        Answer.IDEAL,
    )
    apart = np.cross(bumped, _by_differences(height))
    sine = np.sqrt((apart * apart).sum() / ((bumped**2).sum() * (_by_differences(height) ** 2).sum()))
    yield DATA.check(
        "angle of n' from the drawn surface's normal by differences, degrees",
        float(np.degrees(np.arcsin(sine))),
        Answer.IDEAL,
    )
    # Uphill lies to the left: n' leans to the right, away from the hill (E001.9).
    yield DATA.check(
        "n' along the way downhill, from n", float(-(bumped - n) @ (f_u * p_u + f_v * p_v)), Answer.IDEAL
    )
    view, here = _view(row_of_panels(1, figure.size // 2)[0]), points(0.0, 0.0, height)[1]
    yield from drawn_check(
        figure,
        renderer,
        [
            (0, view, here + 0.4 * n, VIOLET),
            (0, view, here + 0.5 * bumped, RED),
            (0, view, here + n + 0.4 * along_u, BLUE),
            (0, view, here + n + along_u + 0.4 * along_v, GREEN),
        ],
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "height": word.NUMBER(0.42, "How high the hill is.", low=0.05, high=1.0),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

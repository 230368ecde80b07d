"""F001-17: the angle between normal and halfway vector, and how the roughness changes it."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.reflectance import rough_highlights as shine
from fixedpipe.effects.reflectance.rough_highlights import Form

DATA = figure_data(__file__, "F001-17")

PANELS = ("less than one", "more than one")
EYE, CENTER, FIELD = (1.4, 1.35, 3.6), (0.06, 0.42, 0.0), 30.0


def _view(panel):
    return perspective_view(panel, EYE, CENTER, FIELD)


def _world(vectors):
    """(e_1, e_2, n) as the diagram's right, away and up."""
    x, y, z = np.moveaxis(np.asarray(vectors, np.float64), -1, 0)
    return np.stack([x, z, -y], axis=-1)


def unit_vectors(angle, toward):
    """h, ``angle`` degrees from n towards ``toward`` degrees of e_1, and d's unit vector: float64 [3] and
    [2].
    """
    a, b = np.radians(angle), np.radians(toward)
    u = np.array([float(cosine(b)), float(sine(b))])
    return np.array([float(sine(a)) * u[0], float(sine(a)) * u[1], float(cosine(a))]), u


def changed(angle, toward, deviations):
    """(h, h', d) where the angle becomes a' by D^-1: the turned halfway vector in the plane of n and h."""
    h, u = unit_vectors(angle, toward)
    k = np.array([deviations[0] * deviations[0], 0.0, deviations[1] * deviations[1]])
    d = shine.apart(h, np.eye(3))
    squared = float(shine.squared_cosine(d, k, Form.CORRECTED))
    across = np.sqrt(1.0 - squared)
    return h, np.array([across * u[0], across * u[1], np.sqrt(squared)]), d


def _ellipse(deviations, factor):
    points = drawing.arc(
        (0.0, 0.0), 0.0, 360.0, (factor * deviations[0], 0.0), (0.0, factor * deviations[1]), 96
    )
    return _world(np.concatenate([points, np.zeros((len(points), 1))], axis=-1))


def _arc(first, second, radius):
    """Points of the arc between two unit vectors."""
    share = np.arange(33)[:, None] / 32.0
    return radius * normalize((1.0 - share) * first + share * second)


def scene(profile, size, *, angle, toward, small, large, background):
    """F001-17: n, h, d and K's ellipse in the plane, and h turned to a'."""
    out = [drawing.load_font()]
    for name, panel, deviations in zip(PANELS, row_of_panels(2, size), (small, large), strict=True):
        view, up = _view(panel), np.array([0.0, 0.0, 1.0])
        h, turned, d = changed(angle, toward, deviations)
        flat = np.array([d[0], d[1], 0.0])
        reach = 0.85
        square = _world(reach * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]))
        sheet = drawing.sheet(panel)
        out += [
            panel.clear(background),
            drawing.polygon("the surface", view, square, (0.15, 0.17, 0.22)),
            drawing.polygon("K's ellipse", view, _ellipse(deviations, 0.5)[:-1], YELLOW, alpha=0.25),
            drawing.stroke("K's ellipse", view, _ellipse(deviations, 0.5), YELLOW, width=1.4),
            drawing.stroke("h above d", view, _world([h, flat]), FAINT, dash=drawing.DASH),
            drawing.stroke("n to h", view, _world([up, h]), FAINT, dash=drawing.DASH),
            drawing.stroke("a", view, _world(_arc(up, h, 0.45)), BLUE, width=1.8),
            drawing.stroke("a'", view, _world(_arc(up, turned, 0.66)), RED, width=1.8),
            drawing.arrow("d", view, _world([0.0 * flat, flat]), GREEN, width=2.4),
            drawing.arrow("n", view, _world([0.0 * up, up]), VIOLET, width=2.6),
            drawing.arrow("h", view, _world([0.0 * h, h]), BLUE, width=2.6),
            drawing.arrow("h'", view, _world([0.0 * h, turned]), RED, width=2.6),
            drawing.dots("the point", view, _world(0.0 * up), INK),
        ]
        marks = (
            ("n", up, VIOLET, (1, 0), (-6.0, 0.0)),
            ("h, a", h, BLUE, (-1, 0), (6.0, 0.0)),
            ("h', a'", turned, RED, (-1, -1), (5.0, 3.0)),
            ("d", flat, GREEN, (0, 1), (0.0, -5.0)),
        )
        for text, place, color, align, offset in marks:
            out.append(
                drawing.text(text, view, _world(place), color, align=align, offset=offset, outline=background)
            )
        out.append(drawing.text(f"deviation along d {name}", sheet, (-0.94, 0.9), INK, align=(-1, 0)))
        out.append(drawing.text("K's ellipse, by half", sheet, (-0.94, -0.9), YELLOW, align=(-1, 0)))
    return tuple(out)


def _squared(d, deviation, form):
    k = np.array([deviation * deviation, 0.0, deviation * deviation])
    return shine.squared_cosine(d, k, form)


def checks(figure, renderer):
    """When a' is below a, and by how much, over many angles, directions and covariances; and the arrows."""
    rng = np.random.default_rng(17)
    angle, toward = np.radians(rng.uniform(1.0, 80.0, 4000)), rng.uniform(0.0, 2.0 * np.pi, 4000)
    u = np.stack([np.cos(toward), np.sin(toward)], axis=-1)
    d, root = np.sin(angle)[:, None] * u, rng.uniform(-2.0, 2.0, (4000, 2, 2))
    matrix = root @ root.swapaxes(1, 2)
    k = np.stack([matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 1]], axis=-1)
    deviation = np.sqrt(np.einsum("ni,nij,nj->n", u, matrix, u))
    smaller = shine.squared_cosine(d, k, Form.CORRECTED) > np.cos(angle) ** 2
    yield DATA.check(
        ("random d and K: where a' < a and the deviation along d does not exceed one, or the reverse"),
        int((smaller != (deviation > 1.0)).sum()),
        Answer.IDEAL,
    )
    worst = 0.0
    for size in (0.1, 0.5, 1.0, 2.0):
        squared = shine.squared_cosine_isotropic(d, size)
        tangent = np.sqrt((1.0 - squared) / squared)
        worst = max(worst, float(np.abs(tangent * size / np.tan(angle) - 1.0).max()))
    yield DATA.check("isotropic: tan a' I_1 / tan a - 1, largest", worst, Answer.IDEAL)
    p = figure.values
    for name, deviations, sign in zip(PANELS, (p["small"], p["large"]), (1.0, -1.0), strict=True):
        h, turned, _ = changed(p["angle"], p["toward"], deviations)
        more = np.degrees(np.arccos(turned[2]) - np.arccos(h[2]))
        yield DATA.check(
            "a deviation of {name}: a' beyond a, degrees, with the sign that it has",
            sign * more,
            Answer.IDEAL,
            name=name,
        )
    views = [_view(panel) for panel in row_of_panels(2, figure.size // 2)]
    marks = []
    for number, deviations in enumerate((p["small"], p["large"])):
        h, turned, d = changed(p["angle"], p["toward"], deviations)
        marks.append((number, views[number], _world(0.85 * h), BLUE))
        marks.append((number, views[number], _world(0.85 * turned), RED))
        marks.append((number, views[number], _world(np.array([0.6 * d[0], 0.6 * d[1], 0.0])), GREEN))
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "angle": word.of(word.Number(5.0, 80.0), 42.0, "The angle a.", "degrees"),
        "toward": word.DEGREES(-15.0, "Where h leans, from e_1."),
        "small": word.of(
            word.Several((word.Number(0.2, 2.5),) * 2, what="two numbers from 0.2 to 2.5"),
            (0.55, 1.2),
            "The deviations along e_1 and e_2 of the first panel.",
        ),
        "large": word.of(
            word.Several((word.Number(0.2, 2.5),) * 2, what="two numbers from 0.2 to 2.5"),
            (1.6, 0.8),
            "Those of the second.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

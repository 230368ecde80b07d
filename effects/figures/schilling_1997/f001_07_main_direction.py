"""F001-7: the frame that a normal and a main direction make, on a globe."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.bump_mapping import offset_vectors
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, RED, VIOLET
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, cross, dot, normalize, sine, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels

DATA = figure_data(__file__, "F001-7")

EYE, CENTER, FIELD = (1.9, 1.7, 4.7), (-0.1, 0.16, 0.0), 36.0
# How long the three arrows are, in radii.
LENGTH = 0.72
_LIT, _SHADED = (0.26, 0.28, 0.33), (0.17, 0.18, 0.21)


def _axes(main):
    """m of length one, and the two axes of its equator: longitude zero, as far towards +z as may be, and a
    quarter of a turn east of it. float64 [3] each.
    """
    up = unit_vector(main, "The main direction")
    aside = np.array([0.0, 0.0, 1.0]) if abs(up[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    ahead = normalize(aside - dot(aside, up) * up)
    return up, ahead, cross(up, ahead)


def point(longitude, latitude, main):
    """A point of the unit globe whose axis is m: float64 [3]."""
    up, ahead, right = _axes(main)
    a, b = np.radians(longitude), np.radians(latitude)
    return normalize(cosine(b) * (cosine(a) * ahead + sine(a) * right) + sine(b) * up)


def frame(longitude, latitude, main):
    """n, e_1 and e_2 at that point: float64 [3] each."""
    found = offset_vectors.of_main_direction(point(longitude, latitude, main), main)
    return found.normal, found.first, found.second


def _view(panel):
    return perspective_view(panel, EYE, CENTER, FIELD)


def _seen(points):
    """The runs of a line on the globe that are seen, each [k, 3]."""
    towards = np.array(EYE)
    front = dot(points, towards) > 1.0
    ends = np.flatnonzero(np.diff(front)) + 1
    return [run for run in np.split(points, ends) if dot(run[0], towards) > 1.0 and len(run) > 1]


def _lines(main):
    """Parallels and meridians: lists of lines [97, 3]."""
    turn = np.linspace(-180.0, 180.0, 97)
    parallels = [np.array([point(a, b, main) for a in turn]) for b in range(-60, 61, 30)]
    half = np.linspace(-90.0, 90.0, 97)
    meridians = [np.array([point(a, b, main) for b in half]) for a in range(0, 360, 30)]
    return [run for line in (*parallels, *meridians) for run in _seen(line)]


def _outline():
    """The globe's outline as the eye sees it: a closed line [97, 3]."""
    eye = np.array(EYE)
    distance = float(np.sqrt(dot(eye, eye)))
    toward = eye / distance
    aside = normalize(cross(np.array([0.0, 1.0, 0.0]), toward))
    up, radius = cross(toward, aside), np.sqrt(1.0 - 1.0 / distance**2)
    return drawing.arc(toward / distance, 0.0, 360.0, radius * aside, radius * up, segments=96)


def _half_disc(points):
    """A convex part of the plane of n and m, within the globe's circle: closed by its chord."""
    return np.concatenate([points, np.zeros((1, 3))])


def scene(profile, size, *, longitude, latitude, main, background):
    """F001-7: a globe, m, n and the two vectors across it, the plane of n and m."""
    (panel,) = row_of_panels(1, size)
    view, up = _view(panel), unit_vector(main, "The main direction")
    here = point(longitude, latitude, main)
    n, first, second = frame(longitude, latitude, main)
    ring = _outline()
    quarter = np.array([point(longitude, b, main) for b in np.linspace(latitude, 90.0, 33)])
    parallel = np.array([point(a, latitude, main) for a in np.linspace(-180.0, 180.0, 97)])
    out = [
        drawing.load_font(),
        panel.clear(background),
        drawing.polygon("the globe", view, ring[:-1], _SHADED),
        drawing.stroke("its outline", view, ring, FAINT, width=1.6),
        drawing.strokes("parallels and meridians", view, _lines(main), FAINT, width=0.9),
        # Of a far side's parallel nothing may be seen.
        *(drawing.stroke("the parallel", view, run, BLUE, width=1.6) for run in _seen(parallel)),
        drawing.polygon("the plane of n and m", view, _half_disc(quarter), GREEN, alpha=0.22),
        drawing.stroke("the meridian", view, quarter, GREEN, width=1.8),
        drawing.stroke("from the middle to the point", view, (np.zeros(3), here), VIOLET, dash=drawing.DASH),
        drawing.stroke("the axis", view, (np.zeros(3), up), RED, dash=drawing.DASH),
        drawing.arrow("m", view, (up, (1.0 + 0.6) * up), RED, width=2.8),
        drawing.text("m", view, 1.62 * up, RED, align=(-1, 0), offset=(6.0, 0.0), outline=background),
    ]
    for name, vector, color, align, offset in (
        ("n", n, VIOLET, (0, -1), (0.0, 5.0)),
        ("e1", first, BLUE, (0, 1), (6.0, -6.0)),
        ("e2", second, GREEN, (1, -1), (-4.0, 2.0)),
    ):
        tip = here + LENGTH * vector
        out.append(drawing.arrow(name, view, (here, tip), color, width=2.8))
        out.append(drawing.text(name, view, tip, color, align=align, offset=offset, outline=background))
    out.append(drawing.dots("the point", view, here, drawing.INK, radius=3.4))
    for row, (words, color) in enumerate(
        (("e1 = m x n / |m x n|, eastward", BLUE), ("e2 = n x e1, in the plane of n and m", GREEN))
    ):
        place = np.array((0.02, 0.045 + 0.06 * row)) * panel.height
        sheet = drawing.sheet(panel, 0.5 * panel.height, (0.5 * panel.width, 0.5 * panel.height))
        out.append(drawing.text(words, sheet, place, color, align=(-1, 0)))
    return tuple(out)


def checks(figure, renderer):
    """The catalogue's products, east by differences, and the marks."""
    values = {k: figure.values[k] for k in ("longitude", "latitude", "main")}
    m = unit_vector(values["main"], "The main direction")
    n, first, second = frame(**values)
    products = {
        "e1.n": dot(first, n),
        "e2.n": dot(second, n),
        "e1.e2": dot(first, second),
        "e1.m": dot(first, m),
        "(m x n).e2": dot(cross(m, n), second),
    }
    reason = "the catalogue: at right angles, e2 in the plane of n and m (E001.4)"
    for name, value in products.items():
        yield Check(name, abs(float(value)), at_most=1e-12, on=Answer.IDEAL, reason=reason)
    up, ahead, right = _axes(values["main"])
    a, b = np.radians(values["longitude"]), np.radians(values["latitude"])
    exact = np.cos(b) * (np.cos(a) * ahead + np.sin(a) * right) + np.sin(b) * up
    east = np.cos(a) * right - np.sin(a) * ahead
    off = float(np.abs(offset_vectors.of_main_direction(exact, m).first - east).max())
    yield DATA.check("e1 from east, the derivative by longitude, largest", off, Answer.IDEAL)
    view, here = _view(row_of_panels(1, figure.size // 2)[0]), point(**values)
    colors = (VIOLET, BLUE, GREEN)
    marks = [(0, view, here + 0.6 * LENGTH * v, c) for v, c in zip((n, first, second), colors, strict=True)]
    yield from drawn_check(figure, renderer, [*marks, (0, view, 1.3 * m, RED)])


FIGURE = Figure(
    **DATA.words,
    parameters={
        "longitude": word.DEGREES(-24.0, "The point's longitude, from +z eastward.", low=-180.0, high=180.0),
        "latitude": word.DEGREES(28.0, "The point's latitude.", low=-80.0, high=80.0),
        "main": word.of(word.DIRECTION_KIND, (0.0, 1.0, 0.0), "The main direction m."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

"""F002-6: the ellipse that is fitted to the directions that are free."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, RED, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipses, visibility
from fixedpipe.effects.scattering.height_field import ridges
from fixedpipe.effects.scattering.visibility import FREE

DATA = figure_data(__file__, "F002-6")

_COLUMNS = 32
# In UNITs: of a dot, and of the ring that stands for a shadowed direction.
_DOT, _RING, _RING_WIDTH = 2.4, 2.2, 1.0
# Half the height of a panel, and where its middle is: the disc above, the legend below.
_HALF_HEIGHT, _MIDDLE = 1.32, (0.0, -0.12)


@lru_cache(4)
def _groove(angle, directions):
    """The directions above the horizon [n, 3], what is free of them [n, columns], the Ellipses."""
    field = ridges(_COLUMNS, 2, angle, count=1)
    found = sphere.spiral(directions)
    seen = visibility.precompute(field, found[found[:, 2] > 0.0])
    return seen.directions, seen.seen[:, 0] == FREE, ellipses.of_visibility(seen, turned_away_counts=True)


def _texel(fitted, column):
    """Centre, axis, the axis across, both radii of one texel."""
    center, axis, radii = (getattr(fitted, name)[0, column] for name in ("center", "axis", "radii"))
    # Upwards, as it is drawn.
    axis = -axis if axis[1] < 0.0 else axis
    return center, axis, np.array((axis[1], -axis[0])), radii


def _view(panel):
    return drawing.sheet(panel, _HALF_HEIGHT, _MIDDLE)


def _rings(label, view, points, color):
    """Hollow dots."""
    radius = _RING * 2.0 * _HALF_HEIGHT / drawing.UNIT
    circles = [drawing.arc(p, 0.0, 360.0, (radius, 0.0), (0.0, radius), 12) for p in points]
    return drawing.strokes(label, view, circles, color, width=_RING_WIDTH)


def _key(view, row, words, color, hollow=False):
    """A line of the legend."""
    place = np.array((-0.95, -1.16 - 0.125 * row))
    mark = _rings if hollow else lambda *given: drawing.dots(*given, radius=_DOT)
    text = drawing.text(words, view, place, color, align=(-1, 0), offset=(6.0, 0.0))
    return mark(f"{words}: the mark", view, place[None], color), text


def _panel(view, directions, free, fitted, column, background):
    center, axis, across, (r1, r2) = _texel(fitted, column)
    points = directions[:, :2]
    horizon = drawing.arc((0.0, 0.0), 0.0, 360.0, segments=96)
    edge = drawing.arc(center, 0.0, 360.0, r1 * axis, r2 * across, segments=96)
    ends = center + r1 * axis, center + r2 * across
    return (
        view.panel.clear(background),
        drawing.polygon("the ellipse's inside", view, edge[:-1], GREEN, alpha=0.13),
        drawing.stroke("the horizon", view, horizon, FAINT),
        drawing.stroke("the ellipse", view, edge, GREEN, width=1.8),
        _rings("shadowed", view, points[~free[:, column]], BLUE),
        drawing.dots("free", view, points[free[:, column]], YELLOW, radius=_DOT),
        drawing.arrow("r1 a", view, (center, ends[0]), RED, width=2.0),
        drawing.stroke("r2", view, (center, ends[1]), RED, width=2.0),
        drawing.dots("c", view, center, INK, radius=3.2),
        *(
            drawing.text(name, view, place, color, align=align, offset=offset, outline=background)
            for name, place, color, align, offset in (
                ("c", center, INK, (1, 1), (-5.0, -3.0)),
                ("a", ends[0], RED, (1, 1), (-6.0, -3.0)),
                ("r1", 0.5 * (center + ends[0]), RED, (1, 0), (-5.0, 0.0)),
                ("r2", 0.5 * (center + ends[1]), RED, (0, 1), (0.0, -5.0)),
            )
        ),
        *_key(view, 0, "free", YELLOW),
        *_key(view, 1, "shadowed, or turned away", BLUE, hollow=True),
    )


def scene(profile, size, *, angle, directions, columns, background):
    """Two texels of a groove: near its bottom, and high on its flank."""
    found, free, fitted = _groove(angle, directions)
    out = [drawing.load_font()]
    for panel, column in zip(row_of_panels(2, size), columns, strict=True):
        out += _panel(_view(panel), found, free, fitted, column, background)
    return tuple(out)


def checks(figure, renderer):
    """The share of directions on their side by the drawn radii, and the marks."""
    columns = figure.values["columns"]
    found, free, fitted = _groove(figure.values["angle"], figure.values["directions"])
    size, marks = figure.size // 2, []
    for number, column in enumerate(columns):
        center, axis, across, radii = _texel(fitted, column)
        along = (found[:, 0] - center[0]) * axis[0] + (found[:, 1] - center[1]) * axis[1]
        aside = (found[:, 0] - center[0]) * across[0] + (found[:, 1] - center[1]) * across[1]
        inside = (along / radii[0]) ** 2 + (aside / radii[1]) ** 2 <= 1.0
        yield DATA.check(
            "directions on their side of the ellipse, column {column} of {columns}",
            float((inside == free[:, column]).mean()),
            Answer.IDEAL,
            column=column,
            columns=_COLUMNS,
        )
        cut = _cut_off(figure.values["angle"], column, found)
        yield DATA.check(
            ("directions that a groove that goes on for ever hides, or not, as rays say, column {column}"),
            float((cut == ~free[:, column]).mean()),
            Answer.IDEAL,
            column=column,
        )
        view = _view(row_of_panels(2, size)[number])
        # Marks that no other lies on: the middle of the centre's dot, a free direction outside of the rest.
        marks.append((number, view, center, INK))
        marks.append((number, view, center + 0.7 * radii[0] * axis, RED))
        marks.append((number, view, center + 0.8 * radii[1] * across, RED))
    yield from drawn_check(figure, renderer, marks)


def _cut_off(angle, column, found):
    """Which directions the flanks of an endless groove hide from a texel: bool [n].

    The field between texels' centres is straight but at the ridge and in the valley, which lie between two
    columns of one height: the edge that hides is the nearer of these.
    """
    half = _COLUMNS // 2
    slope = np.tan(np.radians(angle))
    height = (np.arange(_COLUMNS) + 0.5) / _COLUMNS
    height = np.where(np.arange(_COLUMNS) < half, height, 1.0 - height) * slope
    x, z = found[:, 0], found[:, 2]
    steep = np.zeros(len(found), bool)
    for step in range(1, 2 * _COLUMNS):
        for sign in (1, -1):
            other = height[(column + sign * step) % _COLUMNS]
            over = (other - height[column]) / (step / _COLUMNS)
            steep |= (sign * x > 0.0) & (z < over * np.abs(x))
    turned = (np.where(column < half, -1.0, 1.0) * slope * x + z) <= 0.0
    return steep | turned


FIGURE = Figure(
    **DATA.words,
    parameters={
        "angle": word.DEGREES(45.0, "How steep the groove's flanks are.", low=5.0, high=80.0),
        "directions": word.of(
            word.Whole(16, 1000), 200, "Directions over the whole sphere along which rays are cast."
        ),
        "columns": word.of(
            word.Several((word.Whole(0, _COLUMNS - 1),) * 2),
            (1, 11),
            "The two texels: columns, of 32 from a valley over the ridge to the next.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

"""F000-8: rays from a texel of a groove, and the ellipse that is fitted to them as seen from above."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, RED, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipses, visibility
from fixedpipe.effects.scattering.height_field import ridges
from fixedpipe.effects.scattering.visibility import BACK, FREE

DATA = figure_data(__file__, "F000-8")

COLUMNS = 32
# How long a ray is that meets nothing, in edges of the groove; and how far the groove is drawn along itself.
_FREE_LENGTH, _HALF_GROOVE = 0.5, 0.9
_EYE, _CENTER = (0.3, 1.15, 2.2), (0.0, 0.2, 0.0)
_LEFT_FLANK, _RIGHT_FLANK = (0.33, 0.36, 0.42), (0.23, 0.25, 0.31)


@lru_cache(4)
def groove(angle, directions):
    """The HeightField; the directions above the horizon [n, 3]; the texels that each column sees along them
    [n, columns], and their distances; and the Ellipses.
    """
    field = ridges(COLUMNS, 2, angle, count=1)
    found = sphere.spiral(directions)
    seen = visibility.precompute(field, found[found[:, 2] > 0.0])
    away = visibility.distances(field, seen)[:, 0]
    return (
        field,
        seen.directions,
        seen.seen[:, 0],
        away,
        ellipses.of_visibility(seen, turned_away_counts=True),
    )


def place(field, column):
    """Where a texel's centre is: x from the groove's bottom, its height."""
    x = (column + 0.5) / COLUMNS
    return np.array([x if x < 0.5 else x - 1.0, 0.0, field.heights[0, column]])


def ends(values):
    """The texel's place [3], and where rays end [n, 3]: where they meet the groove, or in the open."""
    field, found, _, away, _ = groove(values["angle"], values["directions"])
    p = place(field, values["column"])
    length = away[:, values["column"]]
    length = np.where(np.isfinite(length), length, _FREE_LENGTH)
    return p, p + length[:, None] * found


def _stood_up(points):
    """Points with z upwards as the view has them, y upwards."""
    points = np.asarray(points, np.float64)
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


def _space(panel):
    return perspective_view(panel, _EYE, _CENTER, 37.0, 2.0)


def _plane(panel):
    return drawing.sheet(panel, 1.34, (0.0, -0.16))


def _flanks(view, field):
    """The groove's two sides and its edges, as they are drawn: each texel's strip."""
    out, columns = [], np.arange(-COLUMNS // 2, COLUMNS // 2)
    for name, half, color in (("left", columns < 0, _LEFT_FLANK), ("right", columns >= 0, _RIGHT_FLANK)):
        strips = []
        for column in columns[half][:-1]:
            a, b = (place(field, k % COLUMNS) for k in (column, column + 1))
            near, far = (np.array([0.0, y, 0.0]) for y in (-_HALF_GROOVE, _HALF_GROOVE))
            strips.append(_stood_up([a + near, b + near, b + far, a + far]))
        out.append(drawing.polygons(f"the {name} flank", view, strips, color))
    bottom = [place(field, k % COLUMNS) for k in (-1, 0)]
    strip = _stood_up([bottom[0] + near, bottom[1] + near, bottom[1] + far, bottom[0] + far])
    out.append(drawing.polygon("the bottom", view, strip, _RIGHT_FLANK))
    return out


def _rays(view, values, background):
    field, _, seen, _, _ = groove(values["angle"], values["directions"])
    p, tips = ends(values)
    own = seen[:, values["column"]]
    free, met = own == FREE, (own != FREE) & (own != BACK)
    horizon = p + np.concatenate(
        [drawing.arc((0.0, 0.0), 0.0, 360.0, segments=96) * _FREE_LENGTH, np.zeros((97, 1))], axis=1
    )
    start = _stood_up(p)
    # Of either there may be none, where the groove is shallow or rays are few.
    kinds = [
        (which, *drawn)
        for which, *drawn in ((met, "meet the groove", BLUE, 1.0, 2.0), (free, "go free", YELLOW, 0.8, 2.2))
        if which.any()
    ]
    return [
        *_flanks(view, field),
        drawing.stroke("the plane of the base, through p", view, _stood_up(horizon), GREEN, width=1.0),
        *(
            drawing.strokes(
                f"rays that {name}",
                view,
                [[start, _stood_up(tip)] for tip in tips[which]],
                color,
                width=width,
            )
            for which, name, color, width, _ in kinds
        ),
        *(
            drawing.dots(f"the ends of those that {name}", view, _stood_up(tips[which]), color, radius=radius)
            for which, name, color, _, radius in kinds
        ),
        drawing.dots("p", view, start, INK, radius=3.4),
        drawing.text("p", view, start, INK, align=(0, 1), offset=(0.0, -6.0), outline=background),
    ]


def _rings(label, view, points, color):
    radius = 2.2 * 2.0 * 1.34 / drawing.UNIT
    circles = [drawing.arc(c, 0.0, 360.0, (radius, 0.0), (0.0, radius), 12) for c in points]
    return drawing.strokes(label, view, circles, color, width=1.0)


def _dots(label, view, points, color):
    return drawing.dots(label, view, points, color, radius=2.4)


def _ellipse(values):
    """Centre, axis, the axis across, both radii."""
    fitted, column = groove(values["angle"], values["directions"])[-1], values["column"]
    center, axis, radii = (getattr(fitted, name)[0, column] for name in ("center", "axis", "radii"))
    axis = -axis if axis[1] < 0.0 else axis
    return center, axis, np.array((axis[1], -axis[0])), radii


def _projection(view, values, background):
    _, found, seen, _, _ = groove(values["angle"], values["directions"])
    own, points = seen[:, values["column"]], found[:, :2]
    center, axis, across, (r1, r2) = _ellipse(values)
    edge = drawing.arc(center, 0.0, 360.0, r1 * axis, r2 * across, segments=96)
    horizon = drawing.arc((0.0, 0.0), 0.0, 360.0, segments=96)
    out = [
        drawing.polygon("the ellipse's inside", view, edge[:-1], YELLOW, alpha=0.13),
        drawing.stroke("the horizon", view, horizon, GREEN, width=1.0),
        drawing.stroke("the ellipse", view, edge, YELLOW, width=1.8),
        *(
            mark(name, view, points[which], color)
            for mark, name, which, color in (
                (_rings, "turned away", own == BACK, FAINT),
                (_dots, "met", (own != FREE) & (own != BACK), BLUE),
                (_dots, "free", own == FREE, YELLOW),
            )
            if which.any()
        ),
        drawing.arrow("r1 a", view, (center, center + r1 * axis), RED, width=2.0),
        drawing.arrow("r2 across", view, (center, center + r2 * across), RED, width=2.0),
        drawing.dots("c", view, center, INK, radius=3.2),
    ]
    for name, at, color, align, offset in (
        ("c", center, INK, (1, 1), (-5.0, -3.0)),
        ("r1 a", center + 0.75 * r1 * axis, RED, (1, 0), (-5.0, 0.0)),
        ("r2", center + 0.55 * r2 * across, RED, (0, 1), (0.0, -5.0)),
    ):
        out.append(drawing.text(name, view, at, color, align=align, offset=offset, outline=background))
    for row, (words, color) in enumerate(
        (("free: in the ellipse", YELLOW), ("meets the groove", BLUE), ("into its own flank", FAINT))
    ):
        at = np.array((-0.95, -1.17 - 0.125 * row))
        mark = _rings if row == 2 else _dots
        out += (
            mark(f"{words}: the mark", view, at[None], color),
            drawing.text(words, view, at, color, align=(-1, 0), offset=(6.0, 0.0)),
        )
    return out


def scene(profile, size, *, background, **values):
    """The rays in space, and their directions seen from above."""
    left, right = row_of_panels(2, size)
    return (
        drawing.load_font(),
        left.clear(background),
        *_rays(_space(left), values, background),
        right.clear(background),
        *_projection(_plane(right), values, background),
    )


# ---------------------------------------------------------------------------------------------- checks


def checks(figure, renderer):
    """The share of directions on their side by the drawn radii, where rays end by planes, and the marks."""
    values, size = dict(figure.values), figure.size // 2
    _, found, seen, _, _ = groove(values["angle"], values["directions"])
    own = seen[:, values["column"]]
    center, axis, across, (r1, r2) = _ellipse(values)
    offset = found[:, :2] - center
    along, aside = (
        offset[:, 0] * axis[0] + offset[:, 1] * axis[1],
        offset[:, 0] * across[0] + offset[:, 1] * across[1],
    )
    inside = (along / r1) ** 2 + (aside / r2) ** 2 <= 1.0
    yield DATA.check(
        "directions on their side of the ellipse", float((inside == (own == FREE)).mean()), Answer.IDEAL
    )
    p, tips = ends(values)
    met = (own != FREE) & (own != BACK)
    slope = np.tan(np.radians(values["angle"]))
    apart = np.abs(tips[met][:, 2] - np.abs(tips[met][:, 0]) * slope)
    inner = np.abs(tips[met][:, 0]) < 0.5 - 1.0 / COLUMNS
    yield DATA.check(
        "distance of the points that rays meet from the flanks' planes, largest",
        float(apart[inner].max()),
        Answer.IDEAL,
        at_most=1.0 / COLUMNS,
    )
    # The mean of the free directions, which the ellipse's centre is.
    views = _space(row_of_panels(2, size)[0]), _plane(row_of_panels(2, size)[1])
    yield from drawn_check(
        figure,
        renderer,
        [
            (0, views[0], _stood_up(p), INK),
            (1, views[1], found[own == FREE, :2].mean(axis=0), INK),
            (1, views[1], center + 0.45 * r1 * axis, RED),
            (1, views[1], center + 0.3 * r2 * across, RED),
        ],
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "angle": word.DEGREES(45.0, "How steep the groove's flanks are.", low=5.0, high=70.0),
        "directions": word.of(
            word.Whole(16, 1000), 200, "Directions over the whole sphere along which rays are cast."
        ),
        "column": word.of(
            word.Whole(0, COLUMNS - 1),
            5,
            "The texel: its column, of 32 from the groove's bottom up the right flank and down the left.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

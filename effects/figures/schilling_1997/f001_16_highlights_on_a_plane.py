"""F001-16: the outlines of Phong's highlight and of Blinn and Phong's on a plane."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.reflectance.highlight_outlines import Model, half_widths, outline

DATA = figure_data(__file__, "F001-16")

COLORS = {Model.PHONG: BLUE, Model.BLINN_PHONG: YELLOW}
FIELD = 46.0
ELEVATION = word.Word(word.Number(5.0, 60.0), unit="degrees")
EXPONENT = word.Word(word.Whole(8, 1000))


def _eye(elevation):
    radians = np.radians(elevation)
    return (0.0, float(sine(radians) / cosine(radians)), 1.0)


def _views(panels, elevations):
    """Of each panel: the plane from above, and from the eye, for either elevation."""
    views = []
    for number, elevation in enumerate(elevations):
        views.append(drawing.sheet(panels[2 * number], 1.2))
        views.append(perspective_view(panels[2 * number + 1], _eye(elevation), field_of_view=FIELD))
    return views


def _on(number, points):
    """Points (x, z) of the plane in a panel's coordinates: from above with the eye at the lower edge."""
    x, z = points[..., 0], points[..., 1]
    return np.stack([x, -z], axis=-1) if number % 2 == 0 else np.stack([x, 0.0 * x, z], axis=-1)


def _grid(reach):
    """Lines of the plane, a quarter apart."""
    steps = np.arange(-4, 5) * 0.25
    ends = np.array([-1.0, 1.0])
    across = [np.stack([ends, np.full(2, z)], axis=-1) for z in steps if z <= reach]
    along = [np.stack([np.full(2, x), np.minimum(ends, reach)], axis=-1) for x in steps]
    return across + along


def scene(profile, size, *, high, low, blinn_phong, phong, background):
    """F001-16: both outlines on a grid, from above and from the eye."""
    elevations, panels = (high, low), row_of_panels(4, size)
    out = [drawing.load_font()]
    for number, (panel, view) in enumerate(zip(panels, _views(panels, elevations), strict=True)):
        elevation = elevations[number // 2]
        out.append(panel.clear(background))
        # Beneath the eye a line of the plane would be behind it.
        lines = [_on(number, line) for line in _grid(1.0 if number % 2 == 0 else 0.5)]
        out.append(drawing.strokes("the plane", view, lines, (0.20, 0.21, 0.25), width=1.0))
        for model, exponent in ((Model.PHONG, phong), (Model.BLINN_PHONG, blinn_phong)):
            points = _on(number, outline(model, exponent, elevation))
            label = f"{model.value}'s outline"
            out.append(drawing.polygon(f"within {label}", view, points, COLORS[model], alpha=0.35))
            out.append(drawing.stroke(label, view, points, COLORS[model], width=1.8))
        if number % 2 == 0:
            for name, z in (("light", -1.0), ("eye", 1.0)):
                place = np.array([0.0, -z])
                out.append(drawing.dots(name, view, place, INK, radius=3.0))
                out.append(drawing.text(name, view, place, INK, align=(-1, 0), offset=(6.0, 0.0)))
        out.append(drawing.dots("the mirrored light", view, _on(number, np.zeros(2)), FAINT, radius=2.0))
        out += _names(view, number, phong, blinn_phong, elevation)
    return tuple(out)


def _names(view, number, phong, blinn_phong, elevation):
    panel, where = drawing.sheet(view.panel), "from the eye" if number % 2 else "from above"
    yield drawing.text(f"{elevation:g}\u00b0, {where}", panel, (-0.94, 0.88), INK, align=(-1, 0))
    if number == 0:
        for k, (model, exponent) in enumerate(((Model.PHONG, phong), (Model.BLINN_PHONG, blinn_phong))):
            name = f"{model.value}, {exponent}"
            yield drawing.text(name, panel, (-0.94, -0.76 - 0.13 * k), COLORS[model], align=(-1, 0))


def checks(figure, renderer):
    """Half widths in angles of direction, and the outlines that are drawn."""
    values = figure.values
    for theta in (30.0, 60.0, 80.0):
        within, across = half_widths(Model.BLINN_PHONG, values["blinn_phong"], theta)
        expected = 1.0 / np.cos(np.radians(theta))
        yield DATA.check(
            "Blinn-Phong at {theta:g} degrees: in the plane of incidence over across, off 1/cos",
            abs(within / across / expected - 1.0),
            Answer.IDEAL,
            theta=theta,
        )
        within, across = half_widths(Model.PHONG, values["phong"], theta)
        yield DATA.check(
            "Phong at {theta:g} degrees: in the plane of incidence over across, off one",
            abs(within / across - 1.0),
            Answer.IDEAL,
            theta=theta,
        )
    elevations = values["high"], values["low"]
    views, marks = _views(row_of_panels(4, figure.size // 2), elevations), []
    for number in range(4):
        for model, exponent in ((Model.PHONG, values["phong"]), (Model.BLINN_PHONG, values["blinn_phong"])):
            points = outline(model, exponent, elevations[number // 2])
            # Towards the eye, and where Blinn and Phong's, which lies above, is not in the way.
            k = 0 if model is Model.PHONG else len(points) // 4
            marks.append((number, views[number], _on(number, points[k]), COLORS[model]))
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "high": ELEVATION(30.0, "How high lamp and eye are in the first two panels."),
        "low": ELEVATION(10.0, "How high lamp and eye are in the last two."),
        "blinn_phong": EXPONENT(100, "The exponent of n.h."),
        "phong": EXPONENT(25, "The exponent of r.v; a quarter of the other: equally long highlights."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

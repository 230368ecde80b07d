"""The triangle of F003-6 and F003-7: in texture space, and in a scene where its affine map takes it."""

import numpy as np

from fixedpipe.effects.bump_mapping import tangent_space
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import BLUE, GREEN, INK, RED
from fixedpipe.effects.geometry.views import perspective_view

# Corners in texture space and in object space. Neither its edges nor its tangents are at right angles.
COORDINATES = np.array([(0.12, 0.15), (0.92, 0.28), (0.38, 0.90)])
CORNERS = np.array([(-1.05, -0.45, 0.60), (0.95, -0.25, 0.45), (0.20, 0.45, -0.80)])
EYE, CENTER = (0.6, 1.9, 3.9), (0.0, 0.02, 0.0)
# Lines of constant u and v that are drawn.
STEPS = np.arange(1, 10) / 10.0


def the_map():
    """M of the triangle: float64 [3, 3]."""
    return tangent_space.affine_maps(CORNERS[None], COORDINATES[None])[0]


def mapped(coordinates):
    """x(u, v) at coordinates [m, 2]: float64 [m, 3]."""
    return tangent_space.mapped(the_map()[None], np.asarray(coordinates, np.float64)[None])[0]


def sheet(panel):
    """Texture space's unit square and a margin."""
    return drawing.sheet(panel, half_height=0.68, center=(0.5, 0.47))


def view(panel):
    """The scene in which the triangle lies."""
    return perspective_view(panel, EYE, center=CENTER, field_of_view=34.0, radius=2.5)


def inside_lines(axis):
    """The parts of the lines u = const (``axis`` 0) or v = const (1) that lie in the triangle: a list of
    float64 [2, 2].
    """
    out = []
    for step in STEPS:
        ends = []
        for k in range(3):
            a, b = COORDINATES[k], COORDINATES[(k + 1) % 3]
            if (a[axis] < step) != (b[axis] < step):
                f = (step - a[axis]) / (b[axis] - a[axis])
                ends.append(a + f * (b - a))
        if len(ends) == 2:
            out.append(np.array(ends))
    return out


def texture_space(view):
    """The axes, the triangle and its lines in texture space: a list of commands."""
    return [
        drawing.polygon("the triangle in texture space", view, COORDINATES, (0.16, 0.18, 0.23)),
        drawing.strokes("u = const", view, inside_lines(0), RED, width=0.8),
        drawing.strokes("v = const", view, inside_lines(1), GREEN, width=0.8),
        drawing.stroke("its edges", view, COORDINATES[[0, 1, 2, 0]], INK),
        drawing.arrow("the u axis", view, ((0.0, 0.0), (1.08, 0.0)), RED),
        drawing.arrow("the v axis", view, ((0.0, 0.0), (0.0, 1.08)), GREEN),
        drawing.text("u", view, (1.08, 0.0), RED, align=(0, 1), offset=(0.0, -5.0)),
        drawing.text("v", view, (0.0, 1.08), GREEN, align=(1, 0), offset=(-5.0, 0.0)),
    ]


def object_space(view):
    """The triangle in the scene, with the same lines where M takes them: a list of commands."""
    floor = [np.array([(x, -0.8, -1.0), (x, -0.8, 1.0)]) for x in np.arange(-4, 5) / 3.0]
    floor += [np.array([(-4 / 3, -0.8, z), (4 / 3, -0.8, z)]) for z in np.arange(-3, 4) / 3.0]
    return [
        drawing.strokes("a floor", view, floor, (0.20, 0.21, 0.24), width=0.8),
        drawing.polygon("the triangle in object space", view, CORNERS, (0.16, 0.18, 0.23)),
        drawing.strokes(
            "u = const, mapped", view, [mapped(line) for line in inside_lines(0)], RED, width=0.8
        ),
        drawing.strokes(
            "v = const, mapped", view, [mapped(line) for line in inside_lines(1)], GREEN, width=0.8
        ),
        drawing.stroke("its edges", view, CORNERS[[0, 1, 2, 0]], INK),
    ]


def title(panel, words):
    """What a panel shows, at its upper edge."""
    return drawing.text(words, drawing.sheet(panel), (0.0, 0.92), INK)


def corner_labels(view, places, names, outline, aside=(0.0, 0.0, 0.0)):
    """Dots and names at three corners, above or below them and ``aside`` UNITs to the right.

    ``outline``: the colour round the letters, where a line passes under them.
    """
    shown = drawing.project(view, places)[:, :2]
    middle = shown.mean(axis=0)
    out = [drawing.dots("corners", view, places, BLUE)]
    for place, name, pixel, right in zip(places, names, shown, aside, strict=True):
        side = np.sign(pixel[1] - middle[1])
        where = {"align": (0, -int(side)), "offset": (right, 7.0 * side)}
        out.append(drawing.text(name, view, place, BLUE, outline=outline, **where))
    return out

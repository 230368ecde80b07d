"""F003-6: a triangle with texture coordinates as a parametric patch x(u, v)."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import tangent_space
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, GREEN, RED, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared import parametric_triangle as triangle
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F003-6")

# A place in the triangle, marked in both spaces.
PLACE = np.array([0.47, 0.45])


def _views(size):
    first, second = row_of_panels(2, size)
    return triangle.sheet(first), triangle.view(second)


def scene(profile, size, *, background):
    """F003-6: texture space, and object space, joined by the affine map."""
    flat, solid = _views(size)
    place = triangle.mapped(PLACE[None])[0]
    names = [f"(u{k}, v{k})" for k in range(3)]
    return (
        drawing.load_font(),
        flat.panel.clear(background),
        *triangle.texture_space(flat),
        *triangle.corner_labels(flat, triangle.COORDINATES, names, background, (10.0, 0.0, 0.0)),
        drawing.dots("a place (u, v)", flat, PLACE, YELLOW, radius=4.0),
        drawing.text("(u, v)", flat, PLACE, YELLOW, align=(-1, 0), offset=(8.0, 0.0), outline=background),
        triangle.title(flat.panel, "texture space"),
        solid.panel.clear(background),
        *triangle.object_space(solid),
        *triangle.corner_labels(solid, triangle.CORNERS, ("v0", "v1", "v2"), background),
        drawing.dots("x(u, v)", solid, place, YELLOW, radius=4.0),
        drawing.text("x(u, v)", solid, place, YELLOW, align=(-1, 0), offset=(8.0, 0.0), outline=background),
        triangle.title(solid.panel, "object space: x = M (u, v, 1)"),
    )


def checks(figure, renderer):
    """The interpolation constraints of this triangle and of a thousand, and the marks."""
    found = triangle.mapped(triangle.COORDINATES)
    random = np.random.default_rng(6)
    points, coordinates = random.normal(size=(1000, 3, 3)), random.random((1000, 3, 2))
    kept = np.abs(tangent_space.texture_areas(coordinates)) > 0.05
    points, coordinates = points[kept], coordinates[kept]
    maps = tangent_space.affine_maps(points, coordinates)
    many = np.abs(tangent_space.mapped(maps, coordinates) - points).max()
    flat, solid = _views(figure.size // 2)
    marks = [(0, flat, corner, BLUE) for corner in triangle.COORDINATES]
    marks += [(1, solid, corner, BLUE) for corner in found]
    marks += [(0, flat, PLACE, YELLOW), (1, solid, triangle.mapped(PLACE[None])[0], YELLOW)]
    # On a line of constant u, and on one of constant v, between their crossings.
    for place, color in ((np.array([0.6, 0.36]), RED), (np.array([0.36, 0.3]), GREEN)):
        marks += [(0, flat, place, color), (1, solid, triangle.mapped(place[None])[0], color)]
    return (
        DATA.check("x(u_i, v_i) - v_i, largest", float(np.abs(found - triangle.CORNERS).max()), Answer.IDEAL),
        DATA.check("the same of {n} random triangles", float(many), Answer.IDEAL, n=len(points)),
        *drawn_check(figure, renderer, marks),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

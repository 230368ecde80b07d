"""F003-7: tangent, bi-tangent and normal of a triangle."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import tangent_space
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import FAINT, GREEN, RED, VIOLET
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared import parametric_triangle as triangle
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F003-7")

PLACE = np.array([0.42, 0.40])
# How much of a unit step along u and v is drawn.
STEP = 0.25


def _views(size):
    first, second = row_of_panels(2, size)
    return triangle.sheet(first), triangle.view(second)


def _arrows():
    """The drawn vectors' ends: the foot and the tips of t, b and n, float64 [3] each."""
    t, b, n = tangent_space.frames(triangle.the_map())
    foot = triangle.mapped(PLACE[None])[0]
    return foot, foot + STEP * t, foot + STEP * b, foot + 0.8 * normalize(n)


def scene(profile, size, *, background):
    """F003-7: steps along u and v in texture space, and the same steps on the triangle."""
    flat, solid = _views(size)
    foot, along_u, along_v, up = _arrows()
    beyond = along_u + along_v - foot
    legend = drawing.sheet(solid.panel)
    square = PLACE + STEP * np.array([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    return (
        drawing.load_font(),
        flat.panel.clear(background),
        *triangle.texture_space(flat),
        drawing.stroke("a step's square", flat, square, FAINT, dash=drawing.DASH),
        drawing.arrow("along u", flat, (PLACE, PLACE + STEP * np.array((1.0, 0.0))), RED, width=2.6),
        drawing.arrow("along v", flat, (PLACE, PLACE + STEP * np.array((0.0, 1.0))), GREEN, width=2.6),
        triangle.title(flat.panel, "texture space"),
        solid.panel.clear(background),
        *triangle.object_space(solid),
        drawing.stroke("a step's parallelogram", solid, (along_u, beyond, along_v), FAINT, dash=drawing.DASH),
        drawing.arrow("t = dx/du", solid, (foot, along_u), RED, width=2.6),
        drawing.arrow("b = dx/dv", solid, (foot, along_v), GREEN, width=2.6),
        drawing.arrow("n = t x b", solid, (foot, up), VIOLET, width=2.6),
        drawing.text("t", solid, along_u, RED, align=(0, 1), offset=(0.0, -4.0), outline=background),
        drawing.text("b", solid, along_v, GREEN, align=(0, -1), offset=(3.0, 2.0), outline=background),
        drawing.text("n", solid, up, VIOLET, align=(0, -1), offset=(0.0, 3.0)),
        *(
            drawing.text(words, legend, (-0.9, 0.72 - 0.11 * k), color, align=(-1, 1))
            for k, (words, color) in enumerate(
                (("t = dx/du", RED), ("b = dx/dv", GREEN), ("n = t x b", VIOLET))
            )
        ),
        triangle.title(solid.panel, "object space"),
    )


def checks(figure, renderer):
    """M's columns against finite differences of x(u, v), and the drawn arrows."""
    maps = triangle.the_map()
    t, b, n = tangent_space.frames(maps)
    step = 2.0**-8
    differences = [
        (triangle.mapped((PLACE + step * axis)[None]) - triangle.mapped((PLACE - step * axis)[None]))[0]
        / (2.0 * step)
        for axis in np.eye(2)
    ]
    error = max(
        float(np.abs(found - column).max()) for found, column in zip(differences, (t, b), strict=True)
    )
    lean = max(abs(float(dot(normalize(n), axis))) for axis in (t, b))
    flat, solid = _views(figure.size // 2)
    # By finite differences and corners turned counter-clockwise, not by the frame that is drawn.
    foot, upward = triangle.mapped(PLACE[None])[0], np.cross(*(triangle.CORNERS[1:] - triangle.CORNERS[0]))
    middle = [foot + 0.5 * STEP * difference for difference in differences]
    middle.append(foot + 0.4 * normalize(upward))
    marks = [(1, solid, place, color) for place, color in zip(middle, (RED, GREEN, VIOLET), strict=True)]
    marks += [
        (0, flat, PLACE + 0.5 * STEP * axis, color)
        for axis, color in zip(np.eye(2), (RED, GREEN), strict=True)
    ]
    return (
        DATA.check("M's columns - finite differences of x(u, v), largest", error, Answer.IDEAL),
        DATA.check("n.t and n.b, largest", lean, Answer.IDEAL),
        DATA.check("cosine between t and b", abs(float(dot(normalize(t), normalize(b)))), Answer.IDEAL),
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

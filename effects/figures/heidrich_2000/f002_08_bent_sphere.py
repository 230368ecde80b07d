"""F002-8: the directions of one texel, triangulated on the sphere, on a flat base and on bent ones."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import INK, VISIBLE
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, draw
from fixedpipe.effects.scattering import curved_base, height_field, visibility
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.effects.scattering.directions import fan_areas, spiral
from fixedpipe.pipeline.commands import Mesh

DATA = figure_data(__file__, "F002-8")

_TEXELS = 32
# Where the eye is, and in which direction; y is up, as of every camera.
_EYE = (-5.4, 1.4, 2.4)
# Colours of the least, the unchanged and the greatest ratio of areas, which a factor of ``_FACTOR`` reaches.
_LESS, _SAME, _MORE = (
    np.array(color) for color in ((0.16, 0.36, 0.86), (0.55, 0.56, 0.58), (0.93, 0.40, 0.12))
)
_FACTOR = 1.6
_LINE = (0.08, 0.09, 0.11)


def bent_texel(curvature, directions, texel):
    """A texel of the groove on the flank that faces -s. The result is a Bent of the groove's row, with the
    paper's weights; and the texel's directions [n, 3] with y upward, its weights [n] and the texels that it
    sees [n].
    """
    field = height_field.ridges(_TEXELS, 2, 45.0, 1)
    seen = visibility.precompute(field, spiral(directions))
    bent = curved_base.bend(field, seen, Base((curvature, 0.0)), curved_base.fan_weights)
    x, y, z = bent.directions[:, 0, texel].T
    upright = np.stack([x, z, -y], axis=-1)
    return bent, upright, bent.weights[:, 0, texel], seen.seen[:, 0, texel]


def color_of(weights):
    """Colours of ratios of areas [n], float64 [n, 3]; an area that has folded over has the smallest one's
    colour.
    """
    # (w - 1) / (w + 1) is the same but for its sign for a factor and its inverse.
    most = (_FACTOR - 1.0) / (_FACTOR + 1.0)
    weights = np.maximum(weights, 0.0)
    share = np.clip((weights - 1.0) / (weights + 1.0) / most, -1.0, 1.0)[:, None]
    return _SAME + np.maximum(share, 0.0) * (_MORE - _SAME) + np.maximum(-share, 0.0) * (_LESS - _SAME)


def camera(panel):
    """From the side to which the texel sees the other flank."""
    return perspective_view(panel, _EYE, (0.0, -0.1, 0.0), 23.0, 2.0)


def _cells(directions, triangles, colors):
    """The triangles, each in three parts that have their corner's colour: a Mesh."""
    corners = [directions[triangles[:, k]] for k in range(3)]
    center = (corners[0] + corners[1] + corners[2]) / 3.0
    middles = [0.5 * (corners[k] + corners[(k + 1) % 3]) for k in range(3)]
    parts, tints = [], []
    for k in range(3):
        parts.append(np.stack([corners[k], middles[k], center, corners[k], center, middles[k - 1]], axis=1))
        tints.append(np.repeat(colors[triangles[:, k]], 6, axis=0))
    positions = np.concatenate([part.reshape(-1, 3) for part in parts])
    return Mesh(positions=positions, indices=np.arange(len(positions)), colors=np.concatenate(tints))


def _edges(directions, triangles):
    pairs = {tuple(sorted((int(t[k]), int(t[(k + 1) % 3])))) for t in triangles for k in range(3)}
    # Lines in front of the faces that they part.
    return [1.004 * directions[list(pair)] for pair in sorted(pairs)]


def make(profile, size, *, curvatures, directions, texel):
    """The sphere of each panel as triangles, its edges, and dots where something is seen."""
    commands = [drawing.load_font()]
    for panel, curvature in zip(row_of_panels(3, size), curvatures, strict=True):
        view, sheet = camera(panel), drawing.sheet(panel)
        bent, moved, weights, seen = bent_texel(curvature, directions, texel)
        hit = moved[seen >= 0]
        front = hit[dot(hit, normalize(np.array(_EYE))) > 0.1]
        commands += [
            panel.clear(BACKGROUND),
            draw(
                "areas", _cells(moved, bent.triangles, color_of(weights)), view, None, depth_test=FIRST_PASS
            ),
            drawing.strokes(
                "triangles", view, _edges(moved, bent.triangles), _LINE, width=0.7, depth_test=VISIBLE
            ),
            drawing.dots("where something is seen", view, 1.01 * front, INK, radius=1.9, depth_test=VISIBLE),
        ]
        for x, name, color in (
            (-0.78, "smaller", _LESS),
            (-0.12, "as before", _SAME),
            (0.56, "larger", _MORE),
        ):
            commands += [
                drawing.dots(f"{name}: its colour", sheet, (x, -0.91), color, radius=4.0),
                drawing.text(name, sheet, (x, -0.91), INK, align=(-1, 0), offset=(8.0, 0.0)),
            ]
    return tuple(commands)


def _places(figure):
    """Middles between a direction and a triangle's, of triangles that the eye sees, with their colour."""
    eye = normalize(np.array(_EYE))
    out = []
    for number, (panel, curvature) in enumerate(
        zip(row_of_panels(3, figure.size // 2), figure.values["curvatures"], strict=True)
    ):
        bent, moved, weights, _ = bent_texel(curvature, figure.values["directions"], figure.values["texel"])
        colors = color_of(weights)
        for triangle in bent.triangles.tolist():
            center = moved[triangle].sum(axis=0) / 3.0
            if float(dot(normalize(center), eye)) > 0.8:
                k = triangle[0]
                point = 0.5 * moved[k] + 0.5 * center
                out.append((number, camera(panel), point, colors[k]))
    return out


def checks(figure, renderer):
    """The areas themselves, and the picture's colours where the areas are."""
    count = figure.values["directions"]
    per = 4.0 * math.pi / count
    for curvature in figure.values["curvatures"]:
        bent, _, weights, seen = bent_texel(curvature, count, figure.values["texel"])
        areas = fan_areas(spiral(count), bent.triangles)
        if curvature == 0.0:
            yield DATA.check(
                "flat: largest difference of a direction's area from 4 pi / N",
                float(np.abs(areas / per - 1.0).max()),
                Answer.IDEAL,
            )
        yield DATA.check(
            "curvature {curvature:g}: the weighted areas beside 4 pi",
            abs(float((weights * areas).sum()) - 4.0 * math.pi),
            Answer.IDEAL,
            curvature=curvature,
        )
        if curvature == 0.0:
            continue
        beside = _neighbours(bent.triangles, np.flatnonzero(seen >= 0))
        sky = [k for k in sorted(beside) if seen[k] == visibility.FREE]
        rim = float(weights[sky].mean())
        yield Check(
            f"curvature {curvature:g}: mean ratio of the areas of the sky beside what is seen, over one"
            if curvature > 0.0
            else f"curvature {curvature:g}: one over the same",
            (rim if curvature > 0.0 else 1.0 / rim) - 1.0,
            at_least=0.05,
            on=Answer.IDEAL,
            reason="on a convex base the points seen sink away from the sky, on a concave one they rise",
        )
    yield from drawn_check(figure, renderer, _places(figure))


def _neighbours(triangles, of):
    of = set(of.tolist())
    return {k for triangle in triangles.tolist() if of & set(triangle) for k in triangle}


FIGURE = Figure(
    **DATA.words,
    parameters={
        "curvatures": word.of(
            word.Several((word.Number(-0.9, 0.9),) * 3, what="three numbers from -0.9 to 0.9"),
            (0.0, 0.5, -0.5),
            "The base's curvature across the groove, a panel each; positive is convex.",
            "1 / period",
        ),
        "directions": word.of(word.Whole(20, 400), 100, "Directions over the whole sphere."),
        "texel": word.of(
            word.Whole(0, _TEXELS // 2 - 1),
            5,
            "The texel, from the groove's bottom.",
            "texels of 32 a period",
        ),
    },
    methods=(Method("coloured triangles", make, DIAGRAM_MACHINES),),
    acceptance=checks,
)

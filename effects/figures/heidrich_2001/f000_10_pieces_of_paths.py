"""F000-10: paths over a bed of stones: along one direction their pieces are parallel at every point."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.ray_caster import RayCaster
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import BLUE, INK, RED, VISIBLE, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import visibility
from fixedpipe.effects.scattering.displacement import relief
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.effects.scattering.made_fields import gravel
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F000-10")

TEXELS, CELLS, DEPTH = 64, 4, 0.85
# The field's z upwards on the screen.
_STAND = rotation("x", -90.0)
_EYE, _CENTER = (0.0, 17.0, 18.0), (0.0, 0.22, 0.0)
# How long the pieces are that come from the light and go to the eye.
_LONG = 0.6


@lru_cache(1)
def _bed():
    field = gravel(TEXELS, TEXELS, CELLS, DEPTH)
    return field, relief(field).rotated(_STAND)


@lru_cache(8)
def paths(points, direction):
    """(p, q) of each point: float64 [3] in the field's frame, twice as large; q is None if the ray meets
    nothing.

    points  texels (column, row)
    """
    field, _ = _bed()
    seen = visibility.precompute(field, [direction])
    away = visibility.distances(field, seen)[0]
    out = []
    for column, row in points:
        p = np.array(
            [
                2.0 * column / field.columns - 1.0,
                2.0 * row / field.rows - 1.0,
                2.0 * field.heights[row, column],
            ]
        )
        met = np.isfinite(away[row, column])
        out.append((p, p + 2.0 * away[row, column] * seen.directions[0] if met else None))
    return out


def _stood(points):
    return rotate(_STAND, np.atleast_2d(np.asarray(points, np.float64)))


def _view(panel):
    return perspective_view(panel, _EYE, _CENTER, 5.2, 2.4)


def _lit(light):
    """The bed's colours under the light, with shadows by rays: RGB [rows, columns, 3]."""
    field, _ = _bed()
    free = visibility.free_view(field, light)
    lit = np.maximum(dot(field.normals, light), 0.0) * free
    return field.albedo * (np.array((0.16, 0.18, 0.23)) + 0.84 * lit[..., None])


def _pieces(view, found, to_light, to_eye, letters):
    """The arrows of every path; in front of all letters at one of them."""
    out = []
    for p, q in found:
        out.append(("v", (p, p + _LONG * to_eye), BLUE))
        if q is not None:
            out += (("l", (q + _LONG * to_light, q), YELLOW), ("-d_i", (q, p), RED))
    out = [
        drawing.arrow(name, view, _stood(line), color, width=2.2, depth_test=VISIBLE)
        for name, line, color in out
    ]
    places = np.array([point for pair in found for point in pair if point is not None])
    out.append(drawing.dots("p and q", view, _stood(places), INK, radius=2.6, depth_test=VISIBLE))
    p, q = found[letters]
    if q is None:
        return out
    for name, at, color, align, offset in (
        ("p", p, INK, (0, 1), (0.0, -5.0)),
        ("q", q, INK, (0, 1), (0.0, -5.0)),
        ("l", q + 0.75 * _LONG * to_light, YELLOW, (1, 0), (-6.0, 0.0)),
        ("-d", 0.5 * (p + q), RED, (0, -1), (0.0, 5.0)),
        ("v", p + 0.8 * _LONG * to_eye, BLUE, (-1, 0), (6.0, 0.0)),
    ):
        out.append(
            drawing.text(
                name, view, _stood(at)[0], color, align=align, offset=offset, outline=(0.0, 0.0, 0.0)
            )
        )
    return out


def scene(profile, size, *, points, directions, light, eye, background):
    """The same points with one direction, and with another."""
    light, to_eye = check_light(light), unit_vector(eye, "The direction to the eye")
    _, surface = _bed()
    image = texture_2d(factor_texels(_lit(light), profile))
    out = [drawing.load_font(), TexImage(label="load the bed's light", texture="bed", image=image)]
    units = (unit("bed", REPEATED, environment=REPLACE),)
    for panel, direction in zip(row_of_panels(2, size), directions, strict=True):
        view = _view(panel)
        out += (
            panel.clear(background),
            draw("the bed of stones", surface.mesh(), view, None, units, depth_test=FIRST_PASS),
            *_pieces(view, paths(points, direction), light, to_eye, 1),
        )
    return tuple(out)


# ---------------------------------------------------------------------------------------------- checks


def checks(figure, renderer):
    """Where paths end by rays among the bed's triangles, that all pieces are free, and the marks."""
    values = figure.values
    light, to_eye = check_light(values["light"]), unit_vector(values["eye"], "The direction to the eye")
    _, surface = _bed()
    caster = RayCaster(surface.positions[surface.triangles])
    apart, bent, shut, met = 0.0, 0.0, 0, 0
    for direction in values["directions"]:
        along = _stood(unit_vector(direction, "The direction d_i"))
        for p, q in paths(values["points"], direction):
            if q is None:
                continue
            # A little above the triangles that meet at p.
            start = _stood(p) + 1e-6 * along
            hit = caster.nearest(start, along)
            reached = start[0] + hit.distance[0] * along[0]
            met += 1
            apart = max(apart, float(np.abs(reached - _stood(q)[0]).max()))
            piece = normalize(_stood(q)[0] - start[0])
            bent = max(bent, 1.0 - float(dot(along[0], piece)))
            for point, towards in ((q, light), (p, to_eye)):
                toward = _stood(towards)
                shut += int(
                    caster.occluded(_stood(point) + 1e-3 * toward + 1e-4 * _stood((0, 0, 1)), toward)[0]
                )
    yield DATA.check(
        "points q from where rays among the bed's triangles meet it, largest distance", apart, Answer.IDEAL
    )
    yield DATA.check(
        ("one minus the cosine between a path's piece from p to q and its panel's direction, largest"),
        bent,
        Answer.IDEAL,
    )
    yield DATA.check(
        "points that see another along their panel's direction, of ten",
        met,
        Answer.IDEAL,
        at_least=2 * len(values["points"]),
    )
    yield DATA.check("pieces l and v that something is in the way of", shut, Answer.IDEAL)
    size = figure.size // 2
    marks = []
    for number, direction in enumerate(values["directions"]):
        view = _view(row_of_panels(2, size)[number])
        for p, q in paths(values["points"], direction)[1:]:
            marks.append((number, view, _stood(0.8 * q + 0.2 * p)[0], RED))
            marks.append((number, view, _stood(p + 0.5 * _LONG * to_eye)[0], BLUE))
    for on in Answer:
        image, missing = renderer.window(on, figure, size), 0
        for number, view, point, color in marks:
            x, y = (int(c) for c in np.floor(drawing.project(view, point)[:2]))
            missing += bool(np.abs(panel_of(image, number)[y, x] - np.array(color)).max() > 1.0 / 255.0)
        yield DATA.check(
            "of {n} marks on the pieces those that are not drawn where they are",
            missing,
            on,
            at_most=len(marks) // 4,
            n=len(marks),
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "points": word.of(
            word.Several((word.Several((word.Whole(0, TEXELS - 1),) * 2),) * 5),
            ((12, 20), (53, 35), (33, 37), (38, 24), (29, 52)),
            "Where the points p are: columns and rows of 64 texels.",
        ),
        "directions": word.of(
            word.Several((word.DIRECTION_KIND,) * 2),
            ((-0.38, -0.92, 0.2), (-0.92, 0.38, 0.2)),
            "The direction d of each panel, along which points see each other.",
        ),
        "light": word.LIGHT((-0.45, 0.5, 0.8)),
        "eye": word.of(word.DIRECTION_KIND, (0.3, -0.35, 0.9), "The direction v to the eye."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)

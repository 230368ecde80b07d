"""F000-10: paths over a bed of stones: along one direction their pieces are parallel at every point."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.ray_caster import RayCaster
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import BLUE, INK, RED, VISIBLE, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import visibility
from fixedpipe.effects.scattering.displacement import relief
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.effects.scattering.made_fields import gravel
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

TEXELS, CELLS, DEPTH = 64, 4, 0.85
# The field's z upwards on the screen.
_STAND = rotation("x", -90.0)
_EYE, _CENTER = (0.0, 2.35, 2.75), (0.0, 0.12, 0.05)
# How long the pieces are that come from the light and go to the eye.
_LONG = 0.75


@lru_cache(1)
def _bed():
    field = gravel(TEXELS, TEXELS, CELLS, DEPTH)
    return field, relief(field).rotated(_STAND)


@lru_cache(8)
def paths(points, direction):
    """(p, q) of each point: float64 [3] in the field's frame, twice as large; q is None where nothing is met.

    points  texels (column, row)
    """
    field, _ = _bed()
    seen = visibility.precompute(field, [direction])
    away = visibility.distances(field, seen)[0]
    out = []
    for column, row in points:
        p = np.array(
            [2.0 * column / field.columns - 1.0, 2.0 * row / field.rows - 1.0, 2.0 * field.heights[row, column]]
        )
        met = np.isfinite(away[row, column])
        out.append((p, p + 2.0 * away[row, column] * seen.directions[0] if met else None))
    return out


def _stood(points):
    return rotate(_STAND, np.atleast_2d(np.asarray(points, np.float64)))


def _view(panel):
    return perspective_view(panel, _EYE, _CENTER, 33.0, 2.2)


def _lit(light):
    """The bed's colours under the light, with shadows by rays: RGB [rows, columns, 3]."""
    field, _ = _bed()
    free = visibility.free_view(field, light)
    lit = np.maximum(dot(field.normals, light), 0.0) * free
    return field.albedo * (np.array((0.16, 0.18, 0.23)) + 0.62 * lit[..., None])


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
            drawing.text(name, view, _stood(at)[0], color, align=align, offset=offset, outline=(0.0, 0.0, 0.0))
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
            *_pieces(view, paths(points, direction), light, to_eye, 0),
        )
    return tuple(out)

"""A long ground with columns, trees and a gate at its end, for which one shadow map has too few texels.

It is the scene of document 003's "sampling problems": near things appear large, and the far part is many
times as deep. World coordinates: y up, the ground at y = 0, the avenue along -z.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, product, rotation
from fixedpipe.effects.geometry.vectors import cross, normalize, of_40_bits
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene

HALF_WIDTH, START, END = 13.0, 4.0, -68.0
SKY = (0.43, 0.54, 0.66)
# To the sun: from the right, from behind the viewer.
SUN = (0.72, 0.50, 0.36)

# Where the ball lies on its stone, and how large it is.
BALL, BALL_RADIUS = (-1.0, 1.14, -3.4), 0.34

_COLUMN = (
    *((0.0, 0.0), (0.55, 0.0), (0.55, 0.3), (0.34, 0.42)),
    *((0.30, 2.9), (0.46, 3.1), (0.46, 3.4), (0.0, 3.4)),
)
_TREE = (
    *((0.0, 0.0), (0.2, 0.0), (0.16, 1.2), (1.15, 1.5)),
    *((1.35, 2.2), (1.1, 3.2), (0.55, 4.4), (0.0, 5.2)),
)


def _rows(surface, side, places):
    """The surface on both sides of the avenue, at each z of ``places``."""
    return surfaces.joined(*(surface.moved(x, 0.0, z) for z in places for x in (-side, side)))


def ground(across, along):
    """The ground, ``across`` by ``along`` rectangles."""
    length = START - END
    return (
        surfaces.plane(across, along, HALF_WIDTH, length / 2.0)
        .rotated(rotation("x", -90.0))
        .moved(0.0, 0.0, (START + END) / 2.0)
    )


def avenue(detail=24):
    """The scene. ``detail``: segments of columns and trees (``objects_and_lamps.detail_of``); below 16 every
    other column and tree is left out.
    """
    gate = surfaces.joined(
        surfaces.box(2.0, 6.0, 2.0).moved(-4.2, 3.0, -62.0),
        surfaces.box(2.0, 6.0, 2.0).moved(4.2, 3.0, -62.0),
        surfaces.box(11.0, 1.6, 2.4).moved(0.0, 6.8, -62.0),
    )
    segments, step = (detail // 2, 7.5) if detail >= 16 else (5, 15.0)
    columns = _rows(surfaces.lathe(_COLUMN, segments), 3.4, np.arange(-1.5, -54.0, -step))
    trees = _rows(surfaces.lathe(_TREE, segments), 7.6, np.arange(-5.0, -58.0, -step))
    stone = surfaces.joined(
        surfaces.box(0.7, 0.8, 0.7).rotated(rotation("y", 30.0)).moved(-1.0, 0.4, -3.4),
        surfaces.sphere(segments, max(segments // 2, 3)).scaled(BALL_RADIUS).moved(*BALL),
    )
    return Scene(
        (
            Object("ground", ground(2, 8), (0.84, 0.78, 0.62), closed=False),
            Object("columns", columns, (0.78, 0.74, 0.66), 0.1),
            Object("trees", trees, (0.24, 0.42, 0.18), 0.0),
            Object("gate", gate, (0.60, 0.42, 0.34), 0.0),
            Object("stone", stone, (0.70, 0.34, 0.26), 0.3),
        )
    )


def avenue_view(panel):
    """The camera of ``avenue``: a head's height above the ground, at its beginning. No object is nearer to it
    than its near plane, so a map that follows the view wastes no texels on empty space.
    """
    eye = (-0.7, 2.5, 4.0)
    projection = perspective(46.0, panel.width / panel.height, 3.5, 76.0)
    return View(panel, look_at(eye, (-0.1, 0.5, -14.0)), projection, eye, False)


# What magnified views show of ``avenue_view``: their middle, and half their width, in the picture's half
# widths. The second is a third of the first.
_NEAR_SHADOW = (-0.40, -0.38), 0.41
_BALL_SHADOW = (-0.692, -0.462), 0.137


def _magnified(panel, middle, half):
    """A part of ``avenue_view``, which fills the panel."""
    view, zoom = avenue_view(panel), 1.0 / half
    x, y = middle
    magnified = (
        (zoom, 0.0, 0.0, -zoom * x),
        (0.0, zoom, 0.0, -zoom * y),
        (0.0, 0.0, 1.0, 0.0),
        (0.0, 0.0, 0.0, 1.0),
    )
    return replace(view, projection=product(magnified, view.projection))


def _outline(middle, half):
    """A closed outline of a part of ``avenue_view``, in the picture's half widths."""
    x, y = middle
    return tuple((x + i * half, y + j * half) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)))


def near_shadow_view(panel):
    """A magnified part of ``avenue_view``: the stone, its ball and their shadow before the viewer."""
    return _magnified(panel, *_NEAR_SHADOW)


def near_shadow_outline():
    """What ``near_shadow_view`` shows of ``avenue_view``: a closed outline, in the picture's half widths."""
    return _outline(*_NEAR_SHADOW)


def ball_shadow_view(panel):
    """A part of ``near_shadow_view``, three times as large: the shadow of the ball."""
    return _magnified(panel, *_BALL_SHADOW)


def ball_shadow_outline():
    """What ``ball_shadow_view`` shows of ``avenue_view``: a closed outline, in the picture's half widths."""
    return _outline(*_BALL_SHADOW)


def ball_shadow(sun, corners=64):
    """The outline of a round ball's shadow on the ground: points [corners + 1, 3], the last equal to the
    first; or None if not all of it lies before the viewer.

    ``sun``: the direction towards it, of any length.
    """
    toward = normalize(np.asarray(sun, np.float64))
    if toward[1] <= 0.0:
        return None
    across = (
        normalize(cross(toward, np.array((0.0, 1.0, 0.0)))) if toward[1] < 1.0 else np.array((1.0, 0.0, 0.0))
    )
    angles = 2.0 * np.pi * np.arange(corners + 1)[:, None] / corners
    x, y = of_40_bits(np.cos(angles)), of_40_bits(np.sin(angles))
    rim = BALL + BALL_RADIUS * (x * across + y * cross(toward, across))
    points = rim - toward * (rim[:, 1:2] / toward[1])
    return points if (points[:, 2] < START).all() else None

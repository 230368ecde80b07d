"""The still life: a ring, a vase, a column, a sphere and a box on a floor, its camera, and its lamps."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, rotation
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scenes.objects_and_lamps import (
    FLOOR_HALF_WIDTH,
    Lamp,
    Object,
    Scene,
    detail_of,
)

# A turned vase, a smooth curve through (radius, height) between its two flat ends, and a column with base and
# capital.
_VASE = (
    *((0.34, 0.0), (0.36, 0.06), (0.22, 0.14), (0.20, 0.22), (0.34, 0.48), (0.44, 0.78)),
    *((0.42, 1.02), (0.28, 1.26), (0.17, 1.40), (0.16, 1.50), (0.28, 1.63)),
)
_COLUMN = (
    *((0.0, 0.0), (0.34, 0.0), (0.34, 0.12), (0.22, 0.2)),
    *((0.2, 1.94), (0.3, 1.99), (0.3, 2.14), (0.0, 2.14)),
)

# Where the ground's vertices are beyond the floor's edge, world units from the middle: the farther the
# coarser, as the light changes less from place to place. The camera sees no farther than 17; cameras that
# show the lamp too see farther.
_GROUND = (3.4, 4.6, 6.4, 9.0, 13.0, 20.0, 30.0, 45.0)

# Two points of the floor: one that the first lamp reaches, and one in the sphere's shadow; and what of the
# sphere is between. Computed by rays (figure F003-18 checks them).
LIT_POINT, SHADOWED_POINT, BETWEEN = (-0.1, 0.0, 2.2), (2.18, 0.0, 0.66), (1.394, 0.974, 0.931)

# The moving light: round the scene from the left to the right. High, so that no shadow leaves the picture.
# Every side of the box is lit clearly or turned away clearly.
LAMP_POSITIONS = ((-4.6, 8.4, 3.0), (-0.8, 8.8, 5.4), (4.1, 8.6, 4.2))
# What encloses the scene itself from the first of them, closer than its box, whose upper corners are empty:
# where the lamp looks, its planes and its field of view.
# Measured: 39.8 degrees and distances from 7.74 to 11.83 hold every vertex (figure F003-17 checks it).
_LAMP_TARGET, _LAMP_NEAR, _LAMP_FAR, _LAMP_FIELD_OF_VIEW = (-0.5, -0.2, 0.2), 7.5, 12.5, 41.4


def _part(surface, triangles):
    """Some triangles of a surface, with the vertices that they have and no others."""
    used, corners = np.unique(triangles, return_inverse=True)
    arrays = {
        name: getattr(surface, name)[used]
        for name in ("positions", "normals", "tangents", "binormals", "texture_coordinates")
    }
    return surfaces.Surface(**arrays, triangles=corners.reshape(triangles.shape))


def floor_and_ground(cells, beyond=_GROUND):
    """A floor of ``cells`` by ``cells`` squares, and the ground about it, with vertices at the distances
    ``beyond`` its edge. Where they meet they have the same vertices, so that no pixel is between them.
    """
    inside = FLOOR_HALF_WIDTH * (2.0 * np.arange(cells + 1) / cells - 1.0)
    beyond = np.array(beyond)
    lines = np.concatenate([-beyond[::-1], inside, beyond])
    n, far = len(lines) - 1, len(beyond)
    whole = surfaces.plane(n, n)
    x, y = (grid.ravel() for grid in np.meshgrid(lines, lines))
    whole = replace(whole, positions=np.stack([x, y, 0.0 * x], axis=-1)).rotated(rotation("x", -90.0))
    cell = np.arange(n)
    in_floor = (cell >= far) & (cell < n - far)
    of_floor = np.repeat((in_floor[:, None] & in_floor[None, :]).ravel(), 2)
    color = (0.62, 0.60, 0.56)
    floor, ground = (_part(whole, whole.triangles[part]) for part in (of_floor, ~of_floor))
    return (
        Object("floor", floor, color, closed=False),
        Object("ground", ground, color, closed=False, throws=False),
    )


def _curve(points, pieces):
    """A curve through ``points``, each step in so many pieces: Catmull and Rom's, whose tangent at a point is
    half the way between its neighbours.
    """
    p = np.array(points, np.float64)
    tangent = np.concatenate([p[1:2] - p[:1], 0.5 * (p[2:] - p[:-2]), p[-1:] - p[-2:-1]])
    t = (np.arange(pieces) / pieces)[None, :, None]
    a, b, m, n = (part[:, None] for part in (p[:-1], p[1:], tangent[:-1], tangent[1:]))
    # Hermite's form: a + m t + (3 (b - a) - 2 m - n) t^2 + (m + n - 2 (b - a)) t^3.
    way = b - a
    inside = a + t * (m + t * (3.0 * way - 2.0 * m - n + t * (m + n - 2.0 * way)))
    return np.concatenate([inside.reshape(-1, 2), p[-1:]])


def still_life(detail=40):
    """A ring that stands upright, a vase, a column, a sphere and a box on a floor that goes on as ground.

    ``detail``: how finely objects are divided (``detail_of``). Round ones have eight fifths as many segments;
    on panels too small for that (below 24) they have as many, and ground and vase are coarser.
    """
    small = detail < 24
    round_ = detail if small else detail * 8 // 5
    across = round_ // 2
    ring = (
        surfaces.torus(round_, across, 0.62, 0.17).rotated(rotation("x", 90.0)).rotated(rotation("y", 38.0))
    )
    vase = np.concatenate([[(0.0, 0.0)], _curve(_VASE, 1 if small else 3), [(0.0, _VASE[-1][1])]])
    floor, ground = floor_and_ground(6, _GROUND[1::2]) if small else floor_and_ground(12)
    return Scene(
        (
            floor,
            Object("ring", ring.moved(-1.25, 0.79, 0.95), (0.80, 0.52, 0.16), 0.6),
            Object("vase", surfaces.lathe(vase, round_).moved(0.15, 0.0, -0.35), (0.20, 0.42, 0.62), 0.5),
            Object("column", surfaces.lathe(_COLUMN, round_).moved(-1.7, 0.0, -1.5), (0.66, 0.62, 0.55), 0.1),
            Object(
                "sphere",
                surfaces.sphere(round_, across).scaled(0.5).moved(1.55, 0.5, 0.95),
                (0.72, 0.22, 0.2),
                0.7,
            ),
            Object(
                "box",
                surfaces.box(0.9, 1.2, 0.9).rotated(rotation("y", 48.0)).moved(1.5, 0.6, -1.3),
                (0.34, 0.52, 0.34),
                0.1,
            ),
            ground,
        )
    )


def still_life_and_lamp(size):
    """The still life with the detail of a panel's size, and a lamp on its left that lights just that."""
    lamp = Lamp(LAMP_POSITIONS[0], _LAMP_TARGET, _LAMP_NEAR, _LAMP_FAR, _LAMP_FIELD_OF_VIEW)
    return still_life(detail_of(size)), lamp


# From so far that every shadow of the lamps is in the picture; the far plane is beyond all that is seen.
_EYE, _CENTER, _FIELD_OF_VIEW, _NEAR, _FAR = (0.7, 5.7, 9.8), (0.0, 0.72, -0.1), 30.6, 3.0, 40.0


def still_life_view(panel):
    """The camera of ``still_life``."""
    projection = perspective(_FIELD_OF_VIEW, panel.width / panel.height, _NEAR, _FAR)
    return View(panel, look_at(_EYE, _CENTER), projection, _EYE, False)

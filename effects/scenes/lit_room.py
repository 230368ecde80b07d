"""A room with a lamp in its middle and things on every side of it, its front wall left out.

The scene of document 003's "limited field of view". World coordinates: y up, the floor at y = 0, the viewer
looks along -z.
"""

import numpy as np

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, rotation
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene

HALF_WIDTH, HEIGHT, BACK, FRONT = 3.0, 4.2, -3.0, 3.4
# Nearer to the back wall than half of its width: what 90 degrees hold is a square on it.
LAMP = (0.1, 2.15, -1.25)

_VASE = (
    *((0.0, 0.0), (0.30, 0.0), (0.20, 0.14), (0.40, 0.62), (0.36, 0.92), (0.16, 1.16)),
    *((0.24, 1.36), (0.0, 1.36)),
)


def smooth_profile(pieces):
    """The vase's profile with its side as a curve through the same points, each piece divided into so many: a
    tuple of (radius, height).

    The curve is Catmull and Rom's; its foot and its lip stay sharp.
    """
    side = np.array(_VASE[1:-1])
    before, after = np.concatenate([side[:1], side[:-1]]), np.concatenate([side[1:], side[-1:]])
    slope, out = 0.5 * (after - before), [_VASE[0], tuple(side[0].tolist())]
    for k in range(len(side) - 1):
        for t in (np.arange(pieces) + 1.0) / pieces:
            a, b = (1.0 + 2.0 * t) * (1.0 - t) ** 2, t * (1.0 - t) ** 2
            c, d = t * t * (3.0 - 2.0 * t), t * t * (t - 1.0)
            point = a * side[k] + b * slope[k] + c * side[k + 1] + d * slope[k + 1]
            out.append(tuple(point.tolist()))
    return (*out, _VASE[-1])


def walls(cells):
    """Floor, ceiling, left, right and back wall, facing inward, ``cells`` squares along each edge."""
    depth, middle = FRONT - BACK, (FRONT + BACK) / 2.0
    flat = surfaces.plane(cells, cells, HALF_WIDTH, depth / 2.0)
    side = surfaces.plane(cells, cells, depth / 2.0, HEIGHT / 2.0)
    back = surfaces.plane(cells, cells, HALF_WIDTH, HEIGHT / 2.0)
    left, right = (side.rotated(rotation("y", angle)) for angle in (90.0, -90.0))
    up = HEIGHT / 2.0
    return (
        ("floor", flat.rotated(rotation("x", -90.0)).moved(0.0, 0.0, middle), (0.60, 0.52, 0.42)),
        ("ceiling", flat.rotated(rotation("x", 90.0)).moved(0.0, HEIGHT, middle), (0.66, 0.66, 0.64)),
        ("left wall", left.moved(-HALF_WIDTH, up, middle), (0.66, 0.42, 0.36)),
        ("right wall", right.moved(HALF_WIDTH, up, middle), (0.40, 0.54, 0.62)),
        ("back wall", back.moved(0.0, up, BACK), (0.64, 0.62, 0.56)),
    )


def lit_room(detail=24, pieces=1):
    """The scene. ``detail``: segments of round things (``objects_and_lamps.detail_of``). ``pieces``: into how
    many each piece of the vase's side is divided; with more than one its side is a curve.
    """
    across = max(detail // 2, 6)
    profile = _VASE if pieces == 1 else smooth_profile(pieces)
    ring = surfaces.torus(detail, across, 0.55, 0.13).rotated(rotation("x", 62.0))
    table = surfaces.joined(
        surfaces.box(1.5, 0.1, 1.0).moved(0.0, 0.75, 0.0),
        *(surfaces.box(0.1, 0.7, 0.1).moved(x, 0.35, z) for x in (-0.66, 0.66) for z in (-0.4, 0.4)),
    )
    shelf = surfaces.joined(
        surfaces.box(0.5, 0.08, 1.5).moved(2.7, 2.3, -0.7),
        surfaces.box(0.28, 0.5, 0.12).moved(2.66, 2.59, -1.1),
        surfaces.box(0.28, 0.36, 0.16).moved(2.66, 2.52, -0.5),
    )
    things = (
        ("table", table.rotated(rotation("y", -18.0)).moved(1.2, 0.0, 1.1), (0.56, 0.36, 0.22), 0.1),
        ("vase", surfaces.lathe(profile, detail).moved(-1.2, 0.0, -1.5), (0.24, 0.46, 0.60), 0.5),
        (
            "ball",
            surfaces.sphere(detail, across).scaled(0.42).moved(-1.2, 0.42, 1.5),
            (0.72, 0.28, 0.22),
            0.6,
        ),
        ("ring", ring.moved(-1.9, 2.1, -0.3), (0.76, 0.56, 0.2), 0.6),
        ("shelf", shelf, (0.42, 0.34, 0.26), 0.1),
        ("picture", surfaces.box(1.3, 0.9, 0.16).moved(0.5, 2.2, -2.7), (0.36, 0.5, 0.34), 0.1),
    )
    bare = tuple(
        Object(name, surface, color, closed=False) for name, surface, color in walls(max(detail // 3, 4))
    )
    return Scene((*bare, *(Object(*thing) for thing in things)))


def lit_room_view(panel):
    """The camera of ``lit_room``, before the wall that is left out."""
    eye = (0.3, 2.35, 11.4)
    projection = perspective(29.0, panel.width / panel.height, 5.0, 16.0)
    return View(panel, look_at(eye, (0.0, 2.08, 0.0)), projection, eye, False)


def bulb():
    """A small sphere in the light's place, only to be seen."""
    return Object("bulb", surfaces.sphere(16, 8).scaled(0.09).moved(*LAMP), (1.0, 1.0, 1.0))

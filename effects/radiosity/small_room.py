"""A small room with a lamp in its ceiling and two boxes in it: the project's own, for radiosity.

World coordinates: y up, the floor at y = 0, the viewer looks along -z through the wall at z = 1.
"""

import numpy as np

from fixedpipe.effects.radiosity.form_factors import Box
from fixedpipe.effects.radiosity.progressive_refinement import Rectangle

HALF_WIDTH, HEIGHT, HALF_DEPTH = 1.0, 1.7, 1.0
BOXES = {
    "chest": Box((-0.42, 0.3, 0.12), (0.3, 0.3, 0.3), 20.0),
    "column": Box((0.42, 0.52, -0.38), (0.24, 0.52, 0.24), -17.0),
}
FRONT = "front wall"
# Of the ceiling's edges, the lamp's beginning and end, in eighths.
_LAMP = (3, 5)
_LIGHT = np.array((24.0, 21.0, 16.0))


def _rectangle(name, corner, across, up, reflectance, elements, patches, emission=0.0):
    vectors = (np.asarray(v, np.float64) for v in (corner, across, up))
    return Rectangle(name, *vectors, reflectance, (elements, elements), (patches, patches), emission)


def _faces(name, box, reflectance, elements, patches):
    """The five faces of a box that stands on the floor."""
    x, y, z = box.half
    faces = {
        "front": ((-x, -y, z), (2 * x, 0, 0), (0, 2 * y, 0)),
        "right": ((x, -y, z), (0, 0, -2 * z), (0, 2 * y, 0)),
        "back": ((x, -y, -z), (-2 * x, 0, 0), (0, 2 * y, 0)),
        "left": ((-x, -y, -z), (0, 0, 2 * z), (0, 2 * y, 0)),
        "top": ((-x, y, z), (2 * x, 0, 0), (0, 0, -2 * z)),
    }
    for side, (corner, across, up) in faces.items():
        corner, across, up = (box.to_world(np.array(v, np.float64)) for v in (corner, across, up))
        yield _rectangle(
            f"{name}, {side}", corner + np.array(box.middle), across, up, reflectance, elements, patches
        )


def small_room(elements=32, left=(0.68, 0.2, 0.12), right=(0.12, 0.36, 0.52)):
    """The room's rectangles: six walls that face inward, and five faces of each of ``BOXES``.

    elements     along a wall's edge, a multiple of 8; faces of boxes have half as many
    left, right  reflectances of the walls at the sides
    """
    if elements < 8 or elements % 8:
        raise ValueError(f"The room has {elements} elements along an edge; give a multiple of 8, from 8 on.")
    w, h, d = HALF_WIDTH, HEIGHT, HALF_DEPTH
    lamp = np.zeros((elements, elements, 3))
    first, last = (elements * eighths // 8 for eighths in _LAMP)
    lamp[first:last, first:last] = _LIGHT
    pale = (0.74, 0.72, 0.68)
    walls = (
        ("floor", (-w, 0, d), (2 * w, 0, 0), (0, 0, -2 * d), (0.62, 0.55, 0.46)),
        ("ceiling", (-w, h, -d), (2 * w, 0, 0), (0, 0, 2 * d), pale),
        ("left wall", (-w, 0, d), (0, 0, -2 * d), (0, h, 0), left),
        ("right wall", (w, 0, -d), (0, 0, 2 * d), (0, h, 0), right),
        ("back wall", (-w, 0, -d), (2 * w, 0, 0), (0, h, 0), pale),
        (FRONT, (w, 0, d), (-2 * w, 0, 0), (0, h, 0), pale),
    )
    out = [_rectangle(*wall, elements, 8, lamp if wall[0] == "ceiling" else 0.0) for wall in walls]
    for (name, box), color in zip(BOXES.items(), ((0.7, 0.68, 0.62), (0.72, 0.7, 0.66)), strict=True):
        out += _faces(name, box, color, elements // 2, 4)
    return tuple(out)

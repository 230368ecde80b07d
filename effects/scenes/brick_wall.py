"""A wall of bricks as a height field and as a colour map, to show bump mapping.

Bricks lie in courses; odd courses are moved by half a brick. Joints between them are lower by ``depth``, with
a slope of the width ``bevel``; noise roughens bricks and joints. The field is periodic, and its bits are the
same everywhere.
"""

import numpy as np

from fixedpipe.effects.geometry import height_fields

_BRICK, _DARK_BRICK = np.array((0.76, 0.38, 0.27)), np.array((0.50, 0.21, 0.16))
_MORTAR = np.array((0.72, 0.69, 0.63))


def _edges(size, across, courses, joint, bevel):
    """(how much of a brick a texel is, 0 to 1, and that brick's course and number)."""
    s, t = height_fields.texel_centers(size, size)
    y = t * courses
    course = np.floor(y)
    x = s * across - 0.5 * (course % 2)
    number = np.floor(x)
    # Distance to the nearest edge of the brick's cell, in units of the map's edge.
    beside = np.minimum(x - number, number + 1.0 - x) / across
    above = np.minimum(y - course, course + 1.0 - y) / courses
    cover = np.clip((np.minimum(beside, above) - 0.5 * joint) / bevel, 0.0, 1.0)
    return cover * cover * (3.0 - 2.0 * cover), course, number % across


def _checked(across, courses):
    if across < 1 or courses < 2 or courses % 2:
        raise ValueError(
            f"The wall has {courses} courses of {across} bricks; give at least one brick and an even number "
            "of courses, so that the moved ones repeat."
        )


def heights(size, across=5, courses=10, *, joint=0.016, bevel=0.012, depth=0.012, roughness=0.0015):
    """Heights of the wall, float64 [size, size], in units of the map's edge, as ``joint`` (the joints'
    width), ``bevel``, ``depth`` and ``roughness`` (of the noise on it) are.

    Raises ValueError if the courses could not repeat.
    """
    _checked(across, courses)
    cover, course, number = _edges(size, across, courses, joint, bevel)
    s, t = height_fields.texel_centers(size, size)
    # Every brick stands out by a little of its own: sevenths and elevenths repeat late.
    own = ((number * 7.0 + course * 4.0) % 11.0) / 11.0 - 0.5
    noise = height_fields.turbulence(s, t, 16, 3, 3)
    return depth * (cover * (1.0 + 0.3 * own)) + roughness * noise


def colors(size, across=5, courses=10, *, joint=0.016, bevel=0.012):
    """Colours of the wall, float64 [size, size, 3] in [0, 1]: each brick in its own shade, and mortar."""
    _checked(across, courses)
    cover, course, number = _edges(size, across, courses, joint, bevel)
    s, t = height_fields.texel_centers(size, size)
    shade = ((number * 5.0 + course * 3.0) % 7.0) / 6.0
    mottled = np.clip(shade + 0.5 * height_fields.turbulence(s, t, 12, 3, 8), 0.0, 1.0)[..., None]
    brick = _BRICK * mottled + _DARK_BRICK * (1.0 - mottled)
    cover = cover[..., None]
    return np.clip(brick * cover + _MORTAR * (1.0 - cover), 0.0, 1.0)

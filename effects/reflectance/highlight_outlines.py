"""S26: the outlines of Phong's highlight and of Blinn and Phong's on a plane, for a lamp and an eye at
points.

    Phong          (r.v)^m' = 1/2, r the lamp's mirrored ray
    Blinn, Phong   (n.h)^m = 1/2

For a distant lamp and eye, Phong's outline is a circle of directions v about r. Blinn and Phong's is longer
in the plane of incidence, by 1/cos theta. There, a tilt of h turns v by twice the tilt; across the plane it
turns v by twice the tilt's cosine theta. With m = 4 m' both are equally long.

The plane is y = 0 and mirrors the lamp to the eye at the origin. The module uses additions, products,
quotients, square roots and bisections alone, so its bits are the same everywhere.

Source: Schilling 1997, appendix A and figure 16; pass sequence A-S26 of the catalogue.
"""

from enum import StrEnum

import numpy as np

from fixedpipe.effects.bump_mapping.blinn import integer_power
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize, sine
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("S26", "outlines of Phong's highlight and of Blinn and Phong's on a plane", "A"),)

_NORMAL = np.array([0.0, 1.0, 0.0])
# Halvings of an interval: its end is beyond float64's last bit.
_HALVINGS = 60


class Model(StrEnum):
    """Whose highlight."""

    PHONG = "Phong"
    BLINN_PHONG = "Blinn-Phong"


def cosine_of(model, toward_light, toward_eye):
    """r.v or n.h of directions [..., 3], which need no length: float64 [...], above or below zero."""
    light, eye = normalize(toward_light), normalize(toward_eye)
    if Model(model) is Model.BLINN_PHONG:
        return dot(normalize(light + eye), _NORMAL)
    return dot(2.0 * light[..., 1:2] * _NORMAL - light, eye)


def half_cosine(exponent):
    """The cosine whose power is 1/2, below one. Raises ValueError where the exponent is no whole number from
    1 on.
    """
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if integer_power(middle, exponent) <= 0.5 else (low, middle)
    return low


def _last(inside, most):
    """The largest number from 0 to ``most`` [...] up to which ``inside`` says True, by bisection."""
    low, high = np.zeros(most.shape), most.copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        here = inside(middle)
        low, high = np.where(here, middle, low), np.where(here, high, middle)
    return low


def outline(model, exponent, elevation, count=128):
    """The outline on the plane, x and z of ``count`` + 1 points, the first one again at the end: float64
    [count + 1, 2].

    elevation  of lamp and eye above the plane, seen from the origin, degrees between 0 and 90: the lamp is at
               (0, tan, -1), the eye at (0, tan, 1)

    Raises ValueError for another elevation or an exponent below one.
    """
    if not 0.0 < elevation < 90.0:
        raise ValueError(f"Lamp and eye are {elevation} degrees high; give more than 0 and less than 90.")
    height, bound = float(sine(np.radians(elevation)) / cosine(np.radians(elevation))), half_cosine(exponent)
    angles = np.radians(360.0 * np.arange(count) / count)
    # Less across, so that a narrow outline has points at its ends too.
    narrow = float(sine(np.radians(elevation)))
    ray = normalize(np.stack([narrow * cosine(angles), np.zeros(count), sine(angles)], axis=-1))

    def inside(far):
        point = far[:, None] * ray
        return cosine_of(model, (0.0, height, -1.0) - point, (0.0, height, 1.0) - point) >= bound

    # Beneath lamp and eye, and as far again, nothing shines that does not shine up to there.
    points = (_last(inside, np.full(count, 4.0 * (1.0 + height)))[:, None] * ray)[:, 0::2]
    return np.concatenate([points, points[:1]])


def half_widths(model, exponent, theta):
    """(in the plane of incidence, across it): how far v may turn from the mirrored ray before the highlight
    falls to one half, degrees; the first is the mean of both sides. The lamp is far away, ``theta`` degrees
    from the normal.
    """
    s, c = np.sin(np.radians(theta)), np.cos(np.radians(theta))
    light, mirrored, bound = np.array([-s, c, 0.0]), np.array([s, c, 0.0]), half_cosine(exponent)
    found = []
    for axis in (np.array([c, -s, 0.0]), np.array([-c, s, 0.0]), np.array([0.0, 0.0, 1.0])):

        def inside(turn, axis=axis):
            return cosine_of(model, light, np.cos(turn) * mirrored + np.sin(turn) * axis) >= bound

        found.append(float(np.degrees(_last(inside, np.array(np.pi / 2.0)))))
    return 0.5 * (found[0] + found[1]), found[2]

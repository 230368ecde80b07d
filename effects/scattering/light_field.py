"""G28: a light field of a height field with scattered light: pictures from eyes on a plane.

There are two planes: eyes lie in a square above the field, and all pictures lie on the field's mean plane. So
a pixel is the same place in each picture. A picture from an eye in between is linear in four of them. That is
exact where the surface lies on the mean plane, and blurs the parts that stand out of it.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 6 (32 x 32 pictures); pass sequence A-G28. Assumed: the
parameterization, which is that of Levoy, Hanrahan 1996 and Gortler and others 1996.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.passes.arguments import positive
from fixedpipe.effects.scattering import goniometer
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("G28", "a light field of 32 x 32 pictures with scattered light", "6"),)


def _check_eye(field, distance):
    lowest = float(field.heights.max() - field.heights.mean())
    if not lowest < distance < math.inf:
        raise ValueError(
            f"The eyes are {distance!r} above the mean plane, and the field's highest point is {lowest:g}; "
            "give more."
        )


def seen_from(field, eye, size):
    """The texels of a HeightField's period that an eye sees: int32 [size, size], bottom row first.

    eye  (s, t, z): s and t in periods, z above the mean plane

    Raises ValueError for an eye that is not above the field, or too far away, and for a size below one.
    """
    size = goniometer.check_size(size)
    _check_eye(field, eye[2])
    place = (np.arange(size) + 0.5) / size
    s, t = (axis.ravel() for axis in np.meshgrid(place, place))
    along = np.stack([s - eye[0], t - eye[1], np.full(s.shape, -float(eye[2]))], axis=-1)
    mean, highest = float(field.heights.mean()), float(field.heights.max())
    start = (eye[2] - (highest - mean)) / eye[2]
    origins = np.stack(
        [eye[0] + start * along[:, 0], eye[1] + start * along[:, 1], 0.0 * s + highest], axis=-1
    )
    return goniometer.first_texels(field, origins, along).reshape(size, size)


@dataclass(frozen=True, eq=False)
class LightField:
    """Pictures [eyes, eyes, size, size, 3], float64, bottom rows first, from eyes over t and s.

    spread    the square of eyes reaches so far to either side of the field's middle, in periods
    distance  of the eyes above the mean plane
    """

    pictures: NDArray[np.float64]
    spread: float
    distance: float

    def eye(self, row, column):
        """Where a picture's eye is: (s, t, z)."""
        step = 2.0 * self.spread / (len(self.pictures) - 1)
        return 0.5 - self.spread + column * step, 0.5 - self.spread + row * step, self.distance

    def at(self, s, t):
        """The picture from an eye between, linear in the four around it: float64 [size, size, 3]. Eyes beyond
        the square are taken to its edge. Raises ValueError for NaN.
        """
        if s != s or t != t:
            raise ValueError(f"The eye is at {(s, t)!r}; give two numbers.")
        last = len(self.pictures) - 1
        column, row = (
            min(max((place - 0.5 + self.spread) / (2.0 * self.spread) * last, 0.0), float(last))
            for place in (s, t)
        )
        i, j = min(int(row), last - 1), min(int(column), last - 1)
        g, f = row - i, column - j
        low, high = (self.pictures[k, j] * (1.0 - f) + self.pictures[k, j + 1] * f for k in (i, i + 1))
        return low * (1.0 - g) + high * g


def simulated(field, sent, eyes=32, size=32, *, spread=1.0, distance=2.0, progress=None):
    """The LightField of a HeightField whose texels send ``sent`` [rows, columns, 3], scattered light too.

    eyes      along each edge of their square, 2 or more
    size      pixels along a picture's edge
    spread, distance  as for LightField
    progress  None, or a function that is called with the number of rows of eyes that are done

    Raises ValueError for too few eyes, eyes that are not above the field or are too far away, a spread that
    is not positive, a size below one, and light with other texels.
    """
    if not eyes >= 2 or int(eyes) != eyes:
        raise ValueError(f"The light field has {eyes} eyes along its edges; give 2 or more, a whole number.")
    size, spread = goniometer.check_size(size), positive(spread, "How far the eyes spread")
    if np.shape(sent) != (*field.heights.shape, 3):
        raise ValueError(f"The light has shape {np.shape(sent)}; give {(*field.heights.shape, 3)}.")
    _check_eye(field, distance)
    out = LightField(np.empty((eyes, eyes, size, size, 3)), spread, distance)
    flat = np.asarray(sent, np.float64).reshape(-1, 3)
    for row in range(eyes):
        for column in range(eyes):
            out.pictures[row, column] = flat[seen_from(field, out.eye(row, column), size)]
        if progress is not None:
            progress(row + 1)
    return out

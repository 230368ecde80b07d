"""Height fields that scatter light: heights, the normals of their bumps, and how they reflect.

Heights are float64 [rows, columns], bottom row first, at texel centres, in units of the edge of the field's
square. The field is periodic. Between texel centres it consists of triangles. Each square of four centres has
two, divided by the diagonal from lower left to upper right, as in ``surfaces.plane``. So the same field drawn
as a mesh is the same surface.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3. Assumed: triangles; the paper does not say what is
between grid points.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize, sine, unit_vector


@dataclass(frozen=True, eq=False)
class HeightField:
    """A periodic height field and how it reflects light.

    heights   float64 [rows, columns], bottom row first, in edges of the field's square
    normals   float64 [rows, columns, 3], unit vectors in the base's frame, z upward
    albedo    float64 [rows, columns, 3], 0 to 1: the share of light that is scattered evenly
    specular  k_s of k_s ((n.h)+)^exponent, which is added where (n.l) is positive
    exponent  of the highlight
    """

    heights: NDArray[np.float64]
    normals: NDArray[np.float64]
    albedo: NDArray[np.float64]
    specular: float = 0.0
    exponent: float = 16.0

    @property
    def rows(self) -> int:
        """Texels from bottom to top."""
        return self.heights.shape[0]

    @property
    def columns(self) -> int:
        """Texels from left to right."""
        return self.heights.shape[1]

    def with_albedo(self, albedo) -> "HeightField":
        """The same field with another albedo: a number, RGB, or [rows, columns, 3]."""
        return replace(self, albedo=_albedo(albedo, self.heights.shape))


def _albedo(albedo, shape):
    array = np.asarray(albedo, np.float64)
    try:
        array = np.broadcast_to(array[..., None] if array.ndim in (0, 2) else array, (*shape, 3))
    except ValueError:
        raise ValueError(
            f"The albedo has shape {array.shape}; give a number, RGB, or one for each of {shape} texels."
        ) from None
    if not ((array >= 0.0) & (array <= 1.0)).all():
        worst = float(array.flat[int(np.argmax(np.where(np.isfinite(array), np.abs(array - 0.5), np.inf)))])
        raise ValueError(
            f"The albedo is {worst:g} somewhere; a surface sends back from 0 to 1 of the light that it gets."
        )
    return np.ascontiguousarray(array)


def height_field(heights, albedo=0.8, *, normals=None, specular=0.0, exponent=16.0):
    """A HeightField of heights [rows, columns]; ``normals``: None computes them by central differences.

    Raises ValueError for heights that are not finite or fewer than 2 x 2, for an albedo or k_s that is not
    from 0 to 1, for an exponent below 1 and for normals of another shape or length.
    """
    heights = np.ascontiguousarray(height_fields.numbers(heights))
    if min(heights.shape) < 2:
        rows, columns = heights.shape
        raise ValueError(f"The height field has {columns} x {rows} texels; give at least 2 x 2.")
    if normals is None:
        normals = height_fields.frames(*height_fields.slopes(heights))[0]
    normals = np.asarray(normals, np.float64)
    if normals.shape != (*heights.shape, 3) or not (np.abs(dot(normals, normals) - 1.0) < 1e-6).all():
        raise ValueError(f"The normals have shape {normals.shape}; give a unit vector for each texel.")
    if not 0.0 <= specular <= 1.0:
        raise ValueError(f"k_s is {specular!r}; give a number from 0 to 1.")
    if not 1.0 <= exponent < math.inf:
        raise ValueError(f"The exponent is {exponent!r}; give a number from 1 on.")
    return HeightField(
        heights,
        np.ascontiguousarray(normals),
        _albedo(albedo, heights.shape),
        float(specular),
        float(exponent),
    )


def ridges(columns, rows, angle=45.0, count=2, left=(0.8, 0.8, 0.8), right=None):
    """The triangular height field: ``count`` ridges along t, whose flanks are ``angle`` degrees steep.

    left, right  albedo of the flanks that face -s and +s; without ``right`` both have one

    The normals are the flanks'. Source: figures 2 and 9. Raises ValueError for a flank that is not between 0
    and 90 degrees, and for columns that the ridges do not share evenly.
    """
    if not 0.0 < angle < 90.0:
        raise ValueError(f"The flanks are {angle!r} degrees steep; give an angle between 0 and 90.")
    if count < 1 or columns % (2 * count):
        raise ValueError(f"{count} ridges do not share {columns} columns; give a multiple of {2 * count}.")
    radians = math.radians(angle)
    rise, run = float(sine(radians)), float(cosine(radians))
    at = (np.arange(columns) + 0.5) / columns * count
    at = at - np.floor(at)
    climbs = at < 0.5
    heights = np.where(climbs, at, 1.0 - at) / count * (rise / run)
    normal = np.where(climbs[:, None], (-rise, 0.0, run), (rise, 0.0, run))
    albedo = np.where(climbs[:, None], left, left if right is None else right)
    return height_field(
        np.tile(heights, (rows, 1)),
        np.tile(albedo, (rows, 1, 1)),
        normals=normalize(np.tile(normal, (rows, 1, 1))),
    )


def domes(columns, rows, count=4, albedo=0.8, height=1.0):
    """``count`` x ``count`` round bumps, half balls of 0.45 of their cell's edge, ``height`` times as
    high.
    """
    s, t = height_fields.texel_centers(columns, rows)
    x, y = (s * count) % 1.0 - 0.5, (t * count) % 1.0 - 0.5
    heights = np.sqrt(np.maximum(0.45 * 0.45 - (x * x + y * y), 0.0)) / count * height
    return height_field(heights, albedo)


def bumps(columns, rows, albedo=0.8, height=0.12):
    """Table 1's third field: |sin(2 pi s) sin(2 pi t)| times ``height``, creases between bumps."""
    s, t = height_fields.texel_centers(columns, rows)
    return height_field(height * np.abs(sine(2.0 * math.pi * s) * sine(2.0 * math.pi * t)), albedo)


def check_light(light, what="The light's direction"):
    """A direction to a light, of length one: float64 [3]. Raises ValueError where it is no direction, or
    below the horizon.
    """
    vector = unit_vector(light, what)
    if vector[2] <= 0.0:
        raise ValueError(
            f"{what} is {tuple(np.ravel(light).tolist())}, which is not above the horizon; give a "
            "third number above 0."
        )
    return vector

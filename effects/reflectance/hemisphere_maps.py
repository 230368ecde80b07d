"""Functions of a direction above the horizon as square maps, and a reflectance's parameters as two
directions.

A map has one paraboloid's disc, over the hemisphere around z. A direction w lies at (x, y)/(1 + z), from -1
to 1. Its texture coordinate is ((x + 1 + z)/2, (y + 1 + z)/2, 0, 1 + z), which any machine divides by the
last component at each pixel. Texels beyond the disc's edge hold the edge's value, so a direction below the
horizon finds the horizon's. On boards with cube maps the same function fills one, and w itself is the
coordinate.

Source: Heidrich, Seidel 1998 (parabolic maps); Kautz, McCool 1999 (halfway and difference vector by
Gram-Schmidt); Heidrich 2001, sections 1.1.2 and 1.3.
"""

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.geometry.vectors import cross, dot, from_frame, in_frame, normalize
from fixedpipe.effects.reflectance.brdfs import Brdf, Frame

# Texels along an edge of factors' maps. Measured: 48 take half a gigabyte and seconds; both grow with the
# fourth power.
LEAST_SIZE, LARGEST_SIZE = 4, 64


class Halves(Enum):
    """What the first and the second factor are functions of."""

    HALFWAY_AND_DIFFERENCE = "halfway and difference vector"
    LIGHT_AND_VIEW = "light and view"


def _edge(size):
    edge = 2.0 * (np.arange(cube_maps.size_of(size, "A map of directions' size")) + 0.5) / size - 1.0
    return np.meshgrid(edge, edge)


def _drawn_in(s, t, radius):
    """Places that are farther than ``radius`` from the middle, moved there."""
    reach = np.sqrt(s * s + t * t)
    scale = np.where(reach > radius, radius / np.where(reach > 0.0, reach, 1.0), 1.0)
    return s * scale, t * scale


def directions(size):
    """Unit vectors of texels, ``size`` along an edge: float64 [size, size, 3], t from -1 first. Those at the
    edge of the disc and beyond are half a texel above the horizon.
    """
    return parabolic_maps.of_places(*_drawn_in(*_edge(size), 1.0 - 1.0 / max(size, 2)))[1]


def inside(size):
    """The texels whose centres lie on the disc, as indices of the flat map: int64 [n]."""
    return np.flatnonzero(parabolic_maps.inside(size).ravel())


def solid_angles(size):
    """Solid angles of the texels of ``inside``: float64 [n]."""
    return parabolic_maps.solid_angles(size).ravel()[inside(size)]


def filled(values, size, known=None):
    """A map with values [n, c] in the texels of ``inside``: float64 [size, size, c]. The other texels get the
    nearest one's values, and so do those that are not ``known``, bool [n].
    """
    held = inside(size)
    held = held if known is None or not known.any() else held[known]
    out = np.zeros((size * size, values.shape[-1]))
    out[inside(size)] = values
    missing = np.setdiff1d(np.arange(size * size), held)
    row, column = held // size, held % size
    for texel in missing:
        down, across = row - texel // size, column - texel % size
        out[texel] = out[held[int(np.argmin(down * down + across * across))]]
    return out.reshape(size, size, -1)


def above(vectors):
    """Vectors [..., 3], those below the horizon drawn up to it, of any length."""
    vectors = np.array(vectors, np.float64)
    vectors[..., 2] = np.maximum(vectors[..., 2], 0.0)
    return vectors


def coordinates(vectors):
    """Texture coordinates of directions [n, 3]: float64 [n, 4], to be divided by the last at each pixel."""
    x, y, z = np.moveaxis(above(vectors), -1, 0)
    reach = np.sqrt((x * x + y * y) + z * z) + z
    return np.stack([0.5 * (x + reach), 0.5 * (y + reach), 0.0 * x, reach], axis=-1)


def look_up(image, vectors):
    """The values of a map [n, n, c] along directions [..., 3], bilinear: float64 [..., c]."""
    return parabolic_maps.look_up(np.stack([image, image]), above(vectors))


def cube(image, size):
    """A map as a cube map: float64 [6, size, size, c]; the lower half repeats the horizon's values."""
    return look_up(image, cube_maps.directions(size))


# ------------------------------------------------------------------------------------------- parameters


def _frames(half):
    """Tangents and binormals about halfway vectors [..., 3]: the surface's, made perpendicular."""
    x = np.zeros_like(half)
    x[..., 0] = 1.0
    tangents = x - half[..., :1] * half
    # The tangent itself is a halfway vector on the horizon alone; there the binormal takes its part.
    lost = dot(tangents, tangents) < 1e-12
    tangents = normalize(np.where(lost[..., None], (0.0, 0.0, -1.0), tangents))
    return tangents, cross(half, tangents)


def halfway_and_difference(lights, views):
    """The halfway vectors of lights and views [..., 3], and the lights as the halfway vectors' frames see
    them: two float64 [..., 3].
    """
    half = normalize(np.asarray(lights, np.float64) + views)
    return half, in_frame(lights, *_frames(half), half)


def light_and_view(half, difference):
    """The inverse: lights and views of halfway and difference vectors [..., 3]."""
    half = np.asarray(half, np.float64)
    lights = from_frame(difference, *_frames(half), half)
    return lights, (2.0 * dot(half, lights))[..., None] * half - lights


def halves_of(halves, lights, views):
    """The two vectors on which factors depend: two float64 [..., 3]."""
    if halves is Halves.LIGHT_AND_VIEW:
        return np.asarray(lights, np.float64), np.asarray(views, np.float64)
    return halfway_and_difference(lights, views)


# --------------------------------------------------------------------------------------------- inputs


@dataclass(frozen=True, eq=False)
class AnalyticBRDF:
    """A row of ``brdfs.BRDFS`` in the form that is factored: an object with ``at``. ``parameters``: by name,
    those that are not to have their default.
    """

    row: Brdf
    parameters: dict[str, Any] = field(default_factory=dict)

    def at(self, lights, views):
        """f_r of directions [n, 3] each in the surface's frame: float64 [n, 3], per steradian."""
        frame = Frame(np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        found = self.row.reflectance(lights, views, frame, **self.parameters)
        return np.repeat(np.asarray(found, np.float64)[..., None], 3, axis=-1)


def size_of_factors(size):
    """Texels along an edge of factors' maps, as an int. Raises ValueError for a size that is not from 4 to
    64.
    """
    if isinstance(size, bool) or int(size) != size or not LEAST_SIZE <= size <= LARGEST_SIZE:
        raise ValueError(
            f"The factors' maps have {size!r} texels along an edge; give {LEAST_SIZE} or more, "
            f"{LARGEST_SIZE} at the most."
        )
    return int(size)


def sampled(brdf, lights, views):
    """f_r of an object with ``at`` for directions [n, 3] each: float64 [n, 3], at least zero.

    Raises ValueError where it gives another shape, and where it is NaN or infinity.
    """
    found = np.asarray(brdf.at(lights, views), np.float64)
    if found.shape != lights.shape:
        raise ValueError(f"The BRDF's at gives the shape {found.shape} for {len(lights)} pairs; give [n, 3].")
    if not np.isfinite(found).all():
        worst = int(np.flatnonzero(~np.isfinite(found).all(axis=-1))[0])
        raise ValueError(
            f"The BRDF is {found[worst].tolist()} for light {lights[worst].tolist()} and view "
            f"{views[worst].tolist()}; give finite numbers above the horizon."
        )
    return np.maximum(found, 0.0)

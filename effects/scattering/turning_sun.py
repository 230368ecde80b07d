"""G34 for a sun that moves: its light that a height field sends back, on bases of several orientations.

The numbers are ``environment_light.sun_alone``'s, to the bit. What can be known of a field before the sun is
known is computed once (``Prepared``). Two things are left out, as they change no bit:

- Directions along which a texel sees no other bring no light of the sun. A list says which texels it does
  see.
- A ray that has passed all that is high enough in its quarter is free, however far it goes on.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import light_transport
from fixedpipe.effects.scattering.height_field import HeightField
from fixedpipe.effects.scattering.visibility import MOST_TILES, Visibility, check_same_texels, hit
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.raster.kernel import kernel

# Distances from a texel, in texels along the axis along which a ray goes farther. Before the first a ray
# crosses no line on which triangles meet. A crossing lies between two texels and is rounded, so heights are
# of so many texels more.
_RINGS = (0.49, 1, 2, 4, 8, 16, 32, 64)
_MARGIN = 2
# Times the largest height and one. Assumed: larger by far than float64's rounding of a ray's height, smaller
# by far than any bump.
_SAFE = 1e-9


@dataclass(frozen=True, eq=False)
class Prepared:
    """Results for a HeightField and its Visibility that need no light.

    field     the HeightField
    albedo    float64 [rows, columns, 3], the field's
    weight    of the light along one direction
    first     int64 [texels + 1]: where each texel's list begins
    seen      int32 [m]: the texels that it sees, in the directions' order
    cosines   float64 [m]: of the directions along which it sees them
    around    float64 [2, 2, rings, rows, columns]: the height that a free ray must exceed between a ring and
              the next, where x and y grow (0) or fall (1); beyond the last ring, anywhere
    """

    field: HeightField
    albedo: NDArray[np.float64]
    weight: float
    first: NDArray[np.int64]
    seen: NDArray[np.int32]
    cosines: NDArray[np.float64]
    around: NDArray[np.float64]


@kernel("void(float64[:, :, ::1], float64[:, ::1], int32[:, :, ::1], int64[::1], int32[::1], float64[::1])")
def _list(normals, directions, seen, places, texels, cosines):
    """Fill the lists, which begin at ``places``; these are where they end afterwards."""
    for i in range(len(directions)):
        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
        for row in range(seen.shape[1]):
            for column in range(seen.shape[2]):
                if seen[i, row, column] >= 0:
                    n = normals[row, column]
                    place = places[row * seen.shape[2] + column]
                    texels[place] = seen[i, row, column]
                    cosines[place] = (n[0] * x + n[1] * y) + n[2] * z
                    places[row * seen.shape[2] + column] += 1


def _highest(heights, reach, axis, towards):
    """How high a field that repeats is from each texel on, ``reach`` texels ``towards`` 1 or -1 along an
    axis.
    """
    found, width, wanted = heights, 1, reach + 1 + 2 * _MARGIN
    while width < wanted:
        step = min(width, wanted - width)
        found = np.maximum(found, np.roll(found, -towards * step, axis))
        width += step
    return np.roll(found, towards * _MARGIN, axis)


def prepared(field, visibility: Visibility) -> Prepared:
    """What ``sunlit`` needs of a HeightField. Raises ValueError for another field's Visibility."""
    check_same_texels(field, visibility)
    first = np.zeros(field.rows * field.columns + 1, np.int64)
    np.cumsum((visibility.seen >= 0).sum(axis=0).reshape(-1), out=first[1:])
    seen, cosines = np.empty(first[-1], np.int32), np.empty(first[-1])
    _list(field.normals, visibility.directions, visibility.seen, first[:-1].copy(), seen, cosines)
    around = np.empty((2, 2, len(_RINGS), field.rows, field.columns))
    safe = _SAFE * (1.0 + float(np.abs(field.heights).max()))
    for i, along_x in enumerate((1, -1)):
        for j, along_y in enumerate((1, -1)):
            around[i, j, -1] = field.heights.max() + safe
            for ring, reach in enumerate(_RINGS[1:]):
                columns = _highest(field.heights, reach, 1, along_x)
                around[i, j, ring] = _highest(columns, reach, 0, along_y) + safe
    weight = light_transport.WEIGHT / visibility.count
    return Prepared(field, np.array(field.albedo), weight, first, seen, cosines, around)


@kernel(
    "void(int64, int64, float64[:, ::1], float64, float64[:, :, ::1], float64[::1], float64[:, :, ::1], "
    "float64[:, :, ::1], float64[::1], float64[::1], float64[::1], float64[:, :, ::1])"
)
def _direct(begin, end, heights, highest, around, rings, normals, albedo, light, ray, sun, out):
    """The sun's light that texels of some rows send back, with its shadows.

    light, ray  towards the sun: as it is given, and of length one, as rays are
    around      what the ray must be above, in its quarter, up to the next ring
    rings       lengths of the ray at their distances
    """
    rows, columns = heights.shape
    most, last = MOST_TILES * 3 * (rows + columns), len(rings) - 1
    direction = ray[0] * columns, ray[1] * rows, ray[2]
    for row in range(begin, end):
        for column in range(columns):
            n = normals[row, column]
            facing = (n[0] * light[0] + n[1] * light[1]) + n[2] * light[2]
            if facing > 0.0 and (n[0] * ray[0] + n[1] * ray[1]) + n[2] * ray[2] > 0.0:
                # The first ring from which on the ray is above all that lies in its quarter.
                ring = last + 1
                while ring > 0:
                    lowest = heights[row, column] + direction[2] * rings[ring - 1]
                    if not lowest > around[ring - 1, row, column]:
                        break
                    ring -= 1
                if ring > 0:
                    enough = rings[ring] if ring <= last else np.inf
                    if hit(heights, column, row, direction, highest, most, enough)[0] >= 0:
                        facing = 0.0
            else:
                facing = 0.0
            for k in range(3):
                out[row, column, k] = albedo[row, column, k] * facing * sun[k]


@kernel(
    "void(int64, int64, int64[::1], int32[::1], float64[::1], float64[:, ::1], float64, float64[:, ::1], "
    "float64[:, ::1], float64[:, ::1])"
)
def _scatter(begin, end, first, seen, cosines, albedo, weight, light, out, found):
    """What texels send back of each other's light, and add it to what is found."""
    for texel in range(begin, end):
        red, green, blue = 0.0, 0.0, 0.0
        others, weights = seen[first[texel] : first[texel + 1]], cosines[first[texel] : first[texel + 1]]
        for k in range(len(others)):
            # An index without a sign: a negative one would count from the end, and each would be looked at.
            cosine, sent = weights[k], light[np.uint64(others[k])]
            red += cosine * sent[0]
            green += cosine * sent[1]
            blue += cosine * sent[2]
        out[texel, 0] = albedo[texel, 0] * (red * weight)
        out[texel, 1] = albedo[texel, 1] * (green * weight)
        out[texel, 2] = albedo[texel, 2] * (blue * weight)
        for k in range(3):
            found[texel, k] += out[texel, k]


def for_each(work, kinds):
    """``work`` done on each of ``kinds``, by one thread a processor: a list, in their order."""
    with ThreadPoolExecutor(default_threads()) as threads:
        return list(threads.map(work, kinds))


def sunlit(known: Prepared, light, sun, bounces) -> NDArray[np.float64]:
    """A sun's light that the field sends back, scattered ``bounces`` times: float64 [rows, columns, 3].

    light  towards the sun in the base's frame, a unit vector; sun: its RGB

    Raises ValueError for a light that is no direction.
    """
    light = sphere.finite(light, "The sun's direction")
    field = known.field
    found = np.zeros((*field.heights.shape, 3))
    if not light[2] > 0.0:
        return found
    ray, sun = sphere.checked(light[None])[0], np.array(sun, np.float64)
    farther = max(abs(ray[0]) * field.columns, abs(ray[1]) * field.rows)
    _direct(
        0, field.rows, field.heights, float(field.heights.max()),
        known.around[int(ray[0] < 0.0), int(ray[1] < 0.0)],
        np.array(_RINGS) / farther if farther else np.full(len(_RINGS), np.inf),
        field.normals, known.albedo, light, ray, sun, found,
    )  # fmt: skip
    if not len(known.seen):
        return found
    texels = field.rows * field.columns
    flat, albedo = found.reshape(texels, 3), known.albedo.reshape(texels, 3)
    arriving, sent = flat.copy(), np.empty((texels, 3))
    for _ in range(bounces):
        _scatter(
            0, texels, known.first, known.seen, known.cosines, albedo, known.weight, arriving, sent, flat
        )
        arriving, sent = sent, arriving
    return found

"""Height fields, made or taken from photographs and elevation data, and the local frames on them.

A height field is float64 [rows, columns], bottom row first, over a unit square of texture; s runs along
columns, t along rows. It is periodic, as the material textures repeat.

Source: Blinn 1978 (the perturbed normal); Kilgard 2000, section 5 (normals by finite differences).
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, normalize
from fixedpipe.pipeline.textures.pixels import array_of, refused_type

# Luminance of a colour: Rec. 601 weights, as photographs of the time were made grey.
LUMINANCE = (0.299, 0.587, 0.114)
# Of a picture that become floats at a time.
_ROWS = 256


def frames(slope_s, slope_t):
    """Normal, tangent and binormal of z = h(s, t) from its two slopes: three float64 [..., 3] of length one.

    n = (-dh/ds, -dh/dt, 1), t = (1, 0, dh/ds), b = n x t, each normalized.
    """
    slope_s, slope_t = np.broadcast_arrays(np.asarray(slope_s, np.float64), np.asarray(slope_t, np.float64))
    one, zero = np.ones(slope_s.shape), np.zeros(slope_s.shape)
    normal = normalize(np.stack([-slope_s, -slope_t, one], axis=-1))
    tangent = normalize(np.stack([one, zero, slope_s], axis=-1))
    return normal, tangent, cross(normal, tangent)


def numbers(heights):
    """A height field's numbers as float64. Heights are measured in a unit, so a whole number has its plain
    value in every type: a byte of 64 is 64.

    Raises ValueError for anything but numbers, for NaN and infinity, another shape, or no texels.
    """
    array = array_of(heights, "The height field")
    if array.dtype.kind not in "biuf":
        raise refused_type(array, "The height field", "real numbers, whole ones or floats")
    if array.ndim != 2 or 0 in array.shape:
        empty = ", so it is empty" if 0 in array.shape else ""
        raise ValueError(f"The height field has shape {array.shape}{empty}; give some [rows, columns].")
    array = array.astype(np.float64, copy=False)
    if not np.isfinite(array).all():
        raise ValueError("The height field holds NaN or infinity; fill the missing values first.")
    return array


def _neighbours(heights, axis, periodic):
    """The next and the previous heights along an axis; without ``periodic`` the edge continues level."""
    count = heights.shape[axis]
    at = np.arange(count)
    after, before = (at + 1) % count, (at - 1) % count
    if not periodic:
        after[-1], before[0] = count - 1, 0
    return heights.take(after, axis), heights.take(before, axis)


def slopes(heights, periodic=True):
    """Slopes (dh/ds, dh/dt) of a height field by central differences.

    The field covers a unit square, and heights are in units of its edge. Without ``periodic`` it continues
    level beyond its edges.
    """
    heights = numbers(heights)
    out = []
    for axis in (1, 0):
        after, before = _neighbours(heights, axis, periodic)
        out.append((after - before) * (heights.shape[axis] / 2.0))
    return tuple(out)


def dome_slopes(s, t, rim_radius=0.6, rim_slope=1.0):
    """Slopes of one spherical cap per unit square of (s, t), flat between. The slope jumps at the rim: there
    the local frame has a crease.

    rim_radius  in half the square's edge, of any shape that broadcasts with s
    rim_slope   the slope at the rim; 1 is an angle of 45 degrees

    Source: the catalogue's figure F004-2: domes with a 45 degree rim.
    """
    u, v = (s - np.floor(s)) * 2.0 - 1.0, (t - np.floor(t)) * 2.0 - 1.0
    r2, rim2 = u * u + v * v, rim_radius * rim_radius
    inside = r2 < rim2
    # The cap's sphere has radius rim_radius / sin(rim's angle): at 45 degrees its square is twice the rim's.
    z = np.sqrt((1.0 + 1.0 / (rim_slope * rim_slope)) * rim2 - np.where(inside, r2, 0.0))
    return np.where(inside, -u / z, 0.0), np.where(inside, -v / z, 0.0)


def texel_centers(columns, rows):
    """Texture coordinates (s, t) of texel centres: two float64 [rows, columns], bottom row first."""
    return np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)


def from_image(image):
    """Heights in [0, 1] from an image or an elevation array, bottom row first.

    Parameters
    ----------
    image
        [rows, columns] or [rows, columns, 1..4 components], top row first, any numeric type. Colours become
        luminance; alpha is ignored. The lowest value becomes 0 and the highest 1, so bytes, the 16 bits of an
        elevation model and metres need no scale.

    Raises ValueError for another shape, an empty image, a value that is not finite, or a constant image.
    """
    array = array_of(image, "The image")
    if array.dtype.kind not in "biuf":
        raise refused_type(array, "The image", "real numbers, whole ones or floats")
    if 0 in array.shape:
        raise ValueError(f"The image has shape {array.shape}, so it is empty; give at least one pixel.")
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] > 4):
        raise ValueError(
            f"The image has shape {array.shape}; give [rows, columns] or [rows, columns, 1 to 4]."
        )
    heights = _luminance(array) if array.ndim == 3 else array.astype(np.float64)
    low, high = float(heights.min()), float(heights.max())
    if not np.isfinite([low, high]).all():  # of NaN anywhere both are NaN
        raise ValueError(
            "The image holds NaN or infinity; fill the missing values before making a height field."
        )
    # Differences of the largest float64 would overflow; a power of two changes no digit.
    if max(-low, high) > 2.0**1000:
        heights, low, high = heights * 0.25, low * 0.25, high * 0.25
    if low == high:
        raise ValueError(
            f"Every value of the image is {low:g}; a height field needs at least two different heights."
        )
    heights -= low
    heights /= high - low
    return heights[::-1]


def _luminance(array):
    """Colours or grey [rows, columns, 1..4] as float64 [rows, columns], of a few rows at a time: pictures are
    large, and stay in their own type beside it.
    """
    out = np.empty(array.shape[:2])
    for first in range(0, len(array), _ROWS):
        some = array[first : first + _ROWS]
        red, green, blue = (some[..., k if array.shape[2] >= 3 else 0].astype(np.float64) for k in range(3))
        out[first : first + _ROWS] = (LUMINANCE[0] * red + LUMINANCE[1] * green) + LUMINANCE[2] * blue
    return out


def resample(heights, columns, rows):
    """A height field at another size: halved by boxes while twice too large, then bilinear between texel
    centres.
    """
    heights = numbers(heights)
    for axis, size in ((0, rows), (1, columns)):
        heights = np.swapaxes(heights, 0, axis)
        while len(heights) >= 2 * size:
            even = len(heights) & ~1
            heights = heights[0:even:2] + heights[1:even:2]
            heights /= 2
        at = np.clip((np.arange(size) + 0.5) * (len(heights) / size) - 0.5, 0.0, len(heights) - 1.0)
        low = np.minimum(np.floor(at).astype(np.int64), max(len(heights) - 2, 0))
        high = np.minimum(low + 1, len(heights) - 1)
        f = (at - low)[:, None]
        heights = np.swapaxes(heights[low] * (1.0 - f) + heights[high] * f, 0, axis)
    return np.ascontiguousarray(heights)


def tileable(heights, margin=1 / 8):
    """A height field without seams where it repeats, smaller by ``margin`` along both axes.

    The last strip of the field, ``margin`` wide, is faded into the first, so that the field continues across
    its edges. Fields of fewer than eight texels along an axis are left alone there.
    """
    heights = numbers(heights).copy()
    for axis in (0, 1):
        heights = np.swapaxes(heights, 0, axis)
        strip = int(len(heights) * margin)
        if strip:
            kept = len(heights) - strip
            fade = (np.arange(strip) / strip)[:, None]
            heights[:strip] = heights[kept:] * (1.0 - fade) + heights[:strip] * fade
            heights = heights[:kept]
        heights = np.swapaxes(heights, 0, axis)
    return heights


def smooth(heights, passes=1, periodic=True):
    """A height field after ``passes`` binomial filters (1 2 1)/4 along both axes."""
    heights = numbers(heights)
    for _ in range(passes):
        for axis in (0, 1):
            after, before = _neighbours(heights, axis, periodic)
            heights = (before + 2.0 * heights + after) / 4.0
    return heights


def hashed(x, y, seed):
    """Integers to 16 well-mixed bits, by 32-bit multiplications and shifts that give the same everywhere."""
    h = (
        np.asarray(x, np.uint64) * 374761393 + np.asarray(y, np.uint64) * 668265263 + seed * 2246822519
    ) & 0xFFFFFFFF
    for shift, factor in ((15, 2246822519), (13, 3266489917)):
        h = ((h ^ (h >> np.uint64(shift))) * np.uint64(factor)) & np.uint64(0xFFFFFFFF)
    return ((h ^ (h >> np.uint64(16))) & np.uint64(0xFFFF)).astype(np.int64)


def value_noise(columns, rows, cells_s, cells_t, seed):
    """Periodic noise in [-1, 1]: random values on a lattice of cells_s x cells_t, joined by a cubic.

    The lattice values are multiples of 1/32768 - 1, from an integer hash.
    """
    s, t = texel_centers(columns, rows)
    x, y = s * cells_s, t * cells_t
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    f, g = x - i, y - j
    f, g = f * f * (3.0 - 2.0 * f), g * g * (3.0 - 2.0 * g)

    def value(di, dj):
        return hashed((i + di) % cells_s, (j + dj) % cells_t, seed) / 32767.5 - 1.0

    low = value(0, 0) * (1.0 - f) + value(1, 0) * f
    high = value(0, 1) * (1.0 - f) + value(1, 1) * f
    return low * (1.0 - g) + high * g


def gradient_noise(s, t, cells, seed):
    """Periodic noise at texture coordinates, about in [-1, 1], with ``cells`` x ``cells`` cells in a unit
    square.

    The noise is zero at a cell's corners. Each corner has a gradient from an integer hash; a quintic joins
    them, so slopes and curvatures are continuous. Source: Perlin 2002, with gradients of any length up to
    sqrt(2) instead of twelve.
    """
    x, y = s * cells, t * cells
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    f, g = x - i, y - j
    a, b = (u * u * u * (u * (u * 6.0 - 15.0) + 10.0) for u in (f, g))

    def value(di, dj):
        corner = (i + di) % cells, (j + dj) % cells
        gx, gy = (hashed(*corner, 2 * seed + k) / 32767.5 - 1.0 for k in (0, 1))
        return gx * (f - di) + gy * (g - dj)

    low = value(0, 0) * (1.0 - a) + value(1, 0) * a
    high = value(0, 1) * (1.0 - a) + value(1, 1) * a
    return 1.5 * (low * (1.0 - b) + high * b)


def turbulence(s, t, cells, octaves, seed):
    """Periodic noise of several sizes: each octave has twice the cells and half the height of the last."""
    total, amplitude, out = 0.0, 1.0, 0.0
    for k in range(octaves):
        out = out + amplitude * gradient_noise(s, t, cells << k, seed + k)
        total, amplitude = total + amplitude, amplitude * 0.5
    return out / total


def pebbles(columns, rows, cells, seed):
    """A periodic bed of round stones, ``cells`` x ``cells`` of them: heights in units of the field's edge.

    The odd rows of a lattice are moved by half a cell, and every cell holds one stone: a half ball with a
    radius of 0.5 to 0.7 cells. Its centre lies up to a quarter of a cell from the cell's. Where stones
    overlap the higher one is seen. Centres and radii come from an integer hash.

    Raises ValueError when ``cells`` is not an even number from 2 on, as the moved rows could not repeat.
    """
    if cells < 2 or cells % 2:
        raise ValueError(f"The bed has {cells} x {cells} pebbles; give an even number from 2 on.")
    s, t = texel_centers(columns, rows)
    x, y = s * cells, t * cells
    heights = np.zeros((rows, columns))
    for dj in (-1, 0, 1):
        j = np.floor(y).astype(np.int64) + dj
        moved = x - 0.5 * (j % 2)
        for di in (-1, 0, 1):
            i = np.floor(moved).astype(np.int64) + di
            u, v, w = (hashed(i % cells, j % cells, 3 * seed + k) / 65535.0 - 0.5 for k in range(3))
            dx, dy = moved - (i + 0.5 + 0.5 * u), y - (j + 0.5 + 0.5 * v)
            radius = 0.6 + 0.2 * w
            heights = np.maximum(heights, np.sqrt(np.maximum(radius * radius - (dx * dx + dy * dy), 0.0)))
    return heights / cells


def pebble_slopes(size, cells, depth, seed=5):
    """Slopes (dh/ds, dh/dt) of a bed of ``cells`` x ``cells`` pebbles, ``size`` texels along both edges: half
    balls with ``depth`` 1, flatter with less.
    """
    return slopes(smooth(pebbles(size, size, cells, seed), 2) * depth)

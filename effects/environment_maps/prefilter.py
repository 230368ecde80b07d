"""H25, H29, H33: environment maps filtered beforehand as floats.

A cosine filters for diffuse light, Phong's lobe for glossy reflection:

    L_o(r) = sum of w(r.l) L(l) / sum of w(r.l),  w = (r.l)+^(1/r') times the texel's solid angle

The sum is over the whole sphere; r' is the roughness and 1/r' Phong's exponent. Because the sum is divided by
its own weights, it leaves a constant map unchanged. For an integral, k_s = (1/r' + 1)/(2 pi) does the same.
With an exponent of one this is irradiance over pi.

A lobe of exponent e is about 1/sqrt(e) radians wide, and hides much finer detail. So the map is first
averaged to texels of a fifth of that width or less. The lobe's sum is computed on a grid of a third of the
width, and cubics interpolate between. The grid continues beyond each face's edge, so there is no seam.

Source: Heidrich 2001, sections 1.4 and 1.6, Eq. 6; erratum E000.7 (the sphere and not n's hemisphere); pass
sequences A-H25, A-H29 and A-H33 of the catalogue.
"""

import math

import numpy as np

from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique(
        "H25", "diffuse light from an environment map: a cosine filter, looked up by the normal", "1.4"
    ),
    Technique("H29", "glossy reflection: an environment map filtered by Phong's lobe", "1.6"),
    Technique("H33", "environments of high dynamic range, filtered before they become bytes", "1.6"),
)

# Assumed: below this a lobe's weight is left out; what shines a thousand times as bright as a map's mean adds
# less than a byte's step there.
_LEAST_WEIGHT = 1.0e-6
# Texels of the map, and places of the grid, in the lobe's width 1/sqrt(exponent).
# Measured: against sums over all texels, a thousandth of a room's range, 1 % of the image of a point.
_TEXELS_A_WIDTH, _PLACES_A_WIDTH = 5.0, 3.0
# Texels larger than a half of the width are parted, each a square of one colour.
_FEWEST_TEXELS_A_WIDTH = 2.0
# Edges that are not gone below, whatever the lobe.
_LEAST_TEXELS, _LEAST_PLACES = 32, 8
# Texels are taken in squares of so many, which are left out together.
_BLOCK = 8
# Exponents are whole numbers of this: a power is made of squares and square roots alone, which have the same
# bits on every processor.
EXPONENT_STEP = 2.0**-8
LARGEST_EXPONENT = 16384.0


@kernel(
    "void(float64[:, ::1], float64[:, ::1], float64[:, ::1], int64, float64, "
    "float64[:, ::1], float64[:, ::1])"
)
def _filtered(toward, blocks, texels, power, least, scratch, out):
    """Sums over a lobe for directions [n, 3]: out [n, 3].

    blocks  float64 [m, 4]: the direction of a square of texels and the cosine of how far it reaches
    texels  float64 [7, m * block]: x, y, z, solid angle and colour, square after square
    power   the exponent in steps of EXPONENT_STEP
    least   the cosine below which nothing counts
    scratch float64 [3, block], of any content
    """
    cosines, powers, weights = scratch[0], scratch[1], scratch[2]
    block = len(cosines)
    sine_least = math.sqrt(max(0.0, 1.0 - least * least))
    for i in range(len(toward)):
        x, y, z = toward[i, 0], toward[i, 1], toward[i, 2]
        red, green, blue, total = 0.0, 0.0, 0.0, 0.0
        for k in range(len(blocks)):
            reach = blocks[k, 3]
            # The cosine of both angles' sum; beyond a half turn everything counts.
            bound = least * reach - sine_least * math.sqrt(max(0.0, 1.0 - reach * reach))
            if (x * blocks[k, 0] + y * blocks[k, 1]) + z * blocks[k, 2] < bound:
                continue
            first = k * block
            for j in range(block):
                c = (x * texels[0, first + j] + y * texels[1, first + j]) + z * texels[2, first + j]
                c = c if c > least else 0.0
                cosines[j] = c
                weights[j] = texels[3, first + j]
            left = power >> 8
            for j in range(block):
                powers[j] = cosines[j]
            while left:
                if left & 1:
                    for j in range(block):
                        weights[j] *= powers[j]
                left >>= 1
                if left:
                    for j in range(block):
                        powers[j] *= powers[j]
            left = power & 255
            if left:
                for j in range(block):
                    powers[j] = cosines[j]
                while left:
                    for j in range(block):
                        powers[j] = math.sqrt(powers[j])
                    if left & 128:
                        for j in range(block):
                            weights[j] *= powers[j]
                    left = (left << 1) & 255
            for j in range(block):
                w = weights[j]
                red += w * texels[4, first + j]
                green += w * texels[5, first + j]
                blue += w * texels[6, first + j]
                total += w
        out[i, 0], out[i, 1], out[i, 2] = red / total, green / total, blue / total


def exponent_of(exponent):
    """Phong's exponent as the nearest multiple of ``EXPONENT_STEP``.

    Raises ValueError unless it is a number from that step to ``LARGEST_EXPONENT``.
    """
    try:
        value = float(exponent)
    except (TypeError, ValueError):
        value = math.nan
    if not EXPONENT_STEP <= value <= LARGEST_EXPONENT:
        raise ValueError(
            f"The exponent is {exponent!r}; give a number from {EXPONENT_STEP} to {LARGEST_EXPONENT:.0f}, "
            "the reciprocal of the roughness."
        )
    return math.floor(value / EXPONENT_STEP + 0.5) * EXPONENT_STEP


def _halved(cube, weights):
    """A cube map and its texels' solid angles at half the size."""

    def sums(a):
        rows = a[..., 0::2, :, :] + a[..., 1::2, :, :]
        return rows[..., 0::2, :] + rows[..., 1::2, :]

    less = sums(weights[..., None])
    return sums(cube * weights[..., None]) / less, less[..., 0]


def _reduced(cube, edge):
    """The map halved while its edge is even and no less than ``edge`` afterwards, and its solid angles."""
    size = cube.shape[1]
    weights = cube_maps.solid_angles(size)
    while size % 2 == 0 and size // 2 >= edge:
        cube, weights = _halved(cube, weights)
        size //= 2
    return cube, weights


def reduced(cube, edge):
    """A cube map [6, n, n, 3] halved while n is even and no less than ``edge`` afterwards; a texel is the
    mean of what it covers, by solid angle.
    """
    return _reduced(cube, edge)[0]


def _parted(cube, edge):
    """The map with each texel repeated so often that ``edge`` texels and more lie along a face."""
    times = math.ceil(edge / cube.shape[1])
    return cube.repeat(times, axis=1).repeat(times, axis=2)


def _squares(cube, weights):
    """Texels in squares: ``blocks``, ``texels`` and the number in a square, as ``_filtered`` takes them."""
    size = cube.shape[1]
    edge = next(k for k in range(min(_BLOCK, size), 0, -1) if size % k == 0)
    count, toward = size // edge, cube_maps.directions(size)
    rows = np.concatenate(
        [toward, np.broadcast_to(weights, (6, size, size))[..., None], cube], axis=-1
    ).reshape(6, count, edge, count, edge, 7)
    squares = rows.transpose(0, 1, 3, 2, 4, 5).reshape(-1, edge * edge, 7)
    middle = normalize(squares[:, 0, :3] + squares[:, -1, :3])
    cosine = (middle[:, None, :] * squares[..., :3]).sum(axis=-1).min(axis=1)
    # A little less, so that rounding leaves no texel out.
    blocks = np.concatenate([middle, np.maximum(cosine - 1.0e-9, -1.0)[:, None]], axis=-1)
    return blocks, np.ascontiguousarray(squares.reshape(-1, 7).T), edge * edge


def _summed(toward, cube, weights, exponent, threads):
    blocks, texels, block = _squares(cube, weights)
    # Rounded: a logarithm differs in its last bit between processors.
    least = math.floor(_LEAST_WEIGHT ** (1.0 / exponent) * 2.0**20) / 2.0**20
    count = len(toward)
    out = np.empty((count, 3))
    pool = Threads(threads)

    def share(number):
        low, high = (count * k // threads for k in (number, number + 1))
        power, scratch = int(exponent / EXPONENT_STEP), np.empty((3, block))
        _filtered(toward[low:high], blocks, texels, power, least, scratch, out[low:high])
        return 0

    pool.run(share)
    return out


def _cubic(size, places):
    """For ``size`` texel centres of an edge the first of four of the grid's places and their weights
    (Catmull, Rom); the grid has a place and a half more at each end.
    """
    at = (np.arange(size) + 0.5) / size * places + 1.5
    low = np.floor(at).astype(np.int64)
    u = at - low
    weights = (
        0.5 * u * (u * (2.0 - u) - 1.0),
        0.5 * (u * u * (3.0 * u - 5.0) + 2.0),
        0.5 * u * (u * (4.0 - 3.0 * u) + 1.0),
        0.5 * u * u * (u - 1.0),
    )
    return low - 1, weights


def _stretched(grid, size, places):
    """A grid [6, places + 4, places + 4, 3] at ``size`` texels along an edge."""
    low, weights = _cubic(size, places)
    rows = sum(w[:, None, None] * grid[:, low + k] for k, w in enumerate(weights))
    return sum(w[:, None] * rows[:, :, low + k] for k, w in enumerate(weights))


@computed_once
def phong(cube, exponent, size=None, threads=None):
    """A cube map filtered by Phong's lobe around each direction, Eq. 6: float64 [6, size, size, 3].

    cube      float64 [6, n, n, 3], radiance of any range
    exponent  1/r, ``EXPONENT_STEP`` to ``LARGEST_EXPONENT``, rounded to a multiple of that step
    size      texels along the result's edge; None: as many as the cube map has
    threads   None: one a processor. Any number gives the same bits

    Raises ValueError for anything but a cube map, for NaN and infinity, and for numbers out of range.
    """
    cube = cube_maps.checked(cube)
    exponent = exponent_of(exponent)
    size = cube.shape[1] if size is None else cube_maps.size_of(size)
    threads = default_threads() if threads is None else cube_maps.size_of(threads, "The number of threads")
    width = min(1.0, 1.0 / math.sqrt(exponent))
    widths = 0.5 * math.pi / width
    parted = _parted(cube, max(_LEAST_PLACES, _FEWEST_TEXELS_A_WIDTH * widths))
    coarse, weights = _reduced(parted, max(_LEAST_TEXELS, _TEXELS_A_WIDTH * widths))
    places = max(_LEAST_PLACES, math.ceil(_PLACES_A_WIDTH * widths))
    if places + 4 >= size:
        toward = cube_maps.directions(size)
        return _summed(toward.reshape(-1, 3), coarse, weights, exponent, threads).reshape(toward.shape)
    edge = 2.0 * (np.arange(places + 4) - 1.5) / places - 1.0
    toward = normalize(cube_maps.vectors(*np.meshgrid(edge, edge)))
    grid = _summed(toward.reshape(-1, 3), coarse, weights, exponent, threads).reshape(toward.shape)
    # Cubics overshoot beside what is bright.
    return np.clip(_stretched(grid, size, places), cube.min(), cube.max())


def cosine(cube, size, threads=None):
    """Irradiance over pi by the normal, which is the radiance of a white diffuse surface: [6, size, size, 3].

    Arguments and errors as ``phong``'s.
    """
    return phong(cube, 1.0, size, threads)


# Source: the catalogue's A-H33: 99.5 % are below one.
_BELOW_ONE = 0.995


def exposure(cube):
    """The factor of a cube map of floats [6, n, n, 3] with which 99.5 % of its numbers are below one."""
    level = float(np.sort(cube, axis=None)[int(_BELOW_ONE * (cube.size - 1))])
    return 1.0 / level if level > 0.0 else 1.0

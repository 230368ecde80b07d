"""The self-test's shapes: patches of triangles, and images, from whole numbers and fractions alone.

This module takes no sine and no random number from a library, so its results are the same with any NumPy.
"""

from functools import cache
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Mesh

PATCH = 16  # edge of a patch, pixels
ACROSS = 2  # patches side by side


def _inside(number, u, v, size):
    """(x, y, z, w) in clip coordinates of a place in a patch.

    The patch is a little larger than its square and off the pixels' grid, and w differs from corner to
    corner.
    """
    column, row = number % ACROSS, number // ACROSS
    x = (column + 0.02) * PATCH + u * (PATCH + 0.4)
    y = (row + 0.03) * PATCH + v * (PATCH + 0.7)
    w = 1.0 + 0.5 * u + 0.25 * v * (1 + number % 3)
    z = 0.8 - 0.3 * u - 0.9 * v + 0.05 * number
    return [(2.0 * x / size[0] - 1.0) * w, (2.0 * y / size[1] - 1.0) * w, z * w, w]


@cache
def places(steps: int) -> tuple[tuple[float, float], ...]:
    """(u, v) of a grid of ``steps`` squares a side, row by row."""
    edge = [k / steps for k in range(steps + 1)]
    return tuple((u, v) for v in edge for u in edge)


def grid_indices(steps: int) -> list[int]:
    """Two triangles for each square of a grid; every other square has the other diagonal."""
    indices = []
    for row in range(steps):
        for column in range(steps):
            a = row * (steps + 1) + column
            b, c, d = a + 1, a + steps + 1, a + steps + 2
            indices += [a, b, d, a, d, c] if (row + column) % 2 else [a, b, c, b, d, c]
    return indices


def normal(u: float, v: float) -> list[float]:
    """A unit vector that leans away from the patch's middle."""
    x, y = 1.2 * (u - 0.5), 1.2 * (v - 0.4)
    return [x, y, sqrt(1.0 - x * x - y * y)]


def _arrays(number: int, size: tuple[int, int], steps: int) -> dict[str, Any]:
    """The arguments of ``Mesh`` for a patch."""
    at = places(steps)
    return {
        "positions": [_inside(number, u, v, size) for u, v in at],
        "colors": [[u, 0.15 + 0.8 * v, 1.0 - 0.7 * u * v, 0.2 + 0.8 * (u + v) / 2.0] for u, v in at],
        "secondary_colors": [[0.4 * v, 0.1, 0.5 * u, 0.3 + 0.2 * u] for u, v in at],
        "normals": [normal(u, v) for u, v in at],
        "texture_coordinates": (
            [[1.7 * u - 0.2, 2.3 * v - 0.4, 0.1 + 0.8 * u * v, 1.0] for u, v in at],
            [[u - 0.4, 0.6 - v, 0.3 + 0.2 * number - u * v, 1.0 + 0.3 * u] for u, v in at],
            [[u - v, u + v - 1.0, 0.7 - u, 1.0] for u, v in at],
            [[0.9 - 0.4 * u, 0.3 * v - 0.1, 0.6 - 0.5 * v, 1.0] for u, v in at],
        ),
        "fog_coordinates": [0.1 + 0.6 * u + 0.3 * v for u, v in at],
    }


def patch(number: int, size: tuple[int, int]) -> Mesh:
    """Patch ``number`` of a window of ``size``: two triangles, or, for odd numbers, fifty small ones."""
    steps = 5 if number % 2 else 1
    return Mesh(indices=grid_indices(steps), **_arrays(number, size, steps))


def values(*shape: int, seed: int = 0, most: int = 255) -> NDArray[np.int64]:
    """Whole numbers from 0 to ``most`` that look random: int64 of that shape.

    A multiplier and a shift, in whole numbers of 64 bits (Source: Knuth, The Art of Computer Programming,
    volume 3, section 6.4: multiplication by the golden ratio).
    """
    count = int(np.prod(shape))
    mixed = [(k + 97 * seed + 1) * 0x9E3779B97F4A7C15 % 2**64 for k in range(count)]
    return np.array([(m >> 24) % (most + 1) for m in mixed], np.int64).reshape(shape)


def picture(*shape: int, seed: int = 0) -> NDArray[np.uint8]:
    """An image of bytes, [..., rows, columns, RGBA]: squares of a few texels, with grain.

    The squares keep smaller mipmap levels distinct; grain alone would make them all grey.
    """
    *layers, height, width = shape
    squares = values(*layers, -(-height // 4), -(-width // 4), 4, seed=seed)
    smooth = squares.repeat(4, axis=-3).repeat(4, axis=-2)[..., :height, :width, :]
    return ((3 * smooth + values(*shape, 4, seed=seed + 50)) // 4).astype(np.uint8)

"""Curves in space as polylines: positions with their tangents, and the lines of force of point charges."""

import math
from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize, sine


@dataclass(frozen=True, eq=False)
class Curves:
    """Polylines, one after the other.

    positions  float64 [n, 3], world coordinates
    tangents   float64 [n, 3], of length one
    counts     how many of the vertices each polyline has, 2 or more; their sum is n
    """

    positions: NDArray[np.float64]
    tangents: NDArray[np.float64]
    counts: tuple[int, ...]

    def __post_init__(self) -> None:
        if sum(self.counts) != len(self.positions) or min(self.counts, default=0) < 2:
            raise ValueError(
                f"{len(self.counts)} polylines of {min(self.counts, default=0)} vertices and more do not "
                f"make {len(self.positions)} vertices; give one or more polylines, of 2 vertices or more "
                "each, that take all."
            )

    @property
    def segments(self) -> NDArray[np.int64]:
        """Both ends of each piece: int64 [k, 2] into the vertices, polyline by polyline."""
        last = np.cumsum(self.counts) - 1
        first = np.delete(np.arange(len(self.positions)), last)
        return np.stack([first, first + 1], axis=-1)

    def rotated(self, matrix: NDArray[np.float64]) -> "Curves":
        """The curves turned by a 3x3 rotation about the origin."""
        return replace(self, positions=rotate(matrix, self.positions), tangents=rotate(matrix, self.tangents))


def directions(count: int) -> NDArray[np.float64]:
    """``count`` unit vectors all round, evenly spread on a spiral from pole to pole: float64 [count, 3]."""
    if count < 1:
        raise ValueError(f"The number of directions is {count}; give 1 or more.")
    number = np.arange(count)
    height = 1.0 - (2.0 * number + 1.0) / count
    # The golden angle, by which no two turns of the spiral line up.
    angle = number * (math.pi * (3.0 - math.sqrt(5.0)))
    across = np.sqrt(1.0 - height * height)
    return np.stack([across * cosine(angle), across * sine(angle), height], axis=-1)


def _checked(charges: ArrayLike) -> NDArray[np.float64]:
    found = np.asarray(charges, np.float64)
    if found.ndim != 2 or found.shape[1:] != (4,) or not len(found) or not np.isfinite(found).all():
        raise ValueError(
            f"The charges are an array of shape {found.shape}; give rows (x, y, z, charge) of finite numbers."
        )
    return found


def field(points: NDArray[np.float64], charges: ArrayLike) -> NDArray[np.float64]:
    """The electric field of point charges at points [..., 3]: float64 [..., 3], the sum of q r / |r|^3.

    charges  rows (x, y, z, q). A point on a charge has no field of it.
    """
    total = np.zeros(np.shape(points))
    for row in _checked(charges):
        away = points - row[:3]
        square = dot(away, away)
        far = square > 0.0
        cube = np.where(far, square * np.sqrt(square), 1.0)
        total = total + np.where(far, row[3] / cube, 0.0)[..., None] * away
    return total


def lines_of_force(
    charges: ArrayLike, count: int, *, step: float = 0.02, radius: float = 1.0, core: float = 0.05
) -> Curves:
    """Lines of force of point charges in the ball of ``radius`` about the origin. Tangents point along the
    field.

    A line begins at a positive charge and ends within ``core`` of a negative one, or where it leaves the
    ball. Other lines enter the ball and end at a negative charge.

    charges  rows (x, y, z, q), inside the ball
    count    how many lines begin at positive charges, in proportion to their charge, at least one each.
             Negative charges get as many for the same charge; of these, only lines from outside are drawn
    step     length of a piece, in the Runge-Kutta method of fourth order

    Raises ValueError if no charge is positive, if a length is not positive, and if no line is as long as a
    step.
    """
    rows = _checked(charges)
    positive, negative = rows[rows[:, 3] > 0.0], rows[rows[:, 3] < 0.0]
    if not len(positive):
        raise ValueError("No charge is positive, and lines begin at positive ones; give one or more.")
    for value, what in ((step, "step"), (radius, "radius"), (core, "core")):
        if not 0.0 < value < math.inf:
            raise ValueError(f"The {what} of lines of force is {value!r}; give a positive, finite length.")
    a_charge = count / reduce(add, positive[:, 3].tolist())
    found = []
    for sign, from_, to in ((1.0, positive, negative), (-1.0, negative, positive)):
        starts = [row[:3] + core * directions(max(1, int(a_charge * abs(row[3]) + 0.5))) for row in from_]
        if starts:
            tracks, lengths, outside = _traced(np.concatenate(starts), rows, to, sign * step, radius, core)
            kept = (lengths >= 2) & (outside | (sign > 0.0))
            found += [tracks[i, : lengths[i]][:: int(sign)] for i in np.flatnonzero(kept)]
    if not found:
        raise ValueError(
            f"No line of force is as long as a step of {step}; give a shorter step or a larger ball."
        )
    positions = np.concatenate(found)
    return Curves(positions, normalize(field(positions, rows)), tuple(len(line) for line in found))


def _traced(here, charges, ends, step, radius, core):
    """Lines from points ``here`` [n, 3] by pieces of ``step``, against the field where it is negative:
    (float64 [n, most, 3], how many of these each has, whether it left the ball).
    """

    def toward(points):
        return normalize(field(points, charges))

    places, going = [here], np.ones(len(here), bool)
    lengths, outside = np.ones(len(here), int), np.zeros(len(here), bool)
    # Longer than half round the ball and back no line is.
    for _ in range(int(8.0 * radius / abs(step)) + 2):
        a = toward(here)
        b = toward(here + (0.5 * step) * a)
        c = toward(here + (0.5 * step) * b)
        d = toward(here + step * c)
        following = here + (step / 6.0) * (((a + 2.0 * b) + 2.0 * c) + d)
        leaves = dot(following, following) >= radius * radius
        outside |= going & leaves
        going = going & ~leaves
        for row in ends:
            away = following - row[:3]
            going = going & (dot(away, away) > core * core)
        if not going.any():
            break
        here = np.where(going[:, None], following, here)
        places.append(here)
        lengths += going
    return np.stack(places, axis=1), lengths, outside

"""Form factors from points to rectangles, and how things in between reduce them.

A polygon of radiance one gives a point with a normal Lambert's sum over its edges. Each edge adds the angle
that it subtends, times the lean of the plane through edge and point. This is exact for a polygon above the
point's horizon. A rectangle is divided into smaller ones. Each is visible if its middle is, so shadows are
soft in as many steps.

The module uses additions, products, quotients and square roots alone, for angles too, in a fixed order. So
its bits are the same everywhere.

Source: Baum, Rushmeier, Winget 1989 (the sum in radiosity); Lambert 1760.
"""

import math
from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import cross, dot, normalize

# Of a segment's length: how far from its ends a box must begin to hide something.
_TOUCH = 1.0e-6
# Terms of the arc tangent's series at tan(pi/8) and below: what is left out is 2e-13 radians.
_TERMS = 14


def angles(cosines, sines):
    """Angles in radians from 0 to pi, of their cosines and sines, the latter not negative.

    The eighth part's tangent by three halvings, and the arc tangent's series: no library's function, whose
    last bit differs between processors.
    """
    t = sines / np.maximum(1.0 + cosines, 1.0e-30)
    for _ in range(2):
        t = t / (1.0 + np.sqrt(1.0 + t * t))
    square, total = t * t, np.zeros_like(t)
    for k in range(_TERMS, -1, -1):
        total = (1.0 if k % 2 == 0 else -1.0) / (2 * k + 1) + square * total
    return 8.0 * t * total


@dataclass(frozen=True)
class Box:
    """A box that stands upright: its middle, half of its width, height and depth, and by how many degrees it
    is turned about the y axis.
    """

    middle: tuple[float, float, float]
    half: tuple[float, float, float]
    degrees: float

    def to_box(self, vectors):
        """World vectors [..., 3] in the box's axes."""
        return rotate(rotation("y", -self.degrees), vectors)

    def to_world(self, vectors):
        """Vectors of the box's axes [..., 3] in the world's."""
        return rotate(rotation("y", self.degrees), vectors)

    def holds(self, places):
        """Which places [..., 3] lie inside: bool [...]."""
        return (np.abs(self.to_box(places - np.array(self.middle))) < np.array(self.half)).all(axis=-1)

    def hides(self, places, toward):
        """Whether it lies between places [..., 3] and place + toward [..., 3]: bool [...]."""
        start, along = self.to_box(places - np.array(self.middle)), self.to_box(toward)
        enters, leaves = np.full(start.shape[:-1], _TOUCH), np.full(start.shape[:-1], 1.0 - _TOUCH)
        for k, half in enumerate(self.half):
            step = np.where(np.abs(along[..., k]) > 1.0e-12, along[..., k], 1.0e-12)
            first, second = (-half - start[..., k]) / step, (half - start[..., k]) / step
            enters = np.maximum(enters, np.minimum(first, second))
            leaves = np.minimum(leaves, np.maximum(first, second))
        return enters < leaves


@dataclass(frozen=True)
class Ball:
    """A ball: its middle and its radius."""

    middle: tuple[float, float, float]
    radius: float

    def holds(self, places):
        """Which places [..., 3] lie inside: bool [...]."""
        away = places - np.array(self.middle)
        return dot(away, away) < self.radius * self.radius

    def hides(self, places, toward):
        """Whether it lies between places [..., 3] and place + toward [..., 3]: bool [...]."""
        away = places - np.array(self.middle)
        length = dot(toward, toward)
        nearest = np.clip(-dot(away, toward) / np.maximum(length, 1.0e-30), 0.0, 1.0)
        return self.holds(places + nearest[..., None] * toward)


def from_rectangle(places, normals, rectangle, parts=1, things=()):
    """Form factors from points to a rectangle, which shines to the side of across x up.

    places, normals  float64 [n, 3]
    rectangle        corner, across, up: three vectors
    parts            along each edge
    things           ``Box`` and ``Ball`` that may hide parts of it

    Returns float64 [n], from 0 to 1: with them irradiance over radiosity. A point behind the rectangle gets
    nothing.
    """
    places, normals = np.asarray(places, np.float64), np.asarray(normals, np.float64)
    corner, across, up = (np.asarray(v, np.float64) for v in rectangle)
    steps = np.arange(parts + 1) / parts
    grid = corner + steps[None, :, None] * across + steps[:, None, None] * up
    rays = normalize(grid[:, :, None] - places)

    def edges(first, second):
        """What edges add, by point."""
        plane = cross(first, second)
        sine = np.sqrt(dot(plane, plane))
        lean = dot(plane, normals) / np.maximum(sine, 1.0e-30)
        return angles(dot(first, second), sine) * lean

    rows, columns = edges(rays[:, :-1], rays[:, 1:]), edges(rays[:-1], rays[1:])
    around = (rows[:-1] + columns[:, 1:]) - (rows[1:] + columns[:, :-1])
    factors = np.maximum(-around / (2.0 * math.pi), 0.0)
    front = dot(places - corner, cross(across, up)) > 0.0
    factors = np.where(front, factors, 0.0)
    if things:
        middles = (grid[:-1, :-1] + grid[1:, 1:]) / 2.0
        toward = middles[:, :, None] - places
        for thing in things:
            factors = np.where(thing.hides(places, toward), 0.0, factors)
    total = np.zeros(len(places))
    for part in factors.reshape(-1, len(places)):
        total = total + part
    return total

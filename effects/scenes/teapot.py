"""Utah's teapot: bicubic Bézier patches, tessellated here.

Rim, body, lid and bottom are turned: a cubic profile times a quarter of a circle, whose inner control points
stand off by 0.56 of the radius. So their normals are those of profile and circle. They have a direction even
where the profile meets the axis and the patch has none. Handle and spout are mirrored halves.

Source: Newell 1975, the University of Utah's teapot (32 patches), as published by Crow 1987, The origins of
the teapot. Where it departs: the quarters of the lid's knob stand off by 0.56 too, not by 0.5625.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface, joined, plane
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector

# (radius, height) of control points, four for each piece; the last of one piece is the first of the next.
# From the rim's inner edge down to the bottom's middle, and from the knob's top to the lid's edge.
_POT = (
    *((1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4), (1.75, 1.875), (2.0, 1.35), (2.0, 0.9)),
    *((2.0, 0.45), (1.5, 0.225), (1.5, 0.15), (1.5, 0.075), (1.425, 0.0), (0.0, 0.0)),
)
_LID = ((0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4))
_OFF = 0.56
# Control points of two pieces each, which share a row: (x, height) on the plane of symmetry and beside it on
# the one side, then on the other side's, and how far beside.
_HANDLE = (
    ((-1.6, 2.025), (-1.5, 2.25), 0.3),
    ((-2.3, 2.025), (-2.5, 2.25), 0.3),
    ((-2.7, 2.025), (-3.0, 2.25), 0.3),
    ((-2.7, 1.8), (-3.0, 1.8), 0.3),
    ((-2.7, 1.575), (-3.0, 1.35), 0.3),
    ((-2.5, 1.125), (-2.65, 0.9375), 0.3),
    ((-2.0, 0.9), (-1.9, 0.6), 0.3),
)
_SPOUT = (
    *(((1.7, 1.425), (1.7, 0.6), 0.66), ((2.6, 1.425), (3.1, 0.825), 0.66), ((2.3, 2.1), (2.4, 2.025), 0.25)),
    *(((2.7, 2.4), (3.3, 2.4), 0.25), ((2.8, 2.475), (3.525, 2.49375), 0.25)),
    *(((2.9, 2.475), (3.45, 2.5125), 0.15), ((2.8, 2.4), (3.2, 2.4), 0.15)),
)
# How far control points are from the axis, and the lid's knob is above the bottom.
REACH, HEIGHT = 3.525, 3.15


def _weights(count):
    """Bernstein's cubics and their derivatives at ``count`` + 1 places of [0, 1]: two float64 [4, places]."""
    t = np.arange(count + 1) / count
    r = 1.0 - t
    values = np.stack([r * r * r, 3.0 * (r * r * t), 3.0 * (r * t * t), t * t * t])
    slopes = 3.0 * np.stack([-r * r, r * r - 2.0 * (r * t), 2.0 * (r * t) - t * t, t * t])
    return values, slopes


def _curve(points, weights):
    """A Bézier curve of four control points [4, k]: float64 [places, k]."""
    total = points[0] * weights[0][:, None]
    for k in range(1, 4):
        total = total + points[k] * weights[k][:, None]
    return total


def _grid(positions, normals, tangents):
    """A Surface of [rows, columns, 3] each: s along columns, t along rows."""
    rows, columns = (edge - 1 for edge in positions.shape[:2])
    cells = plane(columns, rows)
    positions, normals, tangents = (array.reshape(-1, 3) for array in (positions, normals, tangents))
    normals = normalize(normals)
    tangents = normalize(tangents - dot(tangents, normals)[:, None] * normals)
    found = Surface(
        positions, normals, tangents, cross(normals, tangents), cells.texture_coordinates, cells.triangles
    )
    return _outside(found)


def _outside(surface):
    """The surface without triangles that have no area, the others counter-clockwise seen from outside."""
    a, b, c = (surface.positions[surface.triangles[:, k]] for k in range(3))
    across = cross(b - a, c - a)
    area = dot(across, across)
    kept = area > 1e-9 * area.max()
    mean = surface.normals[surface.triangles]
    turned = dot(across, (mean[:, 0] + mean[:, 1]) + mean[:, 2]) < 0.0
    triangles = np.where(turned[:, None], surface.triangles[:, ::-1], surface.triangles)
    return replace(surface, triangles=np.ascontiguousarray(triangles[kept]))


def _turned(profile, pieces):
    """A profile turned about the y axis: quarters, whose texture coordinates go round together."""
    values, slopes = _weights(pieces)
    quarter = np.array([(1.0, 0.0), (1.0, _OFF), (_OFF, 1.0), (0.0, 1.0)])
    arc, around = _curve(quarter, values), _curve(quarter, slopes)
    profile = np.array(profile)
    lengths = (len(profile) - 1) // 3
    out = []
    for piece in range(lengths):
        points = profile[3 * piece : 3 * piece + 4]
        (radius, height), (out_slope, up_slope) = (_curve(points, w).T for w in (values, slopes))
        for turn in range(4):
            # Four quarters: (x, z) to (-z, x) and on.
            (x, z), (dx, dz) = (_quarter(pair.T, turn) for pair in (arc, around))
            flat = np.zeros_like(x)
            ring, along = np.stack([x, flat, z], axis=-1), np.stack([dx, flat, dz], axis=-1)
            up = np.array([0.0, 1.0, 0.0])
            positions = radius[:, None, None] * ring + height[:, None, None] * up
            down = out_slope[:, None, None] * ring + up_slope[:, None, None] * up
            tangents = np.broadcast_to(along, positions.shape)
            # The profile runs down with the outside on its left, where the ring turns from x to z.
            normals = cross(tangents, down)
            part = _grid(positions, normals, -tangents)
            s, t = part.texture_coordinates[:, 0], part.texture_coordinates[:, 1]
            place = np.stack([1.0 - (turn + s) / 4.0, 1.0 - (piece + t) / lengths], axis=-1)
            out.append(replace(part, texture_coordinates=place))
    return joined(*out)


def _quarter(pair, turn):
    x, z = pair
    return ((x, z), (-z, x), (-x, -z), (z, -x))[turn]


def _mirrored(rows, pieces):
    """Handle or spout: two halves of two pieces each."""
    values, slopes = _weights(pieces)
    out = []
    for start in (0, 3):
        for side in (1.0, -1.0):
            points = np.array(
                [
                    [(*a, 0.0), (*a, side * beside), (*b, side * beside), (*b, 0.0)]
                    for a, b, beside in rows[start : start + 4]
                ]
            )
            across = [np.stack([_curve(row, weights) for row in points]) for weights in (values, slopes)]
            positions, along = (
                _curve(across[0].reshape(4, -1), weights).reshape(pieces + 1, pieces + 1, 3)
                for weights in (values, slopes)
            )
            around = _curve(across[1].reshape(4, -1), values).reshape(pieces + 1, pieces + 1, 3)
            out.append(_grid(positions, side * cross(around, along), along))
    return joined(*out)


def teapot(pieces: int = 8) -> Surface:
    """The teapot about the y axis, all of it within one of the axis: the spout towards +x, the middle of its
    height at the origin.

    pieces  how many parts a patch has along an edge: 64 pieces^2 triangles, less 8 pieces at the axis

    Tangents run round the axis, on handle and spout along them. Raises ValueError for fewer than one piece.
    """
    if isinstance(pieces, bool) or int(pieces) != pieces or pieces < 1:
        raise ValueError(f"A patch of the teapot has {pieces!r} pieces along an edge; give 1 or more.")
    pieces = int(pieces)
    parts = joined(
        _turned(_POT, pieces),
        _turned(_LID, pieces),
        _mirrored(_HANDLE, pieces),
        _mirrored(_SPOUT, pieces),
    )
    return parts.moved(0.0, -0.5 * HEIGHT, 0.0).scaled(1.0 / REACH)


def framed_along(surface: Surface, axis) -> Surface:
    """The surface with tangents that point along an ``axis``, a vector, as far as possible: as for strokes,
    grooves or ridges that were all cut in one direction. Where the normal is the axis, any tangent.

    Raises ValueError for an axis that is no direction.
    """
    axis = unit_vector(axis, "The axis")
    # Where the normal is the axis nothing is left of it; the least coordinate's axis is not the normal then.
    other = np.zeros(3)
    other[int(np.argmin(np.abs(axis)))] = 1.0
    tangents = np.broadcast_to(axis, surface.normals.shape)
    tangents = tangents - dot(tangents, surface.normals)[:, None] * surface.normals
    lost = dot(tangents, tangents) < 1e-12
    instead = other - dot(surface.normals, other)[:, None] * surface.normals
    tangents = normalize(np.where(lost[:, None], instead, tangents))
    return replace(surface, tangents=tangents, binormals=cross(surface.normals, tangents))

"""The part of a scene that a camera sees: the convex body where its frustum and the scene's box meet, on the
CPU.

A body is eight corners, float64 [8, 3]: corner 4 i + 2 j + k is at end i, j, k (0 or 1) of the three axes, in
the order of ``Scene.corners``. Boxes, frusta and slices of frusta are such bodies.

Source: document 003, "first pass": the view frustum of the light encloses the scene; artefact A-Z14/Z15 of
the catalogue. All arithmetic is elementwise, so that the matrices made from it have the same bits everywhere.
"""

import numpy as np

from fixedpipe.effects.geometry.matrices import rigid_inverse
from fixedpipe.effects.geometry.vectors import cross, dot, from_frame

# The twelve edges: pairs of corners that differ in one axis; and of each of the six faces three corners.
EDGES = np.array([(a, a | bit) for bit in (4, 2, 1) for a in range(8) if not a & bit])
_FACES = np.array(
    [(side, side | b, side | c) for a, b, c in ((4, 2, 1), (2, 1, 4), (1, 4, 2)) for side in (0, a)]
)


def checked_corners(corners, what):
    """Corners as float64 [8, 3]. Raises ValueError, naming ``what``, for anything else and where there is no
    volume.
    """
    out = np.asarray(corners, np.float64)
    if out.shape != (8, 3) or not np.isfinite(out).all():
        raise ValueError(f"{what} has corners of shape {out.shape}; give eight of three finite numbers.")
    volume = dot(cross(out[4] - out[0], out[2] - out[0]), out[1] - out[0])
    if volume == 0.0:
        raise ValueError(f"{what} is flat; give a body with a volume.")
    return out


def planes(corners):
    """The six planes of a body, float64 [6, 4]: normals that point inward, and a x + b y + c z + d >= 0
    inside.
    """
    a, b, c = (corners[_FACES[:, k]] for k in range(3))
    normals = cross(b - a, c - a)
    middle = corners.sum(axis=0) / 8.0
    distances = dot(normals, middle - a)
    normals = normals * np.where(distances < 0.0, -1.0, 1.0)[:, None]
    return np.concatenate([normals, -dot(normals, a)[:, None]], axis=1)


def _edges_inside(corners, bounds):
    """The ends, float64 [n, 3], of what the planes leave of a body's edges."""
    a, b = corners[EDGES[:, 0]], corners[EDGES[:, 1]]
    first, last = np.zeros(len(a)), np.ones(len(a))
    for plane in bounds:
        at_a, at_b = dot(a, plane[:3]) + plane[3], dot(b, plane[:3]) + plane[3]
        crossing = at_a / np.where(at_a != at_b, at_a - at_b, 1.0)
        first = np.where((at_a < 0.0) & (at_b >= 0.0), np.maximum(first, crossing), first)
        last = np.where((at_a >= 0.0) & (at_b < 0.0), np.minimum(last, crossing), last)
        last = np.where((at_a < 0.0) & (at_b < 0.0), -1.0, last)
    kept = first <= last
    ends = [(a + t[:, None] * (b - a))[kept] for t in (first, last)]
    return np.concatenate(ends)


def meeting(first, second):
    """The corners of the intersection of two bodies, float64 [n, 3], some twice; n is 0 if they do not meet.

    Such a corner lies on an edge of one of them. It is an end of the piece that the other's planes leave of
    this edge.
    """
    first, second = checked_corners(first, "The first body"), checked_corners(second, "The second body")
    return np.concatenate([_edges_inside(first, planes(second)), _edges_inside(second, planes(first))])


def clip_distances(view):
    """Near and far plane of a perspective camera, as distances.

    Raises ValueError where the camera's projection is no perspective one.
    """
    if tuple(view.projection[3]) != (0.0, 0.0, -1.0, 0.0):
        raise ValueError("The camera's projection is not perspective; give a view with a vanishing point.")
    a, b = view.projection[2][2], view.projection[2][3]
    return b / (a - 1.0), b / (a + 1.0)


def frustum(view, near=None, far=None):
    """The corners of a perspective camera's frustum between two distances, None: its own planes.

    The axes are the camera's right, its up and away from it.
    """
    own = clip_distances(view)
    near, far = (o if given is None else float(given) for o, given in zip(own, (near, far), strict=True))
    if not 0.0 < near < far:
        raise ValueError(
            f"A frustum from {near} to {far} has no volume; give two distances, the nearer first."
        )
    p = view.projection
    inverse = np.array(rigid_inverse(view.modelview))
    eye = np.array(
        [
            (d * (x + p[0][2]) / p[0][0], d * (y + p[1][2]) / p[1][1], -d)
            for x in (-1.0, 1.0)
            for y in (-1.0, 1.0)
            for d in (near, far)
        ]
    )
    return from_frame(eye, inverse[:3, 0], inverse[:3, 1], inverse[:3, 2]) + inverse[:3, 3]

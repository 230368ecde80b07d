"""A torus by rays, at every pixel, with the frames of ``surfaces.torus``: the reference for its triangles."""

import numpy as np

from fixedpipe.effects.geometry.matrices import rigid_inverse, rotate
from fixedpipe.effects.geometry.vectors import normalize

_STEPS = 96


def _distance(points, radius, tube_radius):
    ring = np.sqrt(points[..., 0] ** 2 + points[..., 2] ** 2) - radius
    return np.sqrt(ring * ring + points[..., 1] ** 2) - tube_radius


def torus_at_pixels(view, turn, radius, tube_radius):
    """What rays through the pixels' centres of ``view``'s panel meet, bottom row first.

    view    of ``views.perspective_view`` or ``orthographic_view``
    turn    the torus's 3x3 rotation, about the origin

    Returns (covered, points, (tangents, binormals, normals)): bool [height, width], and of the covered
    pixels, in world coordinates, float64 [n, 3] each.
    """
    panel, projection = view.panel, view.projection
    x = ((np.arange(panel.width) + 0.5) * 2.0 / panel.width - 1.0) / projection[0][0]
    y = ((np.arange(panel.height) + 0.5) * 2.0 / panel.height - 1.0) / projection[1][1]
    x, y = np.meshgrid(x, y)
    zero = 0.0 * x
    if view.infinite_viewer:
        starts, rays = np.stack([x, y, zero + 8.0], axis=-1), np.stack([zero, zero, zero - 1.0], axis=-1)
    else:
        starts, rays = np.zeros((*x.shape, 3)), normalize(np.stack([x, y, zero - 1.0], axis=-1))
    inverse = np.array(rigid_inverse(view.modelview))
    back = np.asarray(turn).T
    starts = rotate(back, rotate(inverse[:3, :3], starts) + inverse[:3, 3])
    rays = rotate(back, rotate(inverse[:3, :3], rays))
    along = np.zeros(x.shape)
    # Steps as long as the distance to the torus pass nothing; near it they converge.
    for _ in range(_STEPS):
        along = along + _distance(starts + along[..., None] * rays, radius, tube_radius)
    points = starts + along[..., None] * rays
    covered = np.abs(_distance(points, radius, tube_radius)) < 1e-6
    points = points[covered]
    away = np.sqrt(points[:, 0] ** 2 + points[:, 2] ** 2)
    ring = np.stack([points[:, 0] / away, 0.0 * away, points[:, 2] / away], axis=-1)
    normals = normalize(points - radius * ring)
    tangents = np.stack([ring[:, 2], 0.0 * away, -ring[:, 0]], axis=-1)
    outward = normals[:, 0] * ring[:, 0] + normals[:, 2] * ring[:, 2]
    up = np.array([0.0, 1.0, 0.0])
    binormals = outward[:, None] * up - normals[:, 1:2] * ring
    frame = tuple(rotate(np.asarray(turn), v) for v in (tangents, binormals, normals))
    return covered, rotate(np.asarray(turn), points), frame

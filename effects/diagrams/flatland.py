"""A scene in the plane for diagrams of visibility: polygons, rays that meet them, the volumes behind them.

Everything is computed by intersecting rays with edges, so that a diagram shows the scene as rays find it.
Points are pairs of a sheet's units.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass(frozen=True)
class Shape:
    """A convex polygon, its corners counter-clockwise; ``name``: in a diagram's words."""

    name: str
    corners: tuple[tuple[float, float], ...]

    @property
    def edges(self):
        """The ends of its edges, two float64 [n, 2]."""
        corners = np.array(self.corners)
        return corners, np.roll(corners, -1, axis=0)

    def contains(self, point, margin=0.0):
        """Whether a point lies inside, farther than ``margin`` from every edge."""
        a, b = self.edges
        along = b - a
        length = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])
        side = along[:, 0] * (point[1] - a[:, 1]) - along[:, 1] * (point[0] - a[:, 0])
        return bool((side > margin * length).all())


@dataclass(frozen=True)
class Crossing:
    """Where a ray crosses an edge: its parameter on the ray, the point, whether the ray enters there, and
    what.
    """

    parameter: float
    point: tuple[float, float]
    enters: bool
    shape: Shape


def crossings(start, towards, shapes):
    """Where the ray from ``start`` through ``towards`` (parameter 1) crosses the shapes' edges, in its order.

    It enters a shape where it runs against the edge's outward normal.
    """
    (x, y), (dx, dy) = start, (towards[0] - start[0], towards[1] - start[1])
    out = []
    for shape in shapes:
        for (ax, ay), (bx, by) in zip(*shape.edges, strict=True):
            ex, ey = bx - ax, by - ay
            across = dx * ey - dy * ex
            if across == 0.0:
                continue
            t = ((ax - x) * ey - (ay - y) * ex) / across
            u = ((ax - x) * dy - (ay - y) * dx) / across
            # An edge has its first end and not its second, so that a ray through a corner counts once.
            if t > 1e-9 and 0.0 <= u < 1.0:
                # (ey, -ex) is the outward normal of a counter-clockwise edge.
                out.append(Crossing(float(t), (float(x + t * dx), float(y + t * dy)), across < 0.0, shape))
    return tuple(sorted(out, key=lambda crossing: crossing.parameter))


def first_hit(start, towards, shapes):
    """The first crossing into a shape, or None."""
    return next((c for c in crossings(start, towards, shapes) if c.enters), None)


def is_visible(point, source, shapes, margin=1e-6):
    """Whether the way between a point and the light at ``source`` is free."""
    return all(c.parameter >= 1.0 - margin for c in crossings(source, point, shapes))


def pieces(shape, count):
    """The shape's outline in parts of about equal length: float64 [n, 2 ends, 2], ``count`` on an edge of
    length one.
    """
    out = []
    for a, b in zip(*shape.edges, strict=True):
        length = float(np.sqrt(((b - a) * (b - a)).sum()))
        steps = max(int(np.floor(count * length + 0.5)), 1)
        ends = a + (b - a) * (np.arange(steps + 1) / steps)[:, None]
        out += [np.stack(pair) for pair in pairwise(ends)]
    return np.array(out)


def shadow_volume(shape, source, length):
    """The region that the shape hides from a point light. Its edges are those that face away from the light,
    and the silhouette's two corners extruded, ``length`` units beyond them. A Shape, convex where ``shape``
    is.
    """
    x, y = source
    a, b = shape.edges
    normal_faces = (b[:, 1] - a[:, 1]) * (x - a[:, 0]) - (b[:, 0] - a[:, 0]) * (y - a[:, 1]) > 0.0
    n = len(a)
    # The light-facing edges are one run; its first corner and its last are the silhouette.
    first = next(k for k in range(n) if normal_faces[k] and not normal_faces[k - 1])
    run = [(first + j) % n for j in range(n) if normal_faces[(first + j) % n]]
    front = [tuple(map(float, a[k])) for k in run] + [tuple(map(float, b[run[-1]]))]

    def extruded(corner):
        dx, dy = corner[0] - x, corner[1] - y
        distance = float(np.sqrt(dx * dx + dy * dy))
        return corner[0] + dx / distance * length, corner[1] + dy / distance * length

    return Shape(f"shadow volume of the {shape.name}", (*front, extruded(front[-1]), extruded(front[0])))

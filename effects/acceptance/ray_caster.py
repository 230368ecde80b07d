"""Shadows by casting rays: the exact result that the shadow algorithms of documents 000 and 003 approximate.

A point is lit if nothing lies between it and the light; exactly then Z21's counter of surfaces entered and
left is zero. ``visible`` finds what a view shows at the centre of each pixel. ``lit`` tests the light from
there, and ``seen_fraction`` the many points of an area light (Z26). All of it is float64. No machine draws
any of this; the figures' checks compare with it.

To intersect a ray with a triangle, the triangle is sheared so that the ray is the z axis. They meet if the
three edge functions have one sign. Neighbours compute the same function of their shared edge, so no ray
passes between them. Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013,
section 3. A tree of boxes finds the triangles; the surface area heuristic decides where to split. Source:
Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007, section 3.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.raster.kernel import kernel

# Of the largest coordinate: boxes are larger by this, so that rounding never hides a triangle from the tree.
_BOX_MARGIN = 1e-12
# Of the scene's diagonal: a shadow ray starts this far from its point. Assumed: four orders of magnitude
# above the rounding of a point, six below a pixel of a picture of the scene; what is so close touches.
_START = 1e-10
# A tree of n triangles that halves badly is still no deeper: what is deeper is split in the middle.
_DEEPEST = 64
# Of triangles in a leaf, and of places for a split along an axis; they change how fast rays are, no answer.
_LEAF = 4
_BINS = 16


@kernel
def _box_of(boxes, order, first, end, out):
    """The box of the triangles ``order[first:end]`` into ``out`` [6]: lowest corner, highest corner."""
    for k in range(3):
        out[k], out[3 + k] = np.inf, -np.inf
    for i in range(first, end):
        for k in range(3):
            out[k] = min(out[k], boxes[order[i], k])
            out[3 + k] = max(out[3 + k], boxes[order[i], 3 + k])


@kernel
def _half_area(box):
    x, y, z = box[3] - box[0], box[4] - box[1], box[5] - box[2]
    return x * y + y * z + z * x if x >= 0.0 else 0.0


@kernel
def _best_split(boxes, centers, order, first, end, bin_boxes, counts, side):
    """Axis, coordinate of the cheapest split of ``order[first:end]`` by centres; axis -1: none.

    ``bin_boxes`` [bins, 6], ``counts`` [bins], ``side`` [bins, 7]: scratch.
    """
    best_cost, best_axis, best_at = np.inf, -1, 0.0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in range(first, end):
            low, high = min(low, centers[order[i], axis]), max(high, centers[order[i], axis])
        width = (high - low) / _BINS
        if not width > 0.0:
            continue
        for b in range(_BINS):
            counts[b] = 0
            for k in range(3):
                bin_boxes[b, k], bin_boxes[b, 3 + k] = np.inf, -np.inf
        for i in range(first, end):
            t = order[i]
            b = min(int((centers[t, axis] - low) / width), _BINS - 1)
            counts[b] += 1
            for k in range(3):
                bin_boxes[b, k] = min(bin_boxes[b, k], boxes[t, k])
                bin_boxes[b, 3 + k] = max(bin_boxes[b, 3 + k], boxes[t, 3 + k])
        # side[b]: box and number of bins b .. last
        for b in range(_BINS - 1, -1, -1):
            side[b, 6] = counts[b]
            for k in range(6):
                side[b, k] = bin_boxes[b, k]
            if b < _BINS - 1:
                side[b, 6] += side[b + 1, 6]
                for k in range(3):
                    side[b, k] = min(side[b, k], side[b + 1, k])
                    side[b, 3 + k] = max(side[b, 3 + k], side[b + 1, 3 + k])
        left_count = 0
        left = bin_boxes[0]
        for b in range(_BINS - 1):
            left_count += counts[b]
            if b > 0:
                for k in range(3):
                    left[k] = min(left[k], bin_boxes[b, k])
                    left[3 + k] = max(left[3 + k], bin_boxes[b, 3 + k])
            if left_count == 0 or side[b + 1, 6] == 0.0:
                continue
            cost = _half_area(left) * left_count + _half_area(side[b + 1]) * side[b + 1, 6]
            if cost < best_cost:
                best_cost, best_axis, best_at = cost, axis, low + width * (b + 1)
    return best_axis, best_at


@kernel
def _build(boxes, centers, order, nodes, links, stack, bin_boxes, counts, side):
    """Fill the tree; returns how many nodes it has.

    boxes [n, 6], centers [n, 3]  of the triangles
    order int64 [n]               the triangles, permuted so that each leaf has a run of them
    nodes float64 [2n, 6]         boxes; node 0 is the root
    links int64 [2n, 2]           of a leaf: first, count; of others: left child, -right child
    stack int64 [_DEEPEST, 4]     scratch: node, first, end, depth
    """
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0, 0, len(order), 0
    waiting, made = 1, 1
    while waiting:
        waiting -= 1
        node, first, end, depth = stack[waiting]
        _box_of(boxes, order, first, end, nodes[node])
        if end - first <= _LEAF:
            links[node, 0], links[node, 1] = first, end - first
            continue
        axis, at = -1, 0.0
        if depth < _DEEPEST // 2:
            axis, at = _best_split(boxes, centers, order, first, end, bin_boxes, counts, side)
        middle = first
        if axis >= 0:
            for i in range(first, end):
                if centers[order[i], axis] < at:
                    order[i], order[middle] = order[middle], order[i]
                    middle += 1
        if middle in (first, end):
            middle = (first + end) // 2
        links[node, 0], links[node, 1] = made, -(made + 1)
        stack[waiting, 0], stack[waiting, 1], stack[waiting, 2] = made + 1, middle, end
        stack[waiting + 1, 0], stack[waiting + 1, 1], stack[waiting + 1, 2] = made, first, middle
        stack[waiting, 3] = stack[waiting + 1, 3] = depth + 1
        waiting, made = waiting + 2, made + 2
    return made


@kernel
def _enters(box, ox, oy, oz, ix, iy, iz, shortest, longest):
    """Where a ray enters a box; infinity: it does not between ``shortest`` and ``longest``.

    ``ix, iy, iz``: one over the direction. A product of zero and infinity decides nothing: comparisons with
    it are false.
    """
    near, far = shortest, longest
    for k in range(3):
        o = ox if k == 0 else (oy if k == 1 else oz)
        i = ix if k == 0 else (iy if k == 1 else iz)
        a, b = (box[k] - o) * i, (box[3 + k] - o) * i
        if i < 0.0:
            a, b = b, a
        if a > near:
            near = a
        if b < far:
            far = b
    # Source: Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013: the far distance is rounded three times.
    return near if near <= far * (1.0 + 1e-15) + 1e-300 else np.inf


@kernel
def _cast(
    corners, order, nodes, links, groups,
    origins, directions, shortest, longest, own_triangles, own_groups, any_hit,
    stack, distances, triangles, barycentrics,
):  # fmt: skip
    """Cast rays; ``any_hit``: whatever is hit is enough.

    corners [n, 3, 3]; groups int64 [n]: of the triangles
    origins, directions [r, 3]; shortest, longest [r]: in lengths of the direction, both excluded
    own_triangles, own_groups int64 [r]: what a ray does not hit; -1: nothing
    stack int64 [>= deepest]; distances [r], triangles int64 [r] (-1: none), barycentrics [r, 3]: the result
    """
    for r in range(len(origins)):
        o0, o1, o2 = origins[r, 0], origins[r, 1], origins[r, 2]
        d0, d1, d2 = directions[r, 0], directions[r, 1], directions[r, 2]
        i0, i1, i2 = 1.0 / d0, 1.0 / d1, 1.0 / d2
        kz = 0
        if abs(d1) > abs(d0):
            kz = 1
        if abs(d2) > abs(directions[r, kz]):
            kz = 2
        kx, ky = (kz + 1) % 3, (kz + 2) % 3
        sz = 1.0 / directions[r, kz]
        sx, sy = directions[r, kx] * sz, directions[r, ky] * sz
        best, found = longest[r], -1
        b0, b1, b2 = 0.0, 0.0, 0.0
        waiting = 0
        if _enters(nodes[0], o0, o1, o2, i0, i1, i2, shortest[r], best) < np.inf:
            stack[0] = 0
            waiting = 1
        while waiting:
            waiting -= 1
            node = stack[waiting]
            if links[node, 1] < 0:
                left, right = links[node, 0], -links[node, 1]
                at_left = _enters(nodes[left], o0, o1, o2, i0, i1, i2, shortest[r], best)
                at_right = _enters(nodes[right], o0, o1, o2, i0, i1, i2, shortest[r], best)
                if at_right < at_left:
                    left, right, at_left, at_right = right, left, at_right, at_left
                if at_right < np.inf:
                    stack[waiting] = right
                    waiting += 1
                if at_left < np.inf:
                    stack[waiting] = left
                    waiting += 1
                continue
            first = links[node, 0]
            for i in range(first, first + links[node, 1]):
                t = order[i]
                if t == own_triangles[r] or groups[t] == own_groups[r]:
                    continue
                az, bz, cz = (
                    corners[t, 0, kz] - origins[r, kz],
                    corners[t, 1, kz] - origins[r, kz],
                    corners[t, 2, kz] - origins[r, kz],
                )
                ax = corners[t, 0, kx] - origins[r, kx] - sx * az
                ay = corners[t, 0, ky] - origins[r, ky] - sy * az
                bx = corners[t, 1, kx] - origins[r, kx] - sx * bz
                by = corners[t, 1, ky] - origins[r, ky] - sy * bz
                cx = corners[t, 2, kx] - origins[r, kx] - sx * cz
                cy = corners[t, 2, ky] - origins[r, ky] - sy * cz
                u, v, w = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
                if (u < 0.0 or v < 0.0 or w < 0.0) and (u > 0.0 or v > 0.0 or w > 0.0):
                    continue
                total = u + v + w
                if total == 0.0:
                    continue
                distance = (u * az + v * bz + w * cz) * sz / total
                if not shortest[r] < distance < longest[r]:
                    continue
                if distance < best or (distance == best and t < found):
                    best, found = distance, t
                    b0, b1, b2 = u / total, v / total, w / total
            if any_hit and found >= 0:
                break
        distances[r], triangles[r] = best if found >= 0 else np.inf, found
        barycentrics[r, 0], barycentrics[r, 1], barycentrics[r, 2] = b0, b1, b2


@dataclass(frozen=True, eq=False)
class Hits:
    """The first hits of rays.

    distance      float64 [r], in lengths of the ray's direction; infinity: nothing
    triangle      int64 [r], -1: none. The first of several at one distance
    barycentrics  float64 [r, 3], weights of the triangle's corners; their sum is one
    """

    distance: np.ndarray
    triangle: np.ndarray
    barycentrics: np.ndarray


class RayCaster:
    """Triangles that rays can be cast at.

    triangles  float64 [n, 3, 3]: corners, finite; degenerate ones are never hit
    objects    int64 [n], the object that each triangle belongs to, from 0; None: all are one

    Raises ValueError for arrays of other shapes and numbers that are not finite.
    """

    def __init__(self, triangles, objects=None):
        corners = np.array(triangles, np.float64, order="C")
        if corners.ndim != 3 or corners.shape[1:] != (3, 3) or not len(corners):
            raise ValueError(f"The triangles have the shape {corners.shape}; give [n, 3, 3], one or more.")
        if not np.isfinite(corners).all():
            raise ValueError("A triangle's corner is not finite; rays can be cast at finite triangles only.")
        count = len(corners)
        self.corners = corners
        self.objects = _column(objects, np.int64, count, 0)
        lowest, highest = corners.min(axis=1), corners.max(axis=1)
        margin = _BOX_MARGIN * np.abs(corners).max()
        boxes = np.concatenate([lowest - margin, highest + margin], axis=1)
        self.order = np.arange(count)
        nodes, links = np.empty((2 * count, 6)), np.empty((2 * count, 2), np.int64)
        stack = np.empty((4 * _DEEPEST, 4), np.int64)
        made = _build(
            boxes, 0.5 * (lowest + highest), self.order, nodes, links, stack,
            np.empty((_BINS, 6)), np.empty(_BINS, np.int64), np.empty((_BINS, 7)),
        )  # fmt: skip
        self.nodes, self.links = nodes[:made].copy(), links[:made].copy()
        extent = highest.max(axis=0) - lowest.min(axis=0)
        self.diagonal = float(np.sqrt(dot(extent, extent)))
        self.normals = normalize(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))

    def _cast(self, origins, directions, shortest, longest, own_triangles, own_objects, any_hit):
        directions = np.array(directions, np.float64, order="C")
        count = len(directions)
        origins = np.array(np.broadcast_to(origins, (count, 3)), np.float64, order="C")
        out = np.empty(count), np.empty(count, np.int64), np.empty((count, 3))
        _cast(
            self.corners, self.order, self.nodes, self.links, self.objects, origins, directions,
            _column(shortest, np.float64, count, 0.0),
            _column(longest, np.float64, count, np.inf),
            _column(own_triangles, np.int64, count, -1),
            _column(own_objects, np.int64, count, -1),
            any_hit, np.empty(4 * _DEEPEST, np.int64), *out,
        )  # fmt: skip
        return Hits(*out)

    def nearest(self, origins, directions, longest=None):
        """What rays meet first.

        ``origins``: [r, 3] or one [3]; ``directions``: [r, 3], of any length but zero; ``longest``: the
        distance up to which they reach, in lengths of the direction, a number or [r]; None: infinity.
        """
        return self._cast(origins, directions, None, longest, None, None, False)

    def occluded(self, points, directions, *, longest=None, triangles=None, objects=None):
        """Whether something lies on the way from ``points`` [r, 3] along ``directions`` [r, 3].

        ``longest``: how far, in lengths of the direction: 1 where it ends at a light; None: for ever.
        ``triangles``, ``objects``: int64 [r], of each point its own triangle, and an object that casts no
        shadow on it. bool [r].
        """
        directions = np.asarray(directions, np.float64)
        with np.errstate(divide="ignore"):
            shortest = _START * self.diagonal / np.sqrt(dot(directions, directions))
        return self._cast(points, directions, shortest, longest, triangles, objects, True).triangle >= 0


def _column(values, dtype, count, default):
    """One value for each of ``count`` triangles or rays, as an array."""
    out = np.array(np.broadcast_to(default if values is None else values, (count,)), order="C")
    return out.astype(dtype, copy=False)


def scene_caster(scene):
    """The RayCaster of a ``Scene``; its objects are numbered as in ``scene.objects``."""
    return RayCaster(scene.triangles(), scene.object_of_triangle())


@dataclass(frozen=True, eq=False)
class Visible:
    """What a view shows at its pixels' centres; arrays are [h, w], bottom row first.

    triangle  int64, -1: nothing
    object    int64, -1: nothing
    depth     float64 window depth in [0, 1]; 1 where nothing is
    points    float64 [h, w, 3], world coordinates; zero where nothing is
    normals   float64 [h, w, 3], of the triangle, length one, on the side that is seen
    """

    triangle: np.ndarray
    object: np.ndarray
    depth: np.ndarray
    points: np.ndarray
    normals: np.ndarray

    @property
    def something(self):
        """Where there is a surface: bool [h, w], bottom row first."""
        return self.triangle >= 0


def primary_rays(view, pixels=None):
    """Rays through the pixels' centres of a ``views.View``, from the near to the far plane.

    Origins and directions, float64 [n, 3]; they end at distance one. ``pixels``: their numbers, row by row
    from the bottom, int64 [n]; None: all.
    """
    panel = view.panel
    pixels = np.arange(panel.width * panel.height) if pixels is None else pixels
    row, column = np.divmod(pixels, panel.width)
    x = (column + 0.5) / panel.width * 2.0 - 1.0
    y = (row + 0.5) / panel.height * 2.0 - 1.0
    inverse = np.linalg.inv(np.array(view.projection) @ np.array(view.modelview))

    def at(z):
        clip = np.stack([x, y, np.full_like(x, z), np.ones_like(x)], axis=-1) @ inverse.T
        return clip[:, :3] / clip[:, 3:]

    near = at(-1.0)
    return near, at(1.0) - near


def visible(caster, view):
    """What a ``views.View`` shows of a RayCaster's triangles: ``Visible``."""
    origins, directions = primary_rays(view)
    hits = caster.nearest(origins, directions, 1.0)
    seen = hits.triangle >= 0
    points = np.where(seen[:, None], origins + np.where(seen, hits.distance, 0.0)[:, None] * directions, 0.0)
    normals = np.where(seen[:, None], caster.normals[hits.triangle], 0.0)
    normals = np.where((dot(normals, directions) > 0.0)[:, None], -normals, normals)
    clip = (np.array(view.projection) @ np.array(view.modelview))[2:]
    z, w = (points @ row[:3] + row[3] for row in clip)
    depth = np.where(seen, 0.5 + 0.5 * z / np.where(w == 0.0, 1.0, w), 1.0)
    shape = view.panel.height, view.panel.width
    return Visible(
        hits.triangle.reshape(shape),
        np.where(seen, caster.objects[hits.triangle], -1).reshape(shape),
        depth.reshape(shape),
        points.reshape(*shape, 3),
        normals.reshape(*shape, 3),
    )


def to_light(points, light):
    """Vectors from points [n, 3] to the light, and the length of a shadow ray along them.

    ``light``: for an ``infinite`` lamp the direction is ``position - target``, and rays are infinite.
    Otherwise they end at its ``position``.
    """
    position = np.array(light.position, np.float64)
    if light.infinite:
        return np.broadcast_to(position - np.array(light.target, np.float64), points.shape), None
    return position - points, 1.0


def lit_points(caster, points, normals, light, *, triangles=None, objects=None):
    """Whether the light reaches points [n, 3] of surfaces with normals [n, 3]: bool [n].

    A surface turned away from the light is in shadow. ``triangles``, ``objects``: as for ``occluded``.
    """
    directions, longest = to_light(points, light)
    out = dot(normals, directions) > 0.0
    triangles, objects = (None if own is None else own[out] for own in (triangles, objects))
    blocked = caster.occluded(
        points[out], directions[out], longest=longest, triangles=triangles, objects=objects
    )
    out[out] = ~blocked
    return out


def lit(caster, shown, light, *, self_shadows=True):
    """Where a light reaches what is shown: bool [h, w], bottom row first, false where nothing is.

    ``shown``: Visible. ``light``: a ``Lamp`` of ``fixedpipe.effects.scenes.objects_and_lamps`` (``position``,
    ``target``, ``infinite``). ``self_shadows`` False: an object's own shadow does not fall on it; its sides
    that are turned away stay dark.
    """
    out = shown.something.copy()
    objects = None if self_shadows else shown.object[out]
    out[out] = lit_points(
        caster,
        shown.points[out],
        shown.normals[out],
        light,
        triangles=shown.triangle[out],
        objects=objects,
    )
    return out


def seen_fraction(caster, shown, lights):
    """The part of ``lights``, samples of an area light, that reaches what is shown: float64 [h, w] (Z26)."""
    lights = tuple(lights)
    if not lights:
        raise ValueError("There is no light to be seen; give one or more.")
    return sum(lit(caster, shown, light).astype(np.float64) for light in lights) / len(lights)

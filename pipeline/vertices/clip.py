"""Clipping (section 2.11): Sutherland-Hodgman on all affected triangles at once.

Filled triangles are clipped by the near and far planes, the user planes and the guard band. The sides of the
view volume do not clip them: ``fixedpipe.pipeline.vertices.view_volume`` replaces that by a scissor box.
"""

from functools import partial

import numpy as np

from fixedpipe.pipeline.enums import PrimitiveType, ProvokingVertex
from fixedpipe.pipeline.vertices.arithmetic import ONE, weighted_sum
from fixedpipe.pipeline.vertices.assembly import split

CLIP = slice(0, 4)
EYE = slice(4, 8)
_NEAREST_W = 2.0**-100  # with depth clamping no near plane clips; this bound keeps w positive


def _everywhere(column, count):
    """A column as an array. NumPy's broadcast_to costs more than the work on a short column."""
    return column if column.ndim else np.broadcast_to(column, count)


def _near(v):
    return v[2] + v[3]


def _far(v):
    return v[3] - v[2]


def _eye(v):
    return v[3] - _NEAREST_W


def _user(plane, v):
    return weighted_sum(plane, v[EYE])


def _low(axis, half, reach, v):
    return v[axis] * half + reach * v[3]


def _high(axis, half, reach, v):
    return reach * v[3] - v[axis] * half


def clip_planes(user_planes, half_size, center, size, guard_band, depth_clamp):
    """Distance functions of the clipping planes, in the order in which they clip.

    - ``user_planes``: the enabled user planes.
    - ``half_size``, ``center``: (x, y), half the viewport's size and its middle in window coordinates.
    - ``size``: (width, height) of the framebuffer.
    - ``guard_band``: in pixels around the framebuffer.
    - ``depth_clamp``: a plane at the eye replaces the near and far planes.

    Each function takes a list of columns that starts with clip coordinates; with user planes, eye coordinates
    follow. A vertex is inside when its distance is >= 0.
    """
    depth_planes = [_eye] if depth_clamp else [_near, _far]
    planes = [*depth_planes, *(partial(_user, plane) for plane in user_planes)]
    for axis in (0, 1):
        low = np.float64(center[axis] + guard_band)
        high = np.float64((size[axis] + guard_band) - center[axis])
        planes.append(partial(_low, axis, half_size[axis], low))
        planes.append(partial(_high, axis, half_size[axis], high))
    return planes


# The sides of the view volume, in the order of the last four planes of ``clip_planes``, which they replace.
VIEW_VOLUME_SIDES = (
    partial(_low, 0, ONE, ONE),
    partial(_high, 0, ONE, ONE),
    partial(_low, 1, ONE, ONE),
    partial(_high, 1, ONE, ONE),
)


def clip(triangles, columns, vertex_count, planes):
    """Clip triangles against planes; only triangles with a vertex outside a plane change.

    ``triangles`` is int32 [k, 4]: three vertices and the provoking vertex. ``columns``, of ``vertex_count``
    vertices, starts with the columns that ``clip_planes`` names. Returns:

    - int32 [j, 4]: the triangles in draw order.
    - the columns, with the vertices of clipped triangles appended.
    - int64 [j]: the index in ``triangles`` that each came from.
    - the number of triangles dropped because a clip coordinate is not finite.
    """
    origin = np.arange(len(triangles))
    corners = triangles[:, :3]
    violated = []
    for plane in planes:
        inside = plane(columns) >= 0
        if not np.all(inside):
            violated.append((plane, ~_everywhere(inside, vertex_count)[corners]))
    if not violated:
        return triangles, columns, origin, 0

    touched = np.any([outside.any(axis=1) for _, outside in violated], axis=0)
    finite = np.ones(len(triangles), dtype=bool)
    for column in columns[CLIP]:
        finite &= _everywhere(np.isfinite(column), vertex_count)[corners].all(axis=1)
    hidden = np.any([outside.all(axis=1) for _, outside in violated], axis=0)
    chosen = np.flatnonzero(touched & finite & ~hidden)

    # One row for each attribute, one column for each polygon vertex: plane functions read rows as columns.
    values = np.stack([_everywhere(column, vertex_count)[corners[chosen].ravel()] for column in columns])
    polygon = np.repeat(np.arange(len(chosen)), 3)
    for plane, outside in violated:
        values, polygon = _clip_polygons(values, polygon, plane, outside[chosen].any(axis=1))
    counts = np.bincount(polygon, minlength=len(chosen))

    fans, fan_polygon = split(PrimitiveType.POLYGON, counts, ProvokingVertex.LAST)
    fans += vertex_count
    fans[:, 3] = triangles[chosen[fan_polygon], 3]
    kept = finite & ~touched
    triangles = np.concatenate([triangles[kept], fans.astype(np.int32)])
    origin = np.concatenate([origin[kept], chosen[fan_polygon]])
    order = np.argsort(origin, kind="stable")
    columns = [
        np.concatenate([_everywhere(column, vertex_count), new])
        for column, new in zip(columns, values, strict=True)
    ]
    return triangles[order], columns, origin[order], int(np.count_nonzero(~finite))


def _all_inside(columns, planes):
    """Whether no plane clips any vertex, which is true of most draws."""
    if not all([np.all(np.isfinite(column)) for column in columns[CLIP]]):
        return False
    return all(np.all(plane(columns) >= 0) for plane in planes)


def clip_lines(rows, columns, vertex_count, planes):
    """Clip lines or points, with the results of ``clip``; rows are those of ``assembly.split_lines``.

    A point outside a plane is discarded. A line's end outside a plane moves to the intersection, which is
    computed from the other end, as for triangles.
    """
    if _all_inside(columns, planes):
        return np.ascontiguousarray(rows, np.int32), columns, np.arange(len(rows)), 0
    ends = rows[:, [1, 0]].astype(np.int64)  # the first vertex, then the second
    finite = np.ones(len(rows), dtype=bool)
    for column in columns[CLIP]:
        finite &= _everywhere(np.isfinite(column), vertex_count)[ends].all(axis=1)
    values = [np.stack([_everywhere(c, vertex_count)[ends[:, k]] for c in columns]) for k in (0, 1)]
    hidden, moved = ~finite, np.zeros(ends.shape, dtype=bool)
    for plane in planes:
        distances = [plane(values[0]), plane(values[1])]
        outside = [~(d >= 0) for d in distances]
        hidden |= outside[0] & outside[1]
        for k in (0, 1):
            crossing = np.flatnonzero(outside[k] & ~outside[1 - k] & ~hidden)
            inside, beyond = values[1 - k][:, crossing], values[k][:, crossing]
            t = distances[1 - k] / (distances[1 - k] - distances[k])
            values[k][:, crossing] = inside + t[crossing] * (beyond - inside)
            moved[crossing, k] = True
    kept = ~hidden
    moved &= kept[:, None]
    which = np.flatnonzero(moved.ravel())  # new vertices, line by line
    ends.ravel()[which] = vertex_count + np.arange(len(which))
    new = np.stack(values, axis=2).reshape(len(columns), -1)[:, which]
    rows = np.column_stack([ends[:, 1], ends[:, 0], ends[:, 0], rows[:, 3]]).astype(np.int32)
    if len(which):
        columns = [
            np.concatenate([_everywhere(column, vertex_count), added])
            for column, added in zip(columns, new, strict=True)
        ]
    return rows[kept], columns, np.flatnonzero(kept), int(np.count_nonzero(~finite))


def _clip_polygons(values, polygon, plane, needed):
    """Clip polygons against one plane, but only those marked in ``needed``.

    ``values`` is float64 [attributes, v]; ``polygon`` is int64 [v], ascending: the polygon of each vertex.
    Returns both after clipping. The order is that of each polygon's vertices: an inside vertex is kept, and
    where the edge to the next vertex crosses the plane, the intersection follows.
    """
    distance = plane(values)
    inside = (distance >= 0) | ~needed[polygon]
    first = np.searchsorted(polygon, polygon, side="left")
    following = np.arange(1, len(polygon) + 1)
    last = np.append(polygon[1:] != polygon[:-1], True)[: len(polygon)]
    following[last] = first[last]
    crossing = inside != inside[following]

    emitted = inside.astype(np.int64) + crossing
    position = np.cumsum(emitted) - emitted
    result = np.empty((len(values), int(emitted.sum())))
    result[:, position[inside]] = values[:, inside]

    here = np.flatnonzero(crossing)
    there = following[here]
    i = np.where(inside[here], here, there)
    o = np.where(inside[here], there, here)
    t = distance[i] / (distance[i] - distance[o])
    result[:, (position + inside)[here]] = values[:, i] + t * (values[:, o] - values[:, i])
    return result, np.repeat(polygon, emitted)

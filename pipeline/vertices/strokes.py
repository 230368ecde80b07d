"""Points and lines before rasterization: sizes, outlines of polygons, and the squares of points.

docs/numbers.md section 11 fixes the rules. A row is one of ``WindowPrimitives.triangles``;
``fixedpipe.raster.codes`` has the codes of its kinds.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import Face, FrontFace, PolygonMode, PrimitiveType, VertexStage
from fixedpipe.pipeline.vertices.arithmetic import (
    ONE,
    ZERO,
    columns_of,
    length,
    positive,
    weighted_sum,
)
from fixedpipe.pipeline.vertices.assembly import boundary_edges, stipple_groups
from fixedpipe.pipeline.vertices.chip_floats import lighting_inverse_root
from fixedpipe.raster import codes as C
from fixedpipe.raster.primitives.strokes import POINT_REACH
from fixedpipe.raster.rows import COUNTER, END_STEP, FIRST_STEP, KIND

_EDGES = ((1, 2), (2, 0), (0, 1))  # in the order in which a triangle's outline is drawn

_NO_SOURCE = (0, -1, -1, -1, 0, 0, 0)


def draws_points(mesh, polygon):
    """Whether a mesh may be drawn as points."""
    modes = polygon.front_mode, polygon.back_mode
    return mesh.primitive == PrimitiveType.POINTS or PolygonMode.POINT in modes


def point_sizes(mesh, state, profile, eye):
    """The size of every vertex's point in pixels: a column.

    Measured: Point_params Scale_0_0_1_FF, 192 of 192 points; Detailed_FF: the inverse square root of 4 makes
    a point smaller than one half does, as in the lighting unit's table without a Newton step.
    """
    point = state.point
    if state.vertex.stage == VertexStage.PROGRAM_RESULTS:
        written = point.program_size and mesh.point_sizes is not None
        default = 1.0 if point.program_size else point.size
        (size,) = columns_of(mesh.point_sizes[:, None] if written else None, (default,))
    elif point.parameters is None:
        size = np.float64(point.size)
    else:
        given, d = point.parameters, length(eye[:3])
        under = weighted_sum(given.attenuation, (ONE, d, d * d))
        root = lighting_inverse_root(np.asarray(positive(under)))
        factor = np.fmin(positive(root + np.float64(given.bias)), ONE)
        size = factor * np.float64(given.range) + np.float64(given.minimum)
    return np.fmin(np.fmax(size, ZERO), np.float64(profile.primitives.max_point_size))


def outlined(triangles, boundary, x, y, inverse_w, polygon):
    """Rows and strokes of triangles in their faces' polygon modes, and the triangle of each.

    Culled points and lines are left out; the kernels cull filled triangles.

    - ``triangles``: int32 [k, 4].
    - ``boundary``: uint8 [k], bit j for the edge ``_EDGES[j]``.
    - ``x``, ``y``: int32 [n].
    - ``inverse_w``: float64 [n].

    A triangle without area faces as a counter-clockwise one does. Measured: Front_face FrontFace_LM captures.
    It is not culled if two of its corners coincide. Measured: W_param w_gaps, the lines between its quads.
    Each negative w turns a triangle. Measured: W_param w_neg_strip captures.
    """
    corner_x, corner_y = x[triangles[:, :3]].astype(np.int64), y[triangles[:, :3]].astype(np.int64)
    (x0, x1, x2), (y0, y1, y2) = corner_x.T, corner_y.T
    counter_clockwise = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0) <= 0
    counter_clockwise ^= (inverse_w[triangles[:, :3]] < 0.0).sum(axis=1) & 1 == 1
    front = counter_clockwise == (polygon.front_face == FrontFace.CCW)
    mode = np.where(front, polygon.front_mode, polygon.back_mode)
    culled = {None: front & False, Face.FRONT: front, Face.BACK: ~front}.get(polygon.cull_face, front | True)
    meeting = (corner_x == np.roll(corner_x, 1, axis=1)) & (corner_y == np.roll(corner_y, 1, axis=1))
    culled &= ~meeting.any(axis=1)

    rows = np.repeat(triangles[:, None], 3, axis=1)
    drawn = np.zeros((len(triangles), 3), bool)
    drawn[:, 0] = mode == PolygonMode.FILL  # the kernels cull these
    for j, (start, end) in enumerate(_EDGES):
        outline = (mode != PolygonMode.FILL) & ~culled
        drawn[:, j] |= outline & ((boundary >> j) & 1 != 0)
        first = triangles[:, start]
        second = np.where(mode == PolygonMode.LINE, triangles[:, end], first)
        rows[outline, j, :3] = np.stack([second, first, first], axis=1)[outline]
    kinds = np.choose(mode, [C.PRIMITIVE_POINT, C.PRIMITIVE_LINE, C.PRIMITIVE_TRIANGLE])
    nothing = np.zeros((len(triangles), 3), np.int32)
    strokes = np.column_stack([kinds, ~front, triangles[:, :3], nothing])[:, None].repeat(3, axis=1)
    return rows[drawn], strokes[drawn].astype(np.int32), np.nonzero(drawn)[0]


def with_strokes(primitives, kind):
    """The same primitives with strokes whose rows are all lines or all points."""
    strokes = np.array([(kind, *_NO_SOURCE)], np.int32).repeat(len(primitives.triangles), axis=0)
    return replace(primitives, strokes=strokes)


def whole_size(size):
    """A line's width or a point's size as OpenGL rounds it: to the nearest integer, at least 1.

    ``size`` is a number or a column, in pixels. Source: OpenGL 1.2.1 sections 3.3 and 3.4.2; Assumed: halves
    up.
    """
    return np.fmax(np.floor(size + 0.5), 1.0).astype(np.int64)


def _left_from(major, minor, toward_major, toward_minor, y_is_major, at_major, at_minor):
    """The first step of a line, in its direction, whose diamond the line has not left at a given point.

    All arguments are int64 [k], in 1/16 pixel, y down: a point of the line, its direction, whether y is the
    longer axis, and the given point. Points are shifted left by an infinitesimal, and down by a far smaller
    one. Source: OpenGL 1.2.1 section 3.4.1.
    """
    sign, length = np.where(toward_major < 0, -1, 1), np.maximum(abs(toward_major), 1)
    rise = sign * toward_minor
    tie = np.where(y_is_major | (rise < 0), 1, 0)
    sides = toward_major + toward_minor, toward_major - toward_minor
    step = (at_major >> 4) - sign
    for _ in range(2):
        # The pixel at this step whose diamond the line crosses, and the two sides through which the line may
        # leave it.
        center = 16 * step + 8
        crossed = (minor * length + (center - major) * rise - tie) // (16 * length)
        ahead, beside = at_major - center, at_minor - (16 * crossed + 8)
        moved = np.int64(-1), np.where(y_is_major, 1, -1)
        left = [
            np.sign(side) * (2 * value + by) >= 16
            for side, value, by in zip(sides, (ahead + beside, ahead - beside), moved, strict=True)
        ]
        step = np.where(left[0] | left[1], step + sign, step)
    return step


def with_steps(primitives, groups, line, profile):
    """The same primitives whose lines know their steps and their first place in the line stipple.

    ``groups`` is int64 [k]: consecutive rows of one number share a counter. ``line`` is a LineState.
    """
    strokes = primitives.strokes.copy()
    rows = np.flatnonzero(strokes[:, KIND] == C.PRIMITIVE_LINE)
    ends = primitives.triangles[rows][:, [1, 0]]
    x, y = primitives.x[ends].astype(np.int64), primitives.y[ends].astype(np.int64)
    across, down = x[:, 1] - x[:, 0], y[:, 1] - y[:, 0]
    y_is_major = abs(across) < abs(down)
    if profile.arithmetic.diamond_exit_lines:
        beside = 8 * (whole_size(line.width) - 1)
        x, y = np.where(y_is_major[:, None], x - beside, x), np.where(y_is_major[:, None], y, y + beside)
        major, minor = np.where(y_is_major, [y.T, x.T], [x.T, y.T])
        toward = np.where(y_is_major, [down, across], [across, down])
        first, end = (_left_from(major[0], minor[0], *toward, y_is_major, major[k], minor[k]) for k in (0, 1))
    else:
        # A boundary between rows belongs to the upper one. Measured: 20 of 20 ends (Smoothing_control
        # 0xFFFF0000).
        first, end = np.where(y_is_major, y.T - 1, x.T) >> 4
    strokes[rows, FIRST_STEP], strokes[rows, END_STEP] = first, end
    if line.stipple is not None and len(rows):
        before = np.cumsum(abs(end - first)) - abs(end - first)
        begins = np.diff(groups[rows], prepend=groups[rows[0]] - 1) != 0
        began = before[begins][np.cumsum(begins) - 1]
        strokes[rows, COUNTER] = (before - began) % (16 * line.stipple[0])
    return replace(primitives, strokes=strokes)


def with_squares(primitives, sizes, units, profile):
    """The same primitives, with each point's row as its square (``raster.primitives.strokes``).

    - ``sizes``: a column, pixels. A machine with ``diamond_exit_lines`` rounds them, and moves the point to
      the middle of a pixel or to a corner (Source: OpenGL 1.2.1 section 3.3).
    - ``units``: the texture units whose coordinates sprites replace. s runs from left to right and t from top
      to bottom, each with 1/2 in the middle.

    Measured: Point_sprite AlphaTest, 305506 of 305506 pixels. Point_params Detailed_FF: right of the middle
    and below it, coordinates at exact texel boundaries are off by the last bit; before it they are not.
    """
    points = np.flatnonzero(primitives.strokes[:, KIND] == C.PRIMITIVE_POINT)
    at = primitives.triangles[points, 0].repeat(3)  # a place to the right, the middle, a place below
    sizes = np.broadcast_to(sizes, len(primitives.x))[at]
    half = (8 * whole_size(sizes) if profile.arithmetic.diamond_exit_lines else np.trunc(sizes * 8.0)).astype(
        np.int32
    )
    across, down = np.tile([1, 0, 0], len(points)), np.tile([0, 0, 1], len(points))
    grown = {
        name: np.concatenate([getattr(primitives, name), getattr(primitives, name)[at]])
        for name in ("x", "y", "z", "inverse_w", "colors", "coordinates", "fog")
    }
    first = len(primitives.x)
    if profile.arithmetic.diamond_exit_lines:
        odd, x, y = (half & 8) != 0, primitives.x[at], primitives.y[at]
        grown["x"][first:] = np.where(odd, (x & -16) + 8, (x + 8) & -16)
        grown["y"][first:] = np.where(odd, -(-y & -16) - 8, -((8 - y) & -16))  # window y runs upwards
    # A point smaller than an eighth of a pixel covers the pixel that it lies in. Measured: size 0, through a
    # program and the fixed functions (Point_size PointSmoothOff_01_VS, SmallestPointSize_FF).
    nothing = half == 0
    half = np.where(nothing, np.int32(8), half)
    for name, steps in (("x", across), ("y", down)):
        middle = grown[name][first:]
        middle = np.where(nothing, (middle & -16) + 8, middle)
        grown[name][first:] = middle + POINT_REACH * half * steps
    for i in units:
        s, t = (0.5 + 0.5 * POINT_REACH * steps for steps in (across, down))
        grown["coordinates"][first:, i] = np.stack([s, t, np.zeros(len(at)), np.ones(len(at))], axis=1)
    triangles = primitives.triangles.copy()
    triangles[points, :3] = (first + np.arange(3 * len(points))).reshape(-1, 3)
    return replace(primitives, triangles=triangles, **grown)


def sprite_units(state):
    """The texture units whose coordinates point sprites replace."""
    if not state.point.sprite:
        return []
    return [i for i, unit in enumerate(state.texture_units) if unit is not None and unit.coord_replace]


def stroked(primitives, mesh, state, profile, clipped, origin, sizes):
    """The same primitives with their lines and points made.

    - ``clipped``: int32 [k, 4], the rows after clipping.
    - ``origin``: int64 [k], the row that each came from.
    - ``sizes``: of points, a column.
    """
    if mesh.primitive == PrimitiveType.POINTS:
        primitives = with_strokes(primitives, C.PRIMITIVE_POINT)
    elif not mesh.primitive.is_polygons:
        groups = stipple_groups(mesh)[origin]
        return with_steps(with_strokes(primitives, C.PRIMITIVE_LINE), groups, state.line, profile)
    elif (state.polygon.front_mode, state.polygon.back_mode) == (PolygonMode.FILL, PolygonMode.FILL):
        return primitives
    else:
        boundary = _boundary(mesh, clipped, origin)
        rows, strokes, owners = outlined(
            primitives.triangles, boundary, primitives.x, primitives.y, primitives.inverse_w, state.polygon
        )
        primitives = replace(primitives, triangles=rows, strokes=strokes)
        groups = stipple_groups(mesh)[origin[owners]]
        primitives = with_steps(primitives, groups, state.line, profile)
    if not (primitives.strokes[:, KIND] == C.PRIMITIVE_POINT).any():
        return primitives
    return with_squares(primitives, sizes, sprite_units(state), profile)


def _boundary(mesh, triangles, origin):
    """The edges of each triangle that bound a polygon; a clipped triangle's outline is its whole boundary."""
    boundary = boundary_edges(mesh)[origin]
    clipped = np.isin(origin, origin[(triangles[:, :3] >= len(mesh.positions)).any(axis=1)])
    begins, ends = np.diff(origin, prepend=-1) != 0, np.diff(origin, append=-1) != 0
    return np.where(clipped, 1 | np.where(ends, 2, 0) | np.where(begins, 4, 0), boundary)

"""G01 and G02: which texel is seen from every texel of a height field in every direction: the paper's S_i.

A ray leaves the texel's centre, which is a vertex of the field's triangles (``height_field``); the field
repeats. Along the ray, the height above the field is linear between the lines where triangles meet. So it is
tested on these lines alone, and the crossing is exact up to float64's rounding. The result is the texel whose
centre is nearest to the hit (section 3: "quantized" coordinates for secondary hits).

A texel whose normal faces away from the direction sees nothing along it, because the cosine is zero there
(BACK). That differs from a free view (FREE), which shadows and environments need.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3; pass sequence A-G01 of the catalogue. It departs in
one point: triangles, not bilinear patches, lie between the texels, so the field drawn as a mesh is the same.
"""

from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G01", "the texel that is seen from every texel along each of some hundred directions", "3"),
    Technique("G02", "rays that go on in the next tile of a height field that repeats", "3"),
    Technique("H50", "for each direction a texture that says which texel every texel sees", "3.2"),
)

# What stands for a texel where none is seen: nothing is in the way, or the normal looks away.
FREE, BACK = -1, -2
# Level rays over grooves may go on for ever: after so many tiles nothing is seen.
# Assumed: no scene distinguishes what is farther.
MOST_TILES = 64
# Directions that one task computes.
_DIRECTIONS_A_TASK = 4


@kernel(
    "Tuple((float64, float64, float64))(float64[:, ::1], int64, int64, float64, float64, float64, "
    "UniTuple(float64, 3), UniTuple(int64, 3))"
)
def crossed(heights, column, row, dx, dy, t, lines, numbers):
    """Where a ray from a texel's centre is over the nearest line on which triangles meet, at ``t``, and the
    field's height there: x and y in texels, and the height.

    lines, numbers  of the next column's line, row's and diagonal's: where the ray crosses it, and the
                    how manieth it is
    """
    rows, columns = heights.shape
    # A coordinate that the line has is taken as the whole number that it is.
    x = float(column + (numbers[0] if dx > 0.0 else -numbers[0])) if t == lines[0] else column + t * dx
    if t == lines[1]:
        y = float(row + (numbers[1] if dy > 0.0 else -numbers[1]))
    elif t == lines[0] or t != lines[2]:
        y = row + t * dy
    else:
        y = x - (column - row + (numbers[2] if dx > dy else -numbers[2]))
    i, j = int(np.floor(x)), int(np.floor(y))
    u, v = x - i, y - j
    c0, r0 = i % columns, j % rows
    c1, r1 = c0 + 1 if c0 + 1 < columns else 0, r0 + 1 if r0 + 1 < rows else 0
    # On a line the field is linear between the line's two vertices.
    low = heights[r0, c0]
    if t == lines[0]:
        return x, y, low + v * (heights[r1, c0] - low)
    if t == lines[1]:
        return x, y, low + u * (heights[r0, c1] - low)
    return x, y, low + u * (heights[r1, c1] - low)


@kernel(
    "Tuple((int64, float64))(float64[:, ::1], int64, int64, UniTuple(float64, 3), float64, int64, float64)"
)
def hit(heights, column, row, direction, highest, most, enough):
    """The texel that a ray (``direction``: texels, texels, heights) from a texel's centre hits, or FREE; and
    how far away the point is, in lengths of the direction. The search ends at the distance ``enough``.
    """
    dx, dy, dz = direction
    rows, columns = heights.shape
    z0 = heights[row, column]
    # The ray crosses the columns' lines, the rows' and the diagonals' at whole multiples of these.
    infinity = np.inf
    step_x = 1.0 / abs(dx) if dx != 0.0 else infinity
    step_y = 1.0 / abs(dy) if dy != 0.0 else infinity
    step_d = 1.0 / abs(dx - dy) if dx != dy else infinity
    next_x, next_y, next_d = 1, 1, 1
    before, t_before = 0.0, 0.0
    x_before, y_before = float(column), float(row)
    while next_x + next_y + next_d < most:
        t_x, t_y, t_d = next_x * step_x, next_y * step_y, next_d * step_d
        t = min(t_x, min(t_y, t_d))
        if t == infinity or t > enough:
            break
        z = z0 + t * dz
        if z > highest:
            break
        x, y, field = crossed(heights, column, row, dx, dy, t, (t_x, t_y, t_d), (next_x, next_y, next_d))
        above = z - field
        if above < 0.0:
            if t_before > 0.0:
                share = before / (before - above)
                x, y = x_before + share * (x - x_before), y_before + share * (y - y_before)
                t = t_before + share * (t - t_before)
            # Else the ray begins below the triangle that it leaves over, whose far edge it then sees.
            i, j = int(np.floor(x + 0.5)) % columns, int(np.floor(y + 0.5)) % rows
            return j * columns + i, t
        before, t_before, x_before, y_before = above, t, x, y
        if t == t_x:
            next_x += 1
        if t == t_y:
            next_y += 1
        if t == t_d:
            next_d += 1
    return FREE, infinity


@kernel("int64(float64[:, ::1], int64, int64, float64, float64, float64, float64, int64)")
def _seen(heights, column, row, dx, dy, dz, highest, most):
    """The texel that a ray (dx, dy: texels, dz: heights) from a texel's centre hits, or FREE."""
    return hit(heights, column, row, (dx, dy, dz), highest, most, np.inf)[0]


@kernel("void(float64[:, ::1], float64, float64[:, :, ::1], float64[:, ::1], int32[:, :, ::1])")
def _trace(heights, highest, normals, directions, out):
    rows, columns = heights.shape
    most = MOST_TILES * 3 * (rows + columns)
    for i in range(len(directions)):
        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
        for row in range(rows):
            for column in range(columns):
                n = normals[row, column]
                if (n[0] * x + n[1] * y) + n[2] * z <= 0.0:
                    out[i, row, column] = BACK
                else:
                    out[i, row, column] = _seen(heights, column, row, x * columns, y * rows, z, highest, most)


@kernel("void(float64[:, ::1], float64, int32[:, :, ::1], float64[:, ::1], float64[:, :, ::1])")
def _reach(heights, highest, seen, directions, out):
    rows, columns = heights.shape
    most = MOST_TILES * 3 * (rows + columns)
    for i in range(len(directions)):
        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
        for row in range(rows):
            for column in range(columns):
                out[i, row, column] = np.inf
                if seen[i, row, column] >= 0:
                    d = x * columns, y * rows, z
                    out[i, row, column] = hit(heights, column, row, d, highest, most, np.inf)[1]


def _traced(heights, normals, directions):
    out = np.empty((len(directions), *heights.shape), np.int32)
    _trace(heights, float(heights.max()), normals, directions, out)
    return out


@dataclass(frozen=True, eq=False)
class Visibility:
    """The texel that every texel sees along every direction.

    directions  float64 [n, 3], unit vectors in the base's frame
    seen        int32 [n, rows, columns]: row * columns + column of the texel that is seen, FREE, or BACK
    """

    directions: NDArray[np.float64]
    seen: NDArray[np.int32]

    @property
    def count(self) -> int:
        """How many directions there are."""
        return len(self.directions)

    @property
    def rows(self) -> int:
        """Texels from bottom to top."""
        return self.seen.shape[1]

    @property
    def columns(self) -> int:
        """Texels from left to right."""
        return self.seen.shape[2]

    @property
    def stored_bytes(self) -> int:
        """The memory for the paper's two bytes a texel and direction (E002.5)."""
        return 2 * self.seen.size


def precompute(field, directions, executor=None, progress=None):
    """The Visibility of a HeightField along directions [n, 3].

    executor  a concurrent.futures.Executor among whose workers directions are shared; None: threads, one a
              processor. Any gives the same numbers
    progress  None, or a function that is called with the number of directions that are done, in order

    Raises ValueError for directions that are none (``directions.checked``).
    """
    found = sphere.checked(directions)
    parts = [found[k : k + _DIRECTIONS_A_TASK] for k in range(0, len(found), _DIRECTIONS_A_TASK)]
    if executor is None:
        with ThreadPoolExecutor(default_threads()) as threads:
            seen = _gathered(field, parts, threads, progress)
    else:
        seen = _gathered(field, parts, executor, progress)
    return Visibility(found, seen)


def _gathered(field, parts, executor: Executor, progress):
    futures = [executor.submit(_traced, field.heights, field.normals, part) for part in parts]
    seen, done = [], 0
    for future in futures:
        seen.append(future.result())
        done += len(seen[-1])
        if progress is not None:
            progress(done)
    return np.concatenate(seen)


def check_same_texels(field, visibility):
    """Raises ValueError if a Visibility and a HeightField do not have the same number of texels, because
    kernels use the texels of one as indices into the other.
    """
    theirs, own = visibility.seen.shape[1:], field.heights.shape
    if theirs != own or len(visibility.directions) != len(visibility.seen):
        raise ValueError(
            f"The visibility is of {len(visibility.directions)} directions and {theirs[1]} x {theirs[0]} "
            f"texels, and the field has {own[1]} x {own[0]}; give what precompute makes of this field."
        )


def distances(field, visibility):
    """How far away the point is that each texel of a HeightField sees along each direction of its Visibility,
    in edges of the field's square: float64 [n, rows, columns], infinity where none is seen.

    Raises ValueError for another field's Visibility.
    """
    check_same_texels(field, visibility)
    out = np.empty(visibility.seen.shape)
    _reach(field.heights, float(field.heights.max()), visibility.seen, visibility.directions, out)
    return out


def free_view(field, direction):
    """Where a HeightField's texels see the sky along one direction [3], by rays: bool [rows, columns]."""
    return precompute(field, np.asarray(direction, np.float64)[None]).seen[0] == FREE

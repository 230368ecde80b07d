"""What the vertex stage hands to rasterization: triangles, lines and points in window coordinates."""

from dataclasses import dataclass, field

import numpy as np


def no_strokes():
    """The ``strokes`` of primitives that are all triangles."""
    return np.zeros((0, 5), np.int32)


@dataclass(frozen=True, eq=False)
class WindowPrimitives:
    """Primitives after transformation, lighting, clipping, projection, viewport and snapping.

    x, y           int32 [n], device window coordinates, 1/16 pixel, y down from the framebuffer's top row
    z              float64 [n], window depth, in [0, 1] where nothing clamps it later; a vertex program's, in
                   depth-buffer units
    inverse_w      float64 [n], 1 / clip w, positive
    colors         uint8 [n, 2, 8]: front and back colour; red, green, blue, alpha of the primary colour, then
                   of the secondary; float64, not clamped, if the profile is exact
    coordinates    float64 [n, units, 4]: s, t, r, q of each texture unit, after generation and matrix
    fog            float64 [n]: fog coordinate
    triangles      int32 [k, 4]: three vertices in the order of docs/numbers.md and the provoking vertex
    dropped        primitives dropped because a position was not finite after projection, or w was 0
    two_side       whether back-facing triangles take the back colour
    strokes        int32 [k, 5], or [0, 5] where all are triangles: what each row of ``triangles`` is
                   (raster.rows: TRIANGLE, LINE or POINT), whether it takes the back colour, and the three
                   vertices of the polygon that it came from, -1 if none. A line's row is its second vertex,
                   then its first, twice. A point's row is three corners of its square: lower left, lower
                   right, upper right.
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    inverse_w: np.ndarray
    colors: np.ndarray
    coordinates: np.ndarray
    fog: np.ndarray
    triangles: np.ndarray
    dropped: int
    two_side: bool
    strokes: np.ndarray = field(default_factory=no_strokes)

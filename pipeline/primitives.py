"""What the vertex stage hands to rasterization: triangles in window coordinates, as columns."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class WindowPrimitives:
    """Triangles after transformation, lighting, clipping, projection, viewport and snapping.

    x, y           int32 [n], device window coordinates, 1/16 pixel, y down from the framebuffer's top row
    z              float64 [n], window depth in [0, 1]; a vertex program's, in depth-buffer units
    inverse_w      float64 [n], 1 / clip w, positive
    colors         uint8 [n, 2, 8]: front and back colour; red, green, blue, alpha of the primary colour, then
                   of the secondary; float64, not clamped, if the profile is exact
    coordinates    float64 [n, units, 4]: s, t, r, q of each texture unit, after generation and matrix
    fog            float64 [n]: fog coordinate
    triangles      int32 [k, 4]: three vertices in the order of docs/numbers.md and the provoking vertex
    dropped        primitives dropped because a position was not finite after projection, or w was 0
    two_side       whether back-facing triangles take the back colour
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

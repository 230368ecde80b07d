"""The drawing kernel's slope of w for many triangles in one call: for ``tests.emulators.kernels``."""

from functools import cache

import numpy as np
from numba import njit

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import Vertices
from fixedpipe.raster.portable.w_slope import w_slope


@cache
def _loop():
    """The kernel in a loop, compiled when it is first asked for."""

    @njit(error_model="numpy")
    def loop(draw, vertices, box, found):
        for k in range(len(box)):
            draw[R.X0], draw[R.Y0], draw[R.X1], draw[R.Y1] = box[k, 0], box[k, 1], box[k, 2], box[k, 3]
            found[k] = w_slope(draw, vertices, 3 * k, 3 * k + 1, 3 * k + 2)

    return loop


def slopes_of_w(x, y, w, box):
    """Float64 [n] of triangles: x, y int64 [n, 3], 1/16 pixel; w singles [n, 3]; box int64 [n, 4], pixels."""
    count = w.size
    colors, coordinates = np.zeros((count, 2, 8), np.uint8), np.zeros((count, 0, 4))
    corners = (np.ascontiguousarray(v, np.int32).ravel() for v in (x, y))
    z = np.ascontiguousarray(w, np.float64).ravel()
    vertices = Vertices(*corners, z, 1.0 / z, colors, coordinates)
    found = np.zeros(len(box))
    _loop()(np.zeros(R.DRAW_SIZE, np.int64), vertices, np.ascontiguousarray(box, np.int64), found)
    return found

"""Whether the numbers of a mesh's arrays can be drawn: a kernel for each array, as every new mesh asks."""

from functools import cache

import numpy as np


@cache
def _kernels():
    # Imported at the first mesh: who only names states and machines need not wait for Numba.
    from fixedpipe.raster.primitives import meshes

    return meshes


def are_finite(array):
    """Whether an array [n, c] of float64 or bool has finite numbers alone."""
    return array.dtype == np.bool_ or _kernels().all_finite(array)


def are_vertices(indices, count):
    """Whether int64 [k] are numbers of vertices, 0 to ``count - 1``."""
    return _kernels().all_below(indices, count)

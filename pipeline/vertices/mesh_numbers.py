"""Whether the numbers of a mesh's arrays can be drawn: a kernel for each array, as every new mesh asks."""

import numpy as np

from fixedpipe.raster.primitives.meshes import all_below, all_finite


def are_finite(array):
    """Whether an array [n, c] of float64 or bool has finite numbers alone."""
    return array.dtype == np.bool_ or all_finite(array)


def are_vertices(indices, count):
    """Whether int64 [k] are numbers of vertices, 0 to ``count - 1``."""
    return all_below(indices, count)

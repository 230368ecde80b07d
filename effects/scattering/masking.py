"""G36: bumps hide each other from the eye, although they are a bump map.

Either a coarse displacement hides them, and a bump map holds the rest. Or the bump map's texels are
redistributed by the viewing angle.

A bump map on a flat surface shows every texel, however low the eye is; real bumps hide their far sides. The
paper displaces a coarse mesh, which hides what large bumps hide, and leaves the rest to the bump map. Becker
and Max change the distribution of normals with the angle. Here texels move along lines of sight and keep
their order. Each takes a part of the line in proportion to its visible area over the mean plane, V (n.v)+ /
n_z.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 2; Becker, Max 1993 (the idea of the redistribution;
its form here is inferred). Assumed: 16 x 16 cells.
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.scattering.height_field import check_light, height_field
from fixedpipe.effects.scattering.visibility import free_view
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("G36", "masking: a coarse displacement, or texels redistributed by the angle of view", "2"),
)

CELLS = 16


def coarse(field, cells=CELLS):
    """The HeightField of the means of ``cells`` x ``cells`` squares of texels, for a mesh that is displaced;
    its albedo is the first texel's.

    Raises ValueError for cells that do not part the texels evenly, and for fewer than two.
    """
    rows, columns = field.heights.shape
    if cells < 2 or rows % cells or columns % cells:
        raise ValueError(
            f"{cells} cells along an edge do not part {columns} x {rows} texels evenly; give from 2 on a "
            "number that divides both."
        )
    squares = field.heights.reshape(cells, rows // cells, cells, columns // cells)
    # One texel of all squares after the other, so that the sums have one order.
    total = np.zeros((cells, cells))
    for j in range(rows // cells):
        for i in range(columns // cells):
            total += squares[:, j, :, i]
    return height_field(total * (cells * cells / (rows * columns)), field.albedo[0, 0])


def seen_share(field, view):
    """Each texel's share of a unit of the mean plane, as the eye sees it: V (n.v)+ / (n_z v_z).

    The result is float64 [rows, columns]; its mean is about one.

    view  direction towards the eye [3], above the horizon
    """
    view = check_light(view, "The direction to the eye")
    facing = np.maximum(dot(field.normals, view), 0.0) / (field.normals[..., 2] * view[2])
    return facing * free_view(field, view)


def redistributed(field, view):
    """Which texel is shown at each texel's place of a flat surface: int64 [rows, columns] of row * columns +
    column, in the order in which they lie along the line of sight.

    view  direction towards the eye (x, y, z), above the horizon, along s or along t: x or y is 0

    Raises ValueError for another direction. If no texel of a line is visible, its texels stay in place.
    """
    view = check_light(view, "The direction to the eye")
    if view[0] != 0.0 and view[1] != 0.0:
        raise ValueError(
            f"The direction to the eye is {tuple(view.tolist())}; give one along s or t, whose x or y is 0."
        )
    across = view[0] != 0.0
    share = seen_share(field, view)
    number = np.arange(share.size).reshape(share.shape)
    if across:
        share, number = share.T, number.T
    # From the first row on each texel ends where its sum does.
    ends = np.cumsum(share, axis=0)
    total = ends[-1]
    out = np.empty(share.shape, np.int64)
    count = len(share)
    for column in range(share.shape[1]):
        if total[column] > 0.0:
            places = (np.arange(count) + 0.5) / count * total[column]
            rows = np.searchsorted(ends[:, column], places, side="right")
        else:
            rows = np.arange(count)
        out[:, column] = number[np.minimum(rows, count - 1), column]
    return out.T if across else out

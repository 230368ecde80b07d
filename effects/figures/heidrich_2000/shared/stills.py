"""Pictures that software computed, on a machine's panels: a texel for each pixel, by a texture environment
that every machine has.
"""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import BACKGROUND
from fixedpipe.effects.passes.draws import NEAREST, REPLACE, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.state import PassState, VertexState
from fixedpipe.pipeline.textures.images import texture_2d


def still(picture, panel, name, profile):
    """Commands that show a picture, float64 [panel's height, width, 3], bottom row first, 1 = full."""
    texels = factor_texels(picture, profile)
    height, width = picture.shape[:2]
    columns, rows = (1 << (edge - 1).bit_length() for edge in (width, height))
    image = (texels[:1, :1] * texels.dtype.type(0)).repeat(rows, axis=0).repeat(columns, axis=1)
    image[:height, :width] = texels
    return (
        TexImage(label=f"load {name}", texture=name, image=texture_2d(image)),
        Draw(
            label=f"show {name}",
            mesh=plane().with_repeats(width / columns, height / rows).mesh(),
            state=PassState(
                vertex=VertexState(viewport=panel.viewport),
                texture_units=(unit(name, NEAREST, environment=REPLACE),),
            ),
        ),
    )


def enlarged(picture, size):
    """A picture [n, m, ...] at [size, size, ...] by its nearest pixels."""
    place = 2 * np.arange(size) + 1
    rows, columns = (place * edge // (2 * size) for edge in picture.shape[:2])
    return picture[rows][:, columns]


def gap(cell):
    """How many pixels of a cell's edge are left between pictures: a thirty-second, none in small cells."""
    return cell // 32


def mosaic(pictures, size):
    """Pictures [n, n, edge, edge, 3], the first row below, as one with gaps between: [size, size, 3]."""
    n = len(pictures)
    cell = size // n
    inner = cell - gap(cell)
    out = np.zeros((size, size, 3)) + np.array(BACKGROUND)
    for i in range(n):
        for j in range(n):
            rows, columns = (slice(k * cell, k * cell + inner) for k in (i, j))
            out[rows, columns] = enlarged(pictures[i, j], inner)
    return out


def as_computed(panel, pictures):
    """The share of a mosaic's pixels [size, size, 3] that equal ``pictures``, as for ``mosaic``, within
    2/255: the least of the pictures.
    """
    n = len(pictures)
    cell = panel.shape[0] // n
    inner = cell - gap(cell)
    return min(
        seen_places.alike(
            panel[i * cell : i * cell + inner, j * cell : j * cell + inner],
            seen_places.still(pictures[i, j], inner),
            2.0 / 255.0,
        )
        for i in range(n)
        for j in range(n)
    )


def cells(panel, n):
    """Back from a mosaic [size, size, 3]: its pictures, [n, n, inner, inner, 3]."""
    cell = panel.shape[0] // n
    inner = cell - gap(cell)
    parts = panel[: n * cell, : n * cell].reshape(n, cell, n, cell, 3)[:, :inner, :, :inner]
    return parts.transpose(0, 2, 1, 3, 4)

"""Images of vectors in the host's memory, and the pixel transfer that turns them into dot products.

The transfer is a colour matrix, then a colour table.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.pixel_transfer import PixelTransfer


@dataclass(frozen=True, eq=False)
class HostImage:
    """Vectors as the host stores them: ``values`` = v / (2 ``scale``) + 1/2, floats [rows, columns, 3] in [0,
    1], bottom row first.
    """

    values: np.ndarray
    scale: float

    @classmethod
    def of(cls, vectors, profile):
        """Single precision, what OpenGL's FLOAT is; the exact machine's host has double."""
        scale = float(np.abs(vectors).max())
        values = vectors / (2.0 * scale) + 0.5
        return cls(values if profile.arithmetic.exact else values.astype(np.float32), scale)


def dot_product_transfer(vector, scale, table, biased=True):
    """The pixel transfer that turns an image into a table's entries at dot products with ``vector``.

    ``scale``: the image's (HostImage). ``biased``: True: the colour matrix gives (1 + d)/2. False: it gives
    d, and negative results become zero.
    """
    x, y, z = (float(c) for c in vector)
    row = (2.0 * scale * x, 2.0 * scale * y, 2.0 * scale * z, -scale * ((x + y) + z))
    return PixelTransfer(
        color_matrix=(row,) * 4,
        post_color_matrix_scale=(0.5 if biased else 1.0,) * 4,
        post_color_matrix_bias=(0.5 if biased else 0.0,) * 4,
        post_color_matrix_color_table=table,
    )

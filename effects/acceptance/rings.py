"""The brightness of the rings at the rim of a dome (F004-2, K16, P11): vectors that are interpolated before
they are used make them.
"""

import numpy as np

from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.reflectance import brdfs

# The halfway vector of the catalogue's ring measurements: tilted 24 degrees towards +x.
RING_HALF = normalize(np.array([0.45, 0.0, 1.0]))


def ring_energy(image, map_size, alpha_x, alpha_y):
    """Error energy in the annulus 1.5 texels wide on either side of the rim, over the true highlight's
    energy.

    ``image``: float64 [size, size] of one dome, bottom row first. Returns the ratio, and the image's maximum
    where the true highlight in the annulus is zero.
    """
    size = image.shape[0]
    s, t = height_fields.texel_centers(size, size)
    _, tangent, binormal = height_fields.frames(*height_fields.dome_slopes(s, t))
    true = brdfs.anisotropic_blinn_phong(RING_HALF, tangent, binormal, alpha_x, alpha_y)
    x, y = pixel_grid(size, 1.0)
    annulus = np.abs(np.sqrt(x * x + y * y) - 0.6) < 3.0 / map_size
    error = (image - true)[annulus]
    dark = annulus & (true == 0.0)
    return float((error * error).sum() / (true * true).sum()), float(image[dark].max())

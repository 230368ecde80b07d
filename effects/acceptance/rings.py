"""The rings at the rim of a dome (F004-2, K16, P11): they arise when vectors are interpolated before use."""

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


# An azimuth in sectors, and what a pixel must be brighter by to be seen as one of a ring.
_SECTORS, _SEEN = 36, 0.2


def rings_round_rims(excess, radii, extent, map_size):
    """How far a ring surrounds each dome. The result is the share of 36 sectors of azimuth in which a pixel
    within 1.5 texels of the rim is brighter by more than 0.2.

    excess  float64 [size, size], bottom row first: the picture less one that has no rings
    radii   float64 [domes, domes], the rims' radii in half distances of two domes, bottom row first
    extent  of the square that the domes stand on, over the picture's

    Returns float64 like ``radii``, in [0, 1].
    """
    domes = len(radii)
    x, y = pixel_grid(len(excess), extent)
    s, t = (x + 1.0) * 0.5 * domes, (y + 1.0) * 0.5 * domes
    u, v = (2.0 * (c - np.floor(c)) - 1.0 for c in (s, t))
    sector = np.floor((np.arctan2(v, u) / (2.0 * np.pi)) % 1.0 * _SECTORS)
    shares = np.empty(radii.shape)
    for j, i in np.ndindex(*radii.shape):
        own = (np.floor(s) == i) & (np.floor(t) == j)
        near = own & (np.abs(np.sqrt(u * u + v * v) - radii[j, i]) < 3.0 * domes / map_size)
        shares[j, i] = len(np.unique(sector[near & (excess > _SEEN)])) / _SECTORS
    return shares

"""Fresnel's reflectance of unpolarized light at a smooth surface with a real index of refraction.

The module uses additions, products, quotients and a square root alone, in a fixed order. So its bits are the
same on every computer.

Source: Heidrich 2001, sections 1.1 and 1.5, in the form of the catalogue. A metal's index is complex. The
paper draws metal with a real index of 200, and so does the project.
"""

import numpy as np


def fresnel(cosine, index):
    """The reflectance F in [0, 1], float64 of the shape that both arguments have together.

    cosine  of the angle between the surface's normal, or the half vector, and the light: from 0 to 1
    index   of refraction, inside over outside, above 0. Below 1 it reflects everything beyond the critical
            angle.

    Raises ValueError for other indices; a cosine outside [0, 1] is clamped to it.
    """
    c = np.clip(np.asarray(cosine, np.float64), 0.0, 1.0)
    index = np.asarray(index, np.float64)
    if not (np.isfinite(index) & (index > 0.0)).all():
        raise ValueError(f"The index of refraction is {index!s}; give numbers above 0, as 1.5 for glass.")
    square = index * index - 1.0 + c * c
    g = np.sqrt(np.maximum(square, 0.0))
    # Where both are zero nothing is refracted, the index being one: the quotient is taken as none.
    together = g + c
    apart = np.where(together > 0.0, (g - c) / np.where(together > 0.0, together, 1.0), 0.0)
    turned = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    reflected = 0.5 * (apart * apart) * (1.0 + turned * turned)
    return np.where(square < 0.0, 1.0, reflected)

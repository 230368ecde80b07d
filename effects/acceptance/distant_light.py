"""The light of a distant lamp on what is seen from +z, in float64. Nothing is shared with what draws."""

import numpy as np

from fixedpipe.effects.acceptance.seen_places import unit

# The viewer is far away in front of the picture.
_EYE = np.array([0.0, 0.0, 1.0])


def shone(normals, values):
    """The displayed colours of unit normals [n, 3]: float64 [n, 3].

    ``values``: a figure's own, with light, color, ambient, specular and exponent.
    """
    toward = unit(np.array(values["light"], np.float64))
    half = unit(toward + _EYE)
    cosine = np.maximum(normals @ toward, 0.0)
    # No highlight where the surface turns away from the light.
    shine = np.maximum(normals @ half, 0.0) ** values["exponent"] * np.minimum(1.0, 8.0 * cosine)
    out = np.array(values["ambient"]) + cosine[:, None] * np.array(values["color"])
    return np.clip(out + values["specular"] * shine[:, None], 0.0, 1.0)

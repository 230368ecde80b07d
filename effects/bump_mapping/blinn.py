"""H41 and H42: Blinn's bump mapping in float64, and the map of normals that it gives.

H41. Heights are a function of the surface's parameters. At every given point, their derivatives d_u and d_v
are differences of the heights a texel to either side, interpolated between texels. The normal is that of the
surface that the heights displace (``tangent_space.displaced_normals``). There is no table of normals, and no
vector is interpolated. This is the reference for the machines' passes.

H42. A texture holds the same normals at the texels' centres. A pass that reads it interpolates normals, where
H41 interpolates heights.

Source: Blinn 1978; Heidrich 2001, section 3; pass sequence A-H41. Assumed: the differences' step is a texel,
so both agree at the texels' centres.
"""

import numpy as np

from fixedpipe.effects.bump_mapping import tangent_space
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("H41", "Blinn's bump mapping: derivatives of heights at every point, in float", "3"),
    Technique("H42", "normals that are computed once and stored in a texture", "3"),
)


def interpolated(heights, s, t):
    """Heights between the texels of a periodic field [rows, columns], at coordinates float64 [...]."""
    rows, columns = heights.shape
    x, y = s * columns - 0.5, t * rows - 0.5
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    f, g = x - i, y - j
    low = heights[j % rows, i % columns] * (1.0 - f) + heights[j % rows, (i + 1) % columns] * f
    high = heights[(j + 1) % rows, i % columns] * (1.0 - f) + heights[(j + 1) % rows, (i + 1) % columns] * f
    return low * (1.0 - g) + high * g


def derivatives(heights, s, t):
    """(d_u, d_v) at texture coordinates [...]: differences of the heights a texel to either side, in edges of
    the field. Raises ValueError for heights that are no finite [rows, columns].
    """
    heights = height_fields.numbers(heights)
    s, t = np.asarray(s, np.float64), np.asarray(t, np.float64)
    rows, columns = heights.shape
    u, v = 1.0 / columns, 1.0 / rows
    along_u = interpolated(heights, s + u, t) - interpolated(heights, s - u, t)
    along_v = interpolated(heights, s, t + v) - interpolated(heights, s, t - v)
    return along_u * (columns / 2.0), along_v * (rows / 2.0)


def normals(heights, s, t, along_u=(1.0, 0.0, 0.0), along_v=(0.0, 1.0, 0.0)):
    """H41: the normals of the displaced surface at texture coordinates [...], float64 [..., 3].

    heights           float64 [rows, columns], periodic, bottom row first, in edges of the field
    along_u, along_v  [..., 3], the vectors on the surface for a step of one along u and v. In tangent space,
                      where the surface's own lengths are the heights' unit, they are the two axes
    """
    return tangent_space.displaced_normals(along_u, along_v, *derivatives(heights, s, t))


def normal_map(heights):
    """H42: the normals at the texels' centres in tangent space, float64 [rows, columns, 3]."""
    heights = height_fields.numbers(heights)
    return normals(heights, *height_fields.texel_centers(heights.shape[1], heights.shape[0]))


def integer_power(base, exponent):
    """base ** exponent by squaring, so that it has the same bits everywhere. Raises ValueError where the
    exponent is no whole number from 1 on.
    """
    if exponent != int(exponent) or exponent < 1:
        raise ValueError(f"The exponent is {exponent!r}; give a whole number from 1 on.")
    exponent, out = int(exponent), None
    while exponent:
        if exponent & 1:
            out = base if out is None else out * base
        exponent >>= 1
        base = base * base
    return out


def self_shadow(light):
    """min(1, 8 (l_z)+) of unit light vectors [..., 3] in tangent space: nothing is lit where the smooth
    surface faces away from the light, and the light fades within seven degrees of there (A-H43).
    """
    return np.clip(8.0 * np.asarray(light, np.float64)[..., 2], 0.0, 1.0)


def radiance(normal, light, half, albedo, *, color, ambient, specular, exponent):
    """What a bumped point sends to the viewer: RGB [..., 3], not clamped.

    normal, light, half  unit vectors [..., 3] in tangent space
    albedo               RGB [..., 3], by which diffuse and ambient light are multiplied
    color, ambient       RGB; ``specular``: k_s of the white highlight, whose ``exponent`` is whole
    """
    shadow = self_shadow(light)[..., None]
    lit = np.maximum(dot(normal, light), 0.0)[..., None] * shadow
    shine = integer_power(np.maximum(dot(normal, half), 0.0), exponent)[..., None] * shadow
    return np.asarray(albedo) * (np.asarray(color) * lit + np.asarray(ambient)) + specular * shine

"""Z01 and Z02: normals from a displacement map by central differences, and their encoding as RGB.

Z01. The document differentiates the surface [d(u, v), u, v], the height first:

    n = [d(u+du, v) - d(u-du, v), 2 du, 0]/(2 du) x [d(u, v+dv) - d(u, v-dv), 0, 2 dv]/(2 dv)
      = (1, -d_u, -d_v)

and makes its length one. So the component along the surface's normal comes *first*, while the rendering's [t
b n] expects it last. ``tangent_space_order`` is the step between, (-d_u, -d_v, 1), which the document does
not print (erratum E003.1). Without it every normal lies in the surface.

Z02. A component x in [-1, 1] is the byte round((x + 1)/2 * 255), and is read back as 2 byte/255 - 1. Zero is
half way between two bytes and becomes 128. So a flat texel is (128, 128, 255) and is read as (1/255, 1/255,
1): it leans .318 degrees (P30). The combiners' EXPAND_NORMAL reads 128 as zero, without such a lean;
``fixedpipe.effects.passes.encoding`` stores vectors for them.

Source: Zwicker 2016, "Generating bump maps" and "Storing bump maps"; pass sequence A-Z01/Z02 of the
catalogue.
"""

import numpy as np

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import cross, normalize
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.textures.pixels import unit_numbers

TECHNIQUES = (
    Technique("Z01", "normals of a height field by central differences", "Generating bump maps"),
    Technique("Z02", "normals stored as colours: [-1, 1] in bytes", "Storing bump maps"),
)


def differences(heights, du=1.0, dv=1.0, periodic=True):
    """(d_u, d_v): central differences of a displacement map, float64 [rows, columns] each.

    heights   [rows, columns], bottom row first, in the unit of ``du`` and ``dv``, which are the distances
              between texels
    periodic  whether the map repeats; else it goes on level beyond its edges
    """
    rows, columns = np.shape(heights)
    along_u, along_v = height_fields.slopes(heights, periodic)
    return along_u / (columns * du), along_v / (rows * dv)


def height_first_normals(heights, du=1.0, dv=1.0, periodic=True):
    """The document's normals, by the cross product as printed: float64 [rows, columns, 3] of length one, in
    the order height, u, v, bottom row first. Arguments as for ``differences``.
    """
    d_u, d_v = differences(heights, du, dv, periodic)
    one, zero = np.ones(d_u.shape), np.zeros(d_u.shape)
    along_u, along_v = np.stack([d_u, one, zero], axis=-1), np.stack([d_v, zero, one], axis=-1)
    return normalize(cross(along_u, along_v))


def tangent_space_order(normals):
    """Normals [..., 3] in the order u, v, height, as [t b n] takes them, from height, u, v (E003.1)."""
    return np.roll(normals, -1, axis=-1)


def normals(heights, du=1.0, dv=1.0, periodic=True):
    """Normals in tangent space, (-d_u, -d_v, 1) of length one: float64 [rows, columns, 3], bottom row
    first.
    """
    return tangent_space_order(height_first_normals(heights, du, dv, periodic))


def encode(vectors):
    """Components in [-1, 1] as bytes: round((x + 1)/2 * 255), a half upwards; uint8 of the same shape."""
    scaled = (unit_numbers(vectors, "The array of vectors") + 1.0) / 2.0 * 255.0
    return np.clip(np.floor(scaled + 0.5), 0, 255).astype(np.uint8)


def decode(stored):
    """Bytes as components in [-1, 1], as a fragment program reads them: 2 byte/255 - 1."""
    return 2.0 * (np.asarray(stored, np.float64) / 255.0) - 1.0

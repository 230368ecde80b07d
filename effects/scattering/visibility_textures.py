"""S_i as textures: for every texel the texture coordinates of the texel that it sees, in few bits.

A coordinate of b bits is c / (2^b - 1). A texel i of T is stored as the code nearest to its centre, and read
back, NEAREST, as floor(c T / (2^b - 1)). The result is i for every i if T <= 2^(b-1). If T = 2^b the last
texel has no code of its own: 2^b - 1 is the coordinate 1, which REPEAT takes to texel 0 and CLAMP_TO_EDGE to
the last (P12).

"None is seen" is the coordinate 1, beyond the field. The texture that is looked up (L_d) is at least one
texel wider and higher than the field. Beyond the field it holds black, or the environment's radiance along
d_i (G30). So all codes are read back without error, and a field has at most 2^b - 1 texels along an edge.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3 (two components a texel). Assumed: the code for
"none"; the paper does not say it.
"""

import numpy as np

from fixedpipe.effects.technique import Variant

TECHNIQUES = (Variant(("G01",), "as textures of texture coordinates, of 8, 12 or 16 bits"),)


def codes(texels, size, bits=8):
    """Codes of texels [...] along an axis of ``size`` texels: int64 [...], 0 to 2^bits - 1."""
    one = (1 << bits) - 1
    return np.floor(one * (np.asarray(texels) + 0.5) / size + 0.5).astype(np.int64)


def decoded(stored, size, bits=8):
    """The texels that codes lead to, NEAREST and CLAMP_TO_EDGE: int64 [...]."""
    one = (1 << bits) - 1
    return np.minimum(np.asarray(stored, np.int64) * size // one, size - 1)


def looked_up_size(texels, bits=8):
    """The edge of the texture in which a field's edge of so many texels is looked up, with room for "none".

    Raises ValueError if coordinates of ``bits`` cannot distinguish its texels.
    """
    size = 1 << texels.bit_length()
    if size > 1 << bits:
        raise ValueError(
            f"Coordinates of {bits} bits tell {1 << bits} texels apart, and a field of {texels} with a place "
            f"for 'none' takes {size}: give a field of at most {(1 << bits) - 1} texels along each edge, or "
            "more bits."
        )
    return size


def coordinates(seen, bits=8):
    """S_i as codes of s and t, int64 [rows, columns, 2] of 0 to 2^bits - 1.

    seen  int [rows, columns]: ``Visibility.seen`` for one direction

    Raises ValueError as ``looked_up_size``.
    """
    rows, columns = seen.shape
    out = np.empty((rows, columns, 2), np.int64)
    for k, (texels, position) in enumerate(((columns, seen % columns), (rows, seen // columns))):
        size = looked_up_size(texels, bits)
        out[..., k] = np.where(seen < 0, (1 << bits) - 1, codes(position, size, bits))
    return out


def padded(light, nothing=0, bits=8):
    """The texture in which a field's light [rows, columns, k] is looked up, with ``nothing`` for texels that
    see none: [size, size', k] of the same type.
    """
    rows, columns = light.shape[:2]
    shape = (looked_up_size(rows, bits), looked_up_size(columns, bits), light.shape[2])
    out = np.empty(shape, light.dtype)
    out[...] = nothing
    out[:rows, :columns] = light
    return out


def texels_seen(stored, rows, columns, bits=8):
    """Back from codes: int64 [rows, columns] of row * columns + column, -1 where none is seen."""
    column = decoded(stored[..., 0], looked_up_size(columns, bits), bits)
    row = decoded(stored[..., 1], looked_up_size(rows, bits), bits)
    return np.where((column >= columns) | (row >= rows), -1, row * columns + column)

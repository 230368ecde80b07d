"""What of a mesh's arrays reaches fragments as it is: bytes of colours, texture coordinates of units."""

import math

from numba import int64

from fixedpipe.raster.kernel import bits_of, float_of, kernel


@kernel("b1(Array(float64,2,'C',readonly=True),Array(float64,2,'C',readonly=True),i8,u1[:,:,::1])")
def color_bytes(colors, secondary, mask, out):
    """Bytes of all vertices' colours, clamped to [0, 1] (docs/numbers.md, section 2).

    colors, secondary  float64[n, 0..4]; what is not there is 1 of a colour, 0 of a secondary one
    mask               of the bits of a float64 that are kept
    out                uint8[n, 2, 8]: front and back, which are the same; colour, then secondary colour

    Returns whether all vertices have the same.
    """
    same = True
    for i in range(out.shape[0]):
        for k in range(8):
            value = 1.0 if k < 4 else 0.0
            if k < colors.shape[1]:
                value = colors[i, k]
            if 0 <= k - 4 < secondary.shape[1]:
                value = secondary[i, k - 4]
            value = min(value if value > 0.0 else 0.0, 1.0)
            kept = float_of(bits_of(value) & mask)
            out[i, 0, k] = out[i, 1, k] = int64(math.floor(kept * 255.0 + 0.5))
            same &= out[i, 0, k] == out[0, 0, k]
    return same


@kernel("b1(Array(float64,2,'C',readonly=True),i8,f8[:,:,::1])")
def unit_coordinates(given, unit, out):
    """A unit's s, t, r, q for all vertices from a texture coordinate set: what it lacks is 0, 0, 0 and 1.

    given  float64[n, 0..4]
    out    float64[n, units, 4]

    Returns whether some q is not 1.
    """
    projective = False
    for i in range(out.shape[0]):
        for k in range(4):
            out[i, unit, k] = given[i, k] if k < given.shape[1] else (1.0 if k == 3 else 0.0)
        projective |= out[i, unit, 3] != 1.0
    return projective

"""Kernels over a mesh's own arrays: whether they are usable, and what reaches fragments as it is."""

import math

from numba import int32, int64, types

from fixedpipe.raster.kernel import bits_of, float_of, kernel


@kernel("b1(Array(float64,2,'C',readonly=True))")
def all_finite(numbers):
    """Whether all numbers are finite."""
    finite = True
    for i in range(numbers.shape[0]):
        for k in range(numbers.shape[1]):
            finite &= math.isfinite(numbers[i, k])
    return finite


@kernel("b1(Array(int64,1,'C',readonly=True),i8)")
def all_below(indices, count):
    """Whether all numbers are from 0 to ``count - 1``."""
    below = True
    for i in range(indices.shape[0]):
        below &= (indices[i] >= 0) & (indices[i] < count)
    return below


@kernel("void(Array(int64,1,'C',readonly=True),i8,i4[:,::1])")
def separate_triangles(stream, provoking, out):
    """Rows of TRIANGLES: three vertices of ``stream`` each, then the one of these (0 to 2) that provokes.

    ``out``: int32[k, 4]; ``stream`` has at least 3 k vertices.
    """
    for t in range(out.shape[0]):
        for k in range(3):
            out[t, k] = int32(stream[3 * t + k])
        out[t, 3] = int32(stream[3 * t + provoking])


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


_SETS = types.UniTuple(types.Array(types.float64, 2, "C", readonly=True), 4)


@kernel(int64(_SETS, types.float64[:, :, ::1]))
def unit_coordinates(sets, out):
    """The units' s, t, r, q for all vertices from a texture coordinate set each.

    sets  float64[n, 0..4], of each unit; what a set lacks is 0, 0, 0 and 1
    out   float64[n, units, 4], up to four units

    Returns bits: 1 << u for a unit some of whose q are not 1.
    """
    projective = int64(0)
    for u in range(out.shape[1]):
        given, varies = sets[u], False
        for i in range(out.shape[0]):
            for k in range(4):
                out[i, u, k] = given[i, k] if k < given.shape[1] else (1.0 if k == 3 else 0.0)
            varies |= out[i, u, 3] != 1.0
        projective |= int64(1) << u if varies else int64(0)
    return projective

"""Colour weights of runs, as integers, where colours are all that weights are needed for."""

from numba import float64, int32, int64, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import THREE
from fixedpipe.raster.fixed import reciprocal_24
from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.vector.interpolate import are_exact, area_weights, weights_of
from fixedpipe.raster.vector.lanes import (
    any_lane,
    f64x16,
    floored,
    load_f64x16,
    ramp_f64x16,
    store,
    to_int32,
)

LARGEST_AREA = 2.0**29  # an edge function times 24 bits is then exact
STEEPEST = 2.0**-4  # of a weight, from pixel to pixel: sixteen lanes then differ by less than one
_ONE = 2.0**30  # units of a weight
_PER_STEP = 22  # log2 of the units in 1/256
_FRACTION = (1 << _PER_STEP) - 1
NEAR = 1 << 11  # 2**-19


@kernel(void(int32[:, ::1], int64, int64, THREE, THREE))
def run_color_weights(ints, position, count, n, right):
    """W0 and W2 of ``count`` pixels to the right of the one whose edge functions are ``n``; no perspective.

    They are floor(256 q) of the weights of ``interpolate.run_weights``. With rD the reciprocal of the area in
    24 bits, x = n rD is exact where the area is not above LARGEST_AREA. So is what a step along the run adds.
    The two floors, of the first lane's x and of what the other lanes add, lie less than two units of 2**-30
    below x.

    A weight differs from x by less than 2**-20. Cutting to 24 bits changes an edge function by 2**-23 of it,
    their sum by 2**-21, and a weight by 2**-24; the reciprocal errs by 2**-22; and a weight that is what two
    others leave of one errs by as much as those. So floor(256 q) is that of x unless a step of 1/256 lies
    within NEAR. Where edge functions ``are_exact``, only a weight that two others leave may lie below x, and
    only if the area times its reciprocal is above one. If one of sixteen pixels lies that near, all sixteen
    are computed as in ``run_weights``.
    """
    separate_loop()
    (n0, n1, n2), (right0, right1, right2) = n, right
    out0, out2 = ints[R.W0], ints[R.W2]
    area = (n0 + n1) + n2
    reciprocal = reciprocal_24(area)
    steps = area <= LARGEST_AREA and max(abs(right0), abs(right2)) * reciprocal <= STEEPEST
    scale = reciprocal * _ONE if steps else 0.0
    exact = are_exact(n, right, area)
    beyond = int32(0 if exact and area * reciprocal <= 1.0 else NEAR)
    ramp = ramp_f64x16()
    along0, along2 = to_int32(floored(ramp * (right0 * scale))), to_int32(floored(ramp * (right2 * scale)))
    first0, first2 = n0 * scale, n2 * scale
    for i in range(0, count, 16):
        ahead = float64(i)
        u0 = along0 + int32(first0 + ahead * (right0 * scale))
        u2 = along2 + int32(first2 + ahead * (right2 * scale))
        above0, above2 = (u0 + int32(NEAR)) & int32(_FRACTION), (u2 + int32(NEAR)) & int32(_FRACTION)
        near = (above0 < int32(NEAR) + beyond) | (above2 < int32(NEAR) + beyond)
        if steps and not any_lane(near):
            store(out0, position + i, u0 >> int32(_PER_STEP))
            store(out2, position + i, u2 >> int32(_PER_STEP))
            continue
        a0, a1 = ramp * right0 + (n0 + ahead * right0), ramp * right1 + (n1 + ahead * right1)
        a2 = ramp * right2 + (n2 + ahead * right2)
        if exact:
            w0, w2 = area_weights(a0, a1, a2, f64x16(reciprocal))
        else:
            w0, w2 = weights_of(a0, a1, a2, 1.0, 1.0, 1.0)
        store(out0, position + i, to_int32(w0 * 256.0))
        store(out2, position + i, to_int32(w2 * 256.0))


@kernel(void(float64[:, ::1], int32[:, ::1], int64, int64))
def whole_weights(floats, ints, position, count):
    """W0 and W2 of a triangle's fragments, from Q0 and Q2."""
    separate_loop()
    for i in range(position, position + count, 16):
        store(ints[R.W0], i, to_int32(load_f64x16(floats[R.Q0], i) * 256.0))
        store(ints[R.W2], i, to_int32(load_f64x16(floats[R.Q2], i) * 256.0))

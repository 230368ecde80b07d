"""Projective texture coordinates by vectors: s, t and r over q, as ``fixed.projected`` makes them.

The usual shadow map takes float32 that the processor cuts (``rounding``). Its columns hold what
``coordinates.iterate_floats`` makes: 0, or 24 bits of 2**-123..2**100 by magnitude.
"""

from numba import boolean, float32, float64, int32, int64, types, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import THREE
from fixedpipe.raster.floats import LEAST_Q
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.interpolate import keep_24, reciprocals_24
from fixedpipe.raster.vector.lanes import (
    absolute,
    all_lanes,
    bits_of_singles,
    f64x16,
    floored,
    i32x16,
    load_f32x16,
    load_f64x16,
    maximum,
    minimum,
    narrow_f32,
    select,
    singles_of_bits,
    store,
    to_int32,
)
from fixedpipe.raster.vector.rounding import can_cut, toward_zero
from fixedpipe.raster.vector.singles import exponent, reciprocals

COLUMNS, FIXED = types.UniTuple(float64[::1], 4), types.UniTuple(int32[::1], 3)
_ONE, _PLACES = 127, 23  # exponent field of 1, and where it is
_FRACTION = (1 << _PLACES) - 1
_FARTHEST = 60  # log2 of a q, and of its reciprocal, that float32 takes


@kernel
def signed_reciprocals(q):
    """``fixed.signed_reciprocal`` of q, or of LEAST_Q where it is zero."""
    q = select(q != 0.0, q, f64x16(LEAST_Q))
    return select(q >= 0.0, f64x16(1.0), f64x16(-1.0)) * reciprocals_24(absolute(q))


@kernel("void(f8[::1],i8)")
def reciprocals_of_q(q, count):
    """What ``fixed.projected`` multiplies with, in the column of q."""
    separate_function()
    for at in range(0, count, 16):
        store(q, at, signed_reciprocals(load_f64x16(q, at)))


@kernel("void(f8[::1],f8[::1],i8)")
def multiply(column, factor, count):
    """A column's products with another's, cut to 24 bits."""
    separate_function()
    for at in range(0, count, 16):
        store(column, at, keep_24(load_f64x16(column, at) * load_f64x16(factor, at)))


@kernel
def single_reciprocals(q):
    """``signed_reciprocals`` of float32 lanes whose exponents are within _FARTHEST of 0, toward zero."""
    bits = bits_of_singles(q)
    mantissa = singles_of_bits((bits & int32(_FRACTION)) | int32((_ONE + 24) << _PLACES))
    power = int32((2 * _ONE + 24) << _PLACES) - (bits & int32(0xFF << _PLACES))
    sign = bits & int32(-(1 << 31))
    return singles_of_bits(bits_of_singles(reciprocals(mantissa) * singles_of_bits(power)) | sign)


@kernel(inlined=True)
def limited_floor(value, low, high):
    """The floor of lanes, limited to two integers: what lies below zero becomes ``low``, which does not."""
    return to_int32(minimum(maximum(value, low), high))


@kernel(boolean(float32[:, ::1], FIXED, THREE, float64, int64))
def cut_fixed(singles, out, sizes, largest, count):
    """The leaf of ``fixed_toward_zero``: whether q's exponents let it be float32.

    A product cut to 24 bits never falls below a whole number up to 2**24 that the exact one reaches, so the
    floor of a product with a size is the exact product's.
    """
    separate_loop()
    (f_s, f_t, words), (width, height, scale) = out, sizes
    s, t = singles[R.SINGLE_COORDINATE], singles[R.SINGLE_COORDINATE + 1]
    r, q = singles[R.SINGLE_COORDINATE + 2], singles[R.SINGLE_COORDINATE + 3]
    of_s, of_t, of_r = float32(256.0 * width), float32(256.0 * height), float32(scale)
    half, last_s, last_t = float32(128.0), of_s - float32(128.0), of_t - float32(128.0)
    least, most = int32((_ONE - _FARTHEST) << _PLACES), int32((_ONE + _FARTHEST) << _PLACES)
    inside = i32x16(int32(-1))
    for at in range(0, count, 16):
        divisor = load_f32x16(q, at)
        near = exponent(divisor)
        inside = select((near >= least) & (near <= most), inside, i32x16(int32(0)))
        inverse = single_reciprocals(divisor)
        x, y, z = load_f32x16(s, at) * inverse, load_f32x16(t, at) * inverse, load_f32x16(r, at) * inverse
        store(f_s, at, limited_floor(x * of_s, half, last_s))
        store(f_t, at, limited_floor(y * of_t, half, last_t))
        store(words, at, limited_floor(z * of_r, float32(0.0), float32(largest)))
    return all_lanes(inside != int32(0))


@kernel(boolean(float32[:, ::1], FIXED, THREE, float64, int64))
def fixed_toward_zero(singles, out, sizes, largest, count):
    """``cut_fixed``, rounding toward zero."""
    separate_function()
    return toward_zero(cut_fixed, (singles, out, sizes, largest, count))


@kernel
def fixed_from_singles(singles, out, sizes, largest, count):
    """``fixed_from_projected`` of s, t, r and q in SINGLE_COORDINATE and behind it; False where it must be
    made there.
    """
    return can_cut() and fixed_toward_zero(singles, out, sizes, largest, count)


@kernel("void(f8[::1],f4[::1],i8)")
def narrow_column(column, single, count):
    """A column of 24 bits as float32."""
    separate_loop()
    for at in range(0, count, 16):
        store(single, at, narrow_f32(load_f64x16(column, at)))


@kernel(void(COLUMNS, float32[:, ::1], FIXED, THREE, float64, int64))
def fixed_from_projected(coordinates, singles, out, sizes, largest, count):
    """F of s/q and t/q for a linear filter with CLAMP_TO_EDGE, and the fixed depth words of r/q: what
    ``multiply`` with ``coordinates.fixed_from_floats`` and ``depth_words`` make.

    ``coordinates``: s, t, r, q; ``sizes``: the texture's width and height, up to 4096, and what r/q is
    multiplied with, of 24 bits, as the ``largest`` word is.
    """
    separate_function()
    (s, t, r, q), (f_s, f_t, words), (width, height, scale) = coordinates, out, sizes
    narrow_column(s, singles[R.SINGLE_COORDINATE], count)
    narrow_column(t, singles[R.SINGLE_COORDINATE + 1], count)
    narrow_column(r, singles[R.SINGLE_COORDINATE + 2], count)
    narrow_column(q, singles[R.SINGLE_COORDINATE + 3], count)
    if fixed_from_singles(singles, out, sizes, largest, count):
        return
    for at in range(0, count, 16):
        inverse = signed_reciprocals(load_f64x16(q, at))
        x, y = keep_24(load_f64x16(s, at) * inverse), keep_24(load_f64x16(t, at) * inverse)
        z = keep_24(load_f64x16(r, at) * inverse)
        store(f_s, at, limited_floor(floored(x * (256.0 * width)), 128.0, 256.0 * width - 128.0))
        store(f_t, at, limited_floor(floored(y * (256.0 * height)), 128.0, 256.0 * height - 128.0))
        store(words, at, limited_floor(z * scale, 0.0, largest))

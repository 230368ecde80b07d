"""Weights of runs and what is iterated with them, in float32 that the processor cuts (``rounding``): the
values of ``interpolate.run_weights`` and ``interpolate.terms_of``, where 24 significant bits are all
that an operation keeps.

A float32 has 24 significant bits, so rounding toward zero is the rule's own cut: there are no masks, and
twice as many lanes as with float64. Loops are short, over up to BLOCK fragments whose columns stay in the
nearest memory: a chain from edge functions to weights has some hundred cycles, and the processor overlaps the
iterations of a short loop.
"""

from numba import boolean, float32, float64, int32, int64, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import THREE
from fixedpipe.raster.fixed import power_below, reciprocal_24, truncate_24
from fixedpipe.raster.floats import LARGEST_SINGLE, LEAST_SINGLE
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.interpolate import are_exact
from fixedpipe.raster.vector.lanes import (
    all_lanes,
    any_lane,
    bits_of_singles,
    f32x16,
    fused,
    i32x16,
    load_f32x16,
    load_f64x16,
    maximum,
    minimum,
    narrow_f32,
    ramp_f64x16,
    ramp_i32x16,
    select,
    singles_of_bits,
    store,
    to_float32,
    to_int32,
)
from fixedpipe.raster.vector.rounding import can_cut, toward_zero

LARGEST_INT32 = 2.0**31  # of areas: edge functions below are int32
LARGEST_RATIO = 2.0**60  # of factors: with areas below 2**53 no weight is then below 2**-117 and not zero
LARGEST_DIFFERENCE = 2.0**97  # of coordinates: less than EXACT_FROM's exponent field
BLOCK = 256  # fragments
_ONE, _PLACES = 127, 23  # exponent field of 1, and where it is
_EXPONENT = 0xFF << _PLACES
_EXACT_FROM = (_ONE - 30) << _PLACES  # EXACT_FROM's exponent field


@kernel
def exponent(value):
    """The exponent field of each lane, in its place."""
    return bits_of_singles(value) & int32(_EXPONENT)


@kernel
def times_power(value, power):
    """Lanes times 2**power, exactly."""
    return value * singles_of_bits(i32x16(int32((_ONE + power) << _PLACES)))


# ------------------------------------------------------------------------------------------------- weights


@kernel
def near_reciprocals(total):
    """(x, what of 1 is not total x) for sums in 2**24..2**27: x has twelve bits of the reciprocal of the
    sum's first fifteen, as in ``fixed.reciprocal_24``.

    A quotient cut to 24 bits never falls below a number of 22 bits that the exact one reaches, so it is
    rounded to twelve as the exact one is. The rest is exact: it is below 2**-11, and no bit of it is below
    2**-35, the last of a product of 24 and 12 bits.
    """
    near = singles_of_bits((bits_of_singles(total) + int32(1 << 8)) & int32(-(1 << 9)))
    x = singles_of_bits((bits_of_singles(1.0 / near) + int32((1 << 11) + (1 << 3))) & int32(-(1 << 12)))
    return x, fused(total * -1.0, x, f32x16(float32(1.0)))


@kernel
def reciprocals(total):
    """``fixed.reciprocal_24`` of each lane, all of them in 2**24..2**27.

    The rest is rounded to 2**-24, halves toward zero. Beside 3/4 that is the last bit of a sum, which is cut:
    so half of it is added first, and to what is positive a little less.
    """
    x, rest = near_reciprocals(total)
    half = select(rest < 0.0, f32x16(float32(2.0**-25)), f32x16(float32(2.0**-25 - 2.0**-36)))
    nearest = ((rest + half) + 0.75) - 0.75
    return fused(x, nearest, x)


@kernel
def rest_of(a, b):
    """``interpolate.rest_of``: the difference is an int32, which its conversion cuts."""
    left = (int32(1 << 25) - to_int32(times_power(a, 25))) - to_int32(times_power(b, 25))
    return times_power(to_float32(left), -25)


@kernel
def weight_class(q):
    """``interpolate.weight_class``, as exponent fields."""
    return minimum(maximum(exponent(q), int32((_ONE - 3) << _PLACES)), int32((_ONE - 1) << _PLACES))


@kernel
def rest_to_largest(q0, q1, q2):
    """``interpolate.rest_to_largest``."""
    if all_lanes(q1 > 0.5):
        return q0, q2
    if all_lanes(q0 > 0.5):
        return rest_of(q1, q2), q2
    if all_lanes(q2 > 0.5):
        return q0, rest_of(q0, q1)
    c0, c1, c2 = weight_class(q0), weight_class(q1), weight_class(q2)
    first = (c0 >= c1) & (c0 > c2)
    last = (c2 >= c0) & ((c2 > c1) | ((c2 == c1) & (c0 == c1)))
    return select(first, rest_of(q1, q2), q0), select(last, rest_of(q0, q1), q2)


@kernel(inlined=True)
def store_parts(singles, i, e0, e1, e2):
    """Sixteen fragments' terms of N4.10, in units of their sum, and the sum, at ``i`` of a block."""
    most = maximum(maximum(exponent(e0), exponent(e1)), exponent(e2))
    units = singles_of_bits(int32((2 * _ONE + 24) << _PLACES) - most)
    u0, u1, u2 = e0 * units, e1 * units, e2 * units
    store(singles[R.PART0], i, u0)
    store(singles[R.PART1], i, u1)
    store(singles[R.PART2], i, u2)
    store(singles[R.PARTS], i, to_float32((to_int32(u0) + to_int32(u1)) + to_int32(u2)))


@kernel(inlined=True)
def store_weights(singles, i, q0, q1, q2):
    """SINGLE_Q0 and SINGLE_Q2 of sixteen fragments from ``i`` on."""
    w0, w2 = rest_to_largest(q0, q1, q2)
    store(singles[R.SINGLE_Q0], i, w0)
    store(singles[R.SINGLE_Q2], i, w2)


@kernel(inlined=True)
def finish_block(singles, at, count):
    """The weights of a block's ``count`` fragments, the first of which is ``at``, from their parts."""
    of0, of1, of2, total = singles[R.PART0], singles[R.PART1], singles[R.PART2], singles[R.PARTS]
    for i in range(0, count, 16):
        store(total, i, reciprocals(load_f32x16(total, i)))
    for i in range(0, count, 16):
        r = load_f32x16(total, i)
        q0, q1, q2 = load_f32x16(of0, i) * r, load_f32x16(of1, i) * r, load_f32x16(of2, i) * r
        store_weights(singles, at + i, q0, q1, q2)


@kernel(void(float32[:, ::1], int64, int64, THREE, THREE, THREE, float64))
def cut_weights(singles, position, count, n, right, factors, reciprocal):
    """The leaf of ``single_weights``; ``reciprocal``: of the area, where that is all that weights take of it
    and is below LARGEST_INT32, else 0.
    """
    separate_loop()
    (n0, n1, n2), (right0, right1, right2) = n, right
    f0, f1, f2 = float32(factors[0]), float32(factors[1]), float32(factors[2])
    if (n0 + n1) + n2 >= LARGEST_INT32:
        ramp = ramp_f64x16()
        a0, a1, a2 = ramp * right0 + n0, ramp * right1 + n1, ramp * right2 + n2  # exact, as step by step
        wide0, wide1, wide2 = right0 * 16.0, right1 * 16.0, right2 * 16.0
        for first in range(0, count, BLOCK):
            some = min(int64(BLOCK), count - first)
            for i in range(0, some, 16):
                store_parts(singles, i, narrow_f32(a0) * f0, narrow_f32(a1) * f1, narrow_f32(a2) * f2)
                a0, a1, a2 = a0 + wide0, a1 + wide1, a2 + wide2
            finish_block(singles, position + first, some)
        return
    lane = ramp_i32x16()
    c0 = lane * int32(right0) + int32(n0)
    c1 = lane * int32(right1) + int32(n1)
    c2 = lane * int32(right2) + int32(n2)
    step0, step1, step2 = int32(right0) << int32(4), int32(right1) << int32(4), int32(right2) << int32(4)
    if reciprocal > 0.0:
        r = float32(reciprocal)
        for i in range(0, count, 16):
            store_weights(singles, position + i, to_float32(c0) * r, to_float32(c1) * r, to_float32(c2) * r)
            c0, c1, c2 = c0 + step0, c1 + step1, c2 + step2
        return
    for first in range(0, count, BLOCK):
        some = min(int64(BLOCK), count - first)
        for i in range(0, some, 16):
            store_parts(singles, i, to_float32(c0) * f0, to_float32(c1) * f1, to_float32(c2) * f2)
            c0, c1, c2 = c0 + step0, c1 + step1, c2 + step2
        finish_block(singles, position + first, some)


@kernel(void(float32[:, ::1], int64, int64, THREE, THREE, THREE, float64))
def weights_toward_zero(singles, position, count, n, right, factors, reciprocal):
    """``cut_weights``, rounding toward zero."""
    separate_function()
    toward_zero(cut_weights, (singles, position, count, n, right, factors, reciprocal))


@kernel(void(float32[:, ::1], float64[:, ::1], int64, int64, THREE, float64))
def cut_column_weights(singles, floats, position, count, factors, reciprocal):
    """The leaf of ``single_column_weights``; ``reciprocal``: as for ``cut_weights``."""
    separate_loop()
    f0, f1, f2 = float32(factors[0]), float32(factors[1]), float32(factors[2])
    n0, n1, n2 = floats[R.N0], floats[R.N1], floats[R.N2]
    r = float32(reciprocal)
    for at in range(position, position + count, BLOCK):
        some = min(int64(BLOCK), position + count - at)
        for i in range(0, some, 16):
            e0, e1 = narrow_f32(load_f64x16(n0, at + i)), narrow_f32(load_f64x16(n1, at + i))
            e2 = narrow_f32(load_f64x16(n2, at + i))
            if reciprocal > 0.0:
                store_weights(singles, at + i, e0 * r, e1 * r, e2 * r)
            else:
                store_parts(singles, i, e0 * f0, e1 * f1, e2 * f2)
        if not reciprocal > 0.0:
            finish_block(singles, at, some)


@kernel(void(float32[:, ::1], float64[:, ::1], int64, int64, THREE, float64))
def column_weights_toward_zero(singles, floats, position, count, factors, reciprocal):
    """``cut_column_weights``, rounding toward zero."""
    separate_function()
    toward_zero(cut_column_weights, (singles, floats, position, count, factors, reciprocal))


@kernel
def single_factors(factors):
    """(whether a triangle's weights may be singles, its factors for ``single_weights``).

    They are scaled by one power of two, which weights do not show, so that the largest is in 1..2.
    """
    f0, f1, f2 = factors
    most, least = max(f0, max(f1, f2)), min(f0, min(f1, f2))
    scale = 1.0 / power_below(most)
    return can_cut() and most < least * LARGEST_RATIO, (f0 * scale, f1 * scale, f2 * scale)


@kernel
def is_affine(factors):
    """Whether a triangle is not in perspective."""
    return factors[0] == 1.0 and factors[1] == 1.0 and factors[2] == 1.0


@kernel(void(float32[:, ::1], int64, int64, THREE, THREE, THREE))
def single_weights(singles, position, count, n, right, factors):
    """SINGLE_Q0 and SINGLE_Q2 of ``count`` pixels to the right of the one whose edge functions are ``n``:
    those of ``interpolate.run_weights``; ``factors`` of ``single_factors``.
    """
    separate_function()
    area = (n[0] + n[1]) + n[2]
    once = is_affine(factors) and area < LARGEST_INT32 and are_exact(n, right, area)
    reciprocal = reciprocal_24(area) if once else 0.0
    weights_toward_zero(singles, position, count, n, right, factors, reciprocal)


@kernel(boolean(float32[:, ::1], float64[:, ::1], int64, int64, THREE, float64))
def single_column_weights(singles, floats, position, count, factors, area):
    """SINGLE_Q0 and SINGLE_Q2 of a triangle's fragments: those of ``interpolate.triangle_weights``; False
    where they must be made there. ``factors``: the triangle's own.
    """
    separate_function()
    usable, scaled = single_factors(factors)
    if usable:
        reciprocal = reciprocal_24(area) if is_affine(scaled) else 0.0
        column_weights_toward_zero(singles, floats, position, count, scaled, reciprocal)
    return usable


# ----------------------------------------------------------------------------------------------- coordinates


@kernel
def largest_term(q0, q2, of0, of2, of_own):
    """The exponent field of the largest of products of highest bits (``interpolate.terms_of``).

    That of a product is the sum of its factors' fields; ``of0``, ``of2``: those of differences, less that of
    1. With a factor of zero the sum is some number below _EXACT_FROM, as differences are below
    LARGEST_DIFFERENCE.
    """
    return maximum(maximum(exponent(q0) + of0, exponent(q2) + of2), of_own)


@kernel
def steps_of(largest):
    """How many units of ``interpolate.terms_of`` make one."""
    return singles_of_bits(int32((2 * _ONE + 23) << _PLACES) - largest)


@kernel
def cut_term(q, d):
    """trunc(q d) as an int32, which it must fit into.

    From 2**24 on, the product cut to 24 bits is whole, and lacks last bits. The rest has these: it is exact,
    and of one sign with the product. Below, the rest is a fraction that reaches no whole number.
    """
    product = q * d
    return to_int32(product) + to_int32(fused(q, d, product * -1.0))


@kernel(boolean(float32[:, ::1], int64, int64, int64, THREE, int64))
def cut_coordinate(singles, component, begin, end, terms, log2_factor):
    """The leaf of ``single_coordinate``: whether some coordinate is below EXACT_FROM and not zero.

    The units of one fragment hold for most of the next ones: as in ``coordinates.beside_texels``.
    """
    separate_loop()
    own, d0, d2 = f32x16(float32(terms[0])), f32x16(float32(terms[1])), f32x16(float32(terms[2]))
    q0, q2, out = singles[R.SINGLE_Q0], singles[R.SINGLE_Q2], singles[R.SINGLE_COORDINATE + component]
    one, shift = int32(_ONE << _PLACES), int32((log2_factor - 23) << _PLACES)
    of_own, of0, of2 = exponent(own), exponent(d0) - one, exponent(d2) - one
    has_own, has0, has2 = own != 0.0, d0 != 0.0, d2 != 0.0
    doubt, i = i32x16(int32(0)), begin
    while i < end:
        guess = largest_term(f32x16(q0[i]), f32x16(q2[i]), of0, of2, of_own)
        holds = all_lanes(guess >= int32(_EXACT_FROM))
        if holds:
            steps, unit = steps_of(guess), singles_of_bits(guess + shift)
            cut, e0, e2 = to_int32(own * steps), d0 * steps, d2 * steps
            while holds and i < end:
                w0, w2 = load_f32x16(q0, i), load_f32x16(q2, i)
                holds = all_lanes(largest_term(w0, w2, of0, of2, of_own) == guess)
                if holds:
                    store(out, i, to_float32((cut + cut_term(w0, e0)) + cut_term(w2, e2)) * unit)
                    i += 16
            if i >= end:
                break
        w0, w2 = load_f32x16(q0, i), load_f32x16(q2, i)
        largest = largest_term(w0, w2, of0, of2, of_own)
        some = (has_own | ((w0 != 0.0) & has0)) | ((w2 != 0.0) & has2)
        doubt = select((largest < int32(_EXACT_FROM)) & some, i32x16(int32(1)), doubt)
        largest = maximum(largest, int32(_EXACT_FROM))
        steps, unit = steps_of(largest), singles_of_bits(largest + shift)
        total = (to_int32(own * steps) + cut_term(w0, d0 * steps)) + cut_term(w2, d2 * steps)
        store(out, i, to_float32(total) * unit)
        i += 16
    return any_lane(doubt != int32(0))


@kernel(boolean(float32[:, ::1], int64, int64, int64, THREE, int64))
def coordinate_toward_zero(singles, component, begin, end, terms, log2_factor):
    """``cut_coordinate``, rounding toward zero."""
    separate_function()
    return toward_zero(cut_coordinate, (singles, component, begin, end, terms, log2_factor))


@kernel
def is_usual(value):
    """Whether a vertex's number is zero or a normal float32.

    With a largest term of EXACT_FROM or above, all of a term that is below normal float32 is cut off.
    """
    return value == 0.0 or LEAST_SINGLE <= abs(value) <= LARGEST_SINGLE


@kernel
def single_coordinate(singles, component, begin, end, terms, log2_factor):
    """SINGLE_COORDINATE, or ``component`` columns behind it, of a triangle's fragments: a texture coordinate
    times 2**log2_factor, of the sum that ``interpolate.terms_of`` makes from SINGLE_Q0 and SINGLE_Q2. False
    where some is below EXACT_FROM and not zero: then nothing of it may be used.

    ``terms``: vertex 1's number, and how far vertices 0 and 2 are from it. Of the first no more than 24 bits
    reach the sum.
    """
    v1, d0, d2 = terms
    v1 = truncate_24(v1)
    if not (is_usual(v1) and is_usual(d0) and is_usual(d2) and max(abs(d0), abs(d2)) < LARGEST_DIFFERENCE):
        return False
    return not coordinate_toward_zero(singles, component, begin, end, (v1, d0, d2), log2_factor)


@kernel("void(f4[:,::1],f8[:,::1],i8,i8)")
def widen_weights(singles, floats, begin, end):
    """Q0 and Q2 of fragments from SINGLE_Q0 and SINGLE_Q2, and of no others."""
    separate_loop()
    for i in range(begin, end):
        floats[R.Q0, i] = float64(singles[R.SINGLE_Q0, i])
        floats[R.Q2, i] = float64(singles[R.SINGLE_Q2, i])

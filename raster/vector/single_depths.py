"""Depth words of a triangle's fragments in float32 that the processor cuts (``rounding``) and int32: the
values of ``interpolate.run_depth`` and ``triangle_depth``, where one seed serves the whole triangle.

What is added to a depth is a whole number of units of N5.3, so the sum is an int32. N5.2's reciprocal has 29
bits: a float32 has the upper 24 of the least that the triangle's fragments take, a second one what is more.

What is the same in all fragments lies in a row of numbers, which ``keep_depths`` writes once for a triangle:
a call for each run would spend more time on its arguments than on sixteen fragments.
"""

from numba import boolean, float32, float64, int32, int64, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import THREE
from fixedpipe.raster.fixed import power_below, reciprocal_29
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.portable.interpolate import depth_difference
from fixedpipe.raster.vector.coordinates import logarithm
from fixedpipe.raster.vector.interpolate import DEPTHS, keep_24, shared_seed
from fixedpipe.raster.vector.lanes import (
    all_lanes,
    any_lane,
    bits_of_single,
    f64x16,
    floored,
    fused,
    i32x16,
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
from fixedpipe.raster.vector.singles import LARGEST_INT32, cut_term, exponent

LARGEST_AREA = 2.0**40  # no weight is below 2**-41 and not zero
LARGEST_OFFSET = 2.0**24  # in units: float64 adds larger ones
_LEAST = 2.0**-34  # of depths and of their differences, but zero: times a weight they are above 2**-76
_MOST = 2.0**25  # of them: a unit is then a fraction
_LEAST_DEPTH = 2.0**-3  # not below any unit: float64's sums of such depths are exact
_ALL_ONES = 1.0 - 2.0**-24  # the largest depth below a unit
_NONE = 2.0**-90  # below all of these
_ONE, _PLACES = 127, 23  # exponent field of 1, and where it is
_SEED_BITS, _BITS, _UPPER = 14, 29, 24  # of a seed, a reciprocal, and a float32
_UP = _BITS - _SEED_BITS  # from a seed's last bit to a reciprocal's
_REST = 12  # bits of a Newton step's remainder below the last that counts

# ---------------------------------------------------------------------------------------- the row of numbers

ONE_UNIT = 0  # whether beside each vertex the unit of depths is that vertex's own
EXACT = 1  # whether all sums are the area, and HIGH and LOW its reciprocal
HIGH, LOW = 2, 3  # float32: the upper 24 bits of the area's reciprocal in its last bit, and the others
# Of the Newton step: its seed, what is added to make of it the lower bits of a reciprocal, the remainder of
# the area with _REST bits more than count, and how far a step of the area changes it.
SEED, LOWER, START, FACTOR = 4, 5, 6, 7
WHOLE, SHIFT = 8, 9  # the area without SHIFT bits
OFFSET, LEAST, MOST = 10, 11, 12  # what is added, and the limits
BASES = 13  # where the numbers of each vertex begin:
# float32: its depth, how far the two others are from it, times what a reciprocal's last bit is worth, and the
# unit of depths, where ONE_UNIT is set; then the other three are in it.
DEPTH, FIRST, SECOND, UNIT = 0, 1, 2, 3
FIELD = 4  # the exponent field of its depth, or of _NONE
BASE_SIZE = 5


@kernel(inlined=True)
def keep_single(numbers, place, value):
    """A float32 as one of a row's numbers."""
    numbers[place] = bits_of_single(float32(value))


@kernel
def whole(numbers, place):
    """An int32 of a row, in all lanes."""
    return i32x16(numbers[place])


@kernel
def single(numbers, place):
    """A float32 of a row, in all lanes."""
    return singles_of_bits(i32x16(numbers[place]))


# -------------------------------------------------------------------------------------- once for a triangle


@kernel(inlined=True)
def is_usual(z):
    """Whether a difference of depths, times a weight, is a float32, and its unit a fraction."""
    return z == 0.0 or _LEAST <= abs(z) <= _MOST


@kernel(inlined=True)
def is_depth(z):
    """Whether words have the floor of the exact sum though float64 rounds that, which adds a vertex's depth
    first.

    It rounds only where the unit is above the depth, and then ``depths_by_largest`` sees where the floor is
    another. Below zero it would have to look at each addition.
    """
    return z == 0.0 or _LEAST <= z <= _MOST or _LEAST_DEPTH <= -z <= _MOST


@kernel(inlined=True)
def has_one_unit(z, first, second):
    """Whether a vertex's depth is the largest term beside it, with differences of two others.

    Its edge function has the highest bit of all, so another vertex's weight is below 2/3. Times a difference
    of up to 2 P(z) that is below 2 P(z): its highest bit is not above z's.
    """
    return z > 0.0 and max(abs(first), abs(second)) <= 2.0 * power_below(z)


@kernel(inlined=True)
def keep_base(numbers, vertex, z, first, second, last_bit):
    """A vertex's depth and two differences as the numbers of a base; ``last_bit``: of a reciprocal."""
    at, units = BASES + vertex * BASE_SIZE, 1.0
    if numbers[ONE_UNIT]:
        units = 2.0**28 / power_below(z)
        keep_single(numbers, at + UNIT, 1.0 / units)
    keep_single(numbers, at + DEPTH, z * units)
    keep_single(numbers, at + FIRST, first * last_bit * units)
    keep_single(numbers, at + SECOND, second * last_bit * units)
    numbers[at + FIELD] = (logarithm(power_below(max(abs(z), _NONE))) + int32(_ONE)) << int32(_PLACES)


@kernel
def nearest(remainder):
    """A remainder without its _REST lower bits: to nearest, halves toward zero."""
    return (remainder + ((1 << (_REST - 1)) - int64(remainder > 0))) >> _REST


@kernel(inlined=True)
def keep_high(numbers, reciprocal):
    """HIGH of a reciprocal of 29 bits; it, too, is returned."""
    high = (reciprocal >> (_BITS - _UPPER)) << (_BITS - _UPPER)
    keep_single(numbers, HIGH, float64(high))
    return high


@kernel(inlined=True)
def keep_reciprocals(numbers, area):
    """Whether one seed and one exponent serve the sums of an area; if so, its numbers are kept."""
    power = power_below(area)
    if numbers[EXACT]:
        reciprocal = int64(reciprocal_29(area) * power * 2.0**_BITS)
        keep_single(numbers, LOW, float64(reciprocal - keep_high(numbers, reciprocal)))
        return True
    of_area, shared = shared_seed(area)
    seed, bits = int64(of_area * power * 2.0**_SEED_BITS), int64(logarithm(power)) + 1
    shift, left = max(bits - _BITS, int64(0)), max(_BITS - bits, int64(0))
    most = int64(area) >> shift
    start = (int64(1) << (_SEED_BITS + _BITS - 1)) - (most << left) * seed
    # Of all sums the area has the least reciprocal.
    high = keep_high(numbers, (seed << _UP) + ((seed * nearest(start)) >> _UP))
    numbers[SEED], numbers[LOWER] = int32(seed), int32((seed << _UP) - high)
    numbers[START], numbers[FACTOR] = int32(start), int32(seed << left)
    numbers[WHOLE], numbers[SHIFT] = int32(most), int32(shift)
    return shared and area - area * 2.0**-22 >= power


@kernel(boolean(int32[:, ::1], int64, boolean, DEPTHS))
def keep_depths(ints, size, exact, depths):
    """Whether a triangle's depth words may be made here; if so, its DEPTH_NUMBERS are kept.

    ``size``: its area; ``exact``: whether its edge functions have 24 bits at every pixel. They do where the
    area is below 2**24.
    """
    separate_function()
    numbers, area = ints[R.DEPTH_NUMBERS], float64(size)
    (z0, z1, z2), offset, low, high = depths
    if z0 == z1 and z1 == z2:  # one word for all: ``run_depth`` just stores it
        return False
    z10, z20, z21 = depth_difference(z1, z0), depth_difference(z2, z0), depth_difference(z2, z1)
    usual = is_depth(z0) and is_depth(z1) and is_depth(z2) and low <= low and high <= high
    usual = usual and is_usual(z10) and is_usual(z20) and is_usual(z21)
    added = int32(min(max(offset, -LARGEST_OFFSET), LARGEST_OFFSET))
    # A sum below zero is cut toward zero, not to its floor. Without an offset upward it is at the lower
    # limit, which is not negative.
    positive = offset <= 0.0 or min(z0, min(z1, z2)) >= 0.0
    if not (can_cut() and usual and positive and 0.0 < area < LARGEST_AREA):
        return False
    one_unit = has_one_unit(z0, z10, z20) and has_one_unit(z1, z10, z21) and has_one_unit(z2, z20, z21)
    numbers[ONE_UNIT], numbers[EXACT] = int32(one_unit), int32(exact)
    numbers[OFFSET], numbers[LEAST], numbers[MOST] = added, int32(low), int32(high)
    last_bit = 2.0**-_BITS / power_below(area)
    keep_base(numbers, 0, z0, z10, z20, last_bit)
    keep_base(numbers, 1, z1, 0.0 - z10, z21, last_bit)
    keep_base(numbers, 2, z2, 0.0 - z20, 0.0 - z21, last_bit)
    return keep_reciprocals(numbers, area) and float64(added) == offset


@kernel(inlined=True)
def have_24_bits(edges):
    """Whether a triangle's edge functions have 24 bits at every pixel (``interpolate.are_exact``)."""
    (n0, n1, n2), (right0, right1, right2), (down0, down1, down2), area, _sign = edges
    bits = ((n0 | n1 | n2) | (right0 | right1 | right2)) | (down0 | down1 | down2)
    return float64(area) < 2.0**24 * float64(bits & -bits)


# ------------------------------------------------------------------------------------- for sixteen fragments


@kernel
def weight(edge, high, low):
    """N5.2's weight, times the reciprocal's last bit, of an edge function of 24 bits.

    The product with ``high`` and its rest are exact. The rest and the product with ``low`` are cut finer than
    at the sum's last bit, which is therefore that of the exact sum.
    """
    product = edge * high
    return product + fused(edge, low, fused(edge, high, product * -1.0))


@kernel(inlined=True)
def depths_in_unit(numbers, at, first, second):
    """Depths cut to 24 bits, in the unit of the base whose numbers begin at ``at``, from two weights."""
    total = cut_term(first, single(numbers, at + FIRST)) + to_int32(single(numbers, at + DEPTH))
    total = total + cut_term(second, single(numbers, at + SECOND))
    return to_float32(total) * single(numbers, at + UNIT)


@kernel(inlined=True)
def depths_by_largest(numbers, at, first, second):
    """Depths cut to 24 bits from two weights: each in the unit of its largest term.

    Of the base's own depth the floor is enough: what it lacks is less than a unit, and a unit is a fraction.
    Float64 rounds a sum from 2**29 units on to a multiple of 2**-23, and so that of _ALL_ONES up to the next
    whole number of units. This is the only depth for which it does: the others below a unit are farther from
    it, and the sums of larger ones are exact.
    """
    d_first, d_second = single(numbers, at + FIRST), single(numbers, at + SECOND)
    a, b = first * d_first, second * d_second
    rest_a, rest_b = fused(first, d_first, a * -1.0), fused(second, d_second, b * -1.0)
    largest = maximum(maximum(exponent(a), exponent(b)), whole(numbers, at + FIELD))
    scale = singles_of_bits(int32((2 * _ONE + 28) << _PLACES) - largest)
    of_a = to_int32(a * scale) + to_int32(rest_a * scale)
    of_b = to_int32(b * scale) + to_int32(rest_b * scale)
    own, total = single(numbers, at + DEPTH) * scale, of_a + of_b
    up = (own == float32(_ALL_ONES)) & (total >= int32(1 << 29))
    total = total + select(up, i32x16(1), to_int32(floored(own)))
    return to_float32(total) * singles_of_bits(largest - int32(28 << _PLACES))


@kernel(inlined=True)
def words_beside(numbers, vertex, first, second, low):
    """Depth words beside a vertex, from the two others' edge functions and the reciprocals' lower bits."""
    at, high = BASES + vertex * BASE_SIZE, single(numbers, HIGH)
    q_first, q_second = weight(first, high, low), weight(second, high, low)
    if numbers[ONE_UNIT]:
        depth = depths_in_unit(numbers, at, q_first, q_second)
    else:
        depth = depths_by_largest(numbers, at, q_first, q_second)
    word = to_int32(depth) + whole(numbers, OFFSET)
    return minimum(maximum(word, whole(numbers, LEAST)), whole(numbers, MOST))


@kernel(inlined=True)
def words_of(numbers, e0, e1, e2, low):
    """Depth words from edge functions of 24 bits. The base is chosen as ``interpolate.depth_of`` does."""
    p0, p1, p2 = exponent(e0), exponent(e1), exponent(e2)
    first = (p0 > p1) & (p0 >= p2)
    last = (p2 > p1) & (p2 > p0)
    # Most vectors lie wholly beside one vertex.
    if all_lanes(first):
        return words_beside(numbers, 0, e1, e2, low)
    if all_lanes(last):
        return words_beside(numbers, 2, e0, e1, low)
    words = words_beside(numbers, 1, e0, e2, low)
    if any_lane(first | last):
        words = select(first, words_beside(numbers, 0, e1, e2, low), words)
        words = select(last, words_beside(numbers, 2, e0, e1, low), words)
    return words


@kernel(inlined=True)
def lower_bits(numbers, total):
    """What the reciprocal of a sum of edge functions, cut to 29 bits, has beyond HIGH: 0 or more."""
    remainder = (whole(numbers, WHOLE) - total) * whole(numbers, FACTOR) + whole(numbers, START)
    half = int32(1 << (_REST - 1))
    nearer = select(remainder > int32(0), i32x16(half - int32(1)), i32x16(half))
    step = (remainder + nearer) >> int32(_REST)
    return to_float32(((step * whole(numbers, SEED)) >> int32(_UP)) + whole(numbers, LOWER))


# ------------------------------------------------------------------------------------------- runs, triangles


@kernel(void(int32[:, ::1], int64, int64, THREE, THREE))
def cut_run_depth(ints, position, count, n, right):
    """The leaf of ``single_run_depth`` for areas below LARGEST_INT32."""
    separate_loop()
    (n0, n1, n2), (right0, right1, right2) = n, right
    numbers, words, lane = ints[R.DEPTH_NUMBERS], ints[R.DEPTH_WORD], ramp_i32x16()
    c0 = lane * int32(right0) + int32(n0)
    c1 = lane * int32(right1) + int32(n1)
    c2 = lane * int32(right2) + int32(n2)
    step0, step1, step2 = int32(right0) << int32(4), int32(right1) << int32(4), int32(right2) << int32(4)
    low = single(numbers, LOW)
    for i in range(position, position + count, 16):
        e0, e1, e2 = to_float32(c0), to_float32(c1), to_float32(c2)
        if not numbers[EXACT]:
            total = (to_int32(e0) + to_int32(e1)) + to_int32(e2)
            low = lower_bits(numbers, total >> whole(numbers, SHIFT))
        store(words, i, words_of(numbers, e0, e1, e2, low))
        c0, c1, c2 = c0 + step0, c1 + step1, c2 + step2


@kernel(void(int32[:, ::1], int64, int64, THREE, THREE))
def cut_wide_depth(ints, position, count, n, right):
    """The leaf of ``single_run_depth`` for areas from LARGEST_INT32 on."""
    separate_loop()
    (n0, n1, n2), (right0, right1, right2) = n, right
    numbers, words, ramp = ints[R.DEPTH_NUMBERS], ints[R.DEPTH_WORD], ramp_f64x16()
    a0, a1, a2 = ramp * right0 + n0, ramp * right1 + n1, ramp * right2 + n2  # exact, as step by step
    step0, step1, step2 = right0 * 16.0, right1 * 16.0, right2 * 16.0
    # SHIFT is an older triangle's where EXACT is set: then ``units`` is not used.
    low, units = single(numbers, LOW), f64x16(1.0 / float64(int64(1) << int64(numbers[SHIFT])))
    for i in range(position, position + count, 16):
        if not numbers[EXACT]:
            total = (keep_24(a0) + keep_24(a1)) + keep_24(a2)
            low = lower_bits(numbers, to_int32(total * units))
        e0, e1, e2 = narrow_f32(a0), narrow_f32(a1), narrow_f32(a2)
        store(words, i, words_of(numbers, e0, e1, e2, low))
        a0, a1, a2 = a0 + step0, a1 + step1, a2 + step2


@kernel(void(float64[:, ::1], int32[:, ::1], int64, int64))
def cut_triangle_depth(floats, ints, position, count):
    """The leaf of ``single_triangle_depth``."""
    separate_loop()
    n0, n1, n2 = floats[R.N0], floats[R.N1], floats[R.N2]
    numbers, words = ints[R.DEPTH_NUMBERS], ints[R.DEPTH_WORD]
    low = single(numbers, LOW)
    for i in range(position, position + count, 16):
        e0, e1 = narrow_f32(load_f64x16(n0, i)), narrow_f32(load_f64x16(n1, i))
        e2 = narrow_f32(load_f64x16(n2, i))
        store(words, i, words_of(numbers, e0, e1, e2, low))


@kernel(void(int32[:, ::1], int64, int64, THREE, THREE))
def run_depth_toward_zero(ints, position, count, n, right):
    """``cut_run_depth``, rounding toward zero."""
    separate_function()
    toward_zero(cut_run_depth, (ints, position, count, n, right))


@kernel(void(int32[:, ::1], int64, int64, THREE, THREE))
def wide_depth_toward_zero(ints, position, count, n, right):
    """``cut_wide_depth``, rounding toward zero."""
    separate_function()
    toward_zero(cut_wide_depth, (ints, position, count, n, right))


@kernel
def single_run_depth(ints, position, count, n, right):
    """DEPTH_WORD of ``count`` pixels to the right of the one whose edge functions are ``n``: those of
    ``interpolate.run_depth``, of a triangle whose numbers ``keep_depths`` kept.
    """
    if (n[0] + n[1]) + n[2] < LARGEST_INT32:
        run_depth_toward_zero(ints, position, count, n, right)
    else:
        wide_depth_toward_zero(ints, position, count, n, right)


@kernel(void(float64[:, ::1], int32[:, ::1], int64, int64))
def single_triangle_depth(floats, ints, position, count):
    """DEPTH_WORD of a triangle's fragments, which carry their edge functions; its area is below 2**24: those
    of ``interpolate.triangle_depth``, of a triangle whose numbers ``keep_depths`` kept.
    """
    separate_function()
    toward_zero(cut_triangle_depth, (floats, ints, position, count))

"""Texture sampling by vectors: the texels of raster/portable/sample.py, fetched four at a time.

A texture's levels are stored once more as row pairs: every row has its first texel again at its end, and
every texel its upper neighbour beside it (the last row's is the first row), so that one load of 128 bits
brings the whole footprint of a linear filter. A neighbour that a wrap mode does not mean has weight 0.

A coordinate F counts 1/256 texels of a level: floor(256 u size). A linear filter reads column
(F - 128) >> 8 with the fraction (F - 128) & 255, a nearest one column F >> 8 with none. Whatever is in F,
a texel inside the level is read.

Filtering goes through ``located``, int32[LOCATED, batch + SLACK]: where each fragment's footprint begins and
how it is weighted. Units whose coordinates, sizes, filters and wrap modes agree can share it.
"""

import numpy as np
from numba import int16, int32, int64, uint64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.lanes import (
    even_lanes,
    halves_of_lanes,
    i32x16,
    lanes_of_halves,
    largest_lane,
    load_each_i32x16,
    load_i16x32,
    load_i32x16,
    load_quads,
    lowest_bit,
    maximum,
    minimum,
    mixed_bytes,
    odd_lanes,
    select,
    shift_right,
    smallest_lane,
    store,
)

# Rows of ``located``: the footprint's first element in the row pairs and its weights, the fraction across in
# the low 16 bits and the one upwards above; both again for a second level; the fraction between them.
FIRST, WEIGHTS, UPPER_FIRST, UPPER_WEIGHTS, BETWEEN, LOCATED = range(6)

_LOWEST, _HIGHEST = -(1 << 31), (1 << 31) - 1


# ---------------------------------------------------------------------------------------------- row pairs


@kernel("void(u4[::1],i8,i8,i8,i8,u4[::1],i8)")
def _pair_rows(texels, offset, width, height, faces, pairs, pair_offset):
    """One level, each of its ``faces`` on its own."""
    separate_loop()
    for row in range(faces * height):
        last = (row + 1) % height == 0
        lower = uint64(offset + row * width)
        upper = uint64(offset + (row + 1 - (height if last else 0)) * width)
        at = uint64(pair_offset + row * (width + 1) * 2)
        for x in range(width):
            pairs[at + uint64(2 * x)] = texels[lower + uint64(x)]
            pairs[at + uint64(2 * x + 1)] = texels[upper + uint64(x)]
        pairs[at + uint64(2 * width)] = texels[lower]
        pairs[at + uint64(2 * width + 1)] = texels[upper]


def row_pairs(texels, levels, count, faces=1):
    """A texture's ``count`` levels as row pairs: (pairs uint32[.], levels int32[MAX_LEVELS, 3]).

    texels: uint32[.], packed; levels: int32[MAX_LEVELS, 3], each level's offset in ``texels``, width and
    height; ``faces``: images of each level, one behind another. The levels returned have their offsets in
    ``pairs``. Twice the texels' memory and two elements more for each row.
    """
    found, places, size = np.array(levels, np.int32), [], 0
    for k, (offset, width, height) in enumerate(levels[:count].tolist()):
        found[k, 0] = size
        places.append((offset, width, height, size))
        size += 2 * faces * (width + 1) * height
    pairs = np.empty(size, np.uint32)
    for offset, width, height, place in places:
        _pair_rows(texels, offset, width, height, faces, pairs, place)
    return pairs, found


# ------------------------------------------------------------------------------------------------ locating


@kernel
def _rounded(count):
    """To whole vectors of 32: fetching reads as many, and must find places in this texture there too."""
    return (count + 31) & ~31


@kernel
def _limits(mode, half, size):
    """(lowest, highest, mask): F is limited to the first two, then the column to the mask's bits."""
    if mode == C.WRAP_REPEAT and size & (size - 1) == 0:
        return int32(_LOWEST), int32(_HIGHEST), int32(size - 1)
    if mode == C.WRAP_REPEAT:
        return half, int32(256 * size - 1 + half), int32(-1)
    return half, int32(256 * size - 128), int32(-1)


@kernel("void(i4[:,::1],i8[::1],i4[::1],i4[::1],i8,i4[:,::1])")
def locate(levels, unit, f_s, f_t, count, located):
    """FIRST and WEIGHTS of fragments that all read level 0.

    levels: of the row pairs; unit: int64[UNIT_SIZE], with one filter and REPEAT, CLAMP_TO_EDGE or, for a
    nearest filter, CLAMP on either axis; f_s, f_t: F across and upwards. A 1D texture has one row, and any
    ``f_t``. An axis that repeats and whose size is no power of two has its F in 128..256 size + 127
    (nearest: 0..256 size - 1).
    """
    separate_loop()
    linear, cube = unit[R.MAG_LINEAR] != 0, unit[R.TARGET] == C.TARGET_CUBE_MAP
    half, fraction = int32(128 if linear else 0), int32(255 if linear else 0)
    low_s, high_s, mask_s = _limits(C.WRAP_CLAMP_TO_EDGE if cube else unit[R.WRAP_S], half, levels[0, 1])
    low_t, high_t, mask_t = _limits(C.WRAP_CLAMP_TO_EDGE if cube else unit[R.WRAP_T], half, levels[0, 2])
    mask_s = int32(mask_s * int32(2))
    base, stride = levels[0, 0], int32(int32(levels[0, 1] + int32(1)) * int32(2))
    first, weights = located[FIRST], located[WEIGHTS]
    if low_s == _LOWEST and low_t == _LOWEST:  # both repeat, nothing is limited
        for at in range(0, _rounded(count), 16):
            s, t = load_i32x16(f_s, at) - half, load_i32x16(f_t, at) - half
            column, row = (s >> int32(7)) & mask_s, (t >> int32(8)) & mask_t
            store(first, at, row * stride + column + base)
            store(weights, at, (s & fraction) | ((t & fraction) << int32(16)))
        return
    for at in range(0, _rounded(count), 16):
        s = minimum(maximum(load_i32x16(f_s, at), low_s), high_s) - half
        t = minimum(maximum(load_i32x16(f_t, at), low_t), high_t) - half
        column, row = (s >> int32(7)) & mask_s, (t >> int32(8)) & mask_t
        store(first, at, row * stride + column + base)
        store(weights, at, (s & fraction) | ((t & fraction) << int32(16)))


@kernel
def _level_of(lod, threshold, top, rounding, step, last):
    """The level that a fragment reads whose lambda is ``lod``."""
    if lod <= threshold:
        return min(step, last)
    return min(int32(int32(int32(min(max(lod, int32(0)), top)) + rounding) >> int32(8)) + step, last)


@kernel("i4(i4[:,::1],i8[::1],i4[::1],i4[::1],i4[::1],i4,i8,i4[:,::1])")
def locate_levels(levels, unit, f_s, f_t, lod, step, count, located):
    """FIRST, WEIGHTS and BETWEEN of fragments that have a level each; returns the largest lambda.

    As ``locate``, but the unit may have any filters, and sizes are powers of two. lod: lambda with 8 fraction
    bits; ``step``: 0, or 1 for UPPER_FIRST and UPPER_WEIGHTS of the level above. F are level 0's.
    """
    separate_loop()
    last, mipmap = int32(unit[R.LEVELS] - 1), unit[R.MIPMAP]
    threshold, rounding = int32(unit[R.THRESHOLD]), int32(127 if mipmap == C.MIPMAP_NEAREST else 0)
    top = int32(last * int32(256)) if mipmap != C.MIPMAP_NONE else int32(0)
    smallest, largest = i32x16(int32(_HIGHEST)), i32x16(int32(_LOWEST))
    for at in range(0, _rounded(count), 16):
        value = load_i32x16(lod, at)
        smallest, largest = minimum(smallest, value), maximum(largest, value)
    highest = largest_lane(largest)
    low_level = _level_of(smallest_lane(smallest), threshold, top, rounding, step, last)
    high_level = _level_of(highest, threshold, top, rounding, step, last)

    width, height = levels[0, 1], levels[0, 2]
    bits_s, bits_t = int32(lowest_bit(int64(width))), int32(lowest_bit(int64(height)))
    repeat_s, repeat_t = unit[R.WRAP_S] == C.WRAP_REPEAT, unit[R.WRAP_T] == C.WRAP_REPEAT
    # Beyond these nothing is limited: either the axis repeats, or the level's own limits are narrower.
    below_s, above_s = int32(_LOWEST if repeat_s else _HIGHEST), int32(_HIGHEST if repeat_s else _LOWEST)
    below_t, above_t = int32(_LOWEST if repeat_t else _HIGHEST), int32(_HIGHEST if repeat_t else _LOWEST)
    mag_half, min_half = int32(128 * unit[R.MAG_LINEAR]), int32(128 * unit[R.MIN_LINEAR])
    mag_fraction, min_fraction = int32(255 * unit[R.MAG_LINEAR]), int32(255 * unit[R.MIN_LINEAR])
    first, weights, between = located[2 * step + FIRST], located[2 * step + WEIGHTS], located[BETWEEN]
    one, zero = int32(1), i32x16(int32(0))
    if repeat_s and repeat_t and threshold <= int32(0) and unit[R.MAG_LINEAR] and unit[R.MIN_LINEAR]:
        # Both repeat, nothing is limited; both filters are one, and a lambda below the threshold is 0.
        for at in range(0, _rounded(count), 16):
            value = minimum(maximum(load_i32x16(lod, at), int32(0)), top)
            level = minimum(((value + rounding) >> int32(8)) + step, last)
            base = i32x16(levels[low_level, 0])
            for k in range(low_level + 1, high_level + 1):
                base = select(level >= int32(k), i32x16(levels[k, 0]), base)
            shift_s, shift_t = minimum(level, bits_s), minimum(level, bits_t)
            size_s, size_t = i32x16(width) >> shift_s, i32x16(height) >> shift_t
            s = (load_i32x16(f_s, at) >> shift_s) - int32(128)
            t = (load_i32x16(f_t, at) >> shift_t) - int32(128)
            column, row = (s >> int32(8)) & (size_s - one), (t >> int32(8)) & (size_t - one)
            store(first, at, ((row * (size_s + one) + column) << one) + base)
            store(weights, at, (s & int32(255)) | ((t & int32(255)) << int32(16)))
            store(between, at, value & int32(255))
        return highest
    for at in range(0, _rounded(count), 16):
        value = load_i32x16(lod, at)
        magnified = value <= threshold
        value = select(magnified, zero, minimum(maximum(value, int32(0)), top))
        half = select(magnified, i32x16(mag_half), i32x16(min_half))
        fraction = select(magnified, i32x16(mag_fraction), i32x16(min_fraction))
        level = minimum(((value + rounding) >> int32(8)) + step, last)
        base = i32x16(levels[low_level, 0])
        for k in range(low_level + 1, high_level + 1):
            base = select(level >= int32(k), i32x16(levels[k, 0]), base)
        shift_s, shift_t = minimum(level, bits_s), minimum(level, bits_t)
        size_s, size_t = i32x16(width) >> shift_s, i32x16(height) >> shift_t
        s = maximum(load_i32x16(f_s, at) >> shift_s, minimum(half, below_s))
        t = maximum(load_i32x16(f_t, at) >> shift_t, minimum(half, below_t))
        s = minimum(s, maximum((size_s << int32(8)) - int32(128), above_s)) - half
        t = minimum(t, maximum((size_t << int32(8)) - int32(128), above_t)) - half
        column, row = (s >> int32(8)) & (size_s - one), (t >> int32(8)) & (size_t - one)
        store(first, at, ((row * (size_s + one) + column) << one) + base)
        store(weights, at, (s & fraction) | ((t & fraction) << int32(16)))
        store(between, at, value & int32(255))
    return highest


@kernel("void(i4[:,::1],i4[::1],i8,i4[:,::1])")
def move_to_faces(levels, face, count, located):
    """FIRST from a cube map's first face to each fragment's (0..5; others are limited to these)."""
    separate_loop()
    area = int32(int32(int32(levels[0, 1] + int32(1)) * levels[0, 2]) * int32(2))
    first = located[FIRST]
    for at in range(0, _rounded(count), 16):
        number = minimum(maximum(load_i32x16(face, at), int32(0)), int32(5))
        store(first, at, load_i32x16(first, at) + number * area)


# ------------------------------------------------------------------------------------ fetching, filtering


@kernel
def _doubled(weight):
    """A number of up to 16 bits in 32-bit lanes, in both halves of each."""
    return halves_of_lanes(weight | (weight << int32(16)))


@kernel
def _two_weights(weights, at):
    """A row of 32 fragments: what every second one from ``at`` on has, and what the others have."""
    one, other = load_i32x16(weights, at), load_i32x16(weights, at + 16)
    return even_lanes(one, other), odd_lanes(one, other)


@kernel
def _footprint(pairs, first, weights, at):
    """The filtered texels of sixteen fragments, every second one from ``at`` on, whose WEIGHTS are given: red
    and blue in 16-bit lanes, green and alpha.
    """
    p00, p01, p10, p11 = load_quads(pairs, first, at)
    lower_left, upper_left = halves_of_lanes(p00), halves_of_lanes(p01)
    lower_right, upper_right = halves_of_lanes(p10), halves_of_lanes(p11)
    across, upwards = _doubled(weights & int32(0xFFFF)), _doubled(weights >> int32(16))
    byte, eight = int16(255), int16(8)
    lower = mixed_bytes(lower_left & byte, lower_right & byte, across)
    upper = mixed_bytes(upper_left & byte, upper_right & byte, across)
    red_blue = mixed_bytes(lower, upper, upwards)
    lower = mixed_bytes(shift_right(lower_left, eight), shift_right(lower_right, eight), across)
    upper = mixed_bytes(shift_right(upper_left, eight), shift_right(upper_right, eight), across)
    return red_blue, mixed_bytes(lower, upper, upwards)


@kernel
def _store_pair(one, other, registers, low, high, at):
    """Two values of 32 fragments to their planes, from the lower and upper halves of lanes: of every second
    fragment from ``at`` on (``one``), and of those between (``other``).
    """
    x, y = lanes_of_halves(one), lanes_of_halves(other)
    store(registers[low], at, halves_of_lanes((x & int32(0xFFFF)) | (y << int32(16))))
    store(registers[high], at, halves_of_lanes(shift_right(x, int32(16)) | (y & int32(-65536))))


@kernel
def _store_planes(red_blue0, green_alpha0, red_blue1, green_alpha1, registers, plane, at):
    """Twice sixteen texels as ``_footprint`` gives them, to four planes."""
    _store_pair(red_blue0, red_blue1, registers, plane, plane + 2, at)
    _store_pair(green_alpha0, green_alpha1, registers, plane + 1, plane + 3, at)


@kernel("void(u4[::1],i4[:,::1],i8,i2[:,::1],i8)")
def fetch_linear(pairs, located, count, registers, plane):
    """Filtered texels into four planes from ``plane`` on."""
    separate_loop()
    first, weights = located[FIRST], located[WEIGHTS]
    for at in range(0, count, 32):
        weights0, weights1 = _two_weights(weights, at)
        even0, odd0 = _footprint(pairs, first, weights0, at)
        even1, odd1 = _footprint(pairs, first, weights1, at + 1)
        _store_planes(even0, odd0, even1, odd1, registers, plane, at)


@kernel("void(u4[::1],i4[:,::1],i8,i2[:,::1],i8)")
def fetch_nearest(pairs, located, count, registers, plane):
    """Texels into four planes from ``plane`` on."""
    separate_loop()
    first, byte, eight = located[FIRST], int16(255), int16(8)
    for at in range(0, count, 32):
        one, other = load_each_i32x16(pairs, first, at), load_each_i32x16(pairs, first, at + 16)
        p, q = halves_of_lanes(even_lanes(one, other)), halves_of_lanes(odd_lanes(one, other))
        odd0, odd1 = shift_right(p, eight), shift_right(q, eight)
        _store_planes(p & byte, odd0, q & byte, odd1, registers, plane, at)


@kernel("void(u4[::1],i4[:,::1],i8,i2[:,::1],i8)")
def fetch_blended(pairs, located, count, registers, plane):
    """Filtered texels of two levels, each rounded to bytes, blended, into four planes from ``plane`` on."""
    separate_loop()
    first, upper_first = located[FIRST], located[UPPER_FIRST]
    for at in range(0, count, 32):
        weights0, weights1 = _two_weights(located[WEIGHTS], at)
        upper0, upper1 = _two_weights(located[UPPER_WEIGHTS], at)
        between0, between1 = _two_weights(located[BETWEEN], at)
        even0, odd0 = _footprint(pairs, first, weights0, at)
        even1, odd1 = _footprint(pairs, upper_first, upper0, at)
        weight = _doubled(between0)
        even2, odd2 = mixed_bytes(even0, even1, weight), mixed_bytes(odd0, odd1, weight)
        even0, odd0 = _footprint(pairs, first, weights1, at + 1)
        even1, odd1 = _footprint(pairs, upper_first, upper1, at + 1)
        weight = _doubled(between1)
        even0, odd0 = mixed_bytes(even0, even1, weight), mixed_bytes(odd0, odd1, weight)
        _store_planes(even2, odd2, even0, odd0, registers, plane, at)


@kernel
def _holds(texel, reference, of_equal):
    """Whether depth words are equal (``of_equal``), or the reference the smaller one."""
    return reference == texel if of_equal else reference < texel


@kernel
def _compared_footprint(pairs, first, weights, reference, at, of_equal, outcomes):
    """The filtered comparisons of sixteen fragments, every second one from ``at`` on, in 32-bit lanes; theirs
    are ``weights`` and ``reference``. ``outcomes``: what a texel becomes for which ``_holds``, and another:
    the lower two in the lower halves of lanes, then the upper two.
    """
    (lower, lower_not), (upper, upper_not) = outcomes
    p00, p01, p10, p11 = load_quads(pairs, first, at)
    left = select(_holds(p00, reference, of_equal), lower, lower_not)
    right = select(_holds(p10, reference, of_equal), lower, lower_not)
    left = left | select(_holds(p01, reference, of_equal), upper, upper_not)
    right = right | select(_holds(p11, reference, of_equal), upper, upper_not)
    across = _doubled(weights & int32(0xFFFF))
    rows = lanes_of_halves(mixed_bytes(halves_of_lanes(left), halves_of_lanes(right), across))
    above, below = halves_of_lanes(rows >> int32(16)), halves_of_lanes(rows & int32(0xFFFF))
    return lanes_of_halves(mixed_bytes(below, above, halves_of_lanes(weights >> int32(16))))


@kernel
def _outcome(function, bit, value):
    """Lanes of ``value`` if the comparison function has a bit, else of zero."""
    return i32x16(value if function & bit else int32(0))


@kernel("void(u4[::1],i4[:,::1],i4[::1],i8,i8,i2[:,::1],i8)")
def fetch_compared(pairs, located, references, function, count, registers, plane):
    """Texels that are depth words, each replaced by 255 where "reference FUNC texel" holds and else by 0,
    then filtered: into four planes from ``plane`` on.

    references: int32, depth words, not negative.
    """
    separate_loop()
    first, weights = located[FIRST], located[WEIGHTS]
    less, equal = (function & C.COMPARISON_LESS) != 0, (function & C.COMPARISON_EQUAL) != 0
    greater = (function & C.COMPARISON_GREATER) != 0
    # One comparison for each texel. Where less and greater give the same, and equal does not, that is ==.
    # Else it is <, of the reference or of the number below it: then equal words give what less does.
    of_equal = less == greater and equal != less
    equal_as_less = int32(1 if equal == less else 0)
    holds = C.COMPARISON_EQUAL if of_equal else C.COMPARISON_LESS
    low, high = int32(255), int32(255 << 16)
    lower = _outcome(function, holds, low), _outcome(function, C.COMPARISON_GREATER, low)
    upper = _outcome(function, holds, high), _outcome(function, C.COMPARISON_GREATER, high)
    for at in range(0, count, 32):
        weights0, weights1 = _two_weights(weights, at)
        reference0, reference1 = _two_weights(references, at)
        if not of_equal:
            reference0, reference1 = reference0 - equal_as_less, reference1 - equal_as_less
        one = _compared_footprint(pairs, first, weights0, reference0, at, of_equal, (lower, upper))
        other = _compared_footprint(pairs, first, weights1, reference1, at + 1, of_equal, (lower, upper))
        value = halves_of_lanes(one | (other << int32(16)))
        store(registers[plane], at, value)
        store(registers[plane + 1], at, value)
        store(registers[plane + 2], at, value)
        store(registers[plane + 3], at, value)


@kernel("void(i8,i8,i2[:,::1],i8)")
def make_signed(signed, count, registers, plane):
    """Bytes s + 128 become 2 s in the planes whose component ``signed`` (packed) marks with 0x80."""
    separate_function()
    for c in range(4):
        if (signed >> (8 * c)) & 128:
            values = registers[plane + c]
            for at in range(0, count, 32):
                store(values, at, (load_i16x32(values, at) << int16(1)) - int16(256))


@kernel("void(u4[::1],i8[::1],i4[:,::1],i8,i2[:,::1],i8)")
def filter_located(pairs, unit, located, count, registers, plane):
    """What ``locate`` found, filtered into the unit's four register planes from ``plane`` on."""
    separate_function()
    if unit[R.MAG_LINEAR]:
        fetch_linear(pairs, located, count, registers, plane)
    else:
        fetch_nearest(pairs, located, count, registers, plane)
    if unit[R.SIGNED]:
        make_signed(unit[R.SIGNED], count, registers, plane)


@kernel("void(u4[::1],i4[:,::1],i8[::1],UniTuple(i4[::1],3),i8,i4[:,::1],i2[:,::1],i8)")
def filter_mipmapped(pairs, levels, unit, fixed, count, located, registers, plane):
    """A unit whose filter or level depends on lambda, into four planes.

    ``fixed``: F of s and of t (``locate``), and lambda, 8 fraction bits.
    """
    separate_function()
    f_s, f_t, lod = fixed
    highest = locate_levels(levels, unit, f_s, f_t, lod, int32(0), count, located)
    if unit[R.MIPMAP] == C.MIPMAP_LINEAR and highest > max(unit[R.THRESHOLD], 0):
        locate_levels(levels, unit, f_s, f_t, lod, int32(1), count, located)
        fetch_blended(pairs, located, count, registers, plane)
    elif unit[R.MAG_LINEAR] or unit[R.MIN_LINEAR]:
        fetch_linear(pairs, located, count, registers, plane)
    else:
        fetch_nearest(pairs, located, count, registers, plane)
    if unit[R.SIGNED]:
        make_signed(unit[R.SIGNED], count, registers, plane)

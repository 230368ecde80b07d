"""Texture coordinates by vectors, up to the int32 columns that raster/vector/sample.py reads: counted in
texels as they are iterated, or computed from iterated ones (divided by q, of a cube map's face, compared as
depths).

The operations are those of raster/portable/interpolate.py, sample.py and shadow.py, in the same order, on
columns of float64, but where a function says why others give the same bits. Columns are whole vectors longer
than ``count`` asks for.
"""

from typing import NamedTuple

import numpy as np
from numba import boolean, float32, float64, int32, int64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import type_of
from fixedpipe.raster.fixed import float_depth, power_below
from fixedpipe.raster.floats import EXPONENT_BIAS, FRACTION_BITS
from fixedpipe.raster.kernel import bits_of, kernel, separate_function, separate_loop
from fixedpipe.raster.portable.interpolate import coordinate_difference, product_step, product_sum
from fixedpipe.raster.vector.interpolate import (
    EXACT_FROM,
    LARGEST_COORDINATE,
    LISTED,
    float_of_terms,
    power_of,
    sum_beside,
    terms_of,
)
from fixedpipe.raster.vector.lanes import (
    absolute,
    all_lanes,
    any_lane,
    bits_of_lanes,
    f64x16,
    floats_of_lanes,
    floored,
    i32x16,
    load_f32x16,
    load_f64x16,
    magnitude,
    maximum,
    minimum,
    narrow_i32,
    select,
    store,
    to_doubles,
    to_int32,
)
from fixedpipe.raster.vector.singles import single_coordinate, widen_weights

_FIXED = 8  # fraction bits of a texel coordinate
_LARGEST_STEPS = 2.0**30  # a difference in last bits: its products are int32


@kernel
def logarithm(power):
    """The logarithm of a power of two."""
    return int32((bits_of(power) >> int64(FRACTION_BITS)) - int64(EXPONENT_BIAS))


@kernel
def texels_of(largest, exponent, total, to_fixed):
    """(whether wrapping rounds, floor(256 u size)) of a coordinate u.

    to_fixed: the exponent, in a float64's place, by which 24 bits of the largest term and 256 size differ.
    """
    rounds = any_lane((largest < EXACT_FROM) & (total != 0.0))
    return rounds, to_int32(floored(total * floats_of_lanes(exponent + to_fixed)))


@kernel
def guessed_steps(q0, q2, v1, d0, d2):
    """How many units make one for a fragment's coordinate; 0 where ``beside_texels`` does not apply."""
    step, steps = product_step(v1, 1.0, q0, d0, q2, d2)
    largest = step * 2.0**23
    usual = largest >= EXACT_FROM and largest < LARGEST_COORDINATE * 4.0
    return steps if usual and max(abs(d0), abs(d2)) * steps < _LARGEST_STEPS else 0.0


@kernel
def beside_texels(weights, terms, highest, shifts):
    """Whether the guess of ``guessed_steps`` is right for sixteen fragments; if so, their floor(256 u size).

    weights  q0 and q2
    terms    v1, d0, d2: the vertices' numbers times the guess, v1 cut to an int32
    highest  the highest bit of each
    shifts   how far the terms' sum is shifted right and left to count 1/256 texels; one of them is zero

    A guess is a power of two, so that q d times it has the bits of ``terms_of``'s term, and a conversion to
    integers cuts it as ``truncated`` does. The guess is right exactly where the largest product of highest
    bits is 2**23. Then no term has more than 25 bits, and their sum has at most 27. The sum is cut to 24
    bits, and shifting is floor.
    """
    (q0, q2), (v1, d0, d2), (own, most0, most2), (right, left) = weights, terms, highest, shifts
    total = (v1 + to_int32(q0 * d0)) + to_int32(q2 * d2)
    largest = maximum(maximum(power_of(q0) * most0, power_of(q2) * most2), own)
    size = magnitude(total)
    if any_lane((size >> int32(24)) != int32(0)):
        size = select(size >= int32(1 << 24), size & int32(-2), size)
        size = select(size >= int32(1 << 25), size & int32(-4), size)
        size = select(size >= int32(1 << 26), size & int32(-8), size)
        total = select(total < int32(0), int32(0) - size, size)
    return all_lanes(largest == 2.0**23), (total >> right) << left


@kernel
def exact_steps(q0, q2, v1, d0, d2, size, repeat):
    """``texels_of`` for one fragment where wrapping rounds: every operation of the portable kernels.

    A nearest filter takes the same texel coordinate as a linear one.
    """
    t = product_sum(v1, 1.0, q0, d0, q2, d2) * size
    if repeat:
        t = t - size * np.floor(t * (1.0 / size))
        t = t if t > 0.0 else 0.0
        t = t if t < size else size
    return int32(int32(np.floor((t - 0.5) * 256.0)) + int32(128))


class Axis(NamedTuple):
    """A texture coordinate of a unit: 0 for s, 1 for t; log2 of the texture's size along it; whether it
    repeats.
    """

    unit: int
    component: int
    log2_size: int
    repeat: int


AXIS = type_of(Axis, int64, int64, int64, int64)


@kernel(void(LISTED, int32[:, ::1], float64[:, :, ::1], AXIS, float64[:, ::1], float32[:, ::1], int32[::1]))
def iterate_texels(segments, triangles, coordinates, axis, floats, singles, out):
    """floor(256 u size) of one texture coordinate into a column of int32."""
    separate_loop()
    unit, component, log2_size, repeat = axis
    starts, owners = segments.lists[R.STARTS], segments.lists[R.OWNERS]
    single = segments.lists[R.SINGLE]
    q0, q2 = floats[R.Q0], floats[R.Q2]
    first = R.TERMS + 12 * unit + 3 * component
    base, from0, from2 = floats[first], floats[first + 1], floats[first + 2]
    to_fixed, size = int64((log2_size + _FIXED - 23) << 52), float64(int64(1) << log2_size)
    for s in range(segments.count):
        t, begin, end = owners[s], int64(starts[s]), int64(starts[s + 1])
        if t < 0:
            for i in range(begin, end, 16):
                v1, d0, d2 = load_f64x16(base, i), load_f64x16(from0, i), load_f64x16(from2, i)
                w0, w2 = load_f64x16(q0, i), load_f64x16(q2, i)
                rounds, fixed = texels_of(*terms_of(w0, w2, v1, d0, d2), to_fixed)
                store(out, i, fixed)
                if rounds:
                    for k in range(i, min(i + 16, end)):
                        out[k] = exact_steps(q0[k], q2[k], base[k], from0[k], from2[k], size, repeat)
            continue
        c1 = coordinates[triangles[t, 1], unit, component]
        c0 = coordinate_difference(coordinates[triangles[t, 0], unit, component], c1)
        c2 = coordinate_difference(coordinates[triangles[t, 2], unit, component], c1)
        if single[s]:
            if single_coordinate(singles, 0, begin, end, (c1, c0, c2), log2_size + _FIXED):
                for i in range(begin, end, 16):
                    store(out, i, to_int32(floored(load_f32x16(singles[R.SINGLE_COORDINATE], i))))
                continue
            widen_weights(singles, floats, begin, end)
        v1, d0, d2 = f64x16(c1), f64x16(c0), f64x16(c2)
        i = begin
        while i < end:
            steps = guessed_steps(q0[i], q2[i], c1, c0, c2)
            if steps > 0.0:
                cut, e0, e2 = i32x16(int32(c1 * steps)), f64x16(c0 * steps), f64x16(c2 * steps)
                own = f64x16(power_below(c1 * steps))
                highest = own, f64x16(power_below(c0 * steps)), f64x16(power_below(c2 * steps))
                shift = int32(log2_size) + int32(_FIXED) - logarithm(steps)
                # The sum is below 2**27: shifted by 31 or more, it is its sign.
                shifts = min(max(int32(-shift), int32(0)), int32(31)), max(shift, int32(0))
                holds = True
                while holds and i < end:
                    here = load_f64x16(q0, i), load_f64x16(q2, i)
                    holds, fixed = beside_texels(here, (cut, e0, e2), highest, shifts)
                    if holds:
                        store(out, i, fixed)
                        i += 16
                if i >= end:
                    break
            rounds, fixed = texels_of(*terms_of(load_f64x16(q0, i), load_f64x16(q2, i), v1, d0, d2), to_fixed)
            store(out, i, fixed)
            if rounds:
                for k in range(i, min(i + 16, end)):
                    out[k] = exact_steps(q0[k], q2[k], c1, c0, c2, size, repeat)
            i += 16


ITERATED_FLOATS = void(
    LISTED, int32[:, ::1], float64[:, :, ::1], int64, int64, float64[:, ::1], float32[:, ::1], float64[::1]
)


@kernel(ITERATED_FLOATS)
def iterate_floats(segments, triangles, coordinates, unit, component, floats, singles, out):
    """One texture coordinate (0 to 3: s, t, r, q) into a column of float64."""
    separate_function()
    starts, owners = segments.lists[R.STARTS], segments.lists[R.OWNERS]
    single = segments.lists[R.SINGLE]
    q0, q2 = floats[R.Q0], floats[R.Q2]
    first = R.TERMS + 12 * unit + 3 * component
    base, from0, from2 = floats[first], floats[first + 1], floats[first + 2]
    for s in range(segments.count):
        t, begin, end = owners[s], int64(starts[s]), int64(starts[s + 1])
        if t < 0:
            for i in range(begin, end, 16):
                v1, d0, d2 = load_f64x16(base, i), load_f64x16(from0, i), load_f64x16(from2, i)
                terms = terms_of(load_f64x16(q0, i), load_f64x16(q2, i), v1, d0, d2)
                store(out, i, float_of_terms(*terms))
            continue
        c1 = coordinates[triangles[t, 1], unit, component]
        c0 = coordinate_difference(coordinates[triangles[t, 0], unit, component], c1)
        c2 = coordinate_difference(coordinates[triangles[t, 2], unit, component], c1)
        v1, d0, d2 = f64x16(c1), f64x16(c0), f64x16(c2)
        if c0 == 0.0 and c2 == 0.0:
            value = float_of_terms(*terms_of(d0, d2, v1, d0, d2))
            for i in range(begin, end, 16):
                store(out, i, value)
            continue
        if single[s]:
            if single_coordinate(singles, 0, begin, end, (c1, c0, c2), 0):
                for i in range(begin, end, 16):
                    store(out, i, to_doubles(load_f32x16(singles[R.SINGLE_COORDINATE], i)))
                continue
            widen_weights(singles, floats, begin, end)
        i = begin
        while i < end:
            step, steps = product_step(c1, 1.0, q0[i], c0, q2[i], c2)
            own, e0, e2 = f64x16(np.trunc(c1 * steps)), f64x16(c0 * steps), f64x16(c2 * steps)
            holds = True
            while holds and i < end:
                holds, total = sum_beside(load_f64x16(q0, i), load_f64x16(q2, i), own, e0, e2)
                if holds:
                    store(out, i, total * step)
                    i += 16
            if i < end:
                terms = terms_of(load_f64x16(q0, i), load_f64x16(q2, i), v1, d0, d2)
                store(out, i, float_of_terms(*terms))
                i += 16


@kernel(boolean(LISTED, int32[:, ::1], float64[:, :, ::1], int64, float32[:, ::1]))
def iterate_singles(segments, triangles, coordinates, unit, singles):
    """Whether s, t, r and q of a batch are float32; if so, they are in SINGLE_COORDINATE and behind it."""
    separate_function()
    starts, owners = segments.lists[R.STARTS], segments.lists[R.OWNERS]
    single = segments.lists[R.SINGLE]
    for s in range(segments.count):
        t, begin, end = owners[s], int64(starts[s]), int64(starts[s + 1])
        if t < 0 or not single[s]:
            return False
        for component in range(4):
            c1 = coordinates[triangles[t, 1], unit, component]
            c0 = coordinate_difference(coordinates[triangles[t, 0], unit, component], c1)
            c2 = coordinate_difference(coordinates[triangles[t, 2], unit, component], c1)
            if not single_coordinate(singles, component, begin, end, (c1, c0, c2), 0):
                return False
    return True


@kernel("void(f8[::1],f8[::1],f8[::1],i4[::1],i8)")
def cube_faces(s, t, r, face, count):
    """A direction's ``face``; sc/|ma| + 1 and tc/|ma| + 1 into s and t, 0
    where there is no direction. As fixedpipe.raster.portable.sample.cube_faces.
    """
    separate_function()
    face_x, face_y = i32x16(int32(C.FACE_POSITIVE_X)), i32x16(int32(C.FACE_POSITIVE_Y))
    face_z = i32x16(int32(C.FACE_POSITIVE_Z))
    for at in range(0, count, 16):
        x, y, z = load_f64x16(s, at), load_f64x16(t, at), load_f64x16(r, at)
        is_x = (absolute(x) >= absolute(y)) & (absolute(x) >= absolute(z))
        is_y = absolute(y) >= absolute(z)
        major = select(is_x, x, select(is_y, y, z))
        back = select(major >= 0.0, i32x16(int32(0)), i32x16(int32(1)))
        sign = select(major >= 0.0, f64x16(1.0), f64x16(-1.0))
        ma = major * sign
        sc = select(is_x, z * (sign * -1.0), select(is_y, x, x * sign))
        tc = select(is_x, y * -1.0, select(is_y, z * sign, y * -1.0))
        first = select(is_x, face_x, select(is_y, face_y, face_z))
        some = ma > 0.0
        store(face, at, first + back)
        store(s, at, select(some, sc / ma + 1.0, f64x16(0.0)))
        store(t, at, select(some, tc / ma + 1.0, f64x16(0.0)))


@kernel("void(f8[::1],i4[::1],f8,f8,f8,i8,i8,i8)")
def fixed_from_floats(column, out, size, bias, scale, wrap, linear, count):
    """F of a level of ``size`` texels, of any size, as ``sample.locate`` takes it.

    The texel coordinate is coordinate * (scale * size) + ``bias`` (``scale`` 1, or 1/2 for a cube face's
    doubled coordinates), or, for ``scale`` 0, coordinate + ``bias``; ``bias`` TAU or 0. ``wrap``: REPEAT,
    CLAMP_TO_EDGE or, where not ``linear``, CLAMP.
    """
    separate_loop()
    factor = scale * size if scale != 0.0 else 1.0
    inverse = 1.0 / size
    last = int32(int32(size) - int32(1))
    period = int32(int32(size) * int32(256))
    low, high = 0.0, size
    if wrap == C.WRAP_CLAMP_TO_EDGE:
        low, high = 0.5, size - 0.5
    for at in range(0, count, 16):
        texel = load_f64x16(column, at) * factor + bias
        if wrap == C.WRAP_REPEAT:
            texel = texel - floored(texel * inverse) * size
        texel = minimum(maximum(texel, low), high)  # low, too, where it is not a number
        if linear:
            fixed = to_int32(floored((texel - 0.5) * 256.0))
            fixed = select(fixed < int32(0), fixed + period, fixed) + int32(128)
        else:
            index = to_int32(texel)
            index = select(index > last, i32x16(int32(0) if wrap == C.WRAP_REPEAT else last), index)
            fixed = index << int32(8)
        store(out, at, fixed)


@kernel("void(f8[::1],i4[::1],f8,i8,i4,i8)")
def depth_words(column, out, scale, number_format, maximum_word, count):
    """The depth words that texels are compared with: a coordinate times ``scale``, in units, as
    fixedpipe.raster.portable.shadow.depth_word makes it.
    """
    separate_loop()
    largest = float64(maximum_word)
    if number_format == C.DEPTH_FIXED:
        for at in range(0, count, 16):
            value = maximum(load_f64x16(column, at) * scale, 0.0)
            store(out, at, to_int32(minimum(value, largest)))
        return
    form = float_depth(number_format)
    shift, zero = form.dropped, form.rebias
    for at in range(0, count, 16):
        value = maximum(load_f64x16(column, at) * scale, 0.0)
        bits = (bits_of_lanes(value) >> shift) - zero
        store(out, at, narrow_i32(minimum(maximum(bits, int64(0)), int64(maximum_word))))

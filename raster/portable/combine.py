"""Register combiners over a batch (NV_register_combiners, section 3.8.12; docs/numbers.md, section 8).

Registers are planes ``int16[REGISTERS * 4, batch]`` (red, green, blue, alpha of each register) of so many
``bits``, 8 to 12: at 8 they hold -256..255, and 255 = 1.0. Each loop below does one thing to whole planes;
``general_combiner`` and ``final_combiner`` decide which.
"""

from typing import NamedTuple

import numpy as np
from numba import int16, int32, int64, types, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import type_of
from fixedpipe.raster.fixed import clamp, divide, one_of
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop

_PLANES, _PRODUCTS = types.int16[:, ::1], types.int32[:, ::1]


class Input(NamedTuple):
    """What an input of a portion reads for one channel, and the packed coefficients of its mapping."""

    plane: int
    low: int
    factor: int
    addend: int


INPUT = type_of(Input, int64, int32, int32, int32)


class Output(NamedTuple):
    """How a portion's outputs are finished: bias, scale, the clamp's lower limit, when they are rounded
    (codes.ROUNDING_...).
    """

    bias: int
    scale: int
    low: int
    rounding: int


OUTPUT = type_of(Output, int32, int32, int32, int64)


class Room(NamedTuple):
    """Where a portion computes.

    products  int32[8, batch]
    total     int32[1, batch]
    results   int16[12, batch]
    """

    products: np.ndarray
    total: np.ndarray
    results: np.ndarray


ROOM = type_of(Room, _PRODUCTS, _PRODUCTS, _PLANES)


@kernel
def map_input(x, of, one):
    """Table NV_register_combiners.4: a component, mapped as an Input says."""
    return min(int32(int32(max(int32(x), of.low) * of.factor) + of.addend), one)


@kernel
def scaled(value, scale):
    """Times one, two, four, or one half as (x + 1) >> 1."""
    half = int32(int32(value + int32(1)) >> int32(1))
    return half if scale == C.SCALE_BY_ONE_HALF else int32(value << scale)


@kernel(void(_PLANES, INPUT, INPUT, int64, _PRODUCTS, int64, int64, int32))
def multiply(registers, a, b, count, products, out, per_product, bits):
    """Product of two inputs; exact, or rounded at once."""
    separate_loop()
    one, pa, pb, po = one_of(bits), uint64(a.plane), uint64(b.plane), uint64(out)
    if per_product:
        for i in range(count):
            x, y = map_input(registers[pa, i], a, one), map_input(registers[pb, i], b, one)
            products[po, i] = divide(int32(x * y), bits)
    else:
        for i in range(count):
            x, y = map_input(registers[pa, i], a, one), map_input(registers[pb, i], b, one)
            products[po, i] = int32(x * y)


@kernel("void(i4[:,::1],i8,i8)")
def sum_of_three(products, first, count):
    """A dot product from its three products, into the first of them."""
    separate_loop()
    p0, p1, p2 = uint64(first), uint64(first + 1), uint64(first + 2)
    for i in range(count):
        products[p0, i] = int32(int32(products[p0, i] + products[p1, i]) + products[p2, i])


@kernel("void(i4[:,::1],i8,i8,i8,i4[:,::1])")
def add(products, ab, cd, count, total):
    """AB + CD, before rounding."""
    separate_loop()
    pa, pc = uint64(ab), uint64(cd)
    for i in range(count):
        total[0, i] = int32(products[pa, i] + products[pc, i])


@kernel("void(i4[:,::1],i8,i8,i2[:,::1],i8,i4[:,::1],i4)")
def mux(products, ab, cd, registers, count, total, bit):
    """CD where SPARE0's alpha, clamped to [0, 1], has ``bit`` set (its highest, or its lowest), else AB.

    Measured: the selecting bit (combiner captures).
    """
    separate_loop()
    pa, pc = uint64(ab), uint64(cd)
    for i in range(count):
        selected = (max(int32(registers[C.REGISTER_SPARE0 * 4 + 3, i]), int32(0)) & bit) != int32(0)
        total[0, i] = products[pc, i] if selected else products[pa, i]


@kernel(void(_PRODUCTS, int64, int64, OUTPUT, _PLANES, int64, int32))
def finish(products, source, count, output, results, out, bits):
    """Rounding, bias, scale, clamp.

    Measured: bias before scale, saturation, one half of values >= 0 (combiner captures); low: a profile
    field.
    """
    separate_loop()
    bias, scale, low, rounding = output
    p, r, high = uint64(source), uint64(out), one_of(bits)
    if rounding == C.ROUNDING_AFTER_SCALE and scale == C.SCALE_BY_ONE_HALF:
        # rn(x/2 / one), ties upwards: floor((x + one) / (2 one)) = floor(((x + one) >> 1) / one); ``divide``
        # adds the half that is taken off here.
        less = int32(high >> int32(1))
        for i in range(count):
            halved = int32(int32(products[p, i] + high) >> int32(1))
            results[r, i] = int16(clamp(divide(int32(halved - less), bits), low, high))
    elif rounding == C.ROUNDING_AFTER_SCALE:
        factor = int32(int32(1) << scale)
        for i in range(count):
            value = int32(divide(int32(products[p, i] * factor), bits) + int32(bias * factor))
            results[r, i] = int16(clamp(value, low, high))
    elif rounding == C.ROUNDING_DONE:
        for i in range(count):
            results[r, i] = int16(clamp(scaled(int32(products[p, i] + bias), scale), low, high))
    else:  # ROUNDING_BEFORE_SCALE
        for i in range(count):
            value = scaled(int32(divide(products[p, i], bits) + bias), scale)
            results[r, i] = int16(clamp(value, low, high))


@kernel(void(_PLANES, INPUT, INPUT, int64, OUTPUT, _PLANES, int64, int32))
def one_product(registers, a, b, count, output, results, out, bits):
    """``finish(A B)`` in one loop (JOINT rounding before the scale)."""
    separate_loop()
    bias, scale, low, _rounding = output
    one, pa, pb, po = one_of(bits), uint64(a.plane), uint64(b.plane), uint64(out)
    for i in range(count):
        x, y = map_input(registers[pa, i], a, one), map_input(registers[pb, i], b, one)
        value = scaled(int32(divide(int32(x * y), bits) + bias), scale)
        results[po, i] = int16(clamp(value, low, one))


@kernel(void(_PLANES, types.UniTuple(INPUT, 4), int64, OUTPUT, _PLANES, int64, int32))
def sum_of_products(registers, inputs, count, output, results, out, bits):
    """``finish(A B + C D)`` in one loop: JOINT rounding before the scale, no mux, no dot product."""
    separate_loop()
    (a, b, c, d), (bias, scale, low, _rounding), one = inputs, output, one_of(bits)
    pa, pb, pc, pd, po = uint64(a.plane), uint64(b.plane), uint64(c.plane), uint64(d.plane), uint64(out)
    for i in range(count):
        x, y = map_input(registers[pa, i], a, one), map_input(registers[pb, i], b, one)
        z, w = map_input(registers[pc, i], c, one), map_input(registers[pd, i], d, one)
        value = scaled(int32(divide(int32(int32(x * y) + int32(z * w)), bits) + bias), scale)
        results[po, i] = int16(clamp(value, low, one))


@kernel("void(i2[:,::1],i8,i2[:,::1],i8,i8)")
def copy_plane(source, s, target, t, count):
    """Copy plane s of one array to plane t of another array, or to another plane of the same one."""
    separate_loop()
    ps, pt = uint64(s), uint64(t)
    for i in range(count):
        target[pt, i] = source[ps, i]


@kernel("void(i2[:,::1],i8,i8,i4)")
def fill_plane(planes, p, count, value):
    """Fill a plane."""
    separate_loop()
    at = uint64(p)
    for i in range(count):
        planes[at, i] = int16(value)


@kernel("void(i2[:,::1],i8,i8,i4,i4)")
def convert_plane(planes, p, count, bits, other):
    """A plane of components of ``bits`` bits, in place, to the nearest of ``other`` bits, halves up."""
    separate_loop()
    at, one = uint64(p), one_of(other)
    for i in range(count):
        planes[at, i] = int16(divide(int32(int32(planes[at, i]) * one), bits))


@kernel
def plane_of(row, at, channel):
    """Which plane the input at row[at] reads for a channel: its own, alpha or blue."""
    usage = row[at + 1]
    if usage == C.USAGE_RGB:
        return row[at] * 4 + channel
    return row[at] * 4 + (3 if usage == C.USAGE_ALPHA else 2)  # or USAGE_BLUE


@kernel
def input_at(row, at, plane):
    """The Input that is packed at row[at], and reads a plane."""
    return Input(int64(plane), row[at + 2], row[at + 3], row[at + 4])


@kernel
def input_of(row, number, channel):
    """The Input of a portion's variable A, B, C or D (``number`` 0 to 3) for a channel."""
    at = number * R.INPUT_SIZE
    return input_at(row, at, plane_of(row, at, channel))


@kernel
def output_of(row, arithmetic):
    """How a portion's outputs are finished."""
    after = C.ROUNDING_BEFORE_SCALE if arithmetic[1] else C.ROUNDING_AFTER_SCALE
    rounding = int64(C.ROUNDING_DONE if arithmetic[0] else after)
    return Output(row[R.BIAS], row[R.SCALE], arithmetic[2], rounding)


@kernel(void(_PLANES, types.UniTuple(int64, 2), int64, types.int32[::1], types.int32[::1], ROOM, int32))
def combine_portion(registers, channels, count, row, arithmetic, room, bits):
    """One portion of a general combiner, ``row`` int32[PORTION_SIZE], over channels from the first of two to
    before the second.

    The outputs AB, CD and sum go to planes 0.., 4.. and 8.. of ``room.results``.
    """
    separate_function()
    (first, last), (products, total, results) = channels, room
    per_product, output = arithmetic[0], output_of(row, arithmetic)
    ab_dot, cd_dot = row[R.AB_DOT] != 0, row[R.CD_DOT] != 0
    ab_out, cd_out, sum_out = row[R.AB_OUTPUT] >= 0, row[R.CD_OUTPUT] >= 0, row[R.SUM_OUTPUT] >= 0
    joint = output.rounding == C.ROUNDING_BEFORE_SCALE
    if joint and ab_out and not (cd_out or sum_out or ab_dot):
        for k in range(first, last):
            one_product(registers, input_of(row, 0, k), input_of(row, 1, k), count, output, results, k, bits)
        return
    if joint and sum_out and not (ab_out or cd_out or ab_dot or cd_dot or row[R.MUX]):
        for k in range(first, last):
            inputs = input_of(row, 0, k), input_of(row, 1, k), input_of(row, 2, k), input_of(row, 3, k)
            sum_of_products(registers, inputs, count, output, results, 8 + k, bits)
        return
    for k in range(first, last):
        if ab_out or sum_out:
            a, b = input_of(row, 0, k), input_of(row, 1, k)
            multiply(registers, a, b, count, products, k, per_product, bits)
        if cd_out or sum_out:
            c, d = input_of(row, 2, k), input_of(row, 3, k)
            multiply(registers, c, d, count, products, 4 + k, per_product, bits)
    if ab_dot and (ab_out or sum_out):
        sum_of_three(products, 0, count)
    if cd_dot and (cd_out or sum_out):
        sum_of_three(products, 4, count)
    for k in range(first, last):
        ab, cd = 0 if ab_dot else k, 4 if cd_dot else 4 + k
        if ab_out:
            if ab_dot and k > first:
                copy_plane(results, 0, results, k, count)
            else:
                finish(products, ab, count, output, results, k, bits)
        if cd_out:
            if cd_dot and k > first:
                copy_plane(results, 4, results, 4 + k, count)
            else:
                finish(products, cd, count, output, results, 4 + k, bits)
        if sum_out:
            if row[R.MUX]:
                mux(products, ab, cd, registers, count, total, row[R.MUX])
            else:
                add(products, ab, cd, count, total)
            finish(total, 0, count, output, results, 8 + k, bits)


@kernel("void(i2[:,::1],i4[:,::1],i8,i4[::1],i4[:,::1],i4[:,::1],i2[:,::1],i4)")
def general_combiner(registers, stage, count, arithmetic, products, total, results, bits):
    """One general combiner stage, in place: every output is written after every input is read.

    registers   int16[REGISTERS * 4, batch]
    stage       int32[2, PORTION_SIZE], RGB and alpha portion
    arithmetic  int32[3]: per product, round before scale, clamp low
    products int32[8, batch], total int32[1, batch], results int16[12, batch]: scratch
    """
    separate_function()
    room = Room(products, total, results)
    combine_portion(registers, (int64(0), int64(3)), count, stage[0], arithmetic, room, bits)
    combine_portion(registers, (int64(3), int64(4)), count, stage[1], arithmetic, room, bits)
    for output in range(3):
        rgb, alpha = stage[0, R.AB_OUTPUT + output], stage[1, R.AB_OUTPUT + output]
        if rgb >= 0:
            for k in range(3):
                copy_plane(results, 4 * output + k, registers, rgb * 4 + k, count)
            if output < 2 and stage[0, R.AB_BLUE + output]:
                copy_plane(results, 4 * output + 2, registers, rgb * 4 + 3, count)
        if alpha >= 0:
            copy_plane(results, 4 * output + 3, registers, alpha * 4 + 3, count)


@kernel
def map_final(x, invert, one):
    """UNSIGNED_IDENTITY or UNSIGNED_INVERT in the final combiner."""
    positive = max(int32(x), int32(0))
    return max(int32(one - positive), int32(0)) if invert else positive


@kernel
def final_input(final, number, channel):
    """(the plane, whether it is inverted) of the final combiner's variable A to G (``number`` 0 to 6)."""
    return int64(plane_of(final[number], 0, channel)), final[number, 2]


_FINAL_INPUT = types.Tuple((int64, int32))


@kernel(void(_PLANES, _FINAL_INPUT, _FINAL_INPUT, int64, _PLANES, int64, int32))
def multiply_e_f(registers, e, f, count, out, plane, bits):
    """E F, rounded. Measured: 136923 of 136923 pixels (combiner captures)."""
    separate_loop()
    pe, pf, po, one = uint64(e[0]), uint64(f[0]), uint64(plane), one_of(bits)
    invert_e, invert_f = e[1], f[1]
    for i in range(count):
        x, y = map_final(registers[pe, i], invert_e, one), map_final(registers[pf, i], invert_f, one)
        out[po, i] = int16(divide(int32(x * y), bits))


@kernel("void(i2[:,::1],i8,i8,i8,i2[:,::1],i8,i4)")
def sum_colors(registers, channel, count, flags, out, plane, bits):
    """SPARE0 + SECONDARY, or one minus either: an integer sum, clamped with the color sum clamp.

    Measured: combiner captures.
    """
    separate_loop()
    spare0, po = uint64(C.REGISTER_SPARE0 * 4 + channel), uint64(plane)
    secondary = uint64(C.REGISTER_SECONDARY_COLOR * 4 + channel)
    one = one_of(bits)
    limit = one if flags & C.COLOR_SUM_CLAMP else int32(int32(2) * one)
    invert_spare0 = int32((flags & C.COLOR_SUM_INVERT_SPARE0) != 0)
    invert_secondary = int32((flags & C.COLOR_SUM_INVERT_SECONDARY) != 0)
    for i in range(count):
        total = int32(
            map_final(registers[spare0, i], invert_spare0, one)
            + map_final(registers[secondary, i], invert_secondary, one)
        )
        out[po, i] = int16(min(total, limit))


@kernel(void(_PLANES, types.UniTuple(_FINAL_INPUT, 4), int64, _PLANES, int64, int32))
def final_rgb(registers, inputs, count, out, plane, bits):
    """clamp(rn(A B + (one - A) C) + D, 0, one)."""
    separate_loop()
    (a, invert_a), (b, invert_b), (c, invert_c), (d, invert_d) = inputs
    pa, pb, pc, pd, po, one = uint64(a), uint64(b), uint64(c), uint64(d), uint64(plane), one_of(bits)
    for i in range(count):
        ma = map_final(registers[pa, i], invert_a, one)
        ab = int32(ma * map_final(registers[pb, i], invert_b, one))
        rest = int32(int32(one - ma) * map_final(registers[pc, i], invert_c, one))
        total = int32(divide(int32(ab + rest), bits) + map_final(registers[pd, i], invert_d, one))
        out[po, i] = int16(min(total, one))


@kernel("void(i2[:,::1],i8,i8,i8,i2[:,::1],i8,i4)")
def final_alpha(registers, g, count, invert_g, out, plane, bits):
    """G, mapped."""
    separate_loop()
    pg, po, one = uint64(g), uint64(plane), one_of(bits)
    for i in range(count):
        out[po, i] = int16(map_final(registers[pg, i], invert_g, one))


@kernel("void(i2[:,::1],i4[:,::1],i8,i8,i8,i8,i2[:,::1],i4)")
def final_combiner(registers, final, count, uses_e_times_f, uses_sum, color_sum, out, bits):
    """The final combiner: ``final`` int32[7, FINAL_SIZE], result int16[12, batch] (planes 0..3), 0..one.

    The pseudo-registers are worked out in planes 4..11 of ``out`` and copied to their registers.
    """
    separate_function()
    for k in range(3):
        if uses_sum:
            sum_colors(registers, k, count, color_sum, out, 4 + k, bits)
        if uses_e_times_f:
            e, f = final_input(final, 4, k), final_input(final, 5, k)
            multiply_e_f(registers, e, f, count, out, 8 + k, bits)
    for k in range(3):
        if uses_sum:
            copy_plane(out, 4 + k, registers, C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR * 4 + k, count)
        if uses_e_times_f:
            copy_plane(out, 8 + k, registers, C.REGISTER_E_TIMES_F * 4 + k, count)
    for k in range(3):
        a, b = final_input(final, 0, k), final_input(final, 1, k)
        c, d = final_input(final, 2, k), final_input(final, 3, k)
        final_rgb(registers, (a, b, c, d), count, out, k, bits)
    final_alpha(registers, plane_of(final[6], 0, 3), count, final[6, 2], out, 3, bits)

"""Register combiners over a batch (NV_register_combiners, section 3.8.12; docs/numbers.md, section 8).

Registers are planes ``int16[REGISTERS * 4, batch]`` (red, green, blue, alpha of each register) of so many
``bits``, 8 to 12: at 8 they hold -256..255, and 255 = 1.0. Each loop below does one thing to whole planes;
``general_combiner`` and ``final_combiner`` decide which.
"""

from numba import int16, int32, uint64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import clamp, divide, one_of
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop


@kernel
def map_input(x, low, factor, addend, one):
    """Table NV_register_combiners.4 with the packed coefficients of a mapping."""
    return min(int32(int32(max(int32(x), low) * factor) + addend), one)


@kernel
def scaled(value, scale):
    """Times one, two, four, or one half as (x + 1) >> 1."""
    half = int32(int32(value + int32(1)) >> int32(1))
    return half if scale == C.SCALE_BY_ONE_HALF else int32(value << scale)


@kernel("void(i2[:,::1],i8,i8,i8,i4[::1],i8,i8,i4[:,::1],i8,i8,i4)")
def multiply(registers, a, b, count, row, input_a, input_b, products, out, per_product, bits):
    """Product of planes a and b, mapped as the portion's inputs say; exact, or rounded at once."""
    separate_loop()
    one = one_of(bits)
    pa, pb, po = uint64(a), uint64(b), uint64(out)
    la, fa, aa = row[input_a + 2], row[input_a + 3], row[input_a + 4]
    lb, fb, ab = row[input_b + 2], row[input_b + 3], row[input_b + 4]
    if per_product:
        for i in range(count):
            x = map_input(registers[pa, i], la, fa, aa, one)
            y = map_input(registers[pb, i], lb, fb, ab, one)
            products[po, i] = divide(int32(x * y), bits)
    else:
        for i in range(count):
            x = map_input(registers[pa, i], la, fa, aa, one)
            y = map_input(registers[pb, i], lb, fb, ab, one)
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


@kernel("void(i4[:,::1],i8,i8,i4,i4,i4,i8,i2[:,::1],i8,i4)")
def finish(products, source, count, bias, scale, low, rounding, results, out, bits):
    """Rounding, bias, scale, clamp.

    Measured: bias before scale, saturation, one half of values >= 0 (combiner captures); low: a profile
    field.
    """
    separate_loop()
    high = one_of(bits)
    p, r = uint64(source), uint64(out)
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


@kernel("void(i2[:,::1],i8,i8,i8,i4[::1],i4,i2[:,::1],i8,i4)")
def one_product(registers, a, b, count, row, low, results, out, bits):
    """``finish(A B)`` in one loop (JOINT rounding before the scale)."""
    separate_loop()
    pa, pb, po, n = uint64(a), uint64(b), uint64(out), R.INPUT_SIZE
    la, fa, aa, lb, fb, ab = row[2], row[3], row[4], row[n + 2], row[n + 3], row[n + 4]
    bias, scale, one = row[R.BIAS], row[R.SCALE], one_of(bits)
    for i in range(count):
        x, y = map_input(registers[pa, i], la, fa, aa, one), map_input(registers[pb, i], lb, fb, ab, one)
        value = scaled(int32(divide(int32(x * y), bits) + bias), scale)
        results[po, i] = int16(clamp(value, low, one))


@kernel("void(i2[:,::1],i8,i8,i8,i8,i8,i4[::1],i4,i2[:,::1],i8,i4)")
def sum_of_products(registers, a, b, c, d, count, row, low, results, out, bits):
    """``finish(A B + C D)`` in one loop: JOINT rounding before the scale, no mux, no dot product."""
    separate_loop()
    pa, pb, pc, pd, po = uint64(a), uint64(b), uint64(c), uint64(d), uint64(out)
    n = R.INPUT_SIZE
    la, fa, aa, lb, fb, ab = row[2], row[3], row[4], row[n + 2], row[n + 3], row[n + 4]
    lc, fc, ac, ld, fd, ad = (
        row[2 * n + 2],
        row[2 * n + 3],
        row[2 * n + 4],
        row[3 * n + 2],
        row[3 * n + 3],
        row[3 * n + 4],
    )
    bias, scale, one = row[R.BIAS], row[R.SCALE], one_of(bits)
    for i in range(count):
        x, y = map_input(registers[pa, i], la, fa, aa, one), map_input(registers[pb, i], lb, fb, ab, one)
        z, w = map_input(registers[pc, i], lc, fc, ac, one), map_input(registers[pd, i], ld, fd, ad, one)
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


@kernel("void(i2[:,::1],i8,i8,i8,i4[::1],i4[::1],i4[:,::1],i4[:,::1],i2[:,::1],i4)")
def combine_portion(registers, first, last, count, row, arithmetic, products, total, results, bits):
    """One portion of a general combiner, ``row`` int32[PORTION_SIZE], over channels first..last-1.

    The outputs AB, CD and sum go to planes 0.., 4.. and 8.. of ``results``.
    """
    separate_function()
    per_product, low = arithmetic[0], arithmetic[2]
    after = C.ROUNDING_BEFORE_SCALE if arithmetic[1] else C.ROUNDING_AFTER_SCALE
    rounding = C.ROUNDING_DONE if per_product else after
    bias, scale = row[R.BIAS], row[R.SCALE]
    ab_dot, cd_dot = row[R.AB_DOT] != 0, row[R.CD_DOT] != 0
    ab_out, cd_out, sum_out = row[R.AB_OUTPUT] >= 0, row[R.CD_OUTPUT] >= 0, row[R.SUM_OUTPUT] >= 0
    a, b, c, d = 0, R.INPUT_SIZE, 2 * R.INPUT_SIZE, 3 * R.INPUT_SIZE
    if ab_out and not (cd_out or sum_out or ab_dot) and rounding == C.ROUNDING_BEFORE_SCALE:
        for k in range(first, last):
            pa, pb = plane_of(row, a, k), plane_of(row, b, k)
            one_product(registers, pa, pb, count, row, low, results, k, bits)
        return
    products_alone = not (ab_out or cd_out or ab_dot or cd_dot or row[R.MUX])
    if sum_out and products_alone and rounding == C.ROUNDING_BEFORE_SCALE:
        for k in range(first, last):
            pa, pb, pc, pd = (
                plane_of(row, a, k),
                plane_of(row, b, k),
                plane_of(row, c, k),
                plane_of(row, d, k),
            )
            sum_of_products(registers, pa, pb, pc, pd, count, row, low, results, 8 + k, bits)
        return
    for k in range(first, last):
        if ab_out or sum_out:
            pa, pb = plane_of(row, a, k), plane_of(row, b, k)
            multiply(registers, pa, pb, count, row, a, b, products, k, per_product, bits)
        if cd_out or sum_out:
            pc, pd = plane_of(row, c, k), plane_of(row, d, k)
            multiply(registers, pc, pd, count, row, c, d, products, 4 + k, per_product, bits)
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
                finish(products, ab, count, bias, scale, low, rounding, results, k, bits)
        if cd_out:
            if cd_dot and k > first:
                copy_plane(results, 4, results, 4 + k, count)
            else:
                finish(products, cd, count, bias, scale, low, rounding, results, 4 + k, bits)
        if sum_out:
            if row[R.MUX]:
                mux(products, ab, cd, registers, count, total, row[R.MUX])
            else:
                add(products, ab, cd, count, total)
            finish(total, 0, count, bias, scale, low, rounding, results, 8 + k, bits)


@kernel("void(i2[:,::1],i4[:,::1],i8,i4[::1],i4[:,::1],i4[:,::1],i2[:,::1],i4)")
def general_combiner(registers, stage, count, arithmetic, products, total, results, bits):
    """One general combiner stage, in place: every output is written after every input is read.

    registers   int16[REGISTERS * 4, batch]
    stage       int32[2, PORTION_SIZE], RGB and alpha portion
    arithmetic  int32[3]: per product, round before scale, clamp low
    products int32[8, batch], total int32[1, batch], results int16[12, batch]: scratch
    """
    separate_function()
    combine_portion(registers, 0, 3, count, stage[0], arithmetic, products, total, results, bits)
    combine_portion(registers, 3, 4, count, stage[1], arithmetic, products, total, results, bits)
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


@kernel("void(i2[:,::1],i8,i8,i8,i8,i8,i2[:,::1],i8,i4)")
def multiply_e_f(registers, e, f, count, invert_e, invert_f, out, plane, bits):
    """E F, rounded. Measured: 136923 of 136923 pixels (combiner captures)."""
    separate_loop()
    pe, pf, po, one = uint64(e), uint64(f), uint64(plane), one_of(bits)
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


@kernel("void(i2[:,::1],i8,i8,i8,i8,i8,i4[:,::1],i2[:,::1],i8,i4)")
def final_rgb(registers, a, b, c, d, count, final, out, plane, bits):
    """clamp(rn(A B + (one - A) C) + D, 0, one)."""
    separate_loop()
    one = one_of(bits)
    pa, pb, pc, pd, po = uint64(a), uint64(b), uint64(c), uint64(d), uint64(plane)
    invert_a, invert_b, invert_c, invert_d = final[0, 2], final[1, 2], final[2, 2], final[3, 2]
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
            e, f = plane_of(final[4], 0, k), plane_of(final[5], 0, k)
            multiply_e_f(registers, e, f, count, final[4, 2], final[5, 2], out, 8 + k, bits)
    for k in range(3):
        if uses_sum:
            copy_plane(out, 4 + k, registers, C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR * 4 + k, count)
        if uses_e_times_f:
            copy_plane(out, 8 + k, registers, C.REGISTER_E_TIMES_F * 4 + k, count)
    for k in range(3):
        a, b = plane_of(final[0], 0, k), plane_of(final[1], 0, k)
        c, d = plane_of(final[2], 0, k), plane_of(final[3], 0, k)
        final_rgb(registers, a, b, c, d, count, final, out, k, bits)
    final_alpha(registers, plane_of(final[6], 0, 3), count, final[6, 2], out, 3, bits)

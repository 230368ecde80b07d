"""Register combiners over a batch (NV_register_combiners, section 3.8.12; docs/numbers.md, section 8).

Registers are planes ``int16[REGISTERS * 4, batch]`` (red, green, blue, alpha of each register), -256..255, 255 = 1.0.
Each loop below does one thing to whole planes; ``general_combiner`` and ``final_combiner`` decide which.
"""

from numba import int16, int32

from raster import rows as R
from raster.fixed import clamp, divide_255
from raster.kernel import kernel, separate_function, separate_loop


@kernel
def map_input(x, low, factor, addend):
    """Table NV_register_combiners.4 with the packed coefficients of a mapping."""
    return min(int32(int32(max(int32(x), low) * factor) + addend), int32(255))


@kernel("void(i2[::1],i2[::1],i8,i4[::1],i4[::1],i4[::1],i8)")
def multiply(a, b, count, map_a, map_b, out, per_product):
    """``a b``, exact, or rounded by 255 at once; inputs mapped."""
    separate_loop()
    la, fa, aa = map_a[2], map_a[3], map_a[4]
    lb, fb, ab = map_b[2], map_b[3], map_b[4]
    if per_product:
        for i in range(count):
            out[i] = divide_255(int32(map_input(a[i], la, fa, aa) * map_input(b[i], lb, fb, ab)))
    else:
        for i in range(count):
            out[i] = int32(map_input(a[i], la, fa, aa) * map_input(b[i], lb, fb, ab))


@kernel("void(i4[::1],i4[::1],i4[::1],i8)")
def sum_of_three(a, b, c, count):
    """A dot product from its three products, into all three."""
    separate_loop()
    for i in range(count):
        total = int32(int32(a[i] + b[i]) + c[i])
        a[i] = total
        b[i] = total
        c[i] = total


@kernel("void(i4[::1],i4[::1],i8,i4[::1])")
def add(a, b, count, out):
    """AB + CD, before rounding."""
    separate_loop()
    for i in range(count):
        out[i] = int32(a[i] + b[i])


@kernel("void(i4[::1],i4[::1],i2[::1],i8,i4[::1])")
def mux(ab, cd, selector, count, out):
    """CD where the selector (SPARE0 alpha, clamped to a byte) has its most significant bit set, else AB.

    Measured: the selecting bit (combiner captures).
    """
    separate_loop()
    for i in range(count):
        out[i] = cd[i] if selector[i] >= int16(128) else ab[i]


@kernel("void(i4[::1],i8,i4,i4,i4,i8,i2[::1])")
def finish(x, count, bias, scale, low, rounding, out):
    """Rounding, bias, scale, clamp. ``rounding``: 0 the value is rounded already, 1 before, 2 after the scale.

    Measured: bias before scale, saturation, one half of values >= 0 (combiner captures); low: a profile field.
    """
    separate_loop()
    high = int32(255)
    if rounding == 2 and scale != 0:
        if scale == 3:
            for i in range(count):  # rn(x/2 / 255), ties upwards: floor((x + 255) / 510)
                half = int32(int32(x[i] + int32(255 + 510 * 4096)) // int32(510))
                out[i] = int16(clamp(int32(half - int32(4096)), low, high))
        else:
            factor = int32(int32(1) << scale)
            for i in range(count):
                value = int32(divide_255(int32(x[i] * factor)) + int32(bias * factor))
                out[i] = int16(clamp(value, low, high))
        return
    if scale == 3:
        for i in range(count):
            value = x[i] if rounding == 0 else divide_255(x[i])
            out[i] = int16(clamp(int32(int32(value + int32(bias + 1)) >> int32(1)), low, high))
    else:
        for i in range(count):
            value = x[i] if rounding == 0 else divide_255(x[i])
            out[i] = int16(clamp(int32(int32(value + bias) << scale), low, high))


@kernel("void(i2[::1],i2[::1],i8)")
def copy_plane(source, target, count):
    """Copy a plane."""
    separate_loop()
    for i in range(count):
        target[i] = source[i]


@kernel("void(i2[::1],i8,i4)")
def fill_plane(plane, count, value):
    """Fill a plane."""
    separate_loop()
    for i in range(count):
        plane[i] = int16(value)


@kernel
def plane_of(row, channel):
    """Which plane a variable reads for a channel: its own, alpha (usage 1) or blue (usage 2)."""
    usage = row[1]
    return row[0] * 4 + (channel if usage == 0 else (3 if usage == 1 else 2))


@kernel("void(i2[:,::1],i8,i8,i8,i4[::1],i4[::1],i4[:,::1],i2[:,::1])")
def combine_portion(registers, first, last, count, row, arithmetic, products, results):
    """One portion of a general combiner, ``row`` int32[PORTION_SIZE], over channels first..last-1.

    The outputs AB, CD and sum go to planes 0.., 4.. and 8.. of ``results``.
    """
    separate_function()
    per_product, low = arithmetic[0], arithmetic[2]
    rounding = 0 if per_product else (1 if arithmetic[1] else 2)
    bias, scale = row[R.BIAS], row[R.SCALE]
    needs_ab = row[R.AB_OUTPUT] >= 0 or row[R.SUM_OUTPUT] >= 0
    needs_cd = row[R.CD_OUTPUT] >= 0 or row[R.SUM_OUTPUT] >= 0
    a, b = row[0 : R.INPUT_SIZE], row[R.INPUT_SIZE : 2 * R.INPUT_SIZE]
    c, d = row[2 * R.INPUT_SIZE : 3 * R.INPUT_SIZE], row[3 * R.INPUT_SIZE : 4 * R.INPUT_SIZE]
    for channel in range(first, last):
        if needs_ab:
            pa, pb = registers[plane_of(a, channel)], registers[plane_of(b, channel)]
            multiply(pa, pb, count, a, b, products[channel], per_product)
        if needs_cd:
            pc, pd = registers[plane_of(c, channel)], registers[plane_of(d, channel)]
            multiply(pc, pd, count, c, d, products[4 + channel], per_product)
    if needs_ab and row[R.AB_DOT]:
        sum_of_three(products[0], products[1], products[2], count)
    if needs_cd and row[R.CD_DOT]:
        sum_of_three(products[4], products[5], products[6], count)
    for channel in range(first, last):
        if row[R.AB_OUTPUT] >= 0:
            finish(products[channel], count, bias, scale, low, rounding, results[channel])
        if row[R.CD_OUTPUT] >= 0:
            finish(products[4 + channel], count, bias, scale, low, rounding, results[4 + channel])
        if row[R.SUM_OUTPUT] >= 0:
            if row[R.MUX]:
                mux(products[channel], products[4 + channel], registers[R.SPARE0 * 4 + 3], count, products[8])
            else:
                add(products[channel], products[4 + channel], count, products[8])
            finish(products[8], count, bias, scale, low, rounding, results[8 + channel])


@kernel("void(i2[:,::1],i4[:,::1],i8,i4[::1],i4[:,::1],i2[:,::1])")
def general_combiner(registers, stage, count, arithmetic, products, results):
    """One general combiner stage, in place: every output is written after every input is read.

    registers   int16[REGISTERS * 4, batch]
    stage       int32[2, PORTION_SIZE], RGB and alpha portion
    arithmetic  int32[3]: per product, round before scale, clamp low
    products    int32[9, batch] and results int16[12, batch]: scratch
    """
    separate_function()
    combine_portion(registers, 0, 3, count, stage[0], arithmetic, products, results)
    combine_portion(registers, 3, 4, count, stage[1], arithmetic, products, results)
    for output in range(3):
        rgb, alpha = stage[0, R.AB_OUTPUT + output], stage[1, R.AB_OUTPUT + output]
        if rgb >= 0:
            for channel in range(3):
                copy_plane(results[4 * output + channel], registers[rgb * 4 + channel], count)
        if alpha >= 0:
            copy_plane(results[4 * output + 3], registers[alpha * 4 + 3], count)


@kernel
def map_final(x, invert):
    """UNSIGNED_IDENTITY or UNSIGNED_INVERT in the final combiner."""
    positive = max(int32(x), int32(0))
    return int32(max(int32(int32(255) - positive), int32(0))) if invert else positive


@kernel("void(i2[::1],i2[::1],i8,i8,i8,i2[::1])")
def multiply_e_f(e, f, count, invert_e, invert_f, out):
    """E F, rounded. Measured: 136923 of 136923 pixels (combiner captures)."""
    separate_loop()
    for i in range(count):
        out[i] = int16(divide_255(int32(map_final(e[i], invert_e) * map_final(f[i], invert_f))))


@kernel("void(i2[::1],i2[::1],i8,i8,i2[::1])")
def sum_colors(spare0, secondary, count, clamped, out):
    """SPARE0 + SECONDARY: an integer sum, at most 255 with the color sum clamp. Measured: combiner captures."""
    separate_loop()
    limit = int32(255) if clamped else int32(510)
    for i in range(count):
        total = int32(max(int32(spare0[i]), int32(0)) + max(int32(secondary[i]), int32(0)))
        out[i] = int16(min(total, limit))


@kernel("void(i2[::1],i2[::1],i2[::1],i2[::1],i8,i8,i8,i8,i8,i2[::1])")
def final_rgb(a, b, c, d, count, invert_a, invert_b, invert_c, invert_d, out):
    """clamp(rn(A B + (255 - A) C) + D, 0, 255)."""
    separate_loop()
    for i in range(count):
        ma = map_final(a[i], invert_a)
        mixed = int32(int32(ma * map_final(b[i], invert_b)) + int32(int32(int32(255) - ma) * map_final(c[i], invert_c)))
        out[i] = int16(min(int32(divide_255(mixed) + map_final(d[i], invert_d)), int32(255)))


@kernel("void(i2[::1],i8,i8,i2[::1])")
def final_alpha(g, count, invert_g, out):
    """G, mapped."""
    separate_loop()
    for i in range(count):
        out[i] = int16(map_final(g[i], invert_g))


@kernel("void(i2[:,::1],i4[:,::1],i8,i8,i8,i8,i2[:,::1])")
def final_combiner(registers, final, count, uses_e_times_f, uses_sum, sum_clamp, out):
    """The final combiner: ``final`` int32[7, FINAL_SIZE], result int16[4, batch], 0..255."""
    separate_function()
    for channel in range(3):
        if uses_sum:
            sum_colors(
                registers[R.SPARE0 * 4 + channel],
                registers[R.SECONDARY * 4 + channel],
                count,
                sum_clamp,
                registers[R.SPARE0_PLUS_SECONDARY * 4 + channel],
            )
        if uses_e_times_f:
            e, f = plane_of(final[4], channel), plane_of(final[5], channel)
            multiply_e_f(registers[e], registers[f], count, final[4, 2], final[5, 2], registers[R.E_TIMES_F * 4 + channel])
    for channel in range(3):
        final_rgb(
            registers[plane_of(final[0], channel)],
            registers[plane_of(final[1], channel)],
            registers[plane_of(final[2], channel)],
            registers[plane_of(final[3], channel)],
            count,
            final[0, 2],
            final[1, 2],
            final[2, 2],
            final[3, 2],
            out[channel],
        )
    final_alpha(registers[plane_of(final[6], 3)], count, final[6, 2], out[3])

"""Register combiners over a batch as explicit vectors: the operations of a plan, one by one (docs/numbers.md,
section 8). ``pipeline/native/combiner_plan.py`` plans them.

An operation is one loop: it reads planes of ``int16[PLANES, batch + slack]``, maps them, computes, and writes
one plane. Planes 0..REGISTERS * 4 - 1 are the registers of ``raster/rows.py``; an operation writes to none
that holds a color, the fog or a texel, so that what was interpolated and sampled stays as it was. Unsigned
inputs, by far the most frequent, are multiplied in 16 bits, 32 fragments at a time; what is rare is left to
the loops of ``raster/portable/combine.py``.
"""

import numpy as np
from numba import int16, int32, int64, uint64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.portable import combine as portable
from fixedpipe.raster.vector.lanes import (
    add_saturated,
    i16x32,
    join_i32,
    load_i16x32,
    maximum,
    minimum,
    minimum_unsigned,
    narrow_i16,
    shift_right,
    store,
    upper_half,
    widen_i32,
)

# A plan: int32[operations, OPERATION_SIZE]. Up to six operands A..F in the layout of a portion's inputs:
# plane, what the mapping leaves to do (codes.MAPS_...), and the mapping min(max(x, low) * factor + addend,
# HIGHEST); a constant has the factor 0.
(OPERATION, TARGET, SECOND, ROUNDING, BIAS, SCALE, LOWEST, HIGHEST, MUX, OPERANDS) = range(10)
OPERATION_SIZE = OPERANDS + 6 * R.INPUT_SIZE
TOTAL = 8  # the scratch plane of a sum

PLANES = R.REGISTERS * 4 + R.SPARE_PLANES
SCRATCH_PLANES = 9


# Operands' numbers. Typed: a helper is compiled again for every literal that it is called with.
_A, _B, _C, _D, _E, _F = (np.int64(k) for k in range(6))


@kernel
def plane(row, k):
    """The plane that operand k reads."""
    return uint64(row[OPERANDS + R.INPUT_SIZE * k])


@kernel
def mapping(row, k):
    """Low, factor and addend of operand k, in all lanes."""
    at = OPERANDS + R.INPUT_SIZE * k
    return i16x32(int16(row[at + 2])), i16x32(int16(row[at + 3])), i16x32(int16(row[at + 4]))


@kernel
def mapped(x, low, factor, addend):
    """A mapping of 32 lanes."""
    return minimum(maximum(x, low) * factor + addend, 255)


@kernel
def at_most(row, operands, left):
    """Whether no mapping of the first ``operands`` leaves more to do than ``left``."""
    most = C.MAPS_NOTHING
    for k in range(operands):
        most = max(most, row[OPERANDS + R.INPUT_SIZE * k + 1])
    return most <= left


@kernel
def divide_bytes(n):
    """rn(n / 255) of unsigned 16-bit lanes up to 255 * 255: ``(u + (u >> 8)) >> 8`` with u = n + 128, which
    is exact and needs no seventeenth bit up to 65152. It is the upper half of 257 u = 256 u + u.
    """
    return upper_half(n + 128, 257)


BITS = int32(8)  # of registers: this engine has no other
_OFFSET = 8192  # fixedpipe.raster.fixed.divide adds it so that it divides positive numbers only


@kernel
def divide_sum(n):
    """``fixedpipe.raster.fixed.divide`` of 32-bit lanes by 255, without its last subtraction, in 16 bits."""
    u = n + int32(128 + 255 * _OFFSET)
    return narrow_i16(shift_right(u + shift_right(u + shift_right(u, 8), 8), 8))


@kernel
def ending(row, offset):
    """What ``ended`` needs of an operation: addend, the shifts of its scale, and the clamp."""
    half = int32(1) if row[SCALE] == C.SCALE_BY_ONE_HALF else int32(0)
    left = int32(0) if row[SCALE] == C.SCALE_BY_ONE_HALF else row[SCALE]
    return (
        i16x32(int16(row[BIAS] + half - offset)),
        i16x32(int16(left)),
        i16x32(int16(half)),
        i16x32(int16(row[LOWEST])),
        i16x32(int16(row[HIGHEST])),
    )


@kernel
def ended(value, addend, left, right, low, high):
    """Bias, scale and clamp of rounded 16-bit lanes; one half of x is (x + 1) >> 1."""
    return maximum(minimum(((value + addend) << left) >> right, high), low)


@kernel("void(i2[:,::1],i4[::1],i8)")
def modulate(registers, row, count):
    """MODULATE."""
    separate_loop()
    a, b, out = registers[plane(row, _A)], registers[plane(row, _B)], registers[uint64(row[TARGET])]
    la, fa, aa = mapping(row, _A)
    lb, fb, ab = mapping(row, _B)
    if at_most(row, 2, C.MAPS_NOTHING):
        for i in range(0, count, 32):
            store(out, i, divide_bytes(load_i16x32(a, i) * load_i16x32(b, i)))
        return
    for i in range(0, count, 32):
        x, y = mapped(load_i16x32(a, i), la, fa, aa), mapped(load_i16x32(b, i), lb, fb, ab)
        store(out, i, divide_bytes(x * y))


@kernel("void(i2[:,::1],i4[::1],i8)")
def add_bytes(registers, row, count):
    """ADD_BYTES: what exceeds 255 * 255 gives the same after the clamp, and is cut off in the sum."""
    separate_loop()
    a, b, c, d = (
        registers[plane(row, _A)],
        registers[plane(row, _B)],
        registers[plane(row, _C)],
        registers[plane(row, _D)],
    )
    out = registers[uint64(row[TARGET])]
    la, fa, aa = mapping(row, _A)
    lb, fb, ab = mapping(row, _B)
    lc, fc, ac = mapping(row, _C)
    ld, fd, ad = mapping(row, _D)
    addend, left, right, low, high = ending(row, int32(0))
    for i in range(0, count, 32):
        x, y = mapped(load_i16x32(a, i), la, fa, aa), mapped(load_i16x32(b, i), lb, fb, ab)
        z, w = mapped(load_i16x32(c, i), lc, fc, ac), mapped(load_i16x32(d, i), ld, fd, ad)
        total = minimum_unsigned(add_saturated(x * y, z * w), 255 * 255)
        store(out, i, ended(divide_bytes(total), addend, left, right, low, high))


@kernel("void(i2[:,::1],i4[::1],i8)")
def add_signed(registers, row, count):
    """ADD_SIGNED. Inputs reach HIGHEST where that is more than 255: sums of two colors that nobody clamps."""
    separate_loop()
    a, b, c, d = (
        registers[plane(row, _A)],
        registers[plane(row, _B)],
        registers[plane(row, _C)],
        registers[plane(row, _D)],
    )
    out = registers[uint64(row[TARGET])]
    la, fa, aa = mapping(row, _A)
    lb, fb, ab = mapping(row, _B)
    lc, fc, ac = mapping(row, _C)
    ld, fd, ad = mapping(row, _D)
    addend, left, right, low, high = ending(row, int32(_OFFSET))
    for i in range(0, count, 32):
        x = minimum(maximum(load_i16x32(a, i), la) * fa + aa, high)
        y = minimum(maximum(load_i16x32(b, i), lb) * fb + ab, high)
        z = minimum(maximum(load_i16x32(c, i), lc) * fc + ac, high)
        w = minimum(maximum(load_i16x32(d, i), ld) * fd + ad, high)
        total = widen_i32(x) * widen_i32(y) + widen_i32(z) * widen_i32(w)
        store(out, i, ended(divide_sum(total), addend, left, right, low, high))


@kernel("void(i2[:,::1],i4[::1],i8)")
def dot_product(registers, row, count):
    """DOT_PRODUCT."""
    separate_loop()
    a, b, c = registers[plane(row, _A)], registers[plane(row, _B)], registers[plane(row, _C)]
    d, e, f = registers[plane(row, _D)], registers[plane(row, _E)], registers[plane(row, _F)]
    out = registers[uint64(row[TARGET])]
    la, fa, aa = mapping(row, _A)
    lb, fb, ab = mapping(row, _B)
    lc, fc, ac = mapping(row, _C)
    ld, fd, ad = mapping(row, _D)
    le, fe, ae = mapping(row, _E)
    lf, ff, af = mapping(row, _F)
    addend, left, right, low, high = ending(row, int32(_OFFSET))
    if at_most(row, 6, C.MAPS_WITHIN):
        for i in range(0, count, 32):
            x0, y0 = load_i16x32(a, i) * fa + aa, load_i16x32(b, i) * fb + ab
            x1, y1 = load_i16x32(c, i) * fc + ac, load_i16x32(d, i) * fd + ad
            x2, y2 = load_i16x32(e, i) * fe + ae, load_i16x32(f, i) * ff + af
            total = widen_i32(x0) * widen_i32(y0) + widen_i32(x1) * widen_i32(y1)
            total = total + widen_i32(x2) * widen_i32(y2)
            store(out, i, ended(divide_sum(total), addend, left, right, low, high))
        return
    for i in range(0, count, 32):
        x0, y0 = mapped(load_i16x32(a, i), la, fa, aa), mapped(load_i16x32(b, i), lb, fb, ab)
        x1, y1 = mapped(load_i16x32(c, i), lc, fc, ac), mapped(load_i16x32(d, i), ld, fd, ad)
        x2, y2 = mapped(load_i16x32(e, i), le, fe, ae), mapped(load_i16x32(f, i), lf, ff, af)
        total = widen_i32(x0) * widen_i32(y0) + widen_i32(x1) * widen_i32(y1) + widen_i32(x2) * widen_i32(y2)
        store(out, i, ended(divide_sum(total), addend, left, right, low, high))


@kernel("void(i2[:,::1],i4[::1],i8)")
def lerp(registers, row, count):
    """LERP: the final combiner's equation."""
    separate_loop()
    a, b, c, d = (
        registers[plane(row, _A)],
        registers[plane(row, _B)],
        registers[plane(row, _C)],
        registers[plane(row, _D)],
    )
    out = registers[uint64(row[TARGET])]
    la, fa, aa = mapping(row, _A)
    lb, fb, ab = mapping(row, _B)
    lc, fc, ac = mapping(row, _C)
    ld, fd, ad = mapping(row, _D)
    for i in range(0, count, 32):
        x, y = mapped(load_i16x32(a, i), la, fa, aa), mapped(load_i16x32(b, i), lb, fb, ab)
        z, w = mapped(load_i16x32(c, i), lc, fc, ac), mapped(load_i16x32(d, i), ld, fd, ad)
        store(out, i, minimum(divide_bytes(x * y + (255 - x) * z) + w, 255))


@kernel("void(i2[:,::1],i4[::1],i8,u4[::1])")
def pack(registers, row, count, packed):
    """PACK."""
    separate_loop()
    a, b, c, d = (
        registers[plane(row, _A)],
        registers[plane(row, _B)],
        registers[plane(row, _C)],
        registers[plane(row, _D)],
    )
    la, fa, aa = mapping(row, _A)
    lb, fb, ab = mapping(row, _B)
    lc, fc, ac = mapping(row, _C)
    ld, fd, ad = mapping(row, _D)
    if at_most(row, 4, C.MAPS_NOTHING):
        for i in range(0, count, 32):
            low, high = (
                load_i16x32(a, i) | (load_i16x32(b, i) << 8),
                load_i16x32(c, i) | (load_i16x32(d, i) << 8),
            )
            store(packed, i, join_i32(low, high))
        return
    for i in range(0, count, 32):
        red, green = mapped(load_i16x32(a, i), la, fa, aa), mapped(load_i16x32(b, i), lb, fb, ab)
        blue, alpha = mapped(load_i16x32(c, i), lc, fc, ac), mapped(load_i16x32(d, i), ld, fd, ad)
        store(packed, i, join_i32(red | (green << 8), blue | (alpha << 8)))


@kernel("void(i2[:,::1],i4[:,::1],i8,i4[:,::1],u4[::1])")
def combine(registers, plan, count, scratch, packed):
    """Run a plan over the ``count`` fragments of a batch: general combiners and the final combiner.

    registers  int16[PLANES, batch + slack]: in, the planes that the plan reads (the colors, the fog factor
               and the texels; constants are part of the plan); out, those that hold no such thing are
               undefined
    plan       int32[operations, OPERATION_SIZE] (``fixedpipe.pipeline.native.combiner_plan.plan_combiners``)
    scratch    int32[SCRATCH_PLANES, batch + slack]
    packed     uint32[batch + slack]: out, the fragments' colors, red in the low byte

    Works on whole vectors of 32 fragments, so up to 31 past ``count`` are computed as well.
    """
    separate_function()
    for k in range(plan.shape[0]):
        row = plan[k]
        operation = row[OPERATION]
        if operation == C.PLAN_MODULATE:
            modulate(registers, row, count)
        elif operation == C.PLAN_ADD_BYTES:
            add_bytes(registers, row, count)
        elif operation == C.PLAN_ADD_SIGNED:
            add_signed(registers, row, count)
        elif operation == C.PLAN_DOT_PRODUCT:
            dot_product(registers, row, count)
        elif operation == C.PLAN_LERP:
            lerp(registers, row, count)
        elif operation == C.PLAN_PACK:
            pack(registers, row, count, packed)
        elif operation == C.PLAN_MULTIPLY:
            a = portable.input_at(row, OPERANDS, row[OPERANDS])
            b = portable.input_at(row, OPERANDS + R.INPUT_SIZE, row[OPERANDS + R.INPUT_SIZE])
            rounded = int64(1 if row[ROUNDING] == C.ROUNDING_DONE else 0)
            portable.multiply(registers, a, b, count, scratch, row[TARGET], rounded, BITS)
        elif operation == C.PLAN_SUM_OF_THREE:
            portable.sum_of_three(scratch, row[TARGET], count)
        elif operation == C.PLAN_SUM_OF_TWO:
            portable.add(scratch, row[TARGET], row[SECOND], count, scratch[TOTAL:])
        elif operation == C.PLAN_SELECT:
            portable.copy_plane(registers, row[OPERANDS], registers, C.REGISTER_SPARE0 * 4 + 3, count)
            portable.mux(scratch, row[TARGET], row[SECOND], registers, count, scratch[TOTAL:], row[MUX])
        else:  # PLAN_FINISH
            output = portable.Output(row[BIAS], row[SCALE], row[LOWEST], int64(row[ROUNDING]))
            portable.finish(scratch, row[SECOND], count, output, registers, row[TARGET], BITS)

"""Per-fragment operations in OpenGL's order: the only kernels that write to a framebuffer.

Fragments lie in columns; a run is a piece of one row of one triangle, so its pixels are distinct and a loop
over it may be vectorised; runs follow each other in draw order. Colour is ``uint32[height, width]``, red in
the low byte; where components are wider, ``uint32[height, 4 * width]``.
"""

from numba import int32, int64, types, uint8, uint32, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BUFFERS, RUN, RUNS, STATE, Run
from fixedpipe.raster.fixed import clamp, divide, one_of
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop

_U8, _I32, _I64, _U32 = types.uint8[::1], types.int32[::1], types.int64[::1], types.uint32[::1]
_WORDS, _COLORS, _FACTORS = types.uint32[:, ::1], types.int16[:, ::1], types.int32[:, ::1]


@kernel
def passes(function, value, reference):
    """``value FUNC reference``: whether the function's code has the bit of how the two compare."""
    less, equal, greater = int32(C.COMPARISON_LESS), int32(C.COMPARISON_EQUAL), int32(C.COMPARISON_GREATER)
    relation = less if value < reference else (equal if value == reference else greater)
    return int32(function & relation) != int32(0)


@kernel("void(i2[::1],i8,i4,i4,u1[::1])")
def alpha_test(alpha, count, function, reference, alive):
    """Section 4.1.3, on whole numbers. Measured: alpha test captures."""
    separate_loop()
    for i in range(count):
        alive[i] = uint8(alive[i] & uint8(passes(function, int32(alpha[i]), reference)))


@kernel("void(i4[::1],i8,u1[::1])")
def depth_limits(depth, count, alive):
    """A fragment whose depth lies outside the limits ends. Measured: DepthFmt_z24 FZy captures."""
    separate_loop()
    for i in range(count):
        alive[i] = uint8(alive[i] & uint8(depth[i] >= int32(0)))


@kernel
def stencil_result(stored, mask, xor, addend, low, high):
    """A stencil operation as coefficients: clamp(((s & and) ^ xor) + add, low, high), wrapped to 8 bits."""
    value = int32(int32(int32(stored & mask) ^ xor) + addend)
    return int32(min(max(value, low), high) & int32(255))


@kernel(void(types.uint8[:, ::1], _WORDS, RUN, _U8, _I32, _I64))
def stencil_run(stencil, depth_buffer, run, alive, depth, draw):
    """Stencil test, then depth test, of one run; ``alive`` in and out."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    function, mask = int32(draw[R.STENCIL_FUNCTION]), int32(draw[R.STENCIL_MASK])
    reference = int32(int32(draw[R.STENCIL_REFERENCE]) & mask)
    write = int32(draw[R.STENCIL_WRITE_MASK])
    keep = int32(int32(255) - write)
    depth_function = int32(draw[R.DEPTH_FUNCTION])
    needs_depth, depth_write = draw[R.NEEDS_DEPTH], draw[R.DEPTH_WRITE]
    f, z, p = R.STENCIL_FAIL, R.STENCIL_DEPTH_FAIL, R.STENCIL_DEPTH_PASS
    fa, fx, fd, fl, fh = (
        int32(draw[f]),
        int32(draw[f + 1]),
        int32(draw[f + 2]),
        int32(draw[f + 3]),
        int32(draw[f + 4]),
    )
    za, zx, zd, zl, zh = (
        int32(draw[z]),
        int32(draw[z + 1]),
        int32(draw[z + 2]),
        int32(draw[z + 3]),
        int32(draw[z + 4]),
    )
    pa, px, pd, pl, ph = (
        int32(draw[p]),
        int32(draw[p + 1]),
        int32(draw[p + 2]),
        int32(draw[p + 3]),
        int32(draw[p + 4]),
    )
    for i in range(run.count):
        k = uint64(i)
        stored = int32(stencil[row, at + k])
        living = int32(alive[here + k])
        stencil_passes = int32(living & int32(passes(function, reference, int32(stored & mask))))
        both = stencil_passes
        if needs_depth:
            value, old = depth[here + k], int32(depth_buffer[row, at + k])
            both = int32(stencil_passes & int32(passes(depth_function, value, old)))
            if depth_write:
                depth_buffer[row, at + k] = uint32(value if both else old)
        failed = stencil_result(stored, fa, fx, fd, fl, fh)
        behind = stencil_result(stored, za, zx, zd, zl, zh)
        passed = stencil_result(stored, pa, px, pd, pl, ph)
        result = passed if both else (behind if stencil_passes else failed)
        result = int32(int32(result & write) | int32(stored & keep))
        stencil[row, at + k] = uint8(result if living else stored)
        alive[here + k] = uint8(both)


@kernel(void(_WORDS, RUN, _U8, _I32, int32, int64))
def depth_run(depth_buffer, run, alive, depth, function, write):
    """Depth test of one run without stencil; ``alive`` in and out. Measured: Depth_buffer captures."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    for i in range(run.count):
        k = uint64(i)
        value, old = depth[here + k], int32(depth_buffer[row, at + k])
        passed = int32(int32(alive[here + k]) & int32(passes(function, value, old)))
        alive[here + k] = uint8(passed)
        if write:
            depth_buffer[row, at + k] = uint32(value if passed else old)


@kernel("void(i2[:,::1],i8,u4[::1])")
def pack_colors(colors, count, out):
    """Four planes of 0..255 to packed bytes."""
    separate_loop()
    red, green, blue, alpha = colors[0], colors[1], colors[2], colors[3]
    for i in range(count):
        low = uint32(uint32(red[i]) | uint32(uint32(green[i]) << uint32(8)))
        high = uint32(uint32(uint32(blue[i]) << uint32(16)) | uint32(uint32(alpha[i]) << uint32(24)))
        out[i] = uint32(low | high)


@kernel
def saturating_add(s, d):
    """min(255, s + d) of each byte of two packed colours: ONE, ONE, FUNC_ADD."""
    mask, eight = uint32(0x00FF00FF), uint32(8)
    even = uint32(uint32(s & mask) + uint32(d & mask))
    odd = uint32(uint32(uint32(s >> eight) & mask) + uint32(uint32(d >> eight) & mask))
    even = uint32(even | uint32(uint32(uint32(even >> eight) & uint32(0x00010001)) * uint32(255)))
    odd = uint32(odd | uint32(uint32(uint32(odd >> eight) & uint32(0x00010001)) * uint32(255)))
    return uint32(uint32(even & mask) | uint32(uint32(odd & mask) << eight))


@kernel
def logic(operation, s, d):
    """Table 4.3: the operation's bits are the results for (s, d) = (1, 1), (1, 0), (0, 1), (0, 0)."""
    m0 = uint32(uint32(0) - uint32(operation & 1))
    m1 = uint32(uint32(0) - uint32((operation >> 1) & 1))
    m2 = uint32(uint32(0) - uint32((operation >> 2) & 1))
    m3 = uint32(uint32(0) - uint32((operation >> 3) & 1))
    not_s, not_d = uint32(~s), uint32(~d)
    both = uint32(uint32(uint32(s & d) & m0) | uint32(uint32(s & not_d) & m1))
    return uint32(both | uint32(uint32(uint32(not_s & d) & m2) | uint32(uint32(not_s & not_d) & m3)))


@kernel
def logic_of(operation, s, d, one):
    """``logic`` on a component."""
    return int32(logic(operation, uint32(s), uint32(d)) & uint32(one))


@kernel
def blend_factor(row, at, s, d, sa, da, saturate):
    """One channel's factor: the packed masks select its terms; the last one inverts it.

    row[at..]: masks for S, D, As, Ad, the saturate term; a constant byte; xor 255 for ONE_MINUS.
    """
    colors = int32(int32(s & row[at]) | int32(d & row[at + 1]))
    alphas = int32(int32(sa & row[at + 2]) | int32(da & row[at + 3]))
    rest = int32(int32(saturate & row[at + 4]) | row[at + 5])
    return int32(int32(int32(colors | alphas) | rest) ^ row[at + 6])


@kernel
def blend_equation(equation, s, fs, d, fd, bits):
    """Section 4.1.6 on components of ``bits`` bits: one rounding after the sum. Measured: bytes, 176504832 of
    176504832 pixels (Blend captures).
    """
    if equation == C.EQUATION_MIN:
        return min(s, d)
    if equation == C.EQUATION_MAX:
        return max(s, d)
    source, destination = int32(s * fs), int32(d * fd)
    if equation == C.EQUATION_FUNC_SUBTRACT:
        total = int32(source - destination)
    elif equation == C.EQUATION_FUNC_REVERSE_SUBTRACT:
        total = int32(destination - source)
    else:  # EQUATION_FUNC_ADD; the two signed ones are the surface's
        total = int32(source + destination)
    return min(divide(max(total, int32(0)), bits), one_of(bits))


@kernel
def byte_of(packed, shift):
    """One byte of a packed colour."""
    return int32(uint32(packed >> uint32(shift)) & uint32(255))


@kernel
def merge(packed, old, mask, living):
    """What to store: ``packed`` through the color mask where the fragment lives, else ``old``."""
    masked = uint32(uint32(packed & mask) | uint32(old & uint32(~mask)))
    return masked if living != uint8(0) else old


@kernel(void(_WORDS, RUN, _U32, _U8, _FACTORS, int64, uint32))
def blend_run(color, run, source, alive, factors, equation, mask):
    """Blend one run into the framebuffer. factors int32[2, 4 * FACTOR_SIZE]: source, destination."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    fs, fd = factors[0], factors[1]
    for i in range(run.count):
        s, d = source[here + uint64(i)], color[row, at + uint64(i)]
        sr, sg, sb, sa = byte_of(s, 0), byte_of(s, 8), byte_of(s, 16), byte_of(s, 24)
        dr, dg, db, da = byte_of(d, 0), byte_of(d, 8), byte_of(d, 16), byte_of(d, 24)
        low = min(sa, int32(int32(255) - da))
        fr, er = blend_factor(fs, 0, sr, dr, sa, da, low), blend_factor(fd, 0, sr, dr, sa, da, low)
        fg, eg = (
            blend_factor(fs, R.FACTOR_SIZE, sg, dg, sa, da, low),
            blend_factor(fd, R.FACTOR_SIZE, sg, dg, sa, da, low),
        )
        fb, eb = (
            blend_factor(fs, 2 * R.FACTOR_SIZE, sb, db, sa, da, low),
            blend_factor(fd, 2 * R.FACTOR_SIZE, sb, db, sa, da, low),
        )
        one, bits = int32(255), int32(8)
        fa, ea = (
            blend_factor(fs, 3 * R.FACTOR_SIZE, sa, da, sa, da, one),
            blend_factor(fd, 3 * R.FACTOR_SIZE, sa, da, sa, da, one),
        )
        r, g = (
            uint32(blend_equation(equation, sr, fr, dr, er, bits)),
            uint32(blend_equation(equation, sg, fg, dg, eg, bits)),
        )
        b, a = (
            uint32(blend_equation(equation, sb, fb, db, eb, bits)),
            uint32(blend_equation(equation, sa, fa, da, ea, bits)),
        )
        packed = uint32(
            uint32(r | uint32(g << uint32(8))) | uint32(uint32(b << uint32(16)) | uint32(a << uint32(24)))
        )
        color[row, at + uint64(i)] = merge(packed, d, mask, alive[here + uint64(i)])


@kernel(void(_WORDS, RUN, _U32, _U8, uint32))
def write_run(color, run, source, alive, mask):
    """Replace one run of the framebuffer."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    for i in range(run.count):
        old = color[row, at + uint64(i)]
        color[row, at + uint64(i)] = merge(source[here + uint64(i)], old, mask, alive[here + uint64(i)])


@kernel(void(_WORDS, RUN, _U32, _U8, uint32))
def add_run(color, run, source, alive, mask):
    """Blending with ONE, ONE, FUNC_ADD."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    for i in range(run.count):
        old = color[row, at + uint64(i)]
        total = saturating_add(source[here + uint64(i)], old)
        color[row, at + uint64(i)] = merge(total, old, mask, alive[here + uint64(i)])


@kernel(void(_WORDS, RUN, _U32, _U8, int64, uint32))
def logic_run(color, run, source, alive, operation, mask):
    """Logic operation."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    for i in range(run.count):
        old = color[row, at + uint64(i)]
        result = logic(operation, source[here + uint64(i)], old)
        color[row, at + uint64(i)] = merge(result, old, mask, alive[here + uint64(i)])


@kernel(void(_WORDS, RUN, _U32))
def store_run(color, run, source):
    """Write one run in which every fragment lives, unmasked."""
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    for i in range(run.count):
        color[row, at + uint64(i)] = source[here + uint64(i)]


@kernel
def read_surface(word, alpha):
    """A surface's word as a packed colour, what it does not keep zero; ``alpha``: rows.SURFACE_ALPHA.

    Measured: Blend_surface captures.
    """
    if alpha == C.SURFACE_ALPHA_ONE:
        return uint32(word | uint32(0xFF000000))
    if alpha == C.SURFACE_ALPHA_SEVEN_BITS:
        seven = uint32(uint32(word >> uint32(24)) & uint32(0x7F))
        replicated = uint32(uint32(seven << uint32(1)) | uint32(seven >> uint32(6)))
        return uint32(uint32(word & uint32(0x00FFFFFF)) | uint32(replicated << uint32(24)))
    return word  # SURFACE_ALPHA_STORED


@kernel
def to_surface(packed, keep, pad, alpha):
    """A packed colour as a surface's word: its lower bits cut off, its padding filled in.

    Measured: Blend_surface captures.
    """
    if alpha == C.SURFACE_ALPHA_SEVEN_BITS:
        half = uint32(uint32(packed >> uint32(1)) & uint32(0x7F000000))
        packed = uint32(uint32(packed & uint32(0x00FFFFFF)) | half)
    return uint32(uint32(packed & keep) | pad)


@kernel
def any_equation(equation, s, fs, d, fd, bits):
    """As ``blend_equation``, and the signed two: the source as a two's complement, no factors.

    Measured: the Blend captures' SADD and SREVSUB. Not in ``blend_equation``, where it would cost every other
    equation 4 %.
    """
    adds = equation == C.EQUATION_FUNC_ADD_SIGNED
    if adds or equation == C.EQUATION_FUNC_REVERSE_SUBTRACT_SIGNED:
        sign = int32(int32(1) << int32(bits - 1))
        signed = int32(s - int32(int32(s & sign) << int32(1)))
        return clamp(int32(d + (signed if adds else int32(-signed))), int32(0), one_of(bits))
    return blend_equation(equation, s, fs, d, fd, bits)


@kernel
def blend_channel(equation, factors, at, s, d, terms, bits):
    """One channel of a blended colour.

    ``factors``: int32[4 * FACTOR_SIZE] of the source and of the destination; ``terms``: what they select
    beside the channel itself, both alphas and the saturate term.
    """
    sa, da, saturate = terms
    source = blend_factor(factors[0], at, s, d, sa, da, saturate)
    destination = blend_factor(factors[1], at, s, d, sa, da, saturate)
    return any_equation(equation, s, source, d, destination, bits)


@kernel
def blended(s, d, factors, equation):
    """Two packed colours blended by any equation, into a packed colour."""
    sa, da, one, bits, size = byte_of(s, 24), byte_of(d, 24), int32(255), int32(8), R.FACTOR_SIZE
    terms = sa, da, min(sa, int32(one - da))
    red = blend_channel(equation, factors, 0, byte_of(s, 0), byte_of(d, 0), terms, bits)
    green = blend_channel(equation, factors, size, byte_of(s, 8), byte_of(d, 8), terms, bits)
    blue = blend_channel(equation, factors, 2 * size, byte_of(s, 16), byte_of(d, 16), terms, bits)
    alpha = blend_channel(equation, factors, 3 * size, sa, da, (sa, da, one), bits)
    lower = uint32(uint32(red) | uint32(uint32(green) << uint32(8)))
    return uint32(lower | uint32(uint32(uint32(blue) << uint32(16)) | uint32(uint32(alpha) << uint32(24))))


@kernel(void(_WORDS, RUN, _U32, _U8, _FACTORS, _I64))
def surface_run(color, run, source, alive, factors, draw):
    """Write, blend or combine by a logic operation one run of a surface that does not keep four bytes, or
    blend by a signed equation.
    """
    separate_loop()
    row, at, here = uint64(run.y), uint64(run.x), uint64(run.start)
    both = factors[0], factors[1]
    mode, equation, operation = draw[R.BLEND], draw[R.BLEND_EQUATION], draw[R.LOGIC_OPERATION]
    mask, keep, pad = uint32(draw[R.COLOR_MASK]), uint32(draw[R.SURFACE_KEEP]), uint32(draw[R.SURFACE_PAD])
    alpha = draw[R.SURFACE_ALPHA]
    for i in range(run.count):
        s, old = source[here + uint64(i)], color[row, at + uint64(i)]
        if mode == C.BLEND_GENERAL:
            cut = uint32(s & uint32(keep | uint32(0xFF000000)))
            result = to_surface(blended(cut, read_surface(old, alpha), both, equation), keep, pad, alpha)
        else:
            result = to_surface(s, keep, pad, alpha)
            if mode == C.BLEND_LOGIC:
                result = uint32(uint32(logic(operation, result, old) & keep) | pad)
        color[row, at + uint64(i)] = merge(result, old, mask, alive[here + uint64(i)])


@kernel
def put_component(color, row, at, value, mask, living):
    """Store a component of a wide pixel, where its ``mask`` is on and the fragment lives."""
    if living & mask:
        color[row, at] = uint32(value)


@kernel(void(_WORDS, RUN, _COLORS, _U8, int64))
def wide_write_run(color, run, colors, alive, mask):
    """Replace one run of a buffer whose pixels are four words, a component each."""
    separate_loop()
    row, here = uint64(run.y), uint64(run.start)
    for i in range(run.count):
        k, at, living = here + uint64(i), uint64(4 * (run.x + i)), int64(alive[here + uint64(i)])
        put_component(color, row, at, colors[0, k], mask, living)
        put_component(color, row, at + uint64(1), colors[1, k], mask >> 8, living)
        put_component(color, row, at + uint64(2), colors[2, k], mask >> 16, living)
        put_component(color, row, at + uint64(3), colors[3, k], mask >> 24, living)


@kernel(void(_WORDS, RUN, _COLORS, _U8, _FACTORS, _I64))
def wide_blend_run(color, run, colors, alive, factors, draw):
    """Blend one run into such a buffer, or combine it by a logic operation."""
    separate_loop()
    row, here, size = uint64(run.y), uint64(run.start), R.FACTOR_SIZE
    both = factors[0], factors[1]
    mode, equation, operation = draw[R.BLEND], draw[R.BLEND_EQUATION], draw[R.LOGIC_OPERATION]
    bits, mask = int32(draw[R.BUFFER_BITS]), draw[R.COLOR_MASK]
    one = one_of(bits)
    for i in range(run.count):
        k, at = here + uint64(i), uint64(4 * (run.x + i))
        sr, sg, sb, sa = int32(colors[0, k]), int32(colors[1, k]), int32(colors[2, k]), int32(colors[3, k])
        dr, dg = int32(color[row, at]), int32(color[row, at + uint64(1)])
        db, da = int32(color[row, at + uint64(2)]), int32(color[row, at + uint64(3)])
        if mode == C.BLEND_ADD:
            sr, sg = min(int32(sr + dr), one), min(int32(sg + dg), one)
            sb, sa = min(int32(sb + db), one), min(int32(sa + da), one)
        elif mode == C.BLEND_LOGIC:
            sr, sg = logic_of(operation, sr, dr, one), logic_of(operation, sg, dg, one)
            sb, sa = logic_of(operation, sb, db, one), logic_of(operation, sa, da, one)
        else:  # BLEND_GENERAL
            terms = sa, da, min(sa, int32(one - da))
            sr = blend_channel(equation, both, 0, sr, dr, terms, bits)
            sg = blend_channel(equation, both, size, sg, dg, terms, bits)
            sb = blend_channel(equation, both, 2 * size, sb, db, terms, bits)
            sa = blend_channel(equation, both, 3 * size, sa, da, (sa, da, one), bits)
        living = int64(alive[k])
        put_component(color, row, at, sr, mask, living)
        put_component(color, row, at + uint64(1), sg, mask >> 8, living)
        put_component(color, row, at + uint64(2), sb, mask >> 16, living)
        put_component(color, row, at + uint64(3), sa, mask >> 24, living)


@kernel("void(u1[::1],i8)")
def all_alive(alive, count):
    """Mark a batch's fragments alive."""
    separate_loop()
    for i in range(count):
        alive[i] = uint8(1)


@kernel(void(STATE, int64, RUNS, _COLORS, _U32, _I32, _U8, BUFFERS))
def per_fragment(state, count, runs, colors, packed, depth, alive, buffers):
    """Alpha, stencil and depth test, blending or logic operation, and masks, of a batch.

    colors int16[4, batch] (0..one), depth int32[batch] (-1: outside its limits); scratch: packed
    uint32[batch]; alive uint8[batch]: what shading left where it DISCARDS, afterwards which fragments passed.
    """
    separate_function()
    (color, depth_buffer, stencil), draw, factors = buffers, state.draw, state.factors
    if not draw[R.DISCARDS]:
        all_alive(alive, count)
    if draw[R.ALPHA_TEST]:
        alpha_test(colors[3], count, int32(draw[R.ALPHA_FUNCTION]), int32(draw[R.ALPHA_REFERENCE]), alive)
    if draw[R.DEPTH_CULL]:
        depth_limits(depth, count, alive)
    tested = draw[R.ALPHA_TEST] != 0 or draw[R.DISCARDS] != 0 or draw[R.DEPTH_CULL] != 0
    writes = draw[R.NEEDS_COLOR] and draw[R.COLOR_MASK] != 0
    wide = draw[R.BUFFER_BITS] != R.BITS_OF_BYTES
    if writes and not wide:
        pack_colors(colors, count, packed)
    mask = uint32(draw[R.COLOR_MASK])
    mode = draw[R.BLEND]
    for k in range(runs.count):
        start = int64(runs.starts[k])
        run = Run(int64(runs.x[k]), int64(runs.y[k]), int64(runs.starts[k + 1]) - start, start)
        if draw[R.STENCIL_TEST]:
            stencil_run(stencil, depth_buffer, run, alive, depth, draw)
            tested = True
        elif draw[R.NEEDS_DEPTH]:
            depth_run(depth_buffer, run, alive, depth, int32(draw[R.DEPTH_FUNCTION]), draw[R.DEPTH_WRITE])
            tested = True
        if writes:
            if wide and mode == C.BLEND_REPLACE:
                wide_write_run(color, run, colors, alive, draw[R.COLOR_MASK])
            elif wide:
                wide_blend_run(color, run, colors, alive, factors, draw)
            elif draw[R.SURFACE]:
                surface_run(color, run, packed, alive, factors, draw)
            elif mode == C.BLEND_GENERAL:
                blend_run(color, run, packed, alive, factors, draw[R.BLEND_EQUATION], mask)
            elif mode == C.BLEND_ADD:
                add_run(color, run, packed, alive, mask)
            elif mode == C.BLEND_LOGIC:
                logic_run(color, run, packed, alive, draw[R.LOGIC_OPERATION], mask)
            elif tested or mask != uint32(0xFFFFFFFF):  # BLEND_REPLACE, as what follows
                write_run(color, run, packed, alive, mask)
            else:
                store_run(color, run, packed)

"""Per-fragment operations of the vector engine: the results of ``fixedpipe.raster.portable.per_fragment`` for
two shapes of batch.

A *run* is a piece of a row and goes 16 or 32 pixels at a time. In a *mixed* stretch, of many small triangles,
each fragment names its pixel, and the loops go fragment by fragment: two of them may name the same pixel, and
the earlier one comes first. Whatever is rare is left to the loops of
``fixedpipe.raster.portable.per_fragment``, run by run.
"""

from numba import int16, int32, int64, uint8, uint32, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BUFFERS, RUNS
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.portable import per_fragment as portable
from fixedpipe.raster.vector.addresses import words_at
from fixedpipe.raster.vector.combine import divide_bytes
from fixedpipe.raster.vector.lanes import (
    add_saturated,
    below,
    bytes_of,
    bytes_of_lanes,
    distinct_lanes,
    halves_of_lanes,
    i16x4,
    i32x16,
    lanes_of_bytes,
    lanes_of_halves,
    load_each_i32x16,
    load_i32x16,
    load_i32x16_where,
    load_i32x32,
    load_u8x16,
    load_u8x32,
    mask_bits,
    maximum,
    minimum,
    minimum_unsigned,
    narrow_u8,
    packed_of,
    quarters_of,
    ramp_i32x16,
    select,
    shift_right,
    store,
    store_where,
    widen_unsigned_i16,
)

_FAR_DEPTH = 1 << 30  # two depth words differ by less
_FAR_BYTE = 1 << 14  # and two bytes by less than this
_BLENDED = 8  # pixels: shorter runs take longer to prepare than to blend one by one


@kernel
def interval(function, far):
    """(first, width) so that ``value FUNC reference`` is ``value - reference - first < width`` of unsigned
    numbers that wrap; ``far``: more than the two differ by. ``function``: see ``portable.passes``.
    """
    first, width = int64(0), int64(far)
    if function == C.COMPARISON_NEVER:
        width = int64(0)
    elif function == C.COMPARISON_EQUAL:
        width = int64(1)
    elif function & C.COMPARISON_LESS:
        first = int64(-far)
        if function == C.COMPARISON_NOTEQUAL:
            first, width = int64(1), int64(-1)
        elif function & C.COMPARISON_EQUAL:
            width = int64(far + 1 if function == C.COMPARISON_LEQUAL else 2 * far)
    elif function == C.COMPARISON_GREATER:
        first = int64(1)
    return first, width


# -------------------------------------------------------------------------------------------- hidden pixels


@kernel
def tests_early(draw):
    """Whether a fragment that fails the depth test now can be left out before it is shaded.

    It has no effect then: no stencil operation waits for its failure, and what fails beside the depths of now
    fails at its turn too. For until then depths change by this Draw's fragments alone, each of which passes:
    with LESS, LEQUAL, GREATER and GEQUAL they move away from what failed, with EQUAL they stay, and
    so they do where none is written.
    """
    function, still = draw[R.DEPTH_FUNCTION], draw[R.DEPTH_WRITE] == 0
    useful = draw[R.NEEDS_DEPTH] != 0 and draw[R.NEEDS_COLOR] != 0 and function != C.COMPARISON_ALWAYS
    return useful and draw[R.STENCIL_TEST] == 0 and (still or function != C.COMPARISON_NOTEQUAL)


@kernel("boolean(u4[::1],i4[::1],i4[::1],i8,i8,i8)")
def are_hidden(depth_words, pixel, depth, start, count, function):
    """Whether none of ``count`` fragments from ``start`` passes the depth test, each at its ``pixel``."""
    separate_function()
    first, width = interval(function, _FAR_DEPTH)
    low, near = int32(first), int32(width)
    whole = start + (count & ~15)
    for i in range(start, whole, 16):
        value, old = load_i32x16(depth, i), load_each_i32x16(depth_words, pixel, i)
        if mask_bits(below(value - old - low, near)) != 0:
            return False
    for i in range(whole, start + count):
        old = depth_words[uint64(pixel[i])]
        if uint32(uint32(depth[i]) - old - uint32(low)) < uint32(near):
            return False
    return True


@kernel("boolean(u4[::1],i8,i4[::1],i8,i8,i8)")
def is_hidden(depth_row, x, depth, start, count, function):
    """The same of a run from ``x`` of a row."""
    separate_function()
    first, width = interval(function, _FAR_DEPTH)
    low, near = int32(first), int32(width)
    whole = count & ~15
    for i in range(0, whole, 16):
        value, old = load_i32x16(depth, start + i), load_i32x16(depth_row, x + i)
        if mask_bits(below(value - old - low, near)) != 0:
            return False
    for i in range(whole, count):
        old = depth_row[uint64(x + i)]
        if uint32(uint32(depth[uint64(start + i)]) - old - uint32(low)) < uint32(near):
            return False
    return True


# ------------------------------------------------------------------------------------------------- blending


@kernel
def factor(terms, s, d, sa, da, saturate):
    """``portable.blend_factor`` of every lane: seven masks as there, of each lane's own channel."""
    m0, m1, m2, m3, m4, constant, invert = terms
    return ((s & m0) | (d & m1) | (sa & m2) | (da & m3) | (saturate & m4) | constant) ^ invert


@kernel
def blend_lanes(source, destination, s, d, sa, da, saturate):
    """S Fs + D Fd of byte values in 16-bit lanes, rounded once, at most 255: FUNC_ADD."""
    total = add_saturated(
        s * factor(source, s, d, sa, da, saturate), d * factor(destination, s, d, sa, da, saturate)
    )
    return divide_bytes(minimum_unsigned(total, 255 * 255))


@kernel
def pair_of_terms(row, at, low):
    """An entry of the factors of channels ``low`` and ``low + 2``, in the halves of 32-bit lanes."""
    n = R.FACTOR_SIZE
    return halves_of_lanes(i32x16(int32(row[n * low + at] | (row[n * (low + 2) + at] << 16))))


@kernel
def terms_of_two(row, low):
    """All entries of two channels' factors."""
    return (
        pair_of_terms(row, int64(0), low),
        pair_of_terms(row, int64(1), low),
        pair_of_terms(row, int64(2), low),
        pair_of_terms(row, int64(3), low),
        pair_of_terms(row, int64(4), low),
        pair_of_terms(row, int64(5), low),
        pair_of_terms(row, int64(6), low),
    )


@kernel
def four_of_terms(row, at):
    """An entry of the four channels' factors."""
    n = R.FACTOR_SIZE
    low = int64(row[at]) | (int64(row[n + at]) << 16)
    return quarters_of(low | (int64(row[2 * n + at]) << 32) | (int64(row[3 * n + at]) << 48))


@kernel
def terms_of_four(row):
    """All entries of the four channels' factors."""
    return (
        four_of_terms(row, int64(0)),
        four_of_terms(row, int64(1)),
        four_of_terms(row, int64(2)),
        four_of_terms(row, int64(3)),
        four_of_terms(row, int64(4)),
        four_of_terms(row, int64(5)),
        four_of_terms(row, int64(6)),
    )


@kernel
def blend_colors(s, d, even_source, even_destination, odd_source, odd_destination):
    """Sixteen packed colors, blended: red and blue, then green and alpha."""
    pairs = int32(0x00FF00FF)
    sa, da = shift_right(s, 24), shift_right(d, 24)
    least = minimum(sa, 255 - da)
    alphas, others = halves_of_lanes(sa | (sa << 16)), halves_of_lanes(da | (da << 16))
    saturate = least | (least << 16)
    even = blend_lanes(
        even_source,
        even_destination,
        halves_of_lanes(s & pairs),
        halves_of_lanes(d & pairs),
        alphas,
        others,
        halves_of_lanes(saturate),
    )
    odd = blend_lanes(
        odd_source,
        odd_destination,
        halves_of_lanes(shift_right(s, 8) & pairs),
        halves_of_lanes(shift_right(d, 8) & pairs),
        alphas,
        others,
        halves_of_lanes(saturate | int32(255 << 16)),  # alpha's term is one
    )
    return lanes_of_halves(even) | (lanes_of_halves(odd) << 8)


@kernel("void(u4[::1],i8,i8,u4[::1],u1[::1],i8,i4[:,::1],u4)")
def blend_run(row, x, count, source, alive, start, factors, mask):
    """``portable.blend_run`` with FUNC_ADD, of a row of the framebuffer."""
    separate_loop()
    even_source, odd_source = terms_of_two(factors[0], int64(0)), terms_of_two(factors[0], int64(1))
    even_destination, odd_destination = terms_of_two(factors[1], int64(0)), terms_of_two(factors[1], int64(1))
    written = i32x16(int32(mask))
    for i in range(0, count, 16):
        lanes = ramp_i32x16() < int32(count - i)
        s, d = load_i32x16(source, start + i), load_i32x16_where(row, x + i, lanes)
        result = blend_colors(s, d, even_source, even_destination, odd_source, odd_destination)
        passed = lanes & (load_u8x16(alive, start + i) != 0)
        store_where(row, x + i, d ^ ((d ^ result) & written), passed)


@kernel
def add_packed(s, d):
    """ONE, ONE, FUNC_ADD of two packed colors."""
    return packed_of(add_saturated(bytes_of(s), bytes_of(d)))


# ------------------------------------------------------------------------------------------------------ runs


@kernel("void(u4[::1],u4[::1],i8,i8,u4[::1],i4[::1],u1[::1],i8,i8[::1])")
def depth_and_write(depth_row, color_row, x, count, source, depth, alive, start, draw):
    """Depth test and replacing, or blending with ONE, ONE, FUNC_ADD, of one run."""
    separate_loop()
    first, width = interval(draw[R.DEPTH_FUNCTION], _FAR_DEPTH)
    low, near = int32(first), int32(width)
    writes_depth, adds = draw[R.DEPTH_WRITE] != 0, draw[R.BLEND] == C.BLEND_ADD
    mask = uint32(draw[R.COLOR_MASK])
    whole = count & ~15
    for i in range(0, whole, 16):
        value, old = load_i32x16(depth, start + i), load_i32x16(depth_row, x + i)
        passed = (load_u8x16(alive, start + i) != 0) & below(value - old - low, near)
        if writes_depth:
            store(depth_row, x + i, select(passed, value, old))
        s, d = load_i32x16(source, start + i), load_i32x16(color_row, x + i)
        if adds:
            s = lanes_of_bytes(add_saturated(bytes_of_lanes(s), bytes_of_lanes(d)))
        store(color_row, x + i, select(passed, d ^ ((d ^ s) & int32(mask)), d))
    for i in range(whole, count):
        k, at = uint64(start + i), uint64(x + i)
        old, d, s = depth_row[at], color_row[at], source[k]
        if alive[k] and uint32(uint32(depth[k]) - old - uint32(low)) < uint32(near):
            if writes_depth:
                depth_row[at] = uint32(depth[k])
            if adds:
                s = add_packed(s, d)
            color_row[at] = portable.merge(s, d, mask, uint8(1))


@kernel
def coefficients(draw, at):
    """The coefficients of a stencil operation."""
    return (
        int16(draw[at]),
        int16(draw[at + 1]),
        int16(draw[at + 2]),
        int16(draw[at + 3]),
        int16(draw[at + 4]),
    )


@kernel
def operated(stored, operation):
    """``portable.stencil_result`` of 16-bit lanes."""
    kept, flipped, addend, low, high = operation
    return minimum(maximum(((stored & kept) ^ flipped) + addend, low), high) & 255


@kernel("void(u1[::1],u4[::1],i8,i8,u1[::1],i8,i4[::1],i8[::1])")
def stencil_run(stencil_row, depth_row, x, count, alive, start, depth, draw):
    """``portable.stencil_run`` of a multiple of 32 pixels of a row."""
    separate_loop()
    first, width = interval(draw[R.STENCIL_FUNCTION], _FAR_BYTE)
    mask = int16(draw[R.STENCIL_MASK])
    reference = int16((draw[R.STENCIL_REFERENCE] & draw[R.STENCIL_MASK]) - first)
    range_ = int16(width)
    first_depth, width_depth = interval(draw[R.DEPTH_FUNCTION], _FAR_DEPTH)
    low, range_depth = int32(first_depth), int32(width_depth)
    needs_depth, writes_depth = draw[R.NEEDS_DEPTH] != 0, draw[R.DEPTH_WRITE] != 0
    write = int16(draw[R.STENCIL_WRITE_MASK])
    fail = coefficients(draw, R.STENCIL_FAIL)
    behind = coefficients(draw, R.STENCIL_DEPTH_FAIL)
    passing = coefficients(draw, R.STENCIL_DEPTH_PASS)
    for i in range(0, count, 32):
        before = load_u8x32(stencil_row, x + i)
        stored, living = widen_unsigned_i16(before), load_u8x32(alive, start + i)
        is_alive = living != 0
        stencil_passes = is_alive & below(reference - (stored & mask), range_)
        both = stencil_passes
        if needs_depth:
            value, old = load_i32x32(depth, start + i), load_i32x32(depth_row, x + i)
            both = stencil_passes & below(value - old - low, range_depth)
            if writes_depth:
                store(depth_row, x + i, select(both, value, old))
        result = select(
            both,
            operated(stored, passing),
            select(stencil_passes, operated(stored, behind), operated(stored, fail)),
        )
        result = stored ^ ((stored ^ result) & write)
        store(stencil_row, x + i, select(is_alive, narrow_u8(result), before))
        store(alive, start + i, select(both, living, living ^ living))


# ------------------------------------------------------------------------------------------ mixed fragments


@kernel("void(u4[::1],i4[::1],i8,i8,i4[::1],u1[::1],i8,i8)")
def scatter_depth(depth_buffer, pixel, start, end, depth, alive, function, write):
    """Depth test of fragments start..end-1, in order; ``alive`` in and out.

    depth_buffer  uint32[height * width], as every framebuffer array here
    pixel         int32[.]: y * width + x of each fragment
    depth         int32[.]: depth words
    """
    separate_loop()
    first64, width64 = interval(function, _FAR_DEPTH)
    first, width = int32(first64), uint32(width64)
    for i in range(start, end):
        k = uint64(i)
        at = uint64(pixel[k])
        value, old = depth[k], int32(depth_buffer[at])
        near = uint32(int32(int32(value - old) - first)) < width
        passed = uint8(alive[k] & uint8(near))
        alive[k] = passed
        if write:
            depth_buffer[at] = uint32(value if passed else old)


@kernel("void(u4[::1],i4[::1],i8,i8,u4[::1],u1[::1],u4)")
def scatter_write(color, pixel, start, end, source, alive, mask):
    """Replace the pixels of living fragments start..end-1, in order."""
    separate_loop()
    for i in range(start, end):
        k = uint64(i)
        at = uint64(pixel[k])
        color[at] = portable.merge(source[k], color[at], mask, alive[k])


@kernel("void(u4[::1],i4[::1],i8,i8,u4[::1],u1[::1],u4)")
def scatter_add(color, pixel, start, end, source, alive, mask):
    """Blending with ONE, ONE, FUNC_ADD of living fragments start..end-1, in order."""
    separate_loop()
    for i in range(start, end):
        k = uint64(i)
        at = uint64(pixel[k])
        old = color[at]
        color[at] = portable.merge(add_packed(source[k], old), old, mask, alive[k])


@kernel("void(u4[::1],i4[::1],i8,i8,u4[::1],u1[::1],i4[:,::1],u4)")
def scatter_blend_few(color, pixel, start, end, source, alive, factors, mask):
    """``scatter_blend`` one by one: where pixels meet, or for less than a vector of them."""
    separate_loop()
    of_source, of_destination = terms_of_four(factors[0]), terms_of_four(factors[1])
    top = quarters_of(int64(255) << 48)  # alpha's saturate term is one
    for i in range(start, end):
        k = uint64(i)
        at = uint64(pixel[k])
        fragment, old = source[k], color[at]
        sa, da = int32(fragment >> uint32(24)), int32(old >> uint32(24))
        s, d = widen_unsigned_i16(bytes_of(fragment)), widen_unsigned_i16(bytes_of(old))
        least = i16x4(int16(min(sa, int32(255 - da)))) | top
        result = blend_lanes(of_source, of_destination, s, d, i16x4(int16(sa)), i16x4(int16(da)), least)
        color[at] = portable.merge(packed_of(narrow_u8(result)), old, mask, alive[k])


@kernel("void(u4[::1],i4[::1],i8,i8,u4[::1],u1[::1],i4[:,::1],u4)")
def scatter_blend(color, pixel, start, end, source, alive, factors, mask):
    """``portable.blend_run`` with FUNC_ADD of living fragments start..end-1, in order.

    Sixteen at a time where no two of them have one pixel; ``source`` is then overwritten.
    """
    separate_loop()
    even_source, odd_source = terms_of_two(factors[0], int64(0)), terms_of_two(factors[0], int64(1))
    even_destination, odd_destination = terms_of_two(factors[1], int64(0)), terms_of_two(factors[1], int64(1))
    whole = start + ((end - start) & ~15)
    for i in range(start, whole, 16):
        if not distinct_lanes(load_i32x16(pixel, i)):
            scatter_blend_few(color, pixel, i, i + 16, source, alive, factors, mask)
            continue
        s, d = load_i32x16(source, i), load_each_i32x16(color, pixel, i)
        result = blend_colors(s, d, even_source, even_destination, odd_source, odd_destination)
        store(source, i, d ^ ((d ^ result) & int32(mask)))
        for j in range(i, i + 16):
            k = uint64(j)
            at = uint64(pixel[k])
            color[at] = source[k] if alive[k] else color[at]
    if whole < end:
        scatter_blend_few(color, pixel, whole, end, source, alive, factors, mask)


# ------------------------------------------------------------------------------------------------- a batch


@kernel("void(u4[::1],i8,i8,i4,u1[::1])")
def alpha_test(packed, count, function, reference, alive):
    """``portable.alpha_test`` of packed colors."""
    separate_loop()
    first64, width64 = interval(function, _FAR_BYTE)
    first, width = int32(first64 + reference), uint32(width64)
    for i in range(count):
        alpha = int32(packed[i] >> uint32(24))
        alive[i] = uint8(alive[i] & uint8(uint32(int32(alpha - first)) < width))


@kernel("void(u4[::1],i4[::1],i8)")
def spread_first(packed, depth, count):
    """The first color and the first depth word to ``count`` fragments."""
    separate_loop()
    shade, word = packed[0], depth[0]
    for i in range(count):
        packed[i], depth[i] = shade, word


@kernel(
    void(
        int64[::1],
        int64,
        RUNS,
        int64,
        uint32[::1],
        int32[::1],
        int32[::1],
        uint8[::1],
        int32[:, ::1],
        BUFFERS,
    )
)
def write_fragments(draw, count, runs, solid, packed, pixel, depth, alive, factors, buffers):
    """Alpha, stencil and depth test, blending or logic operation, and masks, of a batch, like
    ``portable.per_fragment``.

    count       fragments; columns have SLACK elements more
    runs        where a run's y is -1 fragments are mixed instead: each has its own ``pixel``, y * width + x
    solid       1: ``packed[0]`` and ``depth[0]`` are those of every fragment, runs tell no more than
                each run's length, and ``count`` is the length of the longest: the columns need hold no more.
                Nothing is mixed then, nor discarded
    packed      uint32: the fragments' colors, which nothing reads unless draw[NEEDS_COLOR]; undefined
                afterwards, as are ``depth`` and ``alive``
    pixel       int32, read where fragments are mixed
    depth       int32: depth words (-1: outside their limits), which nothing reads unless draw[NEEDS_DEPTH]
    alive       uint8: what shading left where it DISCARDS
    factors     int32[2, 4 * FACTOR_SIZE]: the blend factors of source and destination
    """
    separate_function()
    color, depth_buffer, stencil = buffers
    mode, mask, width = draw[R.BLEND], uint32(draw[R.COLOR_MASK]), int64(color.shape[1])
    writes, surface = draw[R.NEEDS_COLOR] != 0 and mask != uint32(0), draw[R.SURFACE] != 0
    tests_stencil, tests_depth = draw[R.STENCIL_TEST] != 0, draw[R.NEEDS_DEPTH] != 0
    blends = mode == C.BLEND_GENERAL
    adds_factors = blends and draw[R.BLEND_EQUATION] == C.EQUATION_FUNC_ADD
    unusual = surface or mode == C.BLEND_LOGIC or (blends and not adds_factors)
    rare = tests_stencil or (writes and unusual)
    fused = tests_depth and writes and not rare and not blends
    if solid:
        spread_first(packed, depth, count)
    if not draw[R.DISCARDS]:
        portable.all_alive(alive, count)
    if draw[R.ALPHA_TEST]:
        alpha_test(packed, count, draw[R.ALPHA_FUNCTION], int32(draw[R.ALPHA_REFERENCE]), alive)
    if draw[R.DEPTH_CULL]:
        portable.depth_limits(depth, count, alive)
    limited = draw[R.ALPHA_TEST] | draw[R.DISCARDS] | draw[R.DEPTH_CULL]
    if solid and limited and count > 0 and not alive[0]:
        return
    untested = not (limited or tests_depth or tests_stencil)
    replaces = mode == C.BLEND_REPLACE and not surface and mask == uint32(0xFFFFFFFF)
    stores = untested and replaces
    color_words = words_at(int64(color.ctypes.data), int64(color.size))
    depth_words = words_at(int64(depth_buffer.ctypes.data), int64(depth_buffer.size))
    for k in range(runs.count):
        start, end = int64(runs.starts[k]), int64(runs.starts[k + 1])
        y, x = int64(runs.y[k]), int64(runs.x[k])
        mixed = y < 0
        if mixed and not rare:
            if tests_depth:
                function, writes_depth = draw[R.DEPTH_FUNCTION], draw[R.DEPTH_WRITE]
                scatter_depth(depth_words, pixel, start, end, depth, alive, function, writes_depth)
            if not writes:
                continue
            if blends:
                scatter_blend(color_words, pixel, start, end, packed, alive, factors, mask)
            elif mode == C.BLEND_ADD:
                scatter_add(color_words, pixel, start, end, packed, alive, mask)
            else:
                scatter_write(color_words, pixel, start, end, packed, alive, mask)
            continue
        if solid:
            start, end = int64(0), end - start
            if k > 0 and (tests_stencil or tests_depth):
                portable.all_alive(alive, end)
        while start < end:
            n = end - start
            if mixed:  # neighbours in a row are a run
                y, x, n = int64(pixel[start]) // width, int64(pixel[start]) % width, int64(1)
                while start + n < end and x + n < width and pixel[start + n] == pixel[start] + int32(n):
                    n += 1
            if tests_stencil:
                whole = n & ~31
                rest, at = n - whole, start + whole
                if whole > 0:
                    stencil_run(stencil[y], depth_buffer[y], x, whole, alive, start, depth, draw)
                if rest > 0:
                    portable.stencil_run(stencil, depth_buffer, y, x + whole, rest, alive, at, depth, draw)
            elif fused:
                depth_and_write(depth_buffer[y], color[y], x, n, packed, depth, alive, start, draw)
            elif tests_depth:
                function, writes_depth = int32(draw[R.DEPTH_FUNCTION]), draw[R.DEPTH_WRITE]
                portable.depth_run(depth_buffer, y, x, n, alive, start, depth, function, writes_depth)
            if writes and not fused:
                if surface:
                    portable.surface_run(color, y, x, n, packed, alive, start, factors, draw)
                elif adds_factors and n >= _BLENDED:
                    blend_run(color[y], x, n, packed, alive, start, factors, mask)
                elif blends:
                    equation = draw[R.BLEND_EQUATION]
                    portable.blend_run(color, y, x, n, packed, alive, start, factors, equation, mask)
                elif mode == C.BLEND_ADD:
                    portable.add_run(color, y, x, n, packed, alive, start, mask)
                elif mode == C.BLEND_LOGIC:
                    operation = draw[R.LOGIC_OPERATION]
                    portable.logic_run(color, y, x, n, packed, alive, start, operation, mask)
                elif stores:  # BLEND_REPLACE, as what follows
                    portable.store_run(color, y, x, n, packed, start)
                else:
                    portable.write_run(color, y, x, n, packed, alive, start, mask)
            start += n

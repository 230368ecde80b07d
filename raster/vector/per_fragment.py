"""Per-fragment operations of the vector engine, with the results of
``fixedpipe.raster.portable.per_fragment``.

A *run* is a piece of a row; its loops take 16 or 32 pixels at a time. In a *mixed* stretch, of many small
triangles, each fragment names its pixel. There the loops go fragment by fragment, since two of them may name
the same pixel, and the earlier one comes first. Rare operations are done run by run, by the loops of
``fixedpipe.raster.portable.per_fragment``.
"""

from typing import NamedTuple

import numpy as np
from numba import int16, int32, int64, types, uint8, uint32, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BUFFERS, RUN, RUNS, Run, type_of
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

FAR_DEPTH = 1 << 30  # two depth words differ by less than this
_FAR_BYTE = 1 << 14  # two bytes differ by less than this
_BLENDED = 8  # pixels: shorter runs take longer to prepare than to blend one by one


_U8, _I32, _I64, _U32 = types.uint8[::1], types.int32[::1], types.int64[::1], types.uint32[::1]
_FACTORS = types.int32[:, ::1]


class Fragments(NamedTuple):
    """A batch's fragments, a row each; columns have SLACK elements more.

    packed  uint32: colors
    pixel   int32: y * width + x, where fragments are mixed
    depth   int32: depth words; -1: outside their limits
    alive   uint8: 1: the fragment has passed so far
    """

    packed: np.ndarray
    pixel: np.ndarray
    depth: np.ndarray
    alive: np.ndarray


FRAGMENTS = type_of(Fragments, _U32, _I32, _I32, _U8)


@kernel
def interval(function, far):
    """(first, width) so that ``value FUNC reference`` is ``value - reference - first < width``, in unsigned
    numbers that wrap.

    ``function``: see ``portable.passes``; ``far``: a number larger than the two ever differ by.
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


# ------------------------------------------------------------------------------------------------- blending


@kernel
def factor(terms, s, d, sa, da, saturate):
    """``portable.blend_factor`` of every lane, by seven masks of the lane's channel."""
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


@kernel(void(_U32, RUN, _U32, _U8, _FACTORS, uint32))
def blend_run(row, run, source, alive, factors, mask):
    """``portable.blend_run`` with FUNC_ADD, of a row of the framebuffer."""
    separate_loop()
    x, _y, count, start = run
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


@kernel(void(_U32, _U32, RUN, _U32, _I32, _U8, _I64))
def depth_and_write(depth_row, color_row, run, source, depth, alive, draw):
    """Depth test and replacing, or blending with ONE, ONE, FUNC_ADD, of one run."""
    separate_loop()
    x, _y, count, start = run
    first, width = interval(draw[R.DEPTH_FUNCTION], FAR_DEPTH)
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


@kernel(void(_U8, _U32, RUN, _U8, _I32, _I64))
def stencil_run(stencil_row, depth_row, run, alive, depth, draw):
    """``portable.stencil_run`` of a multiple of 32 pixels of a row."""
    separate_loop()
    x, _y, count, start = run
    first, width = interval(draw[R.STENCIL_FUNCTION], _FAR_BYTE)
    mask = int16(draw[R.STENCIL_MASK])
    reference = int16((draw[R.STENCIL_REFERENCE] & draw[R.STENCIL_MASK]) - first)
    range_ = int16(width)
    first_depth, width_depth = interval(draw[R.DEPTH_FUNCTION], FAR_DEPTH)
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
    first64, width64 = interval(function, FAR_DEPTH)
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
    """``scatter_blend`` one by one, for fragments of the same pixel, or for fewer than a vector holds."""
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

    Sixteen at a time where all their pixels differ; ``source`` is then overwritten.
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


class Operations(NamedTuple):
    """Which operations a Draw asks for, and the values that they have in common.

    tests_stencil, tests_depth, writes  whether there is a stencil test, a depth test, a colour to write
    surface       whether the framebuffer does not keep four bytes, or the equation is a signed one
    blends        whether it blends with any factors
    adds_factors  and with FUNC_ADD
    fused         whether one loop tests depths and writes colours
    stores        whether every colour replaces what was there
    mask          of the colour's bits
    """

    tests_stencil: bool
    tests_depth: bool
    writes: bool
    surface: bool
    blends: bool
    adds_factors: bool
    fused: bool
    stores: bool
    mask: int


@kernel(inlined=True)
def operations_of(draw, tells):
    """The Operations of a Draw. ``tells``: as in ``write_fragments``."""
    mode, mask = draw[R.BLEND], uint32(draw[R.COLOR_MASK])
    writes, surface = draw[R.NEEDS_COLOR] != 0 and mask != uint32(0), draw[R.SURFACE] != 0
    tests_stencil, tests_depth = draw[R.STENCIL_TEST] != 0, draw[R.NEEDS_DEPTH] != 0
    blends = mode == C.BLEND_GENERAL
    adds_factors = blends and draw[R.BLEND_EQUATION] == C.EQUATION_FUNC_ADD
    untested = not (limits_fragments(draw) or tests_depth or tests_stencil)
    plain = not (surface or mode == C.BLEND_LOGIC or blends)
    fused = tests_depth and writes and not (tests_stencil or tells) and plain
    stores = untested and mode == C.BLEND_REPLACE and not surface and mask == uint32(0xFFFFFFFF)
    return Operations(tests_stencil, tests_depth, writes, surface, blends, adds_factors, fused, stores, mask)


@kernel(inlined=True)
def limits_fragments(draw):
    """Whether fragments may end before the stencil and the depth test."""
    return (draw[R.ALPHA_TEST] | draw[R.DISCARDS] | draw[R.DEPTH_CULL]) != 0


@kernel(inlined=True)
def is_rare(draw, asked):
    """Whether mixed fragments go run by run."""
    unusual = asked.surface or draw[R.BLEND] == C.BLEND_LOGIC or (asked.blends and not asked.adds_factors)
    return asked.tests_stencil or (asked.writes and unusual)


@kernel(inlined=True)
def write_mixed(draw, factors, asked, start, end, fragments, buffers):
    """Mixed fragments start..end-1, in order: the depth test, and what is done with their colours."""
    (packed, pixel, depth, alive), (color, depth_buffer, _stencil) = fragments, buffers
    if asked.tests_depth:
        depth_words = words_at(int64(depth_buffer.ctypes.data), int64(depth_buffer.size))
        function, writes_depth = draw[R.DEPTH_FUNCTION], draw[R.DEPTH_WRITE]
        scatter_depth(depth_words, pixel, start, end, depth, alive, function, writes_depth)
    if asked.writes:
        color_words = words_at(int64(color.ctypes.data), int64(color.size))
        if asked.blends:
            scatter_blend(color_words, pixel, start, end, packed, alive, factors, asked.mask)
        elif draw[R.BLEND] == C.BLEND_ADD:
            scatter_add(color_words, pixel, start, end, packed, alive, asked.mask)
        else:
            scatter_write(color_words, pixel, start, end, packed, alive, asked.mask)


@kernel(inlined=True)
def test_run(draw, asked, run, fragments, buffers):
    """Stencil and depth test of a run, unless its depth test is fused."""
    (_packed, _pixel, depth, alive), (_color, depth_buffer, stencil) = fragments, buffers
    x, y, n, start = run
    if asked.tests_stencil:
        whole = n & ~31
        if whole > 0:
            stencil_run(stencil[y], depth_buffer[y], Run(x, y, whole, start), alive, depth, draw)
        if n > whole:
            rest = Run(x + whole, y, n - whole, start + whole)
            portable.stencil_run(stencil, depth_buffer, rest, alive, depth, draw)
    elif asked.tests_depth and not asked.fused:
        function, writes_depth = int32(draw[R.DEPTH_FUNCTION]), draw[R.DEPTH_WRITE]
        portable.depth_run(depth_buffer, run, alive, depth, function, writes_depth)


@kernel(inlined=True)
def write_run(draw, factors, asked, run, fragments, buffers):
    """What is done with the colours of a run."""
    mode = draw[R.BLEND]
    (packed, _pixel, depth, alive), (color, depth_buffer, _stencil) = fragments, buffers
    if asked.fused:
        depth_and_write(depth_buffer[run.y], color[run.y], run, packed, depth, alive, draw)
    elif asked.surface:
        portable.surface_run(color, run, packed, alive, factors, draw)
    elif asked.adds_factors and run.count >= _BLENDED:
        blend_run(color[run.y], run, packed, alive, factors, asked.mask)
    elif asked.blends:
        portable.blend_run(color, run, packed, alive, factors, draw[R.BLEND_EQUATION], asked.mask)
    elif mode == C.BLEND_ADD:
        portable.add_run(color, run, packed, alive, asked.mask)
    elif mode == C.BLEND_LOGIC:
        portable.logic_run(color, run, packed, alive, draw[R.LOGIC_OPERATION], asked.mask)
    elif asked.stores:  # BLEND_REPLACE, as what follows
        portable.store_run(color, run, packed)
    else:
        portable.write_run(color, run, packed, alive, asked.mask)


@kernel(void(_I64, _FACTORS, int64, RUNS, int64, int64, FRAGMENTS, BUFFERS))
def write_fragments(draw, factors, count, runs, solid, tells, fragments, buffers):
    """Alpha, stencil and depth test, blending or logic operation, and masks, of a batch, like
    ``portable.per_fragment``.

    count      fragments
    runs       where a run's y is -1 fragments are mixed instead: each has its own ``pixel``
    solid      1: the first color and depth word are those of every fragment, runs tell no more than each
               run's length, and ``count`` is the length of the longest: the columns need hold no more.
               Nothing is mixed then, nor discarded
    tells      1: ``alive`` is afterwards which fragments passed; not together with ``solid``
    fragments  nothing reads the colors unless draw[NEEDS_COLOR], or the depth words unless draw[NEEDS_DEPTH];
               ``alive`` is what shading left where it DISCARDS; all but ``pixel``, and ``alive`` where it
               ``tells``, are undefined afterwards
    """
    separate_function()
    packed, pixel, depth, alive = fragments
    asked, width = operations_of(draw, tells != 0), int64(buffers.color.shape[1])
    if solid:
        spread_first(packed, depth, count)
    if not draw[R.DISCARDS]:
        portable.all_alive(alive, count)
    if draw[R.ALPHA_TEST]:
        alpha_test(packed, count, draw[R.ALPHA_FUNCTION], int32(draw[R.ALPHA_REFERENCE]), alive)
    if draw[R.DEPTH_CULL]:
        portable.depth_limits(depth, count, alive)
    if solid and limits_fragments(draw) and count > 0 and not alive[0]:
        return
    rare = is_rare(draw, asked)
    for k in range(runs.count):
        start, end = int64(runs.starts[k]), int64(runs.starts[k + 1])
        y, x = int64(runs.y[k]), int64(runs.x[k])
        mixed = y < 0
        if mixed and not rare:
            write_mixed(draw, factors, asked, start, end, fragments, buffers)
            continue
        if solid:
            start, end = int64(0), end - start
            if k > 0 and (asked.tests_stencil or asked.tests_depth):
                portable.all_alive(alive, end)
        while start < end:
            n = end - start
            if mixed:  # neighbours in a row are a run
                y, x, n = int64(pixel[start]) // width, int64(pixel[start]) % width, int64(1)
                while start + n < end and x + n < width and pixel[start + n] == pixel[start] + int32(n):
                    n += 1
            run = Run(x, y, n, start)
            test_run(draw, asked, run, fragments, buffers)
            if asked.writes:
                write_run(draw, factors, asked, run, fragments, buffers)
            start += n

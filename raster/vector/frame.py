"""The vector engine: every queued Clear and Draw of a frame, band by band of rows.

A frame's commands wait in a table of jobs, each a row of numbers and addresses (``rows.JOB_KIND`` and what
follows). Each thread takes the next band that nobody has and runs all jobs on its rows, in order, so a band
stays in the processor's nearest memory from the first Clear to the last Draw, and no pixel is ever two
threads'. A Draw that ``fill_draw`` refuses goes to the portable engine (``fixedpipe.raster.portable.draw``),
which gives the same bits.
"""

from numba import boolean, float64, int16, int32, int64, uint8, uint32, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BANDS, BUFFERS, Runs, as_bands, plain
from fixedpipe.raster.fixed import reciprocal_24
from fixedpipe.raster.kernel import kernel, next_of, separate_function, separate_loop
from fixedpipe.raster.portable.check import usable_levels
from fixedpipe.raster.portable.interpolate import weight_factors
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.primitives.triangle import corners_of, edge_tie, polygon_offset, row_span
from fixedpipe.raster.vector.addresses import words_at
from fixedpipe.raster.vector.arrays import (
    JOB,
    JOBS,
    PASS,
    SCRATCH,
    as_pass,
    bands_of,
    keep_bands,
    keep_pass,
    pass_of,
)
from fixedpipe.raster.vector.check import usable_job
from fixedpipe.raster.vector.combine import combine
from fixedpipe.raster.vector.interpolate import (
    iterate_colors,
    iterate_packed,
    mixed_depth,
    mixed_weights,
    run_depth,
    run_weights,
    spread,
    spread_colors,
    spread_coordinates,
    spread_depth,
    triangle_depth,
    triangle_weights,
)
from fixedpipe.raster.vector.lanes import (
    count_bits,
    i16x16,
    lowest_bit,
    mask_bits,
    ramp_f64x8,
    ramp_i32x8,
    ramp_i32x16,
    store,
)
from fixedpipe.raster.vector.per_fragment import are_hidden, is_hidden, tests_early, write_fragments
from fixedpipe.raster.vector.small import LARGEST_SMALL, set_up, share
from fixedpipe.raster.vector.unit import plan_units, sample
from fixedpipe.raster.vector.weights import run_color_weights, whole_weights

SMALL = 32  # pixels: triangles whose box is not wider share segments
ALONE = 32  # fragments: from here on a triangle is a segment of its own


@kernel("void(i8[:,::1],i8,i8,i8,i8,i8,i8,i8,i8,i8,i8,i8)")
def fill_clear(jobs, k, x0, y0, x1, y1, buffers, color, color_mask, depth, stencil, stencil_mask):
    """Row k of ``jobs``: clear device pixels [x0, x1) x [y0, y1).

    ``buffers``: bits, codes.BUFFER_...; ``color`` packed, ``depth`` a word, ``stencil`` a byte; masks
    as stored.
    """
    job = jobs[k]
    job[R.JOB_KIND] = C.JOB_CLEAR
    job[R.JOB_X0], job[R.JOB_Y0], job[R.JOB_X1], job[R.JOB_Y1] = x0, y0, x1, y1
    job[R.JOB_BUFFERS], job[R.JOB_COLOR], job[R.JOB_COLOR_MASK] = buffers, color, color_mask
    job[R.JOB_DEPTH], job[R.JOB_STENCIL], job[R.JOB_STENCIL_MASK] = depth, stencil, stencil_mask


@kernel(boolean(JOBS, int64, plain(PASS), plain(BANDS)))
def fill_draw(jobs, k, arrays, bands):
    """Row k of ``jobs`` from a Draw's arrays, which must outlive it: those of a Pass and of Bands, in plain
    tuples. False where the vector engine does not cover the Draw, or where its arrays would lead a kernel
    outside of them (``fixedpipe.raster.vector.check``).
    """
    p = as_pass(arrays)
    if not usable_job(p):
        return False
    draw, vertices, textures = p.state.draw, p.vertices, p.textures
    inverse_w = vertices.inverse_w
    unusual = (
        draw[R.STROKES] | draw[R.STIPPLE] | draw[R.WINDOW_CLIP] | draw[R.W_BUFFERING] | draw[R.DEPTH_FORMAT]
    ) | (draw[R.DEPTH_CULL] | draw[R.FOG_ENABLED] | draw[R.TEXTURE_SHADER] | draw[R.DISCARDS] | draw[R.YCBCR])
    if unusual or draw[R.NEEDS_WEIGHTS] or draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT:
        return False
    job = jobs[k]
    job[R.JOB_KIND] = C.JOB_DRAW
    if not plan_units(job, draw, textures, vertices.coordinates):
        return False
    job[R.JOB_ROW_RUNS] = 0
    for u in range(4):
        path = job[R.JOB_UNIT_PATH + u]
        if path == C.PATH_MIPMAPPED or path == C.PATH_FOOTPRINT:
            job[R.JOB_ROW_RUNS] = 1
    perspective = False
    for v in range(inverse_w.shape[0]):
        if inverse_w[v] < 0.0:  # its triangles go through infinity
            return False
        perspective = perspective or inverse_w[v] != inverse_w[0]
    job[R.JOB_PERSPECTIVE] = perspective
    textured = False
    for u in range(draw[R.UNITS]):
        textured = textured or job[R.JOB_COMPONENTS + u] != 0
    job[R.JOB_OF_COLORS] = draw[R.NEEDS_ITERATION_WEIGHTS] != 0 and not (textured or perspective)
    for edge in range(4):
        job[R.JOB_X0 + edge] = draw[R.X0 + edge]
    job[R.JOB_USABLE] = 1
    for u in range(draw[R.UNITS]):
        size, reads = textures.texels[u].shape[0], job[R.JOB_UNIT_PATH + u] != C.PATH_DISABLED
        if reads and not usable_levels(textures.units[u], textures.levels[u], size, True):
            job[R.JOB_USABLE] = 0
    job[R.JOB_ONE_COLOR] = draw[R.FLAT] == C.COLORS_EQUAL and draw[R.BACK_SIGN] == 0
    keep_bands(job, as_bands(bands))
    keep_pass(job, p)
    return True


@kernel
def fits(job, height, width):
    """Whether a job's pixels are the framebuffer's, and its textures there."""
    inside = 0 <= job[R.JOB_X0] <= width and 0 <= job[R.JOB_X1] <= width
    inside = inside and 0 <= job[R.JOB_Y0] <= height and 0 <= job[R.JOB_Y1] <= height
    return inside and (job[R.JOB_KIND] == C.JOB_CLEAR or job[R.JOB_USABLE] != 0)


@kernel("void(u4[::1],u4,u4)")
def clear_words(words, value, mask):
    """Words to a value, through a mask."""
    separate_loop()
    if mask == uint32(0xFFFFFFFF):
        for i in range(words.shape[0]):
            words[i] = value
    else:
        for i in range(words.shape[0]):
            words[i] = uint32(uint32(words[i] & uint32(~mask)) | uint32(value & mask))


@kernel("void(u1[::1],u1,u1)")
def clear_bytes(bytes_, value, mask):
    """Bytes to a value, through a mask."""
    separate_loop()
    for i in range(bytes_.shape[0]):
        bytes_[i] = uint8(uint8(bytes_[i] & uint8(~mask)) | uint8(value & mask))


@kernel("void(i8[::1],i8,u4[:,::1],u4[:,::1],u1[:,::1])")
def clear_band(job, band, color, depth_buffer, stencil):
    """A Clear's part of one band."""
    separate_function()
    x0, x1, buffers = job[R.JOB_X0], job[R.JOB_X1], job[R.JOB_BUFFERS]
    top, bottom = max(band * BAND_HEIGHT, job[R.JOB_Y0]), min((band + 1) * BAND_HEIGHT, job[R.JOB_Y1])
    for y in range(top, bottom):
        if buffers & C.BUFFER_COLOR:
            clear_words(color[y, x0:x1], uint32(job[R.JOB_COLOR]), uint32(job[R.JOB_COLOR_MASK]))
        if buffers & C.BUFFER_DEPTH:
            clear_words(depth_buffer[y, x0:x1], uint32(job[R.JOB_DEPTH]), uint32(0xFFFFFFFF))
        if buffers & C.BUFFER_STENCIL:
            clear_bytes(stencil[y, x0:x1], uint8(job[R.JOB_STENCIL]), uint8(job[R.JOB_STENCIL_MASK]))


@kernel
def packed_color(color):
    """Four bytes as a packed colour."""
    low = uint32(uint32(color[0]) | uint32(uint32(color[1]) << uint32(8)))
    high = uint32(uint32(color[2]) | uint32(uint32(color[3]) << uint32(8)))
    return uint32(low | uint32(high << uint32(16)))


@kernel("void(u1[::1],i2[:,::1])")
def one_color(color, planes):
    """The primary and secondary colour of a whole Draw, in their planes."""
    separate_loop()
    for c in range(4):
        primary = planes[C.REGISTER_PRIMARY_COLOR * 4 + c]
        secondary = planes[C.REGISTER_SECONDARY_COLOR * 4 + c]
        for i in range(0, primary.shape[0], 16):
            store(primary, i, i16x16(int16(color[c])))
            store(secondary, i, i16x16(int16(color[4 + c])))


@kernel(void(JOB, int32, int64, int64, int64, int64, int64, BUFFERS, SCRATCH))
def finish_batch(job, first, count, length, segments, runs, solid, buffers, scratch):
    """Shade a batch whose weights and depth words are there, and write it.

    first: a triangle, whose colours are all triangles' where the job has JOB_ONE_COLOR; ``count``: fragments
    in columns; ``length``: of all runs together, which is another number where ``solid``
    (``per_fragment.write_fragments``).
    """
    separate_function()
    p = pass_of(job)
    draw, triangles, colors = p.state.draw, p.triangles, p.vertices.colors
    floats, ints, packed, planes = scratch.floats, scratch.ints, scratch.packed, scratch.planes
    lists = scratch.lists
    lists[R.STARTS, segments], lists[R.RUN_STARTS, runs] = int32(count), int32(length)
    of_rows = Runs(lists[R.RUN_STARTS], lists[R.RUN_X], lists[R.RUN_Y], runs)
    flat, terms, varies = draw[R.FLAT], planes[R.COLOR_TERMS :], not job[R.JOB_ONE_COLOR]
    whole = job[R.JOB_OF_COLORS]
    if draw[R.NEEDS_COLOR] and draw[R.DIRECT]:
        if varies:
            out = packed[R.SHADED]
            iterate_packed(lists, segments, triangles, colors, flat, floats, ints, whole, terms, out)
        else:
            packed[R.SHADED, : 1 if solid else count] = packed_color(colors[triangles[first, 3], 0])
    elif draw[R.NEEDS_COLOR]:
        if draw[R.NEEDS_PRIMARY] and varies:
            plane = C.REGISTER_PRIMARY_COLOR * 4
            iterate_colors(
                lists, segments, triangles, colors, 0, flat, floats, ints, whole, terms, planes, plane
            )
        if draw[R.NEEDS_SECONDARY] and varies:
            second, plane = terms[12:], C.REGISTER_SECONDARY_COLOR * 4
            iterate_colors(
                lists, segments, triangles, colors, 4, flat, floats, ints, whole, second, planes, plane
            )
        for u in range(draw[R.UNITS]):
            sample(job, u, count, segments, of_rows, scratch)
        combine(planes, p.plan, count, scratch.products, packed[R.SHADED])
    write_fragments(
        draw, count, of_rows, solid, packed[R.SHADED], ints[R.PIXEL], ints[R.DEPTH_WORD], scratch.alive,
        p.state.factors, buffers,
    )  # fmt: skip


@kernel
def close_mixed(job, draw, floats, ints, start, end, low, high):
    """Weights and depth words of the mixed segment that began at ``start`` (-1: none is open); -1."""
    if start >= 0:
        if draw[R.NEEDS_ITERATION_WEIGHTS]:
            mixed_weights(floats, start, end, job[R.JOB_PERSPECTIVE])
        if draw[R.NEEDS_DEPTH]:
            mixed_depth(floats, ints[R.DEPTH_WORD], start, end, low, high)
    return int64(-1)


@kernel(int64(JOB, int32[::1], int64, int64, BUFFERS, SCRATCH))
def draw_band(job, members, band, batch, buffers, scratch):
    """The rows of ``band`` of a Draw whose triangles there are ``members``; returns how many fragments.

    Fragments fill a batch of columns. Triangles whose box is small share a mixed segment; others are segments
    of their own, row by row. The smallest are set up sixteen at a time (``small``). Where one colour and one
    depth word are all that fragments have, runs alone are kept, and no columns (a solid batch). A row of a
    large triangle, and a small one of ``ALONE`` fragments or more that is not among the smallest, is left out
    where all of it is hidden (``per_fragment.tests_early``).
    """
    separate_function()
    p = pass_of(job)
    draw, draw_float, triangles, vertices = p.state.draw, p.state.draw_float, p.triangles, p.vertices
    z, inverse_w, colors, coordinates = vertices.z, vertices.inverse_w, vertices.colors, vertices.coordinates
    floats, ints, planes, lists = scratch.floats, scratch.ints, scratch.planes, scratch.lists
    needs_depth, has_offset = draw[R.NEEDS_DEPTH], draw[R.POLYGON_OFFSET]
    needs_weights, needs_color = draw[R.NEEDS_ITERATION_WEIGHTS], draw[R.NEEDS_COLOR]
    mixes, perspective = batch >= SMALL * BAND_HEIGHT, job[R.JOB_PERSPECTIVE]
    row_runs, of_colors = job[R.JOB_ROW_RUNS], job[R.JOB_OF_COLORS]
    varies = needs_color and (draw[R.DIRECT] or draw[R.NEEDS_PRIMARY] or draw[R.NEEDS_SECONDARY])
    if varies and job[R.JOB_ONE_COLOR]:
        varies = False
        one_color(colors[triangles[members[0], 3], 0], planes)
    channels = int64(8 if draw[R.NEEDS_SECONDARY] else 4)
    solid_state = not needs_color or (draw[R.DIRECT] and job[R.JOB_ONE_COLOR])
    flat, farthest = draw[R.FLAT], float64(draw[R.DEPTH_MAX])
    low = min(max(draw_float[R.DEPTH_LOW], 0.0), farthest)
    high = min(max(draw_float[R.DEPTH_HIGH], 0.0), farthest)
    width = int64(buffers.color.shape[1])
    early, function = tests_early(draw), int64(draw[R.DEPTH_FUNCTION])
    depth_words = words_at(int64(buffers.depth.ctypes.data), int64(buffers.depth.size))
    top, bottom = max(band * BAND_HEIGHT, draw[R.Y0]), min((band + 1) * BAND_HEIGHT, draw[R.Y1])
    x_first, x_last = draw[R.X0], draw[R.X1] - 1
    # Of the batch: fragments, the longest run, segments, runs; whether it is solid, and its depth word.
    fragments, position, longest, segments, runs = int64(0), int64(0), int64(0), int64(0), int64(0)
    solid, solid_word = False, int32(0)
    mixed_from = int64(-1)  # where the open mixed segment began
    # Sixteen triangles from every sixteenth on are set up together; which of them are drawn from there.
    together, taken, k = mixes and not solid_state, int64(0), int64(0)
    while True:
        finished = k == members.shape[0]
        if together and k & 15 == 0 and not finished:
            taken = set_up(job, members, k, top, bottom - 1, scratch)
        if not finished and (taken >> (k & 15)) & 1:
            begin = position
            k, position, runs, full = share(job, members, k, taken, position, runs, batch, width, scratch)
            if position > begin:
                if not row_runs and (runs == 0 or lists[R.RUN_Y, runs - 1] >= 0):
                    lists[R.RUN_STARTS, runs], lists[R.RUN_Y, runs] = int32(begin), int32(-1)
                    runs += 1
                if mixed_from < 0:
                    mixed_from = begin
                    lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(begin), int32(-1)
                    segments += 1
            if full:
                mixed_from = close_mixed(job, draw, floats, ints, mixed_from, position, low, high)
                finish_batch(job, members[0], position, position, segments, runs, False, buffers, scratch)
                fragments += position
                position, longest, segments, runs = int64(0), int64(0), int64(0), int64(0)
            continue
        t = members[k] if not finished else members[0]
        v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x0, y0, x1, y1, x2, y2 = corners_of(vertices, v0, v1, v2)
        x_least, x_most = min(x0, min(x1, x2)), max(x0, max(x1, x2))
        y_least, y_most = min(y0, min(y1, y2)), max(y0, max(y1, y2))
        first_row, last_row = max((y_least + 7) >> 4, top), min((y_most - 8) >> 4, bottom - 1)
        left, right = max((x_least + 7) >> 4, x_first), min((x_most - 8) >> 4, x_last)
        z0, z1, z2, offset = 0.0, 0.0, 0.0, 0.0
        if needs_depth:
            z0, z1, z2 = z[v0], z[v1], z[v2]
            if has_offset:
                offset = polygon_offset(p.state, vertices, v0, v1, v2)
        plain = solid_state and z0 == z1 and z1 == z2
        word = int32(min(max(z0 + offset, low), high)) if plain else int32(0)
        small = mixes and not (finished or plain) and right - left < SMALL
        small = small and x_most - x_least < LARGEST_SMALL and y_most - y_least < LARGEST_SMALL
        full = finished or plain != solid
        if small:  # room for its box
            full = full or position + (right - left + 1) * (last_row - first_row + 1) > batch
        elif plain:
            full = full or word != solid_word
        # Anything but a small triangle closes an open mixed segment.
        if full or not small:
            mixed_from = close_mixed(job, draw, floats, ints, mixed_from, position, low, high)
        if full:
            if position > 0:
                count = longest if solid else position
                finish_batch(job, t, count, position, segments, runs, solid, buffers, scratch)
                fragments += position
            position, longest, segments, runs = int64(0), int64(0), int64(0), int64(0)
            solid, solid_word = plain, word
            ints[R.DEPTH_WORD, 0] = word
        if finished:
            break
        k += 1
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        sign = int64(-1) if area < 0 else int64(1)
        area *= sign
        right1, down1 = (y2 - y0) * 16 * sign, -(x2 - x0) * 16 * sign
        right2, down2 = -(y1 - y0) * 16 * sign, (x1 - x0) * 16 * sign
        right0, down0 = -(right1 + right2), -(down1 + down2)
        sx, sy = left * 16 + 8, first_row * 16 + 8
        n1 = ((sx - x0) * (y2 - y0) - (x2 - x0) * (sy - y0)) * sign
        n2 = ((x1 - x0) * (sy - y0) - (sx - x0) * (y1 - y0)) * sign
        n0 = area - n1 - n2
        tie0, tie1, tie2 = edge_tie(right0, down0), edge_tie(right1, down1), edge_tie(right2, down2)
        weighed = weight_factors(inverse_w[v0], inverse_w[v1], inverse_w[v2])
        back = int32(1) if draw[R.BACK_SIGN] == sign else int32(0)
        s0, s1, s2 = float64(right0), float64(right1), float64(right2)
        if small:
            begin, runs_before = position, runs
            step0, step1, step2 = ramp_f64x8() * s0, ramp_f64x8() * s1, ramp_f64x8() * s2
            # Sixteen pixels at a time: half a row, one, or where eight are enough two, lane 8 beginning the
            # second.
            wide, wider = right - left >= 8, right - left >= 16
            lane = ramp_i32x16()
            along = lane if wide else lane & 7
            below = lane ^ lane if wide else lane >> 3
            c0 = along * int32(right0) + below * int32(down0) + int32(n0 + tie0)
            c1 = along * int32(right1) + below * int32(down1) + int32(n1 + tie1)
            c2 = along * int32(right2) + below * int32(down2) + int32(n2 + tie2)
            rows_at_once = int64(1 if wide else 2)
            columns = (int64(1) << (right - left + 1)) - 1
            mask = int64(0)
            for row in range(last_row - first_row + 1):
                if wide or row & 1 == 0:
                    mask = mask_bits((c0 | c1 | c2) >= int32(0))
                    if wider:
                        d0, d1, d2 = c0 + int32(16 * right0), c1 + int32(16 * right1), c2 + int32(16 * right2)
                        mask |= mask_bits((d0 | d1 | d2) >= int32(0)) << int64(16)
                    c0 = c0 + int32(rows_at_once * down0)
                    c1 = c1 + int32(rows_at_once * down1)
                    c2 = c2 + int32(rows_at_once * down2)
                else:
                    mask >>= int64(8)
                bits = mask & columns
                if bits == 0:
                    continue
                start, n = lowest_bit(bits), count_bits(bits)
                m0 = float64(n0 + start * right0 + row * down0)
                m1 = float64(n1 + start * right1 + row * down1)
                m2 = float64(n2 + start * right2 + row * down2)
                at = (first_row + row) * width + left + start
                store(floats[R.N0], position, step0 + m0)
                store(floats[R.N1], position, step1 + m1)
                store(floats[R.N2], position, step2 + m2)
                store(ints[R.PIXEL], position, ramp_i32x8() + int32(at))
                for done in range(8, n, 8):
                    store(floats[R.N0], position + done, step0 + (m0 + float64(done) * s0))
                    store(floats[R.N1], position + done, step1 + (m1 + float64(done) * s1))
                    store(floats[R.N2], position + done, step2 + (m2 + float64(done) * s2))
                    store(ints[R.PIXEL], position + done, ramp_i32x8() + int32(at + done))
                if row_runs:
                    lists[R.RUN_STARTS, runs], lists[R.RUN_X, runs] = int32(position), int32(left + start)
                    lists[R.RUN_Y, runs] = int32(first_row + row)
                    ints[R.OWNER, runs] = t
                    runs += 1
                position += n
            n = position - begin
            if n == 0:
                continue
            doubled = float64(area)
            if n >= ALONE:  # before its columns are written: a vector goes beyond the segment's end
                mixed_from = close_mixed(job, draw, floats, ints, mixed_from, begin, low, high)
            if n >= ALONE and needs_depth:
                words = ints[R.DEPTH_WORD]
                triangle_depth(floats, words, begin, n, (z0, z1, z2), doubled, offset, low, high)
                if early and are_hidden(depth_words, ints[R.PIXEL], words, begin, n, function):
                    fragments += n
                    position, runs = begin, runs_before
                    continue
            if not row_runs and (runs == 0 or lists[R.RUN_Y, runs - 1] >= 0):
                lists[R.RUN_STARTS, runs], lists[R.RUN_Y, runs] = int32(begin), int32(-1)
                runs += 1
            if n >= ALONE:
                lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(begin), t
                lists[R.BACKS, segments] = back
                segments += 1
                if needs_weights:
                    triangle_weights(floats, begin, n, weighed, doubled)
                    if of_colors:
                        whole_weights(floats, ints, begin, n)
                continue
            if mixed_from < 0:
                mixed_from = begin
                lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(begin), int32(-1)
                segments += 1
            if needs_weights:
                if perspective:
                    spread(floats[R.WEIGHT_FACTOR0], begin, n, weighed[0])
                    spread(floats[R.WEIGHT_FACTOR1], begin, n, weighed[1])
                    spread(floats[R.WEIGHT_FACTOR2], begin, n, weighed[2])
                else:
                    spread(floats[R.WEIGHT_FACTOR0], begin, n, reciprocal_24(float64(area)))
            if needs_depth:
                spread_depth(floats, begin, n, (z0, z1, z2), float64(area), offset)
            if varies:
                terms, provoking = planes[R.COLOR_TERMS :], triangles[t, 3]
                spread_colors(terms, begin, n, colors, channels, v0, v1, v2, provoking, back, flat)
            for u in range(draw[R.UNITS]):
                components = job[R.JOB_COMPONENTS + u]
                if components:
                    spread_coordinates(floats, begin, n, coordinates, u, components, v0, v1, v2)
            continue
        for row in range(first_row, last_row + 1):
            start, end = row_span(n0 + tie0, n1 + tie1, n2 + tie2, right0, right1, right2, left, right)
            while start < end:
                n = min(end - start, batch if solid else batch - position)
                ahead = start - left
                here = (
                    float64(n0 + ahead * right0),
                    float64(n1 + ahead * right1),
                    float64(n2 + ahead * right2),
                )
                if not solid and needs_depth:
                    words, depths = ints[R.DEPTH_WORD], (z0, z1, z2)
                    run_depth(words, position, n, here, (s0, s1, s2), depths, offset, low, high)
                    if early and is_hidden(buffers.depth[row], start, words, position, n, function):
                        fragments += n
                        start += n
                        continue
                lists[R.RUN_STARTS, runs], lists[R.RUN_X, runs] = int32(position), int32(start)
                lists[R.RUN_Y, runs] = int32(row)
                ints[R.OWNER, runs] = t
                runs += 1
                if not solid:
                    if segments == 0 or lists[R.OWNERS, segments - 1] != t:
                        lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(position), t
                        lists[R.BACKS, segments] = back
                        segments += 1
                    if of_colors:
                        run_color_weights(ints, position, n, here, (s0, s1, s2))
                    elif needs_weights:
                        run_weights(floats, position, n, here, (s0, s1, s2), weighed)
                position += n
                longest = max(longest, n)
                start += n
                if (runs if solid else position) >= batch:
                    count = longest if solid else position
                    finish_batch(job, t, count, position, segments, runs, solid, buffers, scratch)
                    fragments += position
                    position, longest, segments, runs = int64(0), int64(0), int64(0), int64(0)
            n0 += down0
            n1 += down1
            n2 += down2
    return fragments


@kernel(int64(JOBS, int64, int64[::1], int64, BUFFERS, SCRATCH))
def draw_frame(jobs, count, counter, batch, buffers, scratch):
    """Run the first ``count`` jobs on every band that ``counter`` int64[1] still gives.

    Threads that share a frame call this with one counter, which began at 0, and each its own Scratch of at
    least ``batch`` columns. Returns how many fragments this call drew. A job that is larger than the
    framebuffer, or whose textures are not there, is left out.
    """
    fragments = int64(0)
    height, width = buffers.color.shape
    bands = (int64(height) + BAND_HEIGHT - 1) // BAND_HEIGHT
    band = next_of(counter)
    while band < bands:
        for k in range(count):
            job = jobs[k]
            if not fits(job, height, width):
                continue
            if job[R.JOB_KIND] == C.JOB_CLEAR:
                clear_band(job, band, buffers.color, buffers.depth, buffers.stencil)
                continue
            order, ends = bands_of(job)
            if ends.shape[0] < bands:
                continue
            begin, end = int64(ends[band - 1]) if band > 0 else int64(0), int64(ends[band])
            if begin < end:
                fragments += draw_band(job, order[begin:end], band, batch, buffers, scratch)
        band = next_of(counter)
    return fragments

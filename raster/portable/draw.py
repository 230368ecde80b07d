"""Drawing primitives band by band of rows: coverage, batches of fragments, and the order of the stages.

Triangles, lines and points come in draw order; their fragments fill a batch of columns row by row; a full
batch is shaded (interpolation, texture units, combiners: pure functions of columns) and written (per-fragment
operations). A fragment's value depends on its primitive and pixel alone, so neither bands nor the batch size
can change a bit.
"""

import numpy as np
from numba import float64, int16, int32, int64, uint8, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import (
    BANDS,
    BUFFERS,
    RUNS,
    SEGMENTS,
    Runs,
    Segments,
    as_buffers,
    plain,
)
from fixedpipe.raster.fixed import one_of, truncate_24
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.arrays import PASS, SCRATCH, Edges, Scratch, as_pass
from fixedpipe.raster.portable.check import usable
from fixedpipe.raster.portable.combine import (
    convert_plane,
    copy_plane,
    fill_plane,
    final_combiner,
    general_combiner,
)
from fixedpipe.raster.portable.interpolate import (
    color_weights,
    depth_words,
    emit_depth,
    emit_iteration_weights,
    emit_w,
    emit_weights,
    full_weights,
    iterate_color,
    iterate_exact_color,
    iterate_fog,
    iterate_fog_table,
    weight_factors,
    weight_sum,
)
from fixedpipe.raster.portable.per_fragment import all_alive, per_fragment
from fixedpipe.raster.portable.unit import sample_unit, unbound_texture
from fixedpipe.raster.portable.w_slope import w_slope
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.primitives.strokes import (
    along_line,
    line_run,
    open_run,
    stroke_bounds,
    stroke_box,
    triangle_box,
)
from fixedpipe.raster.primitives.triangle import (
    corners_of,
    edge_tie,
    limited_offset,
    polygon_offset,
    reaches_infinity,
    row_span,
    side_of,
)


@kernel
def stroke_span(draw, stroke, corners, row, first, last, right, down):
    """The pixels [from, to) of a row, first..last, that a line or a point draws: its bounds are linear.

    ``right``, ``down``: where in a pixel that is asked, 1/16 pixel from its middle.
    """
    sx, sy = first * 16 + 8 + right, row * 16 + 8 + down
    b0, b1, b2, b3 = stroke_bounds(draw, stroke, corners, sx, sy)
    c0, c1, c2, c3 = stroke_bounds(draw, stroke, corners, sx + 16, sy)
    start, end = row_span(b0, b1, b2, c0 - b0, c1 - b1, c2 - b2, first, last)
    other_start, other_end = row_span(b3, b3, b3, c3 - b3, c3 - b3, c3 - b3, first, last)
    start = max(start, other_start)
    return start, max(start, min(end, other_end))


@kernel
def sample_spans(draw, strokes, t, corners, kind, row, first, last, n, right, down, spans):
    """The pixels [from, to) of a row, first..last, of which a primitive covers each sample, into ``spans``;
    returns the least that holds them all.

    ``n``: a triangle's biased edge functions at the middle of pixel ``first``, which grow by ``right`` from
    pixel to pixel and by ``down`` from row to row.
    """
    low, high = last + 1, first
    for k in range(draw[R.COVER_SAMPLES]):
        x, y = draw[R.COVER_SAMPLE + 2 * k], draw[R.COVER_SAMPLE + 2 * k + 1]
        if kind == C.PRIMITIVE_TRIANGLE:
            start, end = row_span(
                n[0] + ((x * right[0] + y * down[0]) >> 4),
                n[1] + ((x * right[1] + y * down[1]) >> 4),
                n[2] + ((x * right[2] + y * down[2]) >> 4),
                right[0],
                right[1],
                right[2],
                first,
                last,
            )
        else:
            start, end = stroke_span(draw, strokes[t], corners, row, first, last, x, y)
        spans[k, 0], spans[k, 1] = start, end
        if start < end:
            low, high = min(low, start), max(high, end)
    return low, max(low, high)


@kernel
def samples_inside(spans, samples, x):
    """Of how many samples the spans hold pixel x."""
    count = int32(0)
    for k in range(samples):
        count += int32(spans[k, 0] <= x and x < spans[k, 1])
    return count


@kernel
def positive_weights(n, inverse_w, factors):
    """Whether edge functions times 1/w have a sum that weights can be divided by, and so have those times
    ``factors``.
    """
    total = (n[0] * inverse_w[0] + n[1] * inverse_w[1]) + n[2] * inverse_w[2]
    e0 = truncate_24(truncate_24(n[0]) * factors[0])
    e1 = truncate_24(truncate_24(n[1]) * factors[1])
    e2 = truncate_24(truncate_24(n[2]) * factors[2])
    return total > 0.0 and weight_sum(e0, e1, e2) > 0.0


@kernel
def covered_run(spans, samples, start, end, here, step, inverse_w, weighed):
    """The first run [from, to) of pixels within [start, end) that cover some sample.

    ``here``: edge functions at ``start``, which grow by ``step``. Assumed: a pixel outside its triangle whose
    weights have no positive sum is left out.
    """
    low, first = start, start
    found = False
    while first < end:
        k = float64(first - start)
        n = here[0] + k * step[0], here[1] + k * step[1], here[2] + k * step[2]
        inside = samples_inside(spans, samples, first) > 0 and positive_weights(n, inverse_w, weighed)
        if inside and not found:
            low, found = first, True
        elif found and not inside:
            return low, first
        first += 1
    return (low, end) if found else (end, end)


@kernel
def keep_share(results, covered, count, samples):
    """A batch's alpha times the share of samples that are covered, cut.

    Source: OpenGL 1.2.1 sections 3.4.4 and 3.5.2; Measured: of an alpha of one (3D_primitive captures);
    Inferred: of others.
    """
    for i in range(count):
        results[3, i] = int16(int32(int32(results[3, i]) * covered[i]) // int32(samples))


@kernel
def stroke_offset(draw, kind):
    """Whether polygons drawn as such strokes are offset in depth."""
    return draw[R.OFFSET_LINE] if kind == C.PRIMITIVE_LINE else draw[R.OFFSET_POINT]


@kernel
def offset_of(state, vertices, v0, v1, v2):
    """What a polygon adds to its depths."""
    draw, draw_float = state.draw, state.draw_float
    if not draw[R.W_BUFFERING]:
        return polygon_offset(state, vertices, v0, v1, v2)
    factor, steep = draw_float[R.OFFSET_FACTOR], 0.0
    if factor != 0.0:
        steep = factor * w_slope(draw, vertices, v0, v1, v2)
    return limited_offset(draw_float[R.OFFSET_UNITS] + steep)


@kernel
def iterate_four(draw, segments, triangles, colors, first, ints, edges, out, plane):
    """Four colour channels from ``first`` on into four planes of ``out``."""
    flat, bits = draw[R.FLAT], int32(draw[R.BITS])
    for c in range(4):
        k, to = first + c, plane + c
        if draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT:
            iterate_exact_color(segments, triangles, colors, k, flat, edges, out, to, bits)
        else:
            iterate_color(segments, triangles, colors, k, flat, ints, out, to, bits)


@kernel(void(PASS, int64, SEGMENTS, RUNS, SCRATCH))
def shade(p, count, segments, runs, scratch):
    """Fragment colours of a batch, into ``results`` planes 0..3: interpolation, texture units, combiners.

    A texture shader may change ``depth`` and ``alive``.
    """
    separate_function()
    draw, triangles, colors, fog = p.state.draw, p.triangles, p.colors, p.fog
    bits = int32(draw[R.BITS])
    one = one_of(bits)
    edges, floats, ints, registers = scratch.edges, scratch.floats, scratch.ints, scratch.registers
    results = scratch.results
    if draw[R.DISCARDS]:
        all_alive(scratch.alive, count)
    if draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EIGHT_BITS:
        color_weights(floats, count, ints, bits)
    if draw[R.NEEDS_WEIGHTS]:
        full_weights(edges, count, floats)
    if draw[R.DIRECT]:
        iterate_four(draw, segments, triangles, colors, 0, ints, edges, results, 0)
        return
    if draw[R.NEEDS_PRIMARY]:
        plane = C.REGISTER_PRIMARY_COLOR * 4
        iterate_four(draw, segments, triangles, colors, 0, ints, edges, registers, plane)
    if draw[R.NEEDS_SECONDARY]:
        plane = C.REGISTER_SECONDARY_COLOR * 4
        iterate_four(draw, segments, triangles, colors, 4, ints, edges, registers, plane)
    if draw[R.FOG_ENABLED]:
        plane = C.REGISTER_FOG * 4 + 3
        if draw[R.FOG_ENABLED] == C.FOG_BY_TABLE:
            iterate_fog_table(segments, triangles, fog, floats, registers, plane)
        else:
            iterate_fog(segments, triangles, fog, floats, draw[R.FOG_RISING], registers, plane, bits)
    if draw[R.WRITES_TEXTURE]:
        for u in range(4):
            unbound_texture(registers, u, count, one)
    for u in range(draw[R.UNITS]):
        sample_unit(p, u, count, segments, runs, scratch)
    program, constants, arithmetic = p.combiners.program, p.combiners.constants, p.combiners.arithmetic
    for c in range(3):
        fill_plane(registers, C.REGISTER_SPARE0 * 4 + c, count, int32(0))
    copy_plane(registers, C.REGISTER_TEXTURE0 * 4 + 3, registers, C.REGISTER_SPARE0 * 4 + 3, count)
    for c in range(4):
        fill_plane(registers, C.REGISTER_SPARE1 * 4 + c, count, int32(0))
    for stage in range(draw[R.STAGES]):
        if draw[R.STAGE_CONSTANTS]:
            for c in range(8):
                fill_plane(registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, count, int32(constants[stage, c]))
        general_combiner(
            registers, program[stage], count, arithmetic, scratch.products, scratch.total, results, bits
        )
    if draw[R.STAGE_CONSTANTS]:
        for c in range(8):
            fill_plane(
                registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, count, int32(constants[draw[R.STAGES], c])
            )
    uses_ef, uses_sum = draw[R.USES_E_TIMES_F], draw[R.USES_SPARE0_PLUS_SECONDARY]
    color_sum = draw[R.COLOR_SUM]
    final_combiner(registers, p.combiners.final, count, uses_ef, uses_sum, color_sum, results, bits)


@kernel
def narrow(results, count, draw):
    """A batch's colours to the color buffer's bits."""
    for c in range(4):
        convert_plane(results, c, count, int32(draw[R.BITS]), int32(draw[R.BUFFER_BITS]))


@kernel(void(int32[:, ::1], int64, RUNS, int32[::1], uint8[::1], int32[::1]))
def record_batch(record, recorded, runs, owners, alive, covered):
    """(primitive, x, y, passed, samples) of a batch's fragments into rows of ``record`` while it has room."""
    separate_function()
    for run in range(runs.count):
        for i in range(runs.starts[run], runs.starts[run + 1]):
            row = recorded + i
            if row < record.shape[0]:
                record[row, 0] = owners[run]
                record[row, 1] = runs.x[run] + int32(i - runs.starts[run])
                record[row, 2] = runs.y[run]
                record[row, 3] = int32(alive[i])
                record[row, 4] = covered[i]


@kernel(int64(plain(PASS), plain(BANDS), int64, int64, int64, plain(BUFFERS), int32[:, ::1]), allocates=True)
def draw_bands(arrays, bands, first_band, band_step, batch, buffers, record):
    """Draw bands first_band, first_band + band_step, ... of the framebuffer, ``batch`` fragments at a time.

    ``arrays``, ``bands``, ``buffers``: those of a Pass, Bands and Buffers, in plain tuples. ``record``
    int32[n, 5] takes (primitive, x, y, passed, covered samples, 0 of a draw by pixels' middles) of every
    fragment while it has room (n = 0: nothing is recorded). Returns the number of fragments drawn; -1, and
    nothing is drawn, where rows or columns would lead a kernel outside an array
    (``fixedpipe.raster.portable.check``).
    """
    p, target = as_pass(arrays), as_buffers(buffers)
    height, words = target.color.shape
    if batch < 16 or band_step < 1 or not usable(p, height, words):
        return int64(-1)
    if record.shape[0] > 0 and record.shape[1] < 5:
        return int64(-1)
    edges = Edges(np.empty(batch, np.float64), np.empty(batch, np.float64), np.empty(batch, np.float64))
    floats, ints = np.empty((R.FLOAT_COLUMNS, batch), np.float64), np.empty((R.INT_COLUMNS, batch), np.int32)
    packed, registers = (
        np.empty((R.PACKED_COLUMNS, batch), np.uint32),
        np.zeros((R.REGISTERS * 4, batch), np.int16),
    )
    products, total = np.empty((8, batch), np.int32), np.empty((1, batch), np.int32)
    results, shaded = np.empty((12, batch), np.int16), np.empty(batch, np.uint32)
    depth, alive = np.empty(batch, np.int32), np.empty(batch, np.uint8)
    lists = np.empty((R.LISTS, batch + 1), np.int32)
    scratch = Scratch(
        edges, floats, ints, packed, registers, products, total, results, shaded, depth, alive, lists
    )
    state, triangles, strokes, vertices = p.state, p.triangles, p.strokes, p.vertices
    draw, draw_float, factors, constants = state.draw, state.draw_float, state.factors, p.combiners.constants
    z, inverse_w = vertices.z, vertices.inverse_w
    needs_depth = draw[R.NEEDS_DEPTH]
    needs_full_weights = draw[R.NEEDS_WEIGHTS] or draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT
    needs_iteration_weights = draw[R.NEEDS_ITERATION_WEIGHTS] or (needs_depth and draw[R.W_BUFFERING])
    has_strokes, has_offset = draw[R.STROKES], draw[R.POLYGON_OFFSET]
    holes = draw[R.WINDOW_CLIP] != C.WINDOW_CLIP_NONE or draw[R.STIPPLE] != 0
    cut_lines = draw[R.LINE_FACTOR] != 0 or (
        draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS and draw[R.LINE_WIDTH] > R.PIXEL_WIDE
    )
    samples, spans = draw[R.COVER_SAMPLES], np.empty((R.MAX_COVER_SAMPLES, 2), np.int64)
    for i in range(batch):
        ints[R.COVERED, i] = int32(samples)
    for c in range(8):
        fill_plane(registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, batch, int32(constants[0, c]))
    for c in range(3):
        fill_plane(registers, C.REGISTER_FOG * 4 + c, batch, int32(draw[R.FOG_RED + c]))
    one = one_of(int32(draw[R.BITS]))
    fill_plane(registers, C.REGISTER_FOG * 4 + 3, batch, one)
    for u in range(4):
        unbound_texture(registers, u, batch, one)
    (order, ends), recorded = bands, int64(0)
    for band in range(first_band, ends.shape[0], band_step):
        begin, end = int64(ends[band - 1]) if band > 0 else int64(0), int64(ends[band])
        if begin == end:
            continue
        members = order[begin:end]
        top, bottom = max(band * BAND_HEIGHT, draw[R.Y0]), min((band + 1) * BAND_HEIGHT, draw[R.Y1])
        position, segments, runs = int64(0), int64(0), int64(0)
        for k in range(members.shape[0] + 1):
            finished = k == members.shape[0]
            t = members[k] if not finished else members[0]
            v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
            corners = corners_of(vertices, v0, v1, v2)
            x0, y0, x1, y1, x2, y2 = corners
            kind = int64(C.PRIMITIVE_TRIANGLE)
            x_low, y_low, x_high, y_high = triangle_box(draw, corners)
            if has_strokes and not finished:
                kind = int64(strokes[t, 0])
                if kind != C.PRIMITIVE_TRIANGLE:
                    x_low, y_low, x_high, y_high = stroke_box(draw, corners, kind)
            by_samples = samples > 0 and (draw[R.COVERAGE] >> kind) & 1 != 0
            first_row, last_row = max((y_low + 7) >> 4, top), min((y_high - 8) >> 4, bottom - 1)
            left, right = max((x_low + 7) >> 4, draw[R.X0]), min((x_high - 8) >> 4, draw[R.X1] - 1)
            if kind == C.PRIMITIVE_TRIANGLE and reaches_infinity(inverse_w, v0, v1, v2):
                first_row, last_row, left, right = top, bottom - 1, draw[R.X0], draw[R.X1] - 1
            if finished:
                last_row = first_row  # one turn of the row loop, to flush
            # Edge functions n1 and n2 step by these from pixel to pixel and row to row; the rest of the area
            # is n0.
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
            if kind == C.PRIMITIVE_LINE:
                n0, n2 = along_line(draw, x0, y0, x1, y1, sx, sy)
                ahead0, _ = along_line(draw, x0, y0, x1, y1, sx + 16, sy)
                below0, _ = along_line(draw, x0, y0, x1, y1, sx, sy + 16)
                area, n1 = n0 + n2, int64(0)
                right0, down0 = ahead0 - n0, below0 - n0
                right1, down1, right2, down2 = int64(0), int64(0), -right0, -down0
            iw0, iw1, iw2 = inverse_w[v0], inverse_w[v1], inverse_w[v2]
            side0, side1, side2 = int64(1), int64(1), int64(1)
            if kind == C.PRIMITIVE_TRIANGLE:
                side0, side1, side2 = side_of(iw0), side_of(iw1), side_of(iw2)
            tie0 = edge_tie(side0 * right0, side0 * down0)
            tie1 = edge_tie(side1 * right1, side1 * down1)
            tie2 = edge_tie(side2 * right2, side2 * down2)
            if iw0 == iw1 and iw1 == iw2:
                iw0 = iw1 = iw2 = 1.0
            back = int32(1) if draw[R.BACK_SIGN] == sign * side0 * side1 * side2 else int32(0)
            if kind != C.PRIMITIVE_TRIANGLE:
                back = strokes[t, 1]
            z0, z1, z2, offset = 0.0, 0.0, 0.0, 0.0
            weighed = weight_factors(iw0, iw1, iw2)
            if needs_depth and not finished:
                z0, z1, z2 = z[v0], z[v1], z[v2]
                if has_offset and kind == C.PRIMITIVE_TRIANGLE:
                    offset = offset_of(state, vertices, v0, v1, v2)
                elif kind != C.PRIMITIVE_TRIANGLE and strokes[t, 2] >= 0 and stroke_offset(draw, kind):
                    a0, a1, a2 = strokes[t, 2], strokes[t, 3], strokes[t, 4]
                    offset = offset_of(state, vertices, a0, a1, a2)
            for row in range(first_row, last_row + 1):
                start, end = left, left
                if by_samples and not finished:
                    biased = side0 * n0 + tie0, side1 * n1 + tie1, side2 * n2 + tie2
                    right_by = side0 * right0, side1 * right1, side2 * right2
                    down_by = side0 * down0, side1 * down1, side2 * down2
                    start, end = sample_spans(
                        draw, strokes, t, corners, kind, row, left, right, biased, right_by, down_by, spans
                    )
                elif not finished and kind == C.PRIMITIVE_TRIANGLE:
                    start, end = row_span(
                        side0 * n0 + tie0,
                        side1 * n1 + tie1,
                        side2 * n2 + tie2,
                        side0 * right0,
                        side1 * right1,
                        side2 * right2,
                        left,
                        right,
                    )
                elif not finished:
                    start, end = stroke_span(draw, strokes[t], corners, row, left, right, 0, 0)
                while start < end or (finished and position > 0):
                    stop = end
                    if holes and start < end:
                        start, stop = open_run(draw, kind, row, start, end)
                    column, line, alike = start, row, int64(0)
                    if cut_lines and kind == C.PRIMITIVE_LINE and start < stop:
                        start, stop, column, line, alike = line_run(
                            draw, strokes[t], corners, row, start, stop
                        )
                    if by_samples and start < stop:
                        since = start
                        here = (
                            float64(n0 + (start - left) * right0),
                            float64(n1 + (start - left) * right1),
                            float64(n2 + (start - left) * right2),
                        )
                        step = float64(right0), float64(right1), float64(right2)
                        start, stop = covered_run(
                            spans, samples, start, stop, here, step, (iw0, iw1, iw2), weighed
                        )
                        column += start - since
                    if start < stop:
                        n = min(stop - start, batch - position)
                        if by_samples:
                            for i in range(n):
                                ints[R.COVERED, position + i] = samples_inside(spans, samples, start + i)
                        elif samples > 0:
                            for i in range(n):
                                ints[R.COVERED, position + i] = int32(samples)
                        if segments == 0 or lists[R.OWNERS, segments - 1] != t:
                            lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(position), t
                            lists[R.BACKS, segments] = back
                            segments += 1
                        lists[R.RUN_STARTS, runs] = int32(position)
                        lists[R.RUN_X, runs], lists[R.RUN_Y, runs] = int32(start), int32(row)
                        ints[R.OWNER, runs] = t
                        runs += 1
                        ahead, below = column - left, line - row
                        here = (
                            float64(n0 + ahead * right0 + below * down0),
                            float64(n1 + ahead * right1 + below * down1),
                            float64(n2 + ahead * right2 + below * down2),
                        )
                        step = 0.0, 0.0, 0.0
                        if not alike:
                            step = float64(right0), float64(right1), float64(right2)
                        if needs_full_weights:
                            emit_weights(edges, position, n, here, step, (iw0, iw1, iw2))
                        if needs_iteration_weights:
                            emit_iteration_weights(floats, position, n, here, step, weighed)
                        if needs_depth and draw[R.W_BUFFERING]:
                            emit_w(floats, position, n, (z0, z1, z2), offset)
                        elif needs_depth and kind == C.PRIMITIVE_LINE:
                            # Its first vertex, the row's second and third, comes before the other.
                            back_here, back_step = (here[2], here[1], here[0]), (step[2], step[1], step[0])
                            emit_depth(floats, position, n, back_here, back_step, (z2, z1, z0), offset)
                        elif needs_depth:
                            emit_depth(floats, position, n, here, step, (z0, z1, z2), offset)
                        position += n
                        start += n
                    if position == batch or finished:
                        lists[R.STARTS, segments] = lists[R.RUN_STARTS, runs] = int32(position)
                        in_rows = Runs(lists[R.RUN_STARTS], lists[R.RUN_X], lists[R.RUN_Y], runs)
                        if needs_depth:
                            depth_words(floats, position, draw, draw_float, depth)
                        if draw[R.NEEDS_COLOR]:
                            owned = Segments(lists[R.STARTS], lists[R.OWNERS], lists[R.BACKS], segments)
                            shade(p, position, owned, in_rows, scratch)
                            if samples > 1:
                                keep_share(results, ints[R.COVERED], position, samples)
                            if draw[R.BITS] != draw[R.BUFFER_BITS]:
                                narrow(results, position, draw)
                        per_fragment(draw, position, in_rows, results, shaded, depth, alive, factors, target)
                        record_batch(record, recorded, in_rows, ints[R.OWNER], alive, ints[R.COVERED])
                        recorded += position
                        position, segments, runs = int64(0), int64(0), int64(0)
                n0 += down0
                n1 += down1
                n2 += down2
    return recorded

"""Drawing primitives band by band of rows: coverage, batches of fragments, and the order of the stages.

Triangles, lines and points come in draw order; their fragments fill a batch of columns row by row; a full
batch is shaded (interpolation, texture units, combiners: pure functions of columns) and written (per-fragment
operations). A fragment's value depends on its primitive and pixel alone, so neither bands nor the batch size
can change a bit.
"""

import numpy as np
from numba import float64, int32, int64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.check import usable
from fixedpipe.raster.portable.combine import copy_plane, fill_plane, final_combiner, general_combiner
from fixedpipe.raster.portable.interpolate import (
    color_weights,
    depth_words,
    emit_depth,
    emit_weights,
    full_weights,
    iterate_color,
    iterate_exact_color,
    iterate_fog,
    iterate_fog_table,
    iteration_weights,
)
from fixedpipe.raster.portable.per_fragment import all_alive, per_fragment
from fixedpipe.raster.portable.unit import sample_unit, unbound_texture
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.primitives.strokes import along_line, line_run, open_run, stroke_bounds, stroke_margin
from fixedpipe.raster.primitives.triangle import polygon_offset, row_span


@kernel
def stroke_span(draw, stroke, x0, y0, x1, y1, x2, y2, row, first, last):
    """The pixels [from, to) of a row, first..last, that a line or a point draws: its bounds are linear."""
    sx, sy = first * 16 + 8, row * 16 + 8
    b0, b1, b2, b3 = stroke_bounds(draw, stroke, x0, y0, x1, y1, x2, y2, sx, sy)
    c0, c1, c2, c3 = stroke_bounds(draw, stroke, x0, y0, x1, y1, x2, y2, sx + 16, sy)
    start, end = row_span(b0, b1, b2, c0 - b0, c1 - b1, c2 - b2, first, last)
    other_start, other_end = row_span(b3, b3, b3, c3 - b3, c3 - b3, c3 - b3, first, last)
    start = max(start, other_start)
    return start, max(start, min(end, other_end))


@kernel
def stroke_offset(draw, kind):
    """Whether polygons drawn as such strokes are offset in depth."""
    return draw[R.OFFSET_LINE] if kind == C.PRIMITIVE_LINE else draw[R.OFFSET_POINT]


@kernel
def iterate_four(
    draw, starts, owners, backs, segments, triangles, colors, first, ints, e0, e1, e2, out, plane
):
    """Four colour channels from ``first`` on into four planes of ``out``."""
    flat = draw[R.FLAT]
    for c in range(4):
        k, to = first + c, plane + c
        if draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT:
            iterate_exact_color(
                starts, owners, backs, segments, triangles, colors, k, flat, e0, e1, e2, out, to
            )
        else:
            iterate_color(starts, owners, backs, segments, triangles, colors, k, flat, ints, out, to)


@kernel(
    "void(i8[::1],i4[:,:,::1],i4[:,::1],i2[:,::1],i4[::1],i8,i4[::1],i4[::1],i4[::1],i8,i4[:,::1],i4[:,::1],i4[::1],i4[::1],"
    "f8[::1],u1[:,:,::1],f8[:,:,::1],f8[::1],f8[::1],u4[::1],u4[::1],u4[::1],u4[::1],i4[:,:,::1],i8[:,::1],"
    "i4[::1],i4[::1],i4[::1],i8,f8[::1],f8[::1],f8[::1],f8[:,::1],i4[:,::1],u4[:,::1],i2[:,::1],i4[:,::1],i4[:,::1],i2[:,::1],i4[::1],u1[::1])"
)
def shade(
    draw,
    program,
    final,
    constants,
    arithmetic,
    count,
    starts,
    owners,
    backs,
    segments,
    triangles,
    strokes,
    x,
    y,
    inverse_w,
    colors,
    coordinates,
    fog,
    fog_thresholds,
    texels0,
    texels1,
    texels2,
    texels3,
    levels,
    units,
    run_starts,
    run_x,
    run_y,
    runs,
    e0,
    e1,
    e2,
    floats,
    ints,
    packed,
    registers,
    products,
    total,
    results,
    depth,
    alive,
):
    """Fragment colours of a batch, into ``results`` planes 0..3: interpolation, texture units, combiners.

    A texture shader may change ``depth`` and ``alive``.
    """
    separate_function()
    if draw[R.DISCARDS]:
        all_alive(alive, count)
    if draw[R.NEEDS_ITERATION_WEIGHTS]:
        iteration_weights(e0, e1, e2, count, floats)
    if draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EIGHT_BITS:
        color_weights(floats, count, ints)
    if draw[R.NEEDS_WEIGHTS]:
        full_weights(e0, e1, e2, count, floats)
    if draw[R.DIRECT]:
        iterate_four(
            draw, starts, owners, backs, segments, triangles, colors, 0, ints, e0, e1, e2, results, 0
        )
        return
    if draw[R.NEEDS_PRIMARY]:
        iterate_four(
            draw, starts, owners, backs, segments, triangles, colors, 0, ints, e0, e1, e2, registers,
            C.REGISTER_PRIMARY_COLOR * 4,
        )  # fmt: skip
    if draw[R.NEEDS_SECONDARY]:
        iterate_four(
            draw, starts, owners, backs, segments, triangles, colors, 4, ints, e0, e1, e2, registers,
            C.REGISTER_SECONDARY_COLOR * 4,
        )  # fmt: skip
    if draw[R.FOG_ENABLED]:
        rising, plane = draw[R.FOG_RISING], C.REGISTER_FOG * 4 + 3
        if draw[R.FOG_ENABLED] == C.FOG_BY_TABLE:
            iterate_fog_table(
                starts, owners, segments, triangles, fog, floats, fog_thresholds, registers, plane
            )
        else:
            iterate_fog(
                starts, owners, segments, triangles, fog, floats, fog_thresholds, rising, registers, plane
            )
    if draw[R.WRITES_TEXTURE]:
        for u in range(4):
            unbound_texture(registers, u, count)
    for u in range(draw[R.UNITS]):
        texels = texels0 if u == 0 else (texels1 if u == 1 else (texels2 if u == 2 else texels3))
        sample_unit(
            draw, u, units, count, starts, owners, segments, triangles, strokes, x, y, inverse_w, coordinates,
            texels, levels[u], run_starts, run_x, run_y, runs, floats, ints, packed, registers, depth, alive,
        )  # fmt: skip
    for c in range(3):
        fill_plane(registers, C.REGISTER_SPARE0 * 4 + c, count, int32(0))
    copy_plane(registers, C.REGISTER_TEXTURE0 * 4 + 3, registers, C.REGISTER_SPARE0 * 4 + 3, count)
    for c in range(4):
        fill_plane(registers, C.REGISTER_SPARE1 * 4 + c, count, int32(0))
    for stage in range(draw[R.STAGES]):
        if draw[R.STAGE_CONSTANTS]:
            for c in range(8):
                fill_plane(registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, count, int32(constants[stage, c]))
        general_combiner(registers, program[stage], count, arithmetic, products, total, results)
    if draw[R.STAGE_CONSTANTS]:
        for c in range(8):
            fill_plane(
                registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, count, int32(constants[draw[R.STAGES], c])
            )
    uses_ef, uses_sum = draw[R.USES_E_TIMES_F], draw[R.USES_SPARE0_PLUS_SECONDARY]
    final_combiner(registers, final, count, uses_ef, uses_sum, draw[R.COLOR_SUM], results)


@kernel("void(i4[:,::1],i8,i4[::1],i4[::1],i4[::1],i8,i4[:,::1],u1[::1])")
def record_batch(record, recorded, run_starts, run_x, run_y, runs, ints, alive):
    """(primitive, x, y, passed) of a batch's fragments into rows of ``record`` while it has room."""
    separate_function()
    for run in range(runs):
        for i in range(run_starts[run], run_starts[run + 1]):
            row = recorded + i
            if row < record.shape[0]:
                record[row, 0] = ints[R.OWNER, run]
                record[row, 1] = run_x[run] + int32(i - run_starts[run])
                record[row, 2] = run_y[run]
                record[row, 3] = int32(alive[i])


@kernel(
    "i8(i8[::1],f8[::1],i4[:,:,::1],i4[:,::1],i2[:,::1],i4[::1],i4[:,::1],i4[:,::1],i4[:,::1],i4[::1],i4[::1],f8[::1],f8[::1],"
    "u1[:,:,::1],f8[:,:,::1],f8[::1],f8[::1],u4[::1],u4[::1],u4[::1],u4[::1],i4[:,:,::1],i8[:,::1],"
    "i4[::1],i4[::1],i8,i8,i8,u4[:,::1],u4[:,::1],u1[:,::1],i4[:,::1])",
    allocates=True,
)
def draw_bands(
    draw,
    draw_float,
    program,
    final,
    constants,
    arithmetic,
    factors,
    triangles,
    strokes,
    x,
    y,
    z,
    inverse_w,
    colors,
    coordinates,
    fog,
    fog_thresholds,
    texels0,
    texels1,
    texels2,
    texels3,
    levels,
    units,
    order,
    ends,
    first_band,
    band_step,
    batch,
    color,
    depth_buffer,
    stencil,
    record,
):
    """Draw bands first_band, first_band + band_step, ... of the framebuffer.

    Rows are laid out as ``fixedpipe.raster.rows`` says. ``order`` and ``ends`` are what ``fill_bins`` leaves:
    the primitives of band b are ``order[ends[b - 1]:ends[b]]``. ``record`` int32[n, 4] takes (primitive, x,
    y, passed) of every fragment while it has room (n = 0: nothing is recorded). Returns the number of
    fragments drawn; -1, and nothing is drawn, where rows or columns would lead a kernel outside an array
    (``fixedpipe.raster.portable.check``).
    """
    if batch < 16 or band_step < 1 or not usable(
        draw, draw_float, program, final, constants, factors, triangles, strokes, x.shape[0], inverse_w,
        colors, coordinates, fog_thresholds, texels0.shape[0], texels1.shape[0], texels2.shape[0],
        texels3.shape[0], levels, units, color.shape[0], color.shape[1],
    ):  # fmt: skip
        return int64(-1)
    e0, e1, e2 = np.empty(batch, np.float64), np.empty(batch, np.float64), np.empty(batch, np.float64)
    depth = np.empty(batch, np.int32)
    floats = np.empty((R.FLOAT_COLUMNS, batch), np.float64)
    ints = np.empty((R.INT_COLUMNS, batch), np.int32)
    packed = np.empty((R.PACKED_COLUMNS, batch), np.uint32)
    registers = np.zeros((R.REGISTERS * 4, batch), np.int16)
    products, total = np.empty((8, batch), np.int32), np.empty((1, batch), np.int32)
    results = np.empty((12, batch), np.int16)
    colors_packed, alive = np.empty(batch, np.uint32), np.empty(batch, np.uint8)
    starts, owners, backs = (
        np.empty(batch + 1, np.int32),
        np.empty(batch, np.int32),
        np.empty(batch, np.int32),
    )
    run_starts, run_x, run_y = (
        np.empty(batch + 1, np.int32),
        np.empty(batch, np.int32),
        np.empty(batch, np.int32),
    )
    for c in range(8):
        fill_plane(registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, batch, int32(constants[0, c]))
    for c in range(3):
        fill_plane(registers, C.REGISTER_FOG * 4 + c, batch, int32(draw[R.FOG_RED + c]))
    fill_plane(registers, C.REGISTER_FOG * 4 + 3, batch, int32(255))
    for u in range(4):
        unbound_texture(registers, u, batch)

    needs_weights = draw[R.NEEDS_WEIGHTS] or draw[R.NEEDS_ITERATION_WEIGHTS] or draw[R.NEEDS_COLOR_WEIGHTS]
    needs_depth, needs_color = draw[R.NEEDS_DEPTH], draw[R.NEEDS_COLOR]
    has_strokes, has_offset = draw[R.STROKES], draw[R.POLYGON_OFFSET]
    holes = draw[R.WINDOW_CLIP] != C.WINDOW_CLIP_NONE or draw[R.STIPPLE] != 0
    cut_lines = draw[R.LINE_FACTOR] != 0 or (
        draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS and draw[R.LINE_WIDTH] > R.PIXEL_WIDE
    )
    recorded = int64(0)
    for band in range(first_band, ends.shape[0], band_step):
        begin = int64(ends[band - 1]) if band > 0 else int64(0)
        members = int64(ends[band]) - begin
        if members == 0:
            continue
        top, bottom = max(band * BAND_HEIGHT, draw[R.Y0]), min((band + 1) * BAND_HEIGHT, draw[R.Y1])
        position, segments, runs = int64(0), int64(0), int64(0)
        for k in range(members + 1):
            finished = k == members
            t = order[begin + k] if not finished else order[begin]
            v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
            x0, y0, x1, y1, x2, y2 = (
                int64(x[v0]),
                int64(y[v0]),
                int64(x[v1]),
                int64(y[v1]),
                int64(x[v2]),
                int64(y[v2]),
            )
            kind, margin = int64(C.PRIMITIVE_TRIANGLE), int64(0)
            if has_strokes and not finished:
                kind = int64(strokes[t, 0])
                margin = stroke_margin(draw, kind) if kind != C.PRIMITIVE_TRIANGLE else int64(0)
            first_row = max((min(y0, min(y1, y2)) - margin + 7) >> 4, top)
            last_row = min((max(y0, max(y1, y2)) + margin - 8) >> 4, bottom - 1)
            left = max((min(x0, min(x1, x2)) - margin + 7) >> 4, draw[R.X0])
            right = min((max(x0, max(x1, x2)) + margin - 8) >> 4, draw[R.X1] - 1)
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
            # The interior lies to the right of a left edge and below a top edge: a value of 0 is inside
            # there.
            tie0 = int64(0) if right0 > 0 or (right0 == 0 and down0 > 0) else int64(-1)
            tie1 = int64(0) if right1 > 0 or (right1 == 0 and down1 > 0) else int64(-1)
            tie2 = int64(0) if right2 > 0 or (right2 == 0 and down2 > 0) else int64(-1)
            iw0, iw1, iw2 = inverse_w[v0], inverse_w[v1], inverse_w[v2]
            if iw0 == iw1 and iw1 == iw2:
                iw0 = iw1 = iw2 = 1.0
            back = int32(1) if draw[R.BACK_SIGN] == sign else int32(0)
            if kind != C.PRIMITIVE_TRIANGLE:
                back = strokes[t, 1]
            z0, z1, z2, offset, slope = 0.0, 0.0, 0.0, 0.0, 0.0
            zw0, zw1, zw2 = 1.0, 1.0, 1.0
            if needs_depth and not finished:
                z0, z1, z2 = z[v0], z[v1], z[v2]
                if draw[R.W_BUFFERING]:
                    zw0, zw1, zw2 = inverse_w[v0], inverse_w[v1], inverse_w[v2]
                if has_offset and kind == C.PRIMITIVE_TRIANGLE:
                    offset, slope = polygon_offset(draw, draw_float, v0, v1, v2, x, y, z, inverse_w)
                elif kind != C.PRIMITIVE_TRIANGLE and strokes[t, 2] >= 0 and stroke_offset(draw, kind):
                    a0, a1, a2 = strokes[t, 2], strokes[t, 3], strokes[t, 4]
                    offset, slope = polygon_offset(draw, draw_float, a0, a1, a2, x, y, z, inverse_w)
            for row in range(first_row, last_row + 1):
                start, end = left, left
                if not finished and kind == C.PRIMITIVE_TRIANGLE:
                    start, end = row_span(
                        n0 + tie0, n1 + tie1, n2 + tie2, right0, right1, right2, left, right
                    )
                elif not finished:
                    start, end = stroke_span(draw, strokes[t], x0, y0, x1, y1, x2, y2, row, left, right)
                while start < end or (finished and position > 0):
                    stop = end
                    if holes and start < end:
                        start, stop = open_run(draw, kind, row, start, end)
                    column, line, alike = start, row, int64(0)
                    if cut_lines and kind == C.PRIMITIVE_LINE and start < stop:
                        start, stop, column, line, alike = line_run(
                            draw, strokes[t], x0, y0, x1, y1, row, start, stop
                        )
                    if start < stop:
                        n = min(stop - start, batch - position)
                        if segments == 0 or owners[segments - 1] != t:
                            owners[segments], starts[segments], backs[segments] = t, int32(position), back
                            segments += 1
                        run_starts[runs], run_x[runs], run_y[runs] = int32(position), int32(start), int32(row)
                        ints[R.OWNER, runs] = t
                        runs += 1
                        ahead, below = column - left, line - row
                        m0 = float64(n0 + ahead * right0 + below * down0)
                        m1 = float64(n1 + ahead * right1 + below * down1)
                        m2 = float64(n2 + ahead * right2 + below * down2)
                        s0, s1, s2 = float64(right0), float64(right1), float64(right2)
                        if alike:
                            s0 = s1 = s2 = 0.0
                        if needs_weights:
                            emit_weights(e0, e1, e2, position, n, m0, m1, m2, s0, s1, s2, iw0, iw1, iw2)
                        if needs_depth:
                            emit_depth(
                                floats, position, n, m0, m1, m2, s0, s1, s2, zw0, zw1, zw2, z0, z1, z2,
                                offset, slope,
                            )  # fmt: skip
                        position += n
                        start += n
                    if position == batch or finished:
                        starts[segments], run_starts[runs] = int32(position), int32(position)
                        if needs_depth:
                            depth_words(floats, position, draw, draw_float, depth)
                        if needs_color:
                            shade(
                                draw, program, final, constants, arithmetic, position, starts, owners, backs,
                                segments, triangles, strokes, x, y, inverse_w, colors, coordinates, fog,
                                fog_thresholds,
                                texels0, texels1, texels2, texels3, levels, units, run_starts, run_x, run_y,
                                runs, e0, e1, e2, floats, ints, packed, registers, products, total, results,
                                depth, alive,
                            )  # fmt: skip
                        per_fragment(
                            draw, position, run_starts, run_x, run_y, runs, results, colors_packed, depth,
                            alive, factors, color, depth_buffer, stencil,
                        )  # fmt: skip
                        record_batch(record, recorded, run_starts, run_x, run_y, runs, ints, alive)
                        recorded += position
                        position, segments, runs = int64(0), int64(0), int64(0)
                n0 += down0
                n1 += down1
                n2 += down2
    return recorded

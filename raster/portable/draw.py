"""Drawing primitives band by band of rows: coverage, batches of fragments, and the order of the stages.

Triangles, lines and points come in draw order; their fragments fill a batch of columns row by row; a full
batch is shaded (interpolation, texture units, combiners: pure functions of columns) and written (per-fragment
operations). A fragment's value depends on its primitive and pixel alone, so neither bands nor the batch size
can change a bit.
"""

from typing import NamedTuple

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
from fixedpipe.raster.portable.arrays import BATCH, PASS, SCRATCH, Batch, Edges, Scratch, as_pass
from fixedpipe.raster.portable.check import usable
from fixedpipe.raster.portable.combine import (
    convert_plane,
    copy_plane,
    fill_plane,
    final_combiner,
    general_combiner,
)
from fixedpipe.raster.portable.interpolate import (
    Channel,
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
    edges_of_line,
    line_run,
    open_run,
    stroke_bounds,
    stroke_box,
    triangle_box,
)
from fixedpipe.raster.primitives.triangle import (
    as_floats,
    corners_of,
    edge_tie,
    edges_after,
    edges_of,
    limited_offset,
    polygon_offset,
    reaches_infinity,
    row_span,
    side_of,
)


@kernel
def stroke_span(draw, stroke, corners, row, first, last, right, down):
    """The pixels [from, to) of a row, first..last, that a line or a point draws: its bounds are linear.

    ``right``, ``down``: the sample of a pixel, 1/16 pixel from its middle.
    """
    sx, sy = first * 16 + 8 + right, row * 16 + 8 + down
    b0, b1, b2, b3 = stroke_bounds(draw, stroke, corners, sx, sy)
    c0, c1, c2, c3 = stroke_bounds(draw, stroke, corners, sx + 16, sy)
    start, end = row_span(b0, b1, b2, c0 - b0, c1 - b1, c2 - b2, first, last)
    other_start, other_end = row_span(b3, b3, b3, c3 - b3, c3 - b3, c3 - b3, first, last)
    start = max(start, other_start)
    return start, max(start, min(end, other_end))


@kernel
def samples_inside(spans, samples, x):
    """How many samples' spans hold pixel x."""
    count = int32(0)
    for k in range(samples):
        count += int32(spans[k, 0] <= x and x < spans[k, 1])
    return count


@kernel
def positive_weights(n, inverse_w, factors):
    """Whether edge functions times 1/w have a positive sum, and those times ``factors`` as well: weights are
    divided by both.
    """
    total = (n[0] * inverse_w[0] + n[1] * inverse_w[1]) + n[2] * inverse_w[2]
    e0 = truncate_24(truncate_24(n[0]) * factors[0])
    e1 = truncate_24(truncate_24(n[1]) * factors[1])
    e2 = truncate_24(truncate_24(n[2]) * factors[2])
    return total > 0.0 and weight_sum(e0, e1, e2) > 0.0


@kernel
def covered_run(spans, samples, start, end, here, step, weights):
    """The first run [from, to) of pixels within [start, end) with a covered sample.

    ``here``: edge functions at ``start``, which grow by ``step``; ``weights``: what multiplies them, 1/w and
    ``weight_factors``. Assumed: a pixel outside its triangle whose weights have no positive sum is left out.
    """
    inverse_w, factors = weights
    low, first = start, start
    found = False
    while first < end:
        k = float64(first - start)
        n = here[0] + k * step[0], here[1] + k * step[1], here[2] + k * step[2]
        inside = samples_inside(spans, samples, first) > 0 and positive_weights(n, inverse_w, factors)
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


class Primitive(NamedTuple):
    """A primitive that is set up for a band.

    number       its row of ``triangles``
    kind         codes.PRIMITIVE_...
    corners      primitives.triangle.Corners
    left, right  first and last pixel of the rows of its box, as far as it lies in the band
    first, last  first and last row
    edges        primitives.triangle.Edges at pixel (left, first); a line's are how far along it a pixel lies
    sides        what multiplies its edge functions for coverage (``side_of``)
    inverse_w    of its vertices; 1 where they are equal
    factors      what multiplies its edge functions for weights (``weight_factors``)
    depths       of its vertices, units
    offset       what is added to them
    back         1: it shows its back colour
    by_samples   whether it covers samples, or the middles of pixels
    """

    number: int
    kind: int
    corners: tuple
    left: int
    right: int
    first: int
    last: int
    edges: tuple
    sides: tuple
    inverse_w: tuple
    factors: tuple
    depths: tuple
    offset: float
    back: int
    by_samples: bool


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
def iterate_four(p, segments, first, scratch, out, plane):
    """Four colour channels from ``first`` on into four planes of ``out``."""
    draw = p.state.draw
    for c in range(4):
        channel = Channel(p.triangles, p.colors, int64(first + c), draw[R.FLAT], int32(draw[R.BITS]))
        if draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT:
            iterate_exact_color(segments, channel, scratch.edges, out, plane + c)
        else:
            iterate_color(segments, channel, scratch.ints, out, plane + c)


@kernel(void(PASS, int64, SEGMENTS, RUNS, SCRATCH))
def shade(p, count, segments, runs, scratch):
    """Fragment colours of a batch, into ``results`` planes 0..3: interpolation, texture units, combiners.

    A texture shader may change ``depth`` and ``alive``.
    """
    separate_function()
    draw, triangles, fog = p.state.draw, p.triangles, p.fog
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
        iterate_four(p, segments, 0, scratch, results, 0)
        return
    if draw[R.NEEDS_PRIMARY]:
        plane = C.REGISTER_PRIMARY_COLOR * 4
        iterate_four(p, segments, 0, scratch, registers, plane)
    if draw[R.NEEDS_SECONDARY]:
        plane = C.REGISTER_SECONDARY_COLOR * 4
        iterate_four(p, segments, 4, scratch, registers, plane)
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


# --------------------------------------------------------------------------------------------------- set-up


@kernel(inlined=True)
def set_up(p, t, top, bottom):
    """The Primitive of row t of ``triangles``, in rows top..bottom."""
    draw, vertices, strokes, inverse_w = p.state.draw, p.vertices, p.strokes, p.vertices.inverse_w
    v0, v1, v2 = p.triangles[t, 0], p.triangles[t, 1], p.triangles[t, 2]
    corners, kind = corners_of(vertices, v0, v1, v2), int64(C.PRIMITIVE_TRIANGLE)
    x_low, y_low, x_high, y_high = triangle_box(draw, corners)
    if draw[R.STROKES]:
        kind = int64(strokes[t, 0])
        if kind != C.PRIMITIVE_TRIANGLE:
            x_low, y_low, x_high, y_high = stroke_box(draw, corners, kind)
    triangle = kind == C.PRIMITIVE_TRIANGLE
    first, last = max((y_low + 7) >> 4, top), min((y_high - 8) >> 4, bottom)
    left, right = max((x_low + 7) >> 4, draw[R.X0]), min((x_high - 8) >> 4, draw[R.X1] - 1)
    if triangle and reaches_infinity(inverse_w, v0, v1, v2):
        first, last, left, right = top, bottom, draw[R.X0], draw[R.X1] - 1
    edges = edges_of(corners, left, first)
    if kind == C.PRIMITIVE_LINE:
        edges = edges_of_line(draw, corners, left, first, edges.sign)
    iw0, iw1, iw2 = inverse_w[v0], inverse_w[v1], inverse_w[v2]
    side0, side1, side2 = int64(1), int64(1), int64(1)
    if triangle:
        side0, side1, side2 = side_of(iw0), side_of(iw1), side_of(iw2)
    if iw0 == iw1 and iw1 == iw2:
        iw0 = iw1 = iw2 = 1.0
    back = int32(1) if draw[R.BACK_SIGN] == edges.sign * side0 * side1 * side2 else int32(0)
    if not triangle:
        back = strokes[t, 1]
    z0, z1, z2, offset = 0.0, 0.0, 0.0, 0.0
    if draw[R.NEEDS_DEPTH]:
        z0, z1, z2 = vertices.z[v0], vertices.z[v1], vertices.z[v2]
        if triangle and draw[R.POLYGON_OFFSET]:
            offset = offset_of(p.state, vertices, v0, v1, v2)
        elif not triangle and strokes[t, 2] >= 0 and stroke_offset(draw, kind):
            offset = offset_of(p.state, vertices, strokes[t, 2], strokes[t, 3], strokes[t, 4])
    by_samples = draw[R.COVER_SAMPLES] > 0 and (draw[R.COVERAGE] >> kind) & 1 != 0
    return Primitive(
        t, kind, corners, left, right, first, last, edges, (side0, side1, side2), (iw0, iw1, iw2),
        weight_factors(iw0, iw1, iw2), (z0, z1, z2), offset, back, by_samples,
    )  # fmt: skip


# --------------------------------------------------------------------------------------------------- coverage


@kernel(inlined=True)
def turned(sides, numbers):
    """Edge functions, or their steps, as coverage takes them (``side_of``)."""
    return sides[0] * numbers[0], sides[1] * numbers[1], sides[2] * numbers[2]


@kernel(inlined=True)
def biased_edges(primitive, n):
    """(a triangle's edge functions ``n`` for coverage, >= 0 inside and on its own edges; their steps to the
    right; down).
    """
    sides = primitive.sides
    right, down = turned(sides, primitive.edges.right), turned(sides, primitive.edges.down)
    n0, n1, n2 = turned(sides, n)
    n0, n1 = n0 + edge_tie(right[0], down[0]), n1 + edge_tie(right[1], down[1])
    return (n0, n1, n2 + edge_tie(right[2], down[2])), right, down


@kernel(inlined=True)
def cover(draw, strokes, primitive, n, row, spans):
    """The pixels [from, to) of a row that a primitive draws; by samples: that hold all pixels of which it
    covers a sample, and each sample's pixels into ``spans``.

    ``n``: the edge functions at the first pixel of the row.
    """
    first, last = primitive.left, primitive.right
    triangle = primitive.kind == C.PRIMITIVE_TRIANGLE
    biased, right, down = biased_edges(primitive, n)
    if not primitive.by_samples:
        if triangle:
            return row_span(biased[0], biased[1], biased[2], right[0], right[1], right[2], first, last)
        return stroke_span(draw, strokes[primitive.number], primitive.corners, row, first, last, 0, 0)
    low, high = last + 1, first
    for k in range(draw[R.COVER_SAMPLES]):
        x, y = draw[R.COVER_SAMPLE + 2 * k], draw[R.COVER_SAMPLE + 2 * k + 1]
        if triangle:
            n0 = biased[0] + ((x * right[0] + y * down[0]) >> 4)
            n1 = biased[1] + ((x * right[1] + y * down[1]) >> 4)
            n2 = biased[2] + ((x * right[2] + y * down[2]) >> 4)
            start, end = row_span(n0, n1, n2, right[0], right[1], right[2], first, last)
        else:
            start, end = stroke_span(
                draw, strokes[primitive.number], primitive.corners, row, first, last, x, y
            )
        spans[k, 0], spans[k, 1] = start, end
        if start < end:
            low, high = min(low, start), max(high, end)
    return low, max(low, high)


@kernel(inlined=True)
def next_run(draw, strokes, primitive, n, row, start, end, spans):
    """The next pixels within [start, end) of a row that are drawn together: (from, to, x, y, whether all take
    the values of one sample); (x, y): the pixel whose sample gives the first its values.

    ``n``: as in ``cover``.
    """
    kind, stop = primitive.kind, end
    if draw[R.WINDOW_CLIP] != C.WINDOW_CLIP_NONE or draw[R.STIPPLE] != 0:
        start, stop = open_run(draw, kind, row, start, end)
    x, y, alike = start, row, int64(0)
    wide = draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS and draw[R.LINE_WIDTH] > R.PIXEL_WIDE
    if kind == C.PRIMITIVE_LINE and (wide or draw[R.LINE_FACTOR] != 0) and start < stop:
        stroke, corners = strokes[primitive.number], primitive.corners
        start, stop, x, y, alike = line_run(draw, stroke, corners, row, start, stop)
    if primitive.by_samples and start < stop:
        since, right = start, primitive.edges.right
        here, step = as_floats(edges_after(n, right, start - primitive.left)), as_floats(right)
        samples, weights = draw[R.COVER_SAMPLES], (primitive.inverse_w, primitive.factors)
        start, stop = covered_run(spans, samples, start, stop, here, step, weights)
        x += start - since
    return start, stop, x, y, alike


# ---------------------------------------------------------------------------------------------- interpolation


@kernel(inlined=True)
def count_samples(draw, primitive, start, n, position, scratch):
    """How many samples of each pixel are covered, into COVERED; nothing in a Draw by pixels' middles."""
    covered, samples, spans = scratch.ints[R.COVERED], draw[R.COVER_SAMPLES], scratch.spans
    if primitive.by_samples:
        for i in range(n):
            covered[position + i] = samples_inside(spans, samples, start + i)
    elif samples > 0:
        for i in range(n):
            covered[position + i] = int32(samples)


@kernel(inlined=True)
def emit(draw, primitive, position, n, here, step, scratch):
    """Weights and depths of n fragments to the right of the one whose edge functions are ``here``."""
    floats, factors, inverse_w = scratch.floats, primitive.factors, primitive.inverse_w
    needs_depth, w_buffering = draw[R.NEEDS_DEPTH] != 0, draw[R.W_BUFFERING] != 0
    (z0, z1, z2), offset = primitive.depths, primitive.offset
    if draw[R.NEEDS_WEIGHTS] or draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT:
        emit_weights(scratch.edges, position, n, here, step, inverse_w)
    if draw[R.NEEDS_ITERATION_WEIGHTS] or (needs_depth and w_buffering):
        emit_iteration_weights(floats, position, n, here, step, factors)
    if needs_depth and w_buffering:
        emit_w(floats, position, n, (z0, z1, z2), offset)
    elif needs_depth and primitive.kind == C.PRIMITIVE_LINE:
        # A line's first vertex is its row's second and third (``primitives.strokes``).
        back_here, back_step = (here[2], here[1], here[0]), (step[2], step[1], step[0])
        emit_depth(floats, position, n, back_here, back_step, (z2, z1, z0), offset)
    elif needs_depth:
        emit_depth(floats, position, n, here, step, (z0, z1, z2), offset)


@kernel(inlined=True)
def add_run(draw, primitive, batch, start, row, n, scratch):
    """The batch with n fragments of a primitive from pixel (start, row) on; not yet their values."""
    ints, lists, position, t = scratch.ints, scratch.lists, batch.position, primitive.number
    segments, runs = batch.segments, batch.runs
    if segments == 0 or lists[R.OWNERS, segments - 1] != t:
        lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(position), t
        lists[R.BACKS, segments] = primitive.back
        segments += 1
    lists[R.RUN_STARTS, runs] = int32(position)
    lists[R.RUN_X, runs], lists[R.RUN_Y, runs] = int32(start), int32(row)
    ints[R.OWNER, runs] = t
    return Batch(position + n, segments, runs + 1, batch.drawn)


# ------------------------------------------------------------------------------------- shading and writing


@kernel(BATCH(PASS, BATCH, SCRATCH, BUFFERS, int32[:, ::1]))
def finish_batch(p, batch, scratch, target, record):
    """Shade a batch's fragments, write them, and record them; returns the empty batch that follows."""
    separate_function()
    draw, ints, lists, results = p.state.draw, scratch.ints, scratch.lists, scratch.results
    depth, alive, samples = scratch.depth, scratch.alive, draw[R.COVER_SAMPLES]
    position, segments, runs = batch.position, batch.segments, batch.runs
    lists[R.STARTS, segments] = lists[R.RUN_STARTS, runs] = int32(position)
    in_rows = Runs(lists[R.RUN_STARTS], lists[R.RUN_X], lists[R.RUN_Y], runs)
    if draw[R.NEEDS_DEPTH]:
        depth_words(scratch.floats, position, draw, p.state.draw_float, depth)
    if draw[R.NEEDS_COLOR]:
        owned = Segments(lists[R.STARTS], lists[R.OWNERS], lists[R.BACKS], segments)
        shade(p, position, owned, in_rows, scratch)
        if samples > 1:
            keep_share(results, ints[R.COVERED], position, samples)
        if draw[R.BITS] != draw[R.BUFFER_BITS]:
            narrow(results, position, draw)
    per_fragment(p.state, position, in_rows, results, scratch.shaded, depth, alive, target)
    record_batch(record, batch.drawn, in_rows, ints[R.OWNER], alive, ints[R.COVERED])
    return Batch(int64(0), int64(0), int64(0), batch.drawn + position)


# --------------------------------------------------------------------------------------------- the pipeline


@kernel(int64(PASS, int32[::1], int64, int64, SCRATCH, BUFFERS, int32[:, ::1], int64))
def draw_band(p, members, number, capacity, scratch, target, record, drawn):
    """Draw the primitives ``members`` in band ``number``; returns how many fragments there are with the
    ``drawn`` ones before them.

    Primitives are set up, covered row by row, and interpolated in draw order, and their fragments fill a
    batch of ``capacity`` columns; a full batch is shaded and written (``finish_batch``).
    """
    separate_function()
    draw, strokes = p.state.draw, p.strokes
    top, bottom = max(number * BAND_HEIGHT, draw[R.Y0]), min((number + 1) * BAND_HEIGHT, draw[R.Y1]) - 1
    batch = Batch(int64(0), int64(0), int64(0), drawn)
    for k in range(members.shape[0]):
        primitive = set_up(p, members[k], top, bottom)
        n, right, down = primitive.edges.n, primitive.edges.right, primitive.edges.down
        for row in range(primitive.first, primitive.last + 1):
            start, end = cover(draw, strokes, primitive, n, row, scratch.spans)
            while start < end:
                start, stop, x, y, alike = next_run(
                    draw, strokes, primitive, n, row, start, end, scratch.spans
                )
                if start == stop:
                    continue
                position, count = batch.position, min(stop - start, capacity - batch.position)
                batch = add_run(draw, primitive, batch, start, row, count, scratch)
                at = edges_after(edges_after(n, right, x - primitive.left), down, y - row)
                step = (0.0, 0.0, 0.0) if alike else as_floats(right)
                count_samples(draw, primitive, start, count, position, scratch)
                emit(draw, primitive, position, count, as_floats(at), step, scratch)
                start += count
                if batch.position == capacity:
                    batch = finish_batch(p, batch, scratch, target, record)
            n = edges_after(n, down, 1)
    if batch.position > 0:
        batch = finish_batch(p, batch, scratch, target, record)
    return batch.drawn


@kernel(void(PASS, int64, SCRATCH))
def begin_registers(p, capacity, scratch):
    """What registers and columns hold that no batch of a Draw changes."""
    separate_function()
    draw, registers, constants = p.state.draw, scratch.registers, p.combiners.constants
    one, samples = one_of(int32(draw[R.BITS])), int32(draw[R.COVER_SAMPLES])
    for i in range(capacity):
        scratch.ints[R.COVERED, i] = samples
    for c in range(8):
        fill_plane(registers, C.REGISTER_CONSTANT_COLOR0 * 4 + c, capacity, int32(constants[0, c]))
    for c in range(3):
        fill_plane(registers, C.REGISTER_FOG * 4 + c, capacity, int32(draw[R.FOG_RED + c]))
    fill_plane(registers, C.REGISTER_FOG * 4 + 3, capacity, one)
    for u in range(4):
        unbound_texture(registers, u, capacity, one)


@kernel(int64(plain(PASS), plain(BANDS), int64, int64, int64, plain(BUFFERS), int32[:, ::1]), allocates=True)
def draw_bands(arrays, bands, first_band, band_step, capacity, buffers, record):
    """Draw bands first_band, first_band + band_step, ... of the framebuffer, in batches of ``capacity``
    fragments.

    ``arrays``, ``bands``, ``buffers``: those of a Pass, Bands and Buffers, in plain tuples. ``record``
    int32[n, 5] takes (primitive, x, y, passed, covered samples, 0 of a draw by pixels' middles) of every
    fragment while it has room (n = 0: nothing is recorded). Returns the number of fragments drawn; -1, and
    nothing is drawn, where rows or columns would lead a kernel outside an array
    (``fixedpipe.raster.portable.check``).
    """
    p, target, (order, ends) = as_pass(arrays), as_buffers(buffers), bands
    height, words = target.color.shape
    if capacity < 16 or band_step < 1 or not usable(p, height, words):
        return int64(-1)
    if record.shape[0] > 0 and record.shape[1] < 5:
        return int64(-1)
    scratch = Scratch(
        edges=Edges(np.empty(capacity), np.empty(capacity), np.empty(capacity)),
        floats=np.empty((R.FLOAT_COLUMNS, capacity)),
        ints=np.empty((R.INT_COLUMNS, capacity), np.int32),
        packed=np.empty((R.PACKED_COLUMNS, capacity), np.uint32),
        registers=np.zeros((R.REGISTERS * 4, capacity), np.int16),
        products=np.empty((8, capacity), np.int32),
        total=np.empty((1, capacity), np.int32),
        results=np.empty((12, capacity), np.int16),
        shaded=np.empty(capacity, np.uint32),
        depth=np.empty(capacity, np.int32),
        alive=np.empty(capacity, np.uint8),
        lists=np.empty((R.LISTS, capacity + 1), np.int32),
        spans=np.empty((R.MAX_COVER_SAMPLES, 2), np.int64),
    )
    begin_registers(p, capacity, scratch)
    drawn = int64(0)
    for band in range(first_band, ends.shape[0], band_step):
        begin, end = int64(ends[band - 1]) if band > 0 else int64(0), int64(ends[band])
        if begin < end:
            drawn = draw_band(p, order[begin:end], band, capacity, scratch, target, record, drawn)
    return drawn

"""A band of rows of a Draw: set-up, coverage, and the order of the stages (``draw_band``)."""

from typing import NamedTuple

from numba import boolean, float64, int32, int64

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BUFFERS
from fixedpipe.raster.fixed import reciprocal_24
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.interpolate import weight_factors
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.primitives.triangle import (
    as_floats,
    corners_of,
    edge_tie,
    edges_after,
    edges_of,
    polygon_offset,
    row_span,
)
from fixedpipe.raster.vector.addresses import words_at
from fixedpipe.raster.vector.arrays import JOB, SCRATCH, pass_of
from fixedpipe.raster.vector.batch import (
    add_mixed_run,
    add_run,
    add_segment,
    close_mixed,
    depth_range,
    empty_batch,
    finish_batch,
    one_color,
    open_mixed,
    with_row,
    with_small,
    without,
)
from fixedpipe.raster.vector.colors import (
    Colors,
    spread_colors,
)
from fixedpipe.raster.vector.hidden import are_hidden, is_hidden, tests_early
from fixedpipe.raster.vector.interpolate import (
    Depths,
    run_depth,
    run_weights,
    spread,
    spread_coordinates,
    spread_depth,
    triangle_depth,
    triangle_weights,
)
from fixedpipe.raster.vector.lanes import (
    count_bits,
    lowest_bit,
    mask_bits,
    ramp_f64x8,
    ramp_i32x8,
    ramp_i32x16,
    store,
)
from fixedpipe.raster.vector.single_depths import (
    have_24_bits,
    keep_depths,
    single_run_depth,
    single_triangle_depth,
)
from fixedpipe.raster.vector.singles import single_column_weights, single_factors, single_weights
from fixedpipe.raster.vector.small_triangles import LARGEST_SMALL, set_up, share
from fixedpipe.raster.vector.weights import run_color_weights, whole_weights

SMALL = 32  # pixels: triangles whose box is not wider share segments
ALONE = 32  # fragments: from here on a triangle is a segment of its own


class Band(NamedTuple):
    """What all triangles of a Draw have in common in one band of rows.

    left, right  first and last pixel of a row that may be drawn
    top, bottom  first and last row
    width        of the framebuffer, pixels
    capacity     fragments that a batch holds
    low, high    the limits of depths, in units
    mixes        whether small triangles share segments
    one_color    whether one colour is all that fragments have, or none is needed; not in a recorded Draw
    iterates     whether the primary or the secondary colour is needed
    early        whether fragments are left out that are hidden (``hidden.tests_early``); likewise
    """

    left: int
    right: int
    top: int
    bottom: int
    width: int
    capacity: int
    low: float
    high: float
    mixes: bool
    one_color: bool
    iterates: bool
    early: bool


class Triangle(NamedTuple):
    """A triangle in a band.

    number         its row of ``triangles``
    v0, v1, v2     its vertices
    left, right    first and last pixel of the rows of its box, as far as it lies in the band
    top, bottom    first and last row
    edges          primitives.triangle.Edges at the first pixel of its first row
    depths         interpolate.Depths
    solid, word    whether one colour and one depth word are all that its fragments have; that word
    small          whether it goes into a mixed segment, or becomes one of its own, by masks of its rows
    """

    number: int
    v0: int
    v1: int
    v2: int
    left: int
    right: int
    top: int
    bottom: int
    edges: tuple
    depths: tuple
    solid: bool
    word: int
    small: bool


# --------------------------------------------------------------------------------------------------- set-up


@kernel(inlined=True)
def band_of(job, p, number, capacity, buffers):
    """The Band of rows ``number`` of a Draw."""
    draw = p.state.draw
    low, high = depth_range(draw, p.state.draw_float)
    needs_color, equal = draw[R.NEEDS_COLOR] != 0, job[R.JOB_ONE_COLOR] != 0
    recorded = job[R.JOB_RECORDED] != 0
    iterates = draw[R.DIRECT] != 0 or draw[R.NEEDS_PRIMARY] != 0 or draw[R.NEEDS_SECONDARY] != 0
    return Band(
        left=draw[R.X0],
        right=draw[R.X1] - 1,
        top=max(number * BAND_HEIGHT, draw[R.Y0]),
        bottom=min((number + 1) * BAND_HEIGHT, draw[R.Y1]) - 1,
        width=int64(buffers.color.shape[1]),
        capacity=capacity,
        low=low,
        high=high,
        mixes=capacity >= SMALL * BAND_HEIGHT,
        one_color=not recorded and (not needs_color or (draw[R.DIRECT] != 0 and equal)),
        iterates=needs_color and iterates,
        early=not recorded and tests_early(draw),
    )


@kernel(inlined=True)
def triangle_of(p, t, band):
    """Triangle ``t`` in a band: its box, its vertices' depths, and how it is drawn."""
    draw, z = p.state.draw, p.vertices.z
    v0, v1, v2 = p.triangles[t, 0], p.triangles[t, 1], p.triangles[t, 2]
    corners = corners_of(p.vertices, v0, v1, v2)
    x0, y0, x1, y1, x2, y2 = corners
    x_least, x_most = min(x0, min(x1, x2)), max(x0, max(x1, x2))
    y_least, y_most = min(y0, min(y1, y2)), max(y0, max(y1, y2))
    top, bottom = max((y_least + 7) >> 4, band.top), min((y_most - 8) >> 4, band.bottom)
    left, right = max((x_least + 7) >> 4, band.left), min((x_most - 8) >> 4, band.right)
    edges = edges_of(corners, left, top)
    z0, z1, z2, offset = 0.0, 0.0, 0.0, 0.0
    if draw[R.NEEDS_DEPTH]:
        z0, z1, z2 = z[v0], z[v1], z[v2]
        if draw[R.POLYGON_OFFSET]:
            offset = polygon_offset(p.state, p.vertices, v0, v1, v2)
    depths = Depths((z0, z1, z2), offset, band.low, band.high)
    solid = band.one_color and z0 == z1 and z1 == z2
    word = int32(min(max(z0 + offset, band.low), band.high)) if solid else int32(0)
    small = band.mixes and not solid and right - left < SMALL
    small = small and x_most - x_least < LARGEST_SMALL and y_most - y_least < LARGEST_SMALL
    return Triangle(t, v0, v1, v2, left, right, top, bottom, edges, depths, solid, word, small)


@kernel(inlined=True)
def factors_of(vertices, t):
    """What a triangle's edge functions are multiplied with for weights."""
    inverse_w = vertices.inverse_w
    return weight_factors(inverse_w[t.v0], inverse_w[t.v1], inverse_w[t.v2])


@kernel(inlined=True)
def back_of(draw, sign):
    """1 where a triangle whose edge functions have this sign shows its back colour, else 0."""
    return int32(1) if draw[R.BACK_SIGN] == sign else int32(0)


@kernel(inlined=True)
def has_room(batch, t, capacity):
    """Whether a batch can take a triangle: a small one whole; a solid one where the batch's depth word is
    its own. Any other is divided among batches.
    """
    if t.solid != batch.solid:
        return False
    if t.small:
        return batch.position + (t.right - t.left + 1) * (t.bottom - t.top + 1) <= capacity
    return not t.solid or t.word == batch.word


# ---------------------------------------------------------------------------------------- a small triangle


@kernel(inlined=True)
def cover_small(t, band, row_runs, batch, scratch):
    """Edge functions and pixels of a small triangle's fragments into their columns, and with ``row_runs``
    their runs: (position, runs) behind them.

    Sixteen pixels at a time: half a row, a row, or two where eight pixels hold one; then lane 8 begins the
    second.
    """
    floats, ints = scratch.floats, scratch.ints
    position, runs = batch.position, batch.runs
    (n0, n1, n2), (right0, right1, right2), (down0, down1, down2), _area, _sign = t.edges
    s0, s1, s2 = as_floats(t.edges.right)
    step0, step1, step2 = ramp_f64x8() * s0, ramp_f64x8() * s1, ramp_f64x8() * s2
    wide, wider = t.right - t.left >= 8, t.right - t.left >= 16
    lane = ramp_i32x16()
    along = lane if wide else lane & 7
    below = lane ^ lane if wide else lane >> 3
    c0 = along * int32(right0) + below * int32(down0) + int32(n0 + edge_tie(right0, down0))
    c1 = along * int32(right1) + below * int32(down1) + int32(n1 + edge_tie(right1, down1))
    c2 = along * int32(right2) + below * int32(down2) + int32(n2 + edge_tie(right2, down2))
    rows_at_once = int64(1 if wide else 2)
    columns = (int64(1) << (t.right - t.left + 1)) - 1
    mask = int64(0)
    for row in range(t.bottom - t.top + 1):
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
        at = (t.top + row) * band.width + t.left + start
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
            runs = add_run(scratch, runs, position, t.number, t.left + start, t.top + row)
        position += n
    return position, runs


@kernel(inlined=True)
def small_alone(job, p, t, band, batch, end, buffers, scratch):
    """The batch with a small triangle's fragments as a segment of their own; ``end``: as ``cover_small`` has
    it.
    """
    draw, floats, ints, lists = p.state.draw, scratch.floats, scratch.ints, scratch.lists
    (position, runs), begin, area = end, batch.position, float64(t.edges.area)
    n = position - begin
    # First, because what it writes goes a vector beyond the segment's end.
    close_mixed(job, draw, scratch, batch, begin, (band.low, band.high))
    if draw[R.NEEDS_DEPTH]:
        words = ints[R.DEPTH_WORD]
        if keep_depths(ints, t.edges.area, True, t.depths):
            single_triangle_depth(floats, ints, begin, n)
        else:
            triangle_depth(floats, words, begin, n, t.depths, area)
        depth_words = words_at(int64(buffers.depth.ctypes.data), int64(buffers.depth.size))
        function = int64(draw[R.DEPTH_FUNCTION])
        if band.early and are_hidden(depth_words, ints[R.PIXEL], words, begin, n, function):
            return without(batch, n)
    if not job[R.JOB_ROW_RUNS]:
        runs = add_mixed_run(lists, runs, begin)
    single = boolean(False)
    if draw[R.NEEDS_ITERATION_WEIGHTS]:
        factors = factors_of(p.vertices, t)
        single = single_column_weights(scratch.singles, floats, begin, n, factors, area)
        if not single:
            triangle_weights(floats, begin, n, factors, area)
            if job[R.JOB_OF_COLORS]:
                whole_weights(floats, ints, begin, n)
    add_segment(lists, batch.segments, begin, t.number, back_of(draw, t.edges.sign), single)
    return with_small(batch, position, batch.segments + 1, runs, int64(-1))


@kernel(inlined=True)
def small_mixed(job, p, t, band, batch, end, scratch):
    """The batch with a small triangle's fragments in the mixed segment: their triangle's numbers in their
    columns; ``end``: as ``cover_small`` has it.
    """
    draw, floats, lists = p.state.draw, scratch.floats, scratch.lists
    (position, runs), begin, area = end, batch.position, float64(t.edges.area)
    n = position - begin
    if not job[R.JOB_ROW_RUNS]:
        runs = add_mixed_run(lists, runs, begin)
    mixed_from, segments = open_mixed(lists, batch, begin)
    if draw[R.NEEDS_ITERATION_WEIGHTS]:
        if job[R.JOB_PERSPECTIVE]:
            factors = factors_of(p.vertices, t)
            spread(floats[R.WEIGHT_FACTOR0], begin, n, factors[0])
            spread(floats[R.WEIGHT_FACTOR1], begin, n, factors[1])
            spread(floats[R.WEIGHT_FACTOR2], begin, n, factors[2])
        else:
            spread(floats[R.WEIGHT_FACTOR0], begin, n, reciprocal_24(area))
    if draw[R.NEEDS_DEPTH]:
        spread_depth(floats, begin, n, t.depths, area)
    if band.iterates and not job[R.JOB_ONE_COLOR]:
        terms, colors = scratch.planes[R.COLOR_TERMS :], Colors(p.triangles, p.vertices.colors, draw[R.FLAT])
        channels, back = int64(8 if draw[R.NEEDS_SECONDARY] else 4), back_of(draw, t.edges.sign)
        spread_colors(terms, begin, n, colors, channels, t.number, back)
    for u in range(draw[R.UNITS]):
        components = job[R.JOB_COMPONENTS + u]
        if components:
            coordinates, vertices = p.vertices.coordinates, (t.v0, t.v1, t.v2)
            spread_coordinates(floats, begin, n, coordinates, u, components, vertices)
    return with_small(batch, position, segments, runs, mixed_from)


@kernel(inlined=True)
def draw_small(job, p, t, band, batch, buffers, scratch):
    """The batch with the fragments of a small triangle, for which it has room."""
    end = cover_small(t, band, job[R.JOB_ROW_RUNS], batch, scratch)
    if end[0] == batch.position:
        return batch
    if end[0] - batch.position >= ALONE:
        return small_alone(job, p, t, band, batch, end, buffers, scratch)
    return small_mixed(job, p, t, band, batch, end, scratch)


# ------------------------------------------------------------------------------------------ row by row


@kernel(inlined=True)
def draw_rows(job, p, t, band, batch, buffers, scratch):
    """The batch with the fragments of a triangle, row by row; a full batch is finished on the way."""
    draw, floats, ints, lists = p.state.draw, scratch.floats, scratch.ints, scratch.lists
    (n0, n1, n2), right, down, _area, sign = t.edges
    ties = edge_tie(right[0], down[0]), edge_tie(right[1], down[1]), edge_tie(right[2], down[2])
    step, factors, back = as_floats(right), factors_of(p.vertices, t), back_of(draw, sign)
    can_be_single, scaled = single_factors(factors)
    needs_weights, needs_depth = draw[R.NEEDS_ITERATION_WEIGHTS], draw[R.NEEDS_DEPTH]
    single = can_be_single and needs_weights != 0 and job[R.JOB_OF_COLORS] == 0
    kept = needs_depth != 0 and keep_depths(ints, t.edges.area, have_24_bits(t.edges), t.depths)
    for row in range(t.top, t.bottom + 1):
        start, end = row_span(
            n0 + ties[0], n1 + ties[1], n2 + ties[2], right[0], right[1], right[2], t.left, t.right
        )
        while start < end:
            position = batch.position
            n = min(end - start, band.capacity if batch.solid else band.capacity - position)
            here = as_floats(edges_after((n0, n1, n2), right, start - t.left))
            if not batch.solid and needs_depth:
                words = ints[R.DEPTH_WORD]
                if kept:
                    single_run_depth(ints, position, n, here, step)
                else:
                    run_depth(words, position, n, here, step, t.depths)
                function = int64(draw[R.DEPTH_FUNCTION])
                if band.early and is_hidden(buffers.depth[row], start, words, position, n, function):
                    batch = without(batch, n)
                    start += n
                    continue
            add_run(scratch, batch.runs, position, t.number, start, row)
            segments = batch.segments
            if not batch.solid:
                if segments == 0 or lists[R.OWNERS, segments - 1] != t.number:
                    segments = add_segment(lists, segments, position, t.number, back, single)
                if job[R.JOB_OF_COLORS]:
                    run_color_weights(ints, position, n, here, step)
                elif single:
                    single_weights(scratch.singles, position, n, here, step, scaled)
                elif needs_weights:
                    run_weights(floats, position, n, here, step, factors)
            batch = with_row(batch, n, segments)
            start += n
            if (batch.runs if batch.solid else batch.position) >= band.capacity:
                batch = finish_batch(job, t.number, batch, buffers, scratch)
        n0, n1, n2 = edges_after((n0, n1, n2), down, 1)
    return batch


# --------------------------------------------------------------------------------------------- the pipeline


@kernel(int64(JOB, int32[::1], int64, int64, BUFFERS, SCRATCH))
def draw_band(job, members, number, capacity, buffers, scratch):
    """Band ``number`` of a Draw whose triangles there are ``members``; returns how many fragments it makes.

    Triangles are set up and covered in draw order, and their fragments fill a batch of ``capacity`` columns;
    a full batch is shaded and written (``finish_batch``). The smallest triangles are set up sixteen at a time
    (``small_triangles``). Other small ones share a mixed segment, or are a segment of their own from ALONE
    fragments on. All others are drawn row by row. A solid triangle keeps only its runs, and no columns.
    """
    separate_function()
    p = pass_of(job)
    band = band_of(job, p, number, capacity, buffers)
    if band.iterates and job[R.JOB_ONE_COLOR]:
        one_color(p.vertices.colors[p.triangles[members[0], 3], 0], scratch.planes)
    batch = empty_batch(boolean(False), int32(0), int64(0))
    sixteen, taken, k = band.mixes and not band.one_color, int64(0), int64(0)
    while k < members.shape[0]:
        if sixteen and k & 15 == 0:
            taken = set_up(job, members, k, band.top, band.bottom, scratch)
        if (taken >> (k & 15)) & 1:
            k, batch, full = share(job, members, k, taken, batch, capacity, band.width, scratch)
            if full:
                batch = finish_batch(job, members[0], batch, buffers, scratch)
            continue
        t = triangle_of(p, members[k], band)
        if not has_room(batch, t, capacity):
            batch = finish_batch(job, t.number, batch, buffers, scratch)
            batch = empty_batch(t.solid, t.word, batch.drawn)
            scratch.ints[R.DEPTH_WORD, 0] = t.word
        if t.small:
            batch = draw_small(job, p, t, band, batch, buffers, scratch)
        else:
            close_mixed(job, p.state.draw, scratch, batch, batch.position, (band.low, band.high))
            batch = draw_rows(job, p, t, band, without(batch, 0), buffers, scratch)
        k += 1
    return finish_batch(job, members[0], batch, buffers, scratch).drawn

"""A batch of the vector engine: how triangles' fragments are gathered in its columns, and how a full one is
shaded and written.
"""

from typing import NamedTuple

from numba import float64, int16, int32, int64, types, uint32

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BUFFERS, Runs, type_of
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.arrays import JOB, SCRATCH, pass_of
from fixedpipe.raster.vector.colors import (
    Colors,
    ColorWeights,
    iterate_colors,
    iterate_packed,
)
from fixedpipe.raster.vector.combine import combine
from fixedpipe.raster.vector.interpolate import (
    Listed,
    mixed_depth,
    mixed_weights,
)
from fixedpipe.raster.vector.lanes import i16x16, store
from fixedpipe.raster.vector.per_fragment import Fragments, write_fragments
from fixedpipe.raster.vector.record import record_batch
from fixedpipe.raster.vector.unit import sample


class Batch(NamedTuple):
    """What a batch holds so far.

    position    fragments, which is how many columns are taken; of a solid batch the length of all runs
    longest     fragments of its longest run
    segments    how many; of a solid batch none
    runs        how many
    mixed_from  the first fragment of the mixed segment that is open; -1: none is
    solid       whether one colour and one depth word are all that its fragments have: columns stay empty
    word        that depth word
    drawn       fragments of the batches before it, and those that were left out because they are hidden
    """

    position: int
    longest: int
    segments: int
    runs: int
    mixed_from: int
    solid: bool
    word: int
    drawn: int


_COUNTS = (types.int64,) * 5
BATCH = type_of(Batch, *_COUNTS, types.boolean, types.int32, types.int64)


# ------------------------------------------------------------------------------------------------ gathering


@kernel(inlined=True)
def empty_batch(solid, word, drawn):
    """A Batch that holds nothing yet."""
    zero = int64(0)
    return Batch(zero, zero, zero, zero, int64(-1), solid, word, drawn)


@kernel(inlined=True)
def with_row(batch, n, segments):
    """The batch with a run of n fragments more, and so many segments."""
    return Batch(
        batch.position + n,
        max(batch.longest, n),
        segments,
        batch.runs + 1,
        batch.mixed_from,
        batch.solid,
        batch.word,
        batch.drawn,
    )


@kernel(inlined=True)
def with_small(batch, position, segments, runs, mixed_from):
    """The batch with small triangles' fragments up to ``position``. None of them is in a solid batch."""
    return Batch(position, batch.longest, segments, runs, mixed_from, batch.solid, batch.word, batch.drawn)


@kernel(inlined=True)
def without(batch, n):
    """The batch, whose mixed segment is closed, after n fragments that are left out."""
    return Batch(
        batch.position,
        batch.longest,
        batch.segments,
        batch.runs,
        int64(-1),
        batch.solid,
        batch.word,
        batch.drawn + n,
    )


@kernel(inlined=True)
def add_run(scratch, runs, position, t, x, y):
    """A run of triangle t, whose first fragment is ``position`` and first pixel (x, y); how many runs there
    are.
    """
    lists = scratch.lists
    lists[R.RUN_STARTS, runs], lists[R.RUN_X, runs] = int32(position), int32(x)
    lists[R.RUN_Y, runs] = int32(y)
    scratch.ints[R.OWNER, runs] = t
    return runs + 1


@kernel(inlined=True)
def add_mixed_run(lists, runs, position):
    """Fragments from ``position`` on name their pixels themselves (y -1); how many runs there are."""
    if runs == 0 or lists[R.RUN_Y, runs - 1] >= 0:
        lists[R.RUN_STARTS, runs], lists[R.RUN_Y, runs] = int32(position), int32(-1)
        runs += 1
    return runs


@kernel(inlined=True)
def add_segment(lists, segments, position, t, back, single):
    """A segment of triangle t from fragment ``position`` on, whose weights are singles or not; how many
    segments there are.
    """
    lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(position), t
    lists[R.BACKS, segments], lists[R.SINGLE, segments] = back, int32(single)
    return segments + 1


@kernel(inlined=True)
def open_mixed(lists, batch, position):
    """A mixed segment from fragment ``position`` on, unless one is open: (where the open one begins, how many
    segments there are).
    """
    mixed_from, segments = batch.mixed_from, batch.segments
    if mixed_from < 0:
        mixed_from = position
        lists[R.STARTS, segments], lists[R.OWNERS, segments] = int32(position), int32(-1)
        segments += 1
    return mixed_from, segments


@kernel
def close_mixed(job, draw, scratch, batch, end, limits):
    """Weights and depth words of the mixed segment that is open, if one is, up to fragment ``end``."""
    if batch.mixed_from >= 0:
        if draw[R.NEEDS_ITERATION_WEIGHTS]:
            mixed_weights(scratch.floats, batch.mixed_from, end, job[R.JOB_PERSPECTIVE])
        if draw[R.NEEDS_DEPTH]:
            low, high = limits
            mixed_depth(scratch.floats, scratch.ints[R.DEPTH_WORD], batch.mixed_from, end, low, high)


@kernel
def depth_range(draw, draw_float):
    """The least and the greatest depth, in units."""
    farthest = float64(draw[R.DEPTH_MAX])
    low = min(max(draw_float[R.DEPTH_LOW], 0.0), farthest)
    return low, min(max(draw_float[R.DEPTH_HIGH], 0.0), farthest)


# -------------------------------------------------------------------------------------- shading and writing


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


@kernel(inlined=True)
def shade(job, p, first, count, batch, scratch):
    """Packed colours of a batch's ``count`` columns: interpolation, texture units, combiners.

    ``first``: a triangle, whose colours are all triangles' where the job has JOB_ONE_COLOR.
    """
    draw, planes, lists, shaded = p.state.draw, scratch.planes, scratch.lists, scratch.packed[R.SHADED]
    segments = Listed(lists, batch.segments)
    colors = Colors(p.triangles, p.vertices.colors, draw[R.FLAT])
    weights = ColorWeights(scratch.floats, scratch.singles, scratch.ints, job[R.JOB_OF_COLORS])
    terms, varies = planes[R.COLOR_TERMS :], not job[R.JOB_ONE_COLOR]
    if draw[R.DIRECT]:
        if varies:
            iterate_packed(segments, colors, weights, terms, shaded)
        else:
            provoking = p.triangles[first, 3]
            shaded[: 1 if batch.solid else count] = packed_color(p.vertices.colors[provoking, 0])
        return
    if draw[R.NEEDS_PRIMARY] and varies:
        iterate_colors(segments, colors, 0, weights, terms, planes, C.REGISTER_PRIMARY_COLOR * 4)
    if draw[R.NEEDS_SECONDARY] and varies:
        iterate_colors(segments, colors, 4, weights, terms[12:], planes, C.REGISTER_SECONDARY_COLOR * 4)
    runs = Runs(lists[R.RUN_STARTS], lists[R.RUN_X], lists[R.RUN_Y], batch.runs)
    for u in range(draw[R.UNITS]):
        sample(job, u, count, batch.segments, runs, scratch)
    combine(planes, p.plan, count, scratch.products, shaded)


@kernel(BATCH(JOB, int32, BATCH, BUFFERS, SCRATCH))
def finish_batch(job, first, batch, buffers, scratch):
    """Shade a batch's fragments, if there are any, and write them; returns the empty batch that follows.

    ``first``: as in ``shade``.
    """
    separate_function()
    p = pass_of(job)
    draw, ints, lists = p.state.draw, scratch.ints, scratch.lists
    position, segments, runs = batch.position, batch.segments, batch.runs
    close_mixed(job, draw, scratch, batch, position, depth_range(draw, p.state.draw_float))
    if position > 0:
        count = batch.longest if batch.solid else position
        lists[R.STARTS, segments], lists[R.RUN_STARTS, runs] = int32(count), int32(position)
        if draw[R.NEEDS_COLOR]:
            shade(job, p, first, count, batch, scratch)
        of_rows = Runs(lists[R.RUN_STARTS], lists[R.RUN_X], lists[R.RUN_Y], runs)
        columns = Fragments(scratch.packed[R.SHADED], ints[R.PIXEL], ints[R.DEPTH_WORD], scratch.alive)
        recorded = job[R.JOB_RECORDED] != 0
        write_fragments(draw, p.state.factors, count, of_rows, batch.solid, recorded, columns, buffers)
        if recorded:
            record_batch(job, batch.drawn, of_rows, ints[R.OWNER], scratch.alive)
    return empty_batch(batch.solid, batch.word, batch.drawn + position)

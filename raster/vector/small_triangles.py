"""Sixteen small triangles at a time, one in each lane: which pixels they cover, and the numbers that their
fragments carry in mixed segments.

What is computed is what ``fixedpipe.raster.vector.band`` computes for one triangle: edge functions as
integers, and the same float64 operations in the same order (``fixedpipe.raster.vector.interpolate``).
"""

from numba import float64, int32, int64, types, uint32, uint64

from fixedpipe.raster import rows as R
from fixedpipe.raster.floats import LEAST_SINGLE
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.portable.interpolate import coordinate_difference, weight_factors
from fixedpipe.raster.primitives.triangle import polygon_offset
from fixedpipe.raster.vector.arrays import JOB, SCRATCH, pass_of
from fixedpipe.raster.vector.batch import BATCH, add_mixed_run, add_run, open_mixed, with_small
from fixedpipe.raster.vector.colors import (
    Colors,
    spread_colors,
)
from fixedpipe.raster.vector.interpolate import (
    keep_24,
    reciprocals_24,
    reciprocals_29,
    spread,
)
from fixedpipe.raster.vector.lanes import (
    absolute,
    count_bits,
    f64x8,
    f64x16,
    i32x16,
    largest_lane,
    load_f64x16,
    load_i32x16,
    lowest_bit,
    mask_bits,
    maximum,
    minimum,
    ramp_f64x8,
    ramp_i32x8,
    select,
    store,
    to_float64,
)

# Pixels: a mask has bit 8 * row + column for each, the upper four rows in one word and the lower four in one.
WIDEST, HIGHEST = 8, 8
# 1/16 pixel. The visible part of a larger triangle may be as small, but its edge functions need more than 32
# bits, and its area more than the 24 bits of ``mixed_depth``.
LARGEST_SMALL = 2048
FARTHEST = 1 << 24  # 1/16 pixel: differences of nearer vertices are integers of 32 bits


@kernel
def tie_of(right, down):
    """``primitives.triangle.edge_tie`` of sixteen edges."""
    inside = (right > int32(0)) | ((right == int32(0)) & (down > int32(0)))
    return select(inside, i32x16(int32(0)), i32x16(int32(-1)))


@kernel
def difference_of(z, base):
    """``interpolate.depth_difference`` of sixteen pairs."""
    difference = keep_24(z - base)
    return select(absolute(difference) >= LEAST_SINGLE, difference, f64x16(0.0))


@kernel("i8(i4[:,::1],i8,i8,i8,i8,i8)")
def cover(lanes, count, x_first, x_last, top, bottom):
    """Rows of ``lanes`` (``rows.LANE_N0`` and what follows) for the triangles whose corners are there.

    Pixels: x_first..x_last, top..bottom. Returns a bit for each of the first ``count`` triangles that is
    small enough for a mask of its pixels (``rows.LANE_UPPER``); the others' entries have no meaning.
    """
    separate_function()
    x0, y0 = load_i32x16(lanes[R.LANE_X0], 0), load_i32x16(lanes[R.LANE_Y0], 0)
    x1, y1 = load_i32x16(lanes[R.LANE_X1], 0), load_i32x16(lanes[R.LANE_Y1], 0)
    x2, y2 = load_i32x16(lanes[R.LANE_X2], 0), load_i32x16(lanes[R.LANE_Y2], 0)
    x_least, x_most = minimum(x0, minimum(x1, x2)), maximum(x0, maximum(x1, x2))
    y_least, y_most = minimum(y0, minimum(y1, y2)), maximum(y0, maximum(y1, y2))
    small = (minimum(x_least, y_least) > int32(-FARTHEST)) & (maximum(x_most, y_most) < int32(FARTHEST))
    small = small & (maximum(x_most - x_least, y_most - y_least) < int32(LARGEST_SMALL))
    left, right = maximum((x_least + 7) >> 4, int32(x_first)), minimum((x_most - 8) >> 4, int32(x_last))
    first, last = maximum((y_least + 7) >> 4, int32(top)), minimum((y_most - 8) >> 4, int32(bottom))
    across, rows = (right - left) + int32(1), (last - first) + int32(1)
    small = small & (minimum(across, rows) > int32(0))
    small = small & (across <= int32(WIDEST)) & (rows <= int32(HIGHEST))
    found = mask_bits(small) & ((int64(1) << count) - 1)
    if found == 0:
        return found
    across, rows = select(small, across, i32x16(int32(1))), select(small, rows, i32x16(int32(1)))
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    negative = area < int32(0)
    sign = select(negative, i32x16(int32(-1)), i32x16(int32(1)))
    area = area * sign
    right1, down1 = (y2 - y0) * sign * int32(16), (x0 - x2) * sign * int32(16)
    right2, down2 = (y0 - y1) * sign * int32(16), (x1 - x0) * sign * int32(16)
    right0, down0 = int32(0) - (right1 + right2), int32(0) - (down1 + down2)
    sx, sy = left * int32(16) + int32(8), first * int32(16) + int32(8)
    n1 = ((sx - x0) * (y2 - y0) - (x2 - x0) * (sy - y0)) * sign
    n2 = ((x1 - x0) * (sy - y0) - (sx - x0) * (y1 - y0)) * sign
    n0 = area - n1 - n2
    a0, a1, a2 = n0 + tie_of(right0, down0), n1 + tie_of(right1, down1), n2 + tie_of(right2, down2)
    columns = (i32x16(int32(1)) << across) - int32(1)
    zero, one = i32x16(int32(0)), i32x16(int32(1))
    upper, lower = zero, zero
    for row in range(largest_lane(rows)):
        e0, e1, e2 = a0, a1, a2
        bit, bits = one, zero
        for _ in range(largest_lane(across)):
            bits = bits | select((e0 | e1 | e2) >= int32(0), bit, zero)
            e0, e1, e2, bit = e0 + right0, e1 + right1, e2 + right2, bit << int32(1)
        # Right of a triangle's box, and below it, nothing is inside, unless a scissor or band cut the box.
        bits = select(rows > int32(row), bits & columns, zero) << int32(8 * (row & 3))
        if row < 4:
            upper = upper | bits
        else:
            lower = lower | bits
        a0, a1, a2 = a0 + down0, a1 + down1, a2 + down2
    store(lanes[R.LANE_UPPER], 0, upper)
    store(lanes[R.LANE_LOWER], 0, lower)
    store(lanes[R.LANE_LEFT], 0, left)
    store(lanes[R.LANE_ROW], 0, first)
    store(lanes[R.LANE_SIGN], 0, sign)
    store(lanes[R.LANE_AREA], 0, area)
    store(lanes[R.LANE_N0], 0, n0)
    store(lanes[R.LANE_N1], 0, n1)
    store(lanes[R.LANE_N2], 0, n2)
    store(lanes[R.LANE_RIGHT0], 0, right0)
    store(lanes[R.LANE_RIGHT1], 0, right1)
    store(lanes[R.LANE_RIGHT2], 0, right2)
    store(lanes[R.LANE_DOWN0], 0, down0)
    store(lanes[R.LANE_DOWN1], 0, down1)
    store(lanes[R.LANE_DOWN2], 0, down2)
    return found


@kernel(int64(JOB, int32[::1], int64, int64, int64, SCRATCH))
def set_up(job, members, first, top, bottom, scratch):
    """Up to sixteen of ``members`` from ``first`` on, in rows top..bottom, into ``scratch``'s lanes; returns
    a bit for each of them that ``share`` takes.

    Row c of ``lane_floats`` goes into column ``rows.WEIGHT_FACTOR0 + c``.
    """
    separate_function()
    p = pass_of(job)
    draw, triangles, vertices = p.state.draw, p.triangles, p.vertices
    lanes, numbers = scratch.lanes, scratch.lane_floats
    count = min(members.shape[0] - first, 16)
    for lane in range(count):
        t = members[first + lane]
        v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        lanes[R.LANE_X0, lane], lanes[R.LANE_Y0, lane] = vertices.x[v0], vertices.y[v0]
        lanes[R.LANE_X1, lane], lanes[R.LANE_Y1, lane] = vertices.x[v1], vertices.y[v1]
        lanes[R.LANE_X2, lane], lanes[R.LANE_Y2, lane] = vertices.x[v2], vertices.y[v2]
    found = cover(lanes, count, draw[R.X0], draw[R.X1] - 1, top, bottom)
    if found == 0:
        return found
    needs_depth, needs_weights = draw[R.NEEDS_DEPTH], draw[R.NEEDS_ITERATION_WEIGHTS]
    perspective = job[R.JOB_PERSPECTIVE]
    w, z, own = 0, R.Z0 - R.WEIGHT_FACTOR0, R.TERMS - R.WEIGHT_FACTOR0
    left = found
    while left:
        lane = lowest_bit(left)
        left &= left - 1
        if (lanes[R.LANE_UPPER, lane] | lanes[R.LANE_LOWER, lane]) == 0:
            continue
        t = members[first + lane]
        v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if needs_weights and perspective:
            iw0, iw1, iw2 = vertices.inverse_w[v0], vertices.inverse_w[v1], vertices.inverse_w[v2]
            numbers[w, lane], numbers[w + 1, lane], numbers[w + 2, lane] = weight_factors(iw0, iw1, iw2)
        if needs_depth:
            numbers[z, lane], numbers[z + 1, lane] = vertices.z[v0], vertices.z[v1]
            numbers[z + 2, lane] = vertices.z[v2]
            if draw[R.POLYGON_OFFSET]:
                offset = polygon_offset(p.state, vertices, v0, v1, v2)
                numbers[R.Z_OFFSET - R.WEIGHT_FACTOR0, lane] = offset
        for u in range(draw[R.UNITS]):
            for component in range(4):
                if (job[R.JOB_COMPONENTS + u] >> component) & 1:
                    at, base = own + 12 * u + 3 * component, vertices.coordinates[v1, u, component]
                    numbers[at, lane] = base
                    other, third = (
                        vertices.coordinates[v0, u, component],
                        vertices.coordinates[v2, u, component],
                    )
                    numbers[at + 1, lane] = coordinate_difference(other, base)
                    numbers[at + 2, lane] = coordinate_difference(third, base)
    areas = to_float64(load_i32x16(lanes[R.LANE_AREA], 0))
    if needs_weights and not perspective:
        store(numbers[w], 0, reciprocals_24(areas))
    if needs_depth:
        z0, z1 = load_f64x16(numbers[z], 0), load_f64x16(numbers[z + 1], 0)
        z2 = load_f64x16(numbers[z + 2], 0)
        store(numbers[R.Z10 - R.WEIGHT_FACTOR0], 0, difference_of(z1, z0))
        store(numbers[R.Z20 - R.WEIGHT_FACTOR0], 0, difference_of(z2, z0))
        store(numbers[R.Z21 - R.WEIGHT_FACTOR0], 0, difference_of(z2, z1))
        store(numbers[R.Z_RECIPROCAL - R.WEIGHT_FACTOR0], 0, reciprocals_29(areas))
        if not draw[R.POLYGON_OFFSET]:
            store(numbers[R.Z_OFFSET - R.WEIGHT_FACTOR0], 0, f64x16(0.0))
    return found


@kernel(types.Tuple((int64, BATCH, int64))(JOB, int32[::1], int64, int64, BATCH, int64, int64, SCRATCH))
def share(job, members, k, taken, batch, capacity, width, scratch):
    """Fragments of the triangles from ``members[k]`` on that ``set_up`` took, into the mixed segment.

    Returns the first triangle that is not drawn, the batch with the fragments of those before it, and whether
    it was left because the batch has no room for it.
    """
    separate_function()
    p = pass_of(job)
    draw, triangles = p.state.draw, p.triangles
    lanes, numbers = scratch.lanes, scratch.lane_floats
    floats, ints, lists = scratch.floats, scratch.ints, scratch.lists
    n0, n1, n2, pixel = floats[R.N0], floats[R.N1], floats[R.N2], ints[R.PIXEL]
    row_runs, varies, flat = job[R.JOB_ROW_RUNS], draw[R.NEEDS_COLOR] != 0, draw[R.FLAT]
    varies = varies and (draw[R.DIRECT] or draw[R.NEEDS_PRIMARY] or draw[R.NEEDS_SECONDARY])
    varies = varies and not job[R.JOB_ONE_COLOR]
    channels = int64(8 if draw[R.NEEDS_SECONDARY] else 4)
    weights = int64(0)
    if draw[R.NEEDS_ITERATION_WEIGHTS]:
        weights = int64(3 if job[R.JOB_PERSPECTIVE] else 1)
    position, runs, end, full = batch.position, batch.runs, (k | 15) + 1, int64(0)
    while k < end and (taken >> (k & 15)) & 1:
        lane = k & 15
        covered = int64(uint32(lanes[R.LANE_UPPER, lane])) | (int64(lanes[R.LANE_LOWER, lane]) << 32)
        if covered == 0:
            k += 1
            continue
        if position + count_bits(covered) > capacity:
            full = int64(1)
            break
        t, begin = members[k], position
        right0, right1 = float64(lanes[R.LANE_RIGHT0, lane]), float64(lanes[R.LANE_RIGHT1, lane])
        right2 = float64(lanes[R.LANE_RIGHT2, lane])
        step0, step1, step2 = ramp_f64x8() * right0, ramp_f64x8() * right1, ramp_f64x8() * right2
        e0, e1 = float64(lanes[R.LANE_N0, lane]), float64(lanes[R.LANE_N1, lane])
        e2 = float64(lanes[R.LANE_N2, lane])
        down0, down1 = float64(lanes[R.LANE_DOWN0, lane]), float64(lanes[R.LANE_DOWN1, lane])
        down2 = float64(lanes[R.LANE_DOWN2, lane])
        left, y = int64(lanes[R.LANE_LEFT, lane]), int64(lanes[R.LANE_ROW, lane])
        while covered:
            bits = covered & 255
            if bits:
                start = lowest_bit(bits)
                ahead = float64(start)
                store(n0, position, step0 + (e0 + ahead * right0))
                store(n1, position, step1 + (e1 + ahead * right1))
                store(n2, position, step2 + (e2 + ahead * right2))
                store(pixel, position, ramp_i32x8() + int32(y * width + left + start))
                if row_runs:
                    runs = add_run(scratch, runs, position, t, left + start, y)
                position += count_bits(bits)
            e0, e1, e2 = e0 + down0, e1 + down1, e2 + down2
            y += 1
            covered = int64(uint64(covered) >> uint64(8))
        n = position - begin
        for i in range(begin, position, 8):
            for c in range(weights):
                store(floats[R.WEIGHT_FACTOR0 + c], i, f64x8(numbers[c, lane]))
            if draw[R.NEEDS_DEPTH]:
                for c in range(R.Z0 - R.WEIGHT_FACTOR0, R.TERMS - R.WEIGHT_FACTOR0):
                    store(floats[R.WEIGHT_FACTOR0 + c], i, f64x8(numbers[c, lane]))
        for u in range(draw[R.UNITS]):
            components = job[R.JOB_COMPONENTS + u]
            at = int64(R.TERMS - R.WEIGHT_FACTOR0 + 12 * u)
            while components:
                if components & 1:
                    for c in range(at, at + 3):
                        spread(floats[R.WEIGHT_FACTOR0 + c], begin, n, numbers[c, lane])
                components >>= 1
                at += 3
        if varies:
            back = int32(1) if draw[R.BACK_SIGN] == int64(lanes[R.LANE_SIGN, lane]) else int32(0)
            colors = Colors(triangles, p.vertices.colors, flat)
            spread_colors(scratch.planes[R.COLOR_TERMS :], begin, n, colors, channels, t, back)
        k += 1
    if position > batch.position:
        if not row_runs:
            runs = add_mixed_run(lists, runs, batch.position)
        mixed_from, segments = open_mixed(lists, batch, batch.position)
        batch = with_small(batch, position, segments, runs, mixed_from)
    return k, batch, full

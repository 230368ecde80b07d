"""Anisotropic filtering: pairs of filtered texels along the longer side of a fragment's footprint
(docs/numbers.md, section 7).
"""

import numpy as np
from numba import float64, int32, int64, uint32, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS
from fixedpipe.raster.kernel import float_of, kernel, separate_function, separate_loop
from fixedpipe.raster.portable.arrays import PASS, SCRATCH
from fixedpipe.raster.portable.footprint import probes_along
from fixedpipe.raster.portable.level_of_detail import coordinates_at, iterated_of, primitive_of
from fixedpipe.raster.portable.sample import FAR, filter_unit, log2_q7
from fixedpipe.raster.portable.texture_shader import copy_column


@kernel
def block_footprint(draw, kind, source, row, sizes, bx, by):
    """(along s, along t, ratio or probes, lambda) of the block whose origin is (bx, by).

    The longer of the two steps to the block's neighbours, in texture coordinates; how many times longer than
    the other, or than one texel, it is; lambda of the step divided by that, 8 fraction bits, without bias.
    ``sizes``: width and height of level 0.
    """
    divided, (width, height) = row[R.PROJECTIVE], sizes
    ok0, s0, t0, _r0 = coordinates_at(draw, kind, source, divided, bx, by)
    ok1, s1, t1, _r1 = coordinates_at(draw, kind, source, divided, bx + 1, by)
    ok2, s2, t2, _r2 = coordinates_at(draw, kind, source, divided, bx, by + 1)
    sx, tx, sy, ty = (s1 - s0) * width, (t1 - t0) * height, (s2 - s0) * width, (t2 - t0) * height
    dx2, dy2 = sx * sx + tx * tx, sy * sy + ty * ty
    if not (ok0 and ok1 and ok2 and dx2 < np.inf and dy2 < np.inf):
        return 0.0, 0.0, 1.0, FAR
    longer, shorter = max(dx2, dy2), min(dx2, dy2)
    along_s, along_t = (s1 - s0, t1 - t0) if dx2 >= dy2 else (s2 - s0, t2 - t0)
    if row[R.PROBES]:
        probes, square = probes_along(longer, shorter, row[R.PROBES], row[R.EXACT_PROBES])
        return along_s, along_t, probes, (log2_q7(square) if square > 0.0 else int32(-FAR))
    ratio = np.sqrt(longer) / max(np.sqrt(shorter), 1.0)
    ratio = min(max(ratio, 1.0), float_of(row[R.ANISOTROPY]))
    rho2 = longer / (ratio * ratio)
    return along_s, along_t, ratio, (log2_q7(rho2) if rho2 > 0.0 else int32(-FAR))


@kernel(void(PASS, int64, RUNS, SCRATCH))
def footprints(p, unit, runs, scratch):
    """ALONG_S, ALONG_T, RATIO (of footprint assembly: probes) of every fragment's block, and LOD."""
    separate_function()
    draw, row, levels = p.state.draw, p.textures.units[unit], p.textures.levels[unit]
    floats, ints = scratch.floats, scratch.ints
    width, height = float64(levels[0, 1]), float64(levels[0, 2])
    if row[R.TARGET] == C.TARGET_RECTANGLE:  # coordinates that count texels already
        width = height = 1.0
    sizes = width, height
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    for k in range(runs.count):
        t, kind = primitive_of(p, scratch, k)
        source = iterated_of(p, t, unit)
        px, by, block = int64(runs.x[k]), int64(runs.y[k]) & ~1, int64(-1)
        along_s, along_t, ratio, value = 0.0, 0.0, 1.0, int32(0)
        for i in range(runs.starts[k], runs.starts[k + 1]):
            if px & ~1 != block:
                block = px & ~1
                along_s, along_t, ratio, value = block_footprint(draw, kind, source, row, sizes, block, by)
            floats[R.ALONG_S, i], floats[R.ALONG_T, i], floats[R.RATIO, i] = along_s, along_t, ratio
            ints[R.LOD, i] = min(max(int32(value + bias), low), high)
            px += 1


@kernel
def tap_distance(pair, ratio):
    """How far from the centre a pair's texels lie, in footprints' lengths.

    Measured: up to a ratio of two 19400 of 19413 pixels, beyond it 24029 of 24116 (Anisotropy-2 and -4).
    """
    return (ratio - 1.0) / (2.0 * ratio) if ratio <= 2.0 else (float64(pair) + 0.5) / ratio


@kernel
def tap_weight(pair, ratio):
    """The weight of each texel of a pair, in 1/256: the outermost pair takes what the others leave.

    Measured: 11824 of 12015 pixels with ratios from two to four (Anisotropy-4); the 2/3 is Inferred: .53
    to .80 fit where the footprint is upright, 1/2 and 3/4 miss 1151 and 429.
    """
    inner = int32(np.floor(256.0 / ratio + 2.0 / 3.0))
    last = int32(np.ceil(ratio * 0.5)) - int32(1)
    if last <= 0:
        return int32(128) if pair == 0 else int32(0)
    return inner if pair < last else (int32(128) - inner * last if pair == last else int32(0))


@kernel("void(f8[:,::1],i8,f8,i8)")
def move_to_tap(floats, pair, sign, count):
    """S and T of one texel of a pair, from the centre's."""
    separate_loop()
    for i in range(count):
        distance = sign * tap_distance(pair, floats[R.RATIO, i])
        floats[R.S, i] = floats[R.CENTER_S, i] + distance * floats[R.ALONG_S, i]
        floats[R.T, i] = floats[R.CENTER_T, i] + distance * floats[R.ALONG_T, i]


@kernel("void(f8[:,::1],u4[:,::1],i8,i8)")
def add_tap(floats, packed, pair, count):
    """Add TEXEL_0 times its weight to the sums: two bytes at a time, 16 bits apart."""
    separate_loop()
    mask, eight = uint32(0x00FF00FF), uint32(8)
    for i in range(count):
        weight = uint32(tap_weight(pair, floats[R.RATIO, i]))
        texel = packed[R.TEXEL_0, i]
        packed[R.SUM_EVEN, i] += uint32(uint32(texel & mask) * weight)
        packed[R.SUM_ODD, i] += uint32(uint32(uint32(texel >> eight) & mask) * weight)


@kernel("void(u4[:,::1],i8)")
def begin_sums(packed, count):
    """One half in each sum, for rounding."""
    separate_loop()
    for i in range(count):
        packed[R.SUM_EVEN, i] = uint32(0x00800080)
        packed[R.SUM_ODD, i] = uint32(0x00800080)


@kernel("void(u4[:,::1],i8)")
def end_sums(packed, count):
    """The sums' upper bytes as a texel, into TEXEL_0."""
    separate_loop()
    for i in range(count):
        even = uint32(uint32(packed[R.SUM_EVEN, i] >> uint32(8)) & uint32(0x00FF00FF))
        packed[R.TEXEL_0, i] = even | uint32(packed[R.SUM_ODD, i] & uint32(0xFF00FF00))


@kernel("void(u4[::1],i4[:,::1],i8[::1],i8,f8[:,::1],i4[:,::1],u4[:,::1])")
def filter_along(texels, levels, unit, count, floats, ints, packed):
    """Filter a unit's fragments along their footprints, into TEXEL_0: S and T come back changed."""
    separate_function()
    copy_column(floats, R.S, R.CENTER_S, count)
    copy_column(floats, R.T, R.CENTER_T, count)
    begin_sums(packed, count)
    for pair in range(int64(np.ceil(float_of(unit[R.ANISOTROPY]) * 0.5))):
        for side in range(2):
            move_to_tap(floats, pair, 1.0 - 2.0 * side, count)
            filter_unit(texels, levels, unit, count, floats, ints, packed)
            add_tap(floats, packed, pair, count)
    end_sums(packed, count)

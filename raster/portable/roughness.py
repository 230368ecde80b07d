"""Lookups filtered by roughness: over the pixel's footprint and what bumps beneath a texel spread it by
(docs/numbers.md, section 12).
"""

import numpy as np
from numba import float64, int32, int64, uint32, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS
from fixedpipe.raster.kernel import float_of, kernel, separate_function
from fixedpipe.raster.portable.arrays import PASS, SCRATCH
from fixedpipe.raster.portable.footprint import probes_along
from fixedpipe.raster.portable.level_of_detail import coordinates_at, iterated_of, primitive_of
from fixedpipe.raster.portable.sample import FAR, log2_q7


@kernel
def undisplaced(draw, kind, first, second, dotted, px, py):
    """(whether D > 0, s, t) of a pixel's lookup without bumps: of dot products the third coordinates."""
    ok, s, t, r = coordinates_at(draw, kind, second, 0, px, py)
    if dotted:
        _ok, _s, _t, s = coordinates_at(draw, kind, first, 0, px, py)
        t = r
    return ok, s, t


@kernel
def block_sides(draw, kind, first, second, dotted, sizes, bx, by):
    """(whether they are there, xs, xt, ys, yt): the steps of the undisplaced lookup from a block's origin to
    its right and lower neighbours, in texels.
    """
    width, height = sizes
    ok0, s0, t0 = undisplaced(draw, kind, first, second, dotted, bx, by)
    ok1, s1, t1 = undisplaced(draw, kind, first, second, dotted, bx + 1, by)
    ok2, s2, t2 = undisplaced(draw, kind, first, second, dotted, bx, by + 1)
    steps = (s1 - s0) * width, (t1 - t0) * height, (s2 - s0) * width, (t2 - t0) * height
    return ok0 and ok1 and ok2, steps


@kernel
def rough_footprint(good, steps, jacobian, deviations, sizes, row):
    """(along s, along t, probes, lambda) of one fragment.

    steps       xs, xt, ys, yt of the pixel, texels
    jacobian    of s by the bumps' two components, then of t
    deviations  d_1, d_2, d_3, times two: a footprint's side
    row         the unit's: how many probes there are
    """
    (xs, xt, ys, yt), (su, sv, tu, tv), (d1, d2, d3) = steps, jacobian, deviations
    width, height = sizes
    us, ut = (su * d1) * width, (tu * d1) * height
    vs, vt = (su * d2 + sv * d3) * width, (tu * d2 + tv * d3) * height
    a = ((xs * xs + ys * ys) + us * us) + vs * vs
    b = ((xs * xt + ys * yt) + us * ut) + vs * vt
    c = ((xt * xt + yt * yt) + ut * ut) + vt * vt
    half, middle = 0.5 * (a - c), 0.5 * (a + c)
    root = np.sqrt(half * half + b * b)
    longer, shorter = middle + root, max(middle - root, 0.0)
    if not (good and longer < np.inf):
        return 0.0, 0.0, 1.0, FAR
    x = half + root if half >= 0.0 else b
    y = b if half >= 0.0 else root - half
    length = np.sqrt(x * x + y * y)
    x, y = (x / length, y / length) if length > 0.0 else (1.0, 0.0)
    side, probes, square = np.sqrt(longer), 1.0, longer
    if row[R.PROBES] > 1:
        probes, square = probes_along(longer, shorter, row[R.PROBES], row[R.EXACT_PROBES])
    lod = log2_q7(square) if square > 0.0 else int32(-FAR)
    return (x * side) / width, (y * side) / height, probes, lod


@kernel(void(PASS, int64, RUNS, SCRATCH))
def rough_footprints(p, unit, runs, scratch):
    """ALONG_S, ALONG_T, RATIO (the number of probes) and LOD of every fragment.

    For two dot products, s and t of both units are in COORDINATE0 and the columns behind it.
    """
    separate_function()
    draw, row, levels = p.state.draw, p.textures.units[unit], p.textures.levels[unit]
    floats, packed, ints = scratch.floats, scratch.packed, scratch.ints
    width, height = float64(levels[0, 1]), float64(levels[0, 2])
    sizes, stage = (width, height), R.STAGE0 + row[R.ROUGHNESS] - 1
    dotted = row[R.OPERATION] in C.OPERATIONS_OF_TWO_DOT_PRODUCTS
    scale = 2.0 * float_of(row[R.ROUGHNESS_SCALE])
    su, tu = float_of(row[R.OFFSET_MATRIX]), float_of(row[R.OFFSET_MATRIX + 1])
    sv, tv = float_of(row[R.OFFSET_MATRIX + 2]), float_of(row[R.OFFSET_MATRIX + 3])
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    before = max(unit - 1, 0)
    for k in range(runs.count):
        t, kind = primitive_of(p, scratch, k)
        first, second = iterated_of(p, t, before), iterated_of(p, t, unit)
        px, py, block = int64(runs.x[k]), int64(runs.y[k]) & ~1, int64(-1)
        good, steps = False, (0.0, 0.0, 0.0, 0.0)
        for i in range(runs.starts[k], runs.starts[k + 1]):
            if px & ~1 != block:
                block = px & ~1
                good, steps = block_sides(draw, kind, first, second, dotted, sizes, block, py)
            if dotted:
                su, sv = floats[R.COORDINATE0, i], floats[R.COORDINATE0 + 1, i]
                tu, tv = floats[R.COORDINATE0 + 2, i], floats[R.COORDINATE0 + 3, i]
            word = packed[stage, i]
            d1 = float64(word & uint32(255)) / 255.0 * scale
            d2 = (float64(uint32(word >> uint32(8)) & uint32(255)) - 128.0) / 127.0 * scale
            d3 = float64(uint32(word >> uint32(16)) & uint32(255)) / 255.0 * scale
            along_s, along_t, probes, value = rough_footprint(
                good, steps, (su, sv, tu, tv), (d1, d2, d3), sizes, row
            )
            floats[R.ALONG_S, i], floats[R.ALONG_T, i], floats[R.RATIO, i] = along_s, along_t, probes
            ints[R.LOD, i] = min(max(int32(value + bias), low), high)
            px += 1

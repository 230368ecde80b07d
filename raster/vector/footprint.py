"""Footprints longer than wide by vectors: probes and pairs of texels, each filtered like any texel and summed
in the unit's planes.

Their places and weights are computed in the order of raster/portable/anisotropic.py and
raster/portable/footprint.py, so the bits are the same.
"""

import numpy as np
from numba import float64, int16, int32, int64, uint16, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS
from fixedpipe.raster.kernel import float_of, kernel, separate_function, separate_loop
from fixedpipe.raster.portable.anisotropic import move_to_tap, tap_weight
from fixedpipe.raster.portable.footprint import move_to_probe, share_of_a_probe
from fixedpipe.raster.portable.level_of_detail import iterated, weighted
from fixedpipe.raster.vector.arrays import JOB, SCRATCH, pass_of
from fixedpipe.raster.vector.coordinates import fixed_from_floats, iterate_floats
from fixedpipe.raster.vector.interpolate import Listed
from fixedpipe.raster.vector.level_of_detail import lambdas, linear_edge, logarithms
from fixedpipe.raster.vector.sample import filter_mipmapped

# Planes that combiners compute in later: here the texels of one probe.
_ONE = R.REGISTERS * 4


@kernel
def _at(n0, n1, n2, inverse_w, s, t):
    """(D, s, t) at a point, as ``coordinates_at``."""
    e0, e1, e2 = n0 * inverse_w[0], n1 * inverse_w[1], n2 * inverse_w[2]
    total = (e0 + e1) + e2
    inverse = 1.0 / total
    b0, b2 = e0 * inverse, e2 * inverse
    return total, weighted(b0, b2, s), weighted(b0, b2, t)


@kernel
def _blocks(source, sizes, limits, px, py, blocks, floats):
    """ALONG_S, ALONG_T, RATIO, and rho squared (in EXTRA), for each of the blocks from (px, py) to the right.

    ``limits``: the most probes, or minus the largest ratio; whether as many probes are taken as cover it.
    """
    (x0, y0, x1, y1, x2, y2), inverse_w, s, t, _r, _q = source
    (width, height), (most, exact) = sizes, limits
    sign = int64(-1 if (x1 - x0) * (y2 - y0) < (x2 - x0) * (y1 - y0) else 1)
    n0, right0, down0 = linear_edge(x1, y1, x2, y2, px, py, sign)
    n1, right1, down1 = linear_edge(x2, y2, x0, y0, px, py, sign)
    n2, right2, down2 = linear_edge(x0, y0, x1, y1, px, py, sign)
    along_s, along_t, ratio, rho2 = floats[R.P], floats[R.P_SIZE], floats[R.TEXEL], floats[R.EXTRA]
    for k in range(blocks):
        step = 2.0 * float64(k)
        m0, m1, m2 = n0 + step * right0, n1 + step * right1, n2 + step * right2
        d0, s0, t0 = _at(m0, m1, m2, inverse_w, s, t)
        d1, s1, t1 = _at(m0 + right0, m1 + right1, m2 + right2, inverse_w, s, t)
        d2, s2, t2 = _at(m0 + down0, m1 + down1, m2 + down2, inverse_w, s, t)
        ax, ay, bx, by = s1 - s0, t1 - t0, s2 - s0, t2 - t0
        sx, tx, sy, ty = ax * width, ay * height, bx * width, by * height
        dx2, dy2 = sx * sx + tx * tx, sy * sy + ty * ty
        there = d0 > 0.0 and d1 > 0.0 and d2 > 0.0 and dx2 < np.inf and dy2 < np.inf
        wide = dx2 >= dy2
        longer, shorter = (dx2, dy2) if wide else (dy2, dx2)
        if most > 0.0 and exact:
            narrow, number = max(shorter, 1.0), 1.0
            for _ in range(15):
                number = number + 1.0 if number < most and longer > number * number * narrow else number
            square = number * number
            found = longer / square if longer > square * narrow else max(shorter, min(longer, 1.0))
        elif most > 0.0:
            narrow, number = max(shorter, 1.0), 1.0
            number = 2.0 if most > 1.0 and longer >= 2.0 * narrow else number
            number = 4.0 if most > 2.0 and number == 2.0 and longer >= 8.0 * narrow else number
            number = 8.0 if most > 4.0 and number == 4.0 and longer >= 32.0 * narrow else number
            number = 16.0 if most > 8.0 and number == 8.0 and longer >= 128.0 * narrow else number
            square = number * number
            more = longer >= 2.0 * square * narrow
            found = longer / square if more else max(shorter, min(longer, 1.0))
        else:
            number = np.sqrt(longer) / max(np.sqrt(shorter), 1.0)
            number = min(max(number, 1.0), -most)
            found = longer / (number * number)
        along_s[k] = (ax if wide else bx) if there else 0.0
        along_t[k] = (ay if wide else by) if there else 0.0
        ratio[k] = number if there else 1.0
        rho2[k] = found if there else np.inf


@kernel(void(JOB, int64, int64, RUNS, SCRATCH))
def footprints(job, u, count, runs, scratch):
    """ALONG_S, ALONG_T, RATIO and LOD of every fragment's block, as the portable engine's."""
    separate_function()
    p = pass_of(job)
    row, levels, floats, ints = p.textures.units[u], p.textures.levels[u], scratch.floats, scratch.ints
    width, height = float64(levels[0, 1]), float64(levels[0, 2])
    most = float64(row[R.PROBES]) if row[R.PROBES] else -float_of(row[R.ANISOTROPY])
    exact, lod, logs, cells = row[R.EXACT_PROBES] != 0, ints[R.LOD], ints[R.FACE], ints[R.LEVEL]
    for k in range(runs.count):
        owner, start, end = int64(ints[R.OWNER, k]), int64(runs.starts[k]), int64(runs.starts[k + 1])
        px, py = int64(runs.x[k]), int64(runs.y[k]) & ~1
        odd = px & 1
        blocks = (end - start + odd + 1) >> 1
        v0, v1, v2 = p.triangles[owner, 0], p.triangles[owner, 1], p.triangles[owner, 2]
        source = iterated(p.vertices, v0, v1, v2, u)
        _blocks(source, (width, height), (most, exact), px - odd, py, blocks, floats)
        logarithms(floats[R.EXTRA], blocks, logs, cells)
        lambdas(logs, int64(0), blocks, row, lod, start, odd)
        for i in range(start, end):
            block = (i - start + odd) >> 1
            floats[R.ALONG_S, i] = floats[R.P, block]
            floats[R.ALONG_T, i] = floats[R.P_SIZE, block]
            floats[R.RATIO, i] = floats[R.TEXEL, block]


@kernel("void(f8[::1],i8,i8,i2[:,::1],i8)")
def add_probe(probes, probe, count, planes, plane):
    """Add a probe's texels where the footprint has that probe; the first one begins."""
    separate_loop()
    for c in range(4):
        total, texel = planes[plane + c], planes[_ONE + c]
        for i in range(count):
            value = texel[i] if float64(probe) < probes[i] else int16(0)
            total[i] = value if probe == 0 else int16(total[i] + value)


@kernel("void(f8[::1],i4[::1],i8,i2[:,::1],i8)")
def average_probes(probes, shares, count, planes, plane):
    """The sums over the number of probes, fractions cut. ``shares``: room."""
    separate_loop()
    for i in range(count):
        shares[i] = share_of_a_probe(probes[i])
    for c in range(4):
        total = planes[plane + c]
        for i in range(count):
            total[i] = int16((int32(total[i]) * shares[i]) >> int32(16))


@kernel("void(f8[::1],i8,i4[::1],i8)")
def weigh_taps(ratio, pair, weights, count):
    """The weight of each texel of a pair."""
    separate_loop()
    for i in range(count):
        weights[i] = tap_weight(pair, ratio[i])


@kernel("void(i4[::1],i8,i8,i2[:,::1],i8)")
def add_tap(weights, first, count, planes, plane):
    """Add a pair's texels times their weights, 16 bits without sign; the first begins with one half."""
    separate_loop()
    for c in range(4):
        total, texel = planes[plane + c], planes[_ONE + c]
        for i in range(count):
            before = int32(128) if first else int32(total[i])
            total[i] = int16(before + int32(texel[i]) * weights[i])


@kernel("void(i8,i2[:,::1],i8)")
def end_taps(count, planes, plane):
    """The sums' upper bytes."""
    separate_loop()
    for c in range(4):
        total = planes[plane + c]
        for i in range(count):
            total[i] = int16(int32(uint16(total[i])) >> int32(8))


@kernel(void(JOB, int64, int64, SCRATCH))
def _filter(job, u, count, scratch):
    """One texel of every fragment at S and T, into the planes from _ONE on."""
    p = pass_of(job)
    row, levels, floats, ints = p.textures.units[u], p.textures.levels[u], scratch.floats, scratch.ints
    f_s, f_t = ints[R.FIXED0 + 2 * u], ints[R.FIXED0 + 2 * u + 1]
    fixed_from_floats(floats[R.S], f_s, float64(levels[0, 1]), 0.0, 1.0, row[R.WRAP_S], 1, count)
    fixed_from_floats(floats[R.T], f_t, float64(levels[0, 2]), 0.0, 1.0, row[R.WRAP_T], 1, count)
    pairs, fixed, located = p.textures.texels[u], (f_s, f_t, ints[R.LOD]), scratch.located[u]
    filter_mipmapped(pairs, levels, row, fixed, count, located, scratch.planes, _ONE)


@kernel(void(JOB, int64, int64, int64, RUNS, SCRATCH))
def sample_footprints(job, u, count, segments, runs, scratch):
    """A unit whose footprints are assembled, or filtered anisotropically."""
    separate_function()
    p = pass_of(job)
    triangles, coordinates, row = p.triangles, p.vertices.coordinates, p.textures.units[u]
    floats, ints, planes, plane = scratch.floats, scratch.ints, scratch.planes, (C.REGISTER_TEXTURE0 + u) * 4
    listed = Listed(scratch.lists, segments)
    iterate_floats(listed, triangles, coordinates, u, 0, floats, scratch.singles, floats[R.CENTER_S])
    iterate_floats(listed, triangles, coordinates, u, 1, floats, scratch.singles, floats[R.CENTER_T])
    footprints(job, u, count, runs, scratch)
    ratio, most = floats[R.RATIO], 1.0
    for i in range(count):
        most = max(most, ratio[i])
    if row[R.PROBES]:
        for probe in range(int64(most)):
            move_to_probe(floats, probe, count)
            _filter(job, u, count, scratch)
            add_probe(ratio, probe, count, planes, plane)
        average_probes(ratio, ints[R.LEVEL], count, planes, plane)
        return
    weights = ints[R.LEVEL]
    for pair in range(int64(np.ceil(most * 0.5))):
        weigh_taps(ratio, pair, weights, count)
        for side in range(2):
            tap = 2 * pair + side
            move_to_tap(floats, pair, 1.0 - 2.0 * side, count)
            _filter(job, u, count, scratch)
            add_tap(weights, int64(tap == 0), count, planes, plane)
    end_taps(count, planes, plane)

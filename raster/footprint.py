"""Footprint assembly: a power of two of filtered texels along the longer side of a fragment's footprint
(docs/numbers.md, section 7).
"""

import numpy as np
from numba import float64, int32, int64, uint32

from raster import rows as R
from raster.kernel import kernel, separate_function, separate_loop
from raster.level_of_detail import coordinates_at
from raster.sample import FAR, filter_unit, log2_q7
from raster.texture_shader import copy_column


@kernel
def block_probes(draw, kind, v0, v1, v2, x, y, inverse_w, coordinates, unit, row, width, height, bx, by):
    """(along s, along t, probes, lambda) of the block whose origin is (bx, by).

    The longer of the two steps to the block's neighbours, in texture coordinates; how often the shorter, or
    one texel, goes into it, as a power of two; lambda of the shorter, 8 fraction bits, without bias.
    Source: Schilling, Knittel, Strasser 1996; Assumed: to the nearest power, by ratio.
    """
    divided = row[R.PROJECTIVE]
    ok0, s0, t0, _r0 = coordinates_at(
        draw, kind, v0, v1, v2, x, y, inverse_w, coordinates, unit, divided, bx, by
    )
    ok1, s1, t1, _r1 = coordinates_at(
        draw, kind, v0, v1, v2, x, y, inverse_w, coordinates, unit, divided, bx + 1, by
    )
    ok2, s2, t2, _r2 = coordinates_at(
        draw, kind, v0, v1, v2, x, y, inverse_w, coordinates, unit, divided, bx, by + 1
    )
    sx, tx, sy, ty = (s1 - s0) * width, (t1 - t0) * height, (s2 - s0) * width, (t2 - t0) * height
    dx2, dy2 = sx * sx + tx * tx, sy * sy + ty * ty
    if not (ok0 and ok1 and ok2 and dx2 < np.inf and dy2 < np.inf):
        return 0.0, 0.0, 1.0, FAR
    longer, shorter = max(dx2, dy2), min(dx2, dy2)
    narrow, most = max(shorter, 1.0), float64(row[R.PROBES])
    probes = 1.0
    while probes < most and longer >= 2.0 * probes * probes * narrow:
        probes *= 2.0
    rho2 = max(shorter, min(longer, 1.0))
    if longer >= 2.0 * probes * probes * narrow:  # it would take more than there are
        rho2 = longer / (probes * probes)
    along_s, along_t = (s1 - s0, t1 - t0) if dx2 >= dy2 else (s2 - s0, t2 - t0)
    return along_s, along_t, probes, (log2_q7(rho2) if rho2 > 0.0 else int32(-FAR))


@kernel(
    "f8(i8[::1],i4[::1],i4[::1],i4[::1],i8,i4[:,::1],i4[:,::1],i4[::1],i4[::1],f8[::1],f8[:,:,::1],i8,i8[::1],"
    "i4[:,::1],f8[:,::1],i4[:,::1])"
)
def probe_footprints(
    draw, run_starts, run_x, run_y, runs, triangles, strokes, x, y, inverse_w, coordinates, unit, row, levels,
    floats, ints,
):  # fmt: skip
    """ALONG_S, ALONG_T and RATIO (probes) of every fragment's block, and LOD; returns the most probes.

    Arguments as in level_of_detail.
    """
    separate_function()
    width, height, most = float64(levels[0, 1]), float64(levels[0, 2]), 1.0
    if row[R.TARGET] == 4:  # coordinates that count texels already
        width = height = 1.0
    bias, low, high = int32(row[R.LOD_BIAS]), int32(row[R.MIN_LOD]), int32(row[R.MAX_LOD])
    for k in range(runs):
        t = ints[R.OWNER, k]
        kind = int64(strokes[t, R.KIND]) if draw[R.STROKES] else int64(R.TRIANGLE)
        v0, v1, v2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        px, by, block = int64(run_x[k]), int64(run_y[k]) & ~1, int64(-1)
        along_s, along_t, probes, value = 0.0, 0.0, 1.0, int32(0)
        for i in range(run_starts[k], run_starts[k + 1]):
            if px & ~1 != block:
                block = px & ~1
                along_s, along_t, probes, value = block_probes(
                    draw, kind, v0, v1, v2, x, y, inverse_w, coordinates, unit, row, width, height, block, by
                )
                most = max(most, probes)
            floats[R.ALONG_S, i], floats[R.ALONG_T, i], floats[R.RATIO, i] = along_s, along_t, probes
            ints[R.LOD, i] = min(max(int32(value + bias), low), high)
            px += 1
    return most


@kernel("void(f8[:,::1],i8,i8)")
def move_to_probe(floats, probe, count):
    """S and T of one probe, from the footprint's middle; of the first where there are fewer."""
    separate_loop()
    for i in range(count):
        probes = floats[R.RATIO, i]
        number = float64(probe) if float64(probe) < probes else 0.0
        distance = ((2.0 * number + 1.0) - probes) / (2.0 * probes)
        floats[R.S, i] = floats[R.CENTER_S, i] + distance * floats[R.ALONG_S, i]
        floats[R.T, i] = floats[R.CENTER_T, i] + distance * floats[R.ALONG_T, i]


@kernel("void(f8[:,::1],u4[:,::1],i8,i8)")
def add_probe(floats, packed, probe, count):
    """Add TEXEL_0 to the sums where the footprint has that probe: two bytes at a time, 16 bits apart."""
    separate_loop()
    mask, eight, nothing = uint32(0x00FF00FF), uint32(8), uint32(0)
    for i in range(count):
        texel = packed[R.TEXEL_0, i] if float64(probe) < floats[R.RATIO, i] else nothing
        even = nothing if probe == 0 else packed[R.SUM_EVEN, i]
        odd = nothing if probe == 0 else packed[R.SUM_ODD, i]
        packed[R.SUM_EVEN, i] = even + uint32(texel & mask)
        packed[R.SUM_ODD, i] = odd + uint32(uint32(texel >> eight) & mask)


@kernel("void(f8[:,::1],u4[:,::1],i8)")
def average_probes(floats, packed, count):
    """The sums over the number of probes, fractions cut, into TEXEL_0."""
    separate_loop()
    byte = uint32(0xFF)
    for i in range(count):
        probes = floats[R.RATIO, i]
        shift = uint32(0)
        for k in range(1, 5):
            if probes >= float64(1 << k):
                shift = uint32(k)
        even, odd = packed[R.SUM_EVEN, i], packed[R.SUM_ODD, i]
        red, green = uint32(even >> shift) & byte, uint32(odd >> shift) & byte
        upper = uint32(shift + uint32(16))
        blue, alpha = uint32(even >> upper), uint32(odd >> upper)
        low = uint32(red | uint32(green << uint32(8)))
        packed[R.TEXEL_0, i] = low | uint32(uint32(blue << uint32(16)) | uint32(alpha << uint32(24)))


@kernel("void(u4[::1],i4[:,::1],i8[::1],i8,i8,f8[:,::1],i4[:,::1],u4[:,::1])")
def assemble_probes(texels, levels, unit, most, count, floats, ints, packed):
    """Filter a unit's fragments at up to ``most`` probes, into TEXEL_0: S and T come back changed."""
    separate_function()
    copy_column(floats, R.S, R.CENTER_S, count)
    copy_column(floats, R.T, R.CENTER_T, count)
    for probe in range(most):
        move_to_probe(floats, probe, count)
        filter_unit(texels, levels, unit, count, floats, ints, packed)
        add_probe(floats, packed, probe, count)
    average_probes(floats, packed, count)

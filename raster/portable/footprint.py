"""Footprint assembly: filtered texels along the longer side of a fragment's footprint
(docs/numbers.md, section 7).
"""

from numba import float64, int64, uint32

from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.portable.sample import filter_unit
from fixedpipe.raster.portable.texture_shader import copy_column


@kernel
def probes_along(longer, shorter, most, exact):
    """(how many probes, rho squared of each) of a footprint with these sides, squares in texels.

    How often the shorter side, or one texel, goes into the longer: rounded up where ``exact``, else as a
    power of two. Source: Schilling, Knittel, Strasser 1996; Assumed: to the nearest power, by ratio.
    """
    narrow, probes = max(shorter, 1.0), 1.0
    if exact:
        while probes < float64(most) and longer > probes * probes * narrow:
            probes += 1.0
        if longer > probes * probes * narrow:  # it would take more than there are
            return probes, longer / (probes * probes)
        return probes, max(shorter, min(longer, 1.0))
    while probes < float64(most) and longer >= 2.0 * probes * probes * narrow:
        probes *= 2.0
    if longer >= 2.0 * probes * probes * narrow:  # it would take more than there are
        return probes, longer / (probes * probes)
    return probes, max(shorter, min(longer, 1.0))


@kernel
def share_of_a_probe(probes):
    """1 / N with 16 fraction bits, rounded up: a sum of N bytes times it, its fraction cut, is the sum over
    N, cut, for N up to 16 (tests/raster/test_sampling.py has all of them).
    """
    return uint32(65536.0 / probes) + uint32(65536.0 % probes != 0.0)


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
    word, sixteen = uint32(0xFFFF), uint32(16)
    for i in range(count):
        share = share_of_a_probe(floats[R.RATIO, i])
        even, odd = packed[R.SUM_EVEN, i], packed[R.SUM_ODD, i]
        red = uint32(uint32(uint32(even & word) * share) >> sixteen)
        green = uint32(uint32(uint32(odd & word) * share) >> sixteen)
        blue = uint32(uint32(uint32(even >> sixteen) * share) >> sixteen)
        alpha = uint32(uint32(uint32(odd >> sixteen) * share) >> sixteen)
        low = uint32(red | uint32(green << uint32(8)))
        packed[R.TEXEL_0, i] = low | uint32(uint32(blue << uint32(16)) | uint32(alpha << uint32(24)))


@kernel("void(u4[::1],i4[:,::1],i8[::1],i8,f8[:,::1],i4[:,::1],u4[:,::1])")
def assemble_probes(texels, levels, unit, count, floats, ints, packed):
    """Filter a unit's fragments at RATIO probes each, into TEXEL_0: S and T come back changed."""
    separate_function()
    most = 1.0
    for i in range(count):
        most = max(most, floats[R.RATIO, i])
    copy_column(floats, R.S, R.CENTER_S, count)
    copy_column(floats, R.T, R.CENTER_T, count)
    for probe in range(int64(most)):
        move_to_probe(floats, probe, count)
        filter_unit(texels, levels, unit, count, floats, ints, packed)
        add_probe(floats, packed, probe, count)
    average_probes(floats, packed, count)

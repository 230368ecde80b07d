"""Packed texels, filtered and taken apart (docs/numbers.md, section 6).

A texel is a ``uint32`` of register bytes, red in the low byte. A wide one, whose components have more bits,
12 at most, is two of 16 bits for each component: red and green, then blue and alpha, red and blue lower. The
second words of a column of ``packed`` lie in the column R.WIDE farther.
"""

from numba import int16, int32, int64, uint32, uint64

from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_loop


@kernel
def lerp_packed(p, q, weight):
    """(p (256 - w) + q w + 128) >> 8 on each byte of packed texels, w in 0..256.

    Measured: 349524 of 349524 pixels (mip-mapped DXT captures). Two bytes at a time, 16 bits apart: a lane's
    largest value is 255 * 256 + 128 < 65536.
    """
    mask, half, eight = uint32(0x00FF00FF), uint32(0x00800080), uint32(8)
    w = uint32(weight)
    v = uint32(uint32(256) - w)
    even = uint32(uint32(uint32(p & mask) * v) + uint32(uint32(q & mask) * w))
    odd = uint32(uint32(uint32(p >> eight) & mask) * v) + uint32(uint32(uint32(q >> eight) & mask) * w)
    even = uint32(uint32(even + half) >> eight) & mask
    odd = uint32(uint32(odd) + half) & uint32(0xFF00FF00)
    return uint32(even | odd)


@kernel("void(u4[:,::1],i4[:,::1],i8,i8)")
def filter_linear(packed, ints, count, out):
    """Both rows horizontally, each rounded to bytes, then vertically."""
    separate_loop()
    po = uint64(out)
    for i in range(count):
        a, b = ints[R.I_FRACTION, i], ints[R.J_FRACTION, i]
        lower = lerp_packed(packed[R.P00, i], packed[R.P10, i], a)
        upper = lerp_packed(packed[R.P01, i], packed[R.P11, i], a)
        packed[po, i] = lerp_packed(lower, upper, b)


@kernel
def lerp_hilo(p, q, weight):
    """(p (256 - w) + q w + 128) >> 8 on a HILO texel's words: alpha and red, green and blue."""
    w, eight = int64(weight), int64(8)
    high = int64(p >> uint32(24)) * 256 + int64(p & uint32(255))
    other = int64(q >> uint32(24)) * 256 + int64(q & uint32(255))
    high = (high * (256 - w) + other * w + 128) >> eight
    low = int64(p & uint32(0xFF00)) + int64(uint32(p >> uint32(16)) & uint32(255))
    other = int64(q & uint32(0xFF00)) + int64(uint32(q >> uint32(16)) & uint32(255))
    low = (low * (256 - w) + other * w + 128) >> eight
    return uint32(((high >> eight) << 24) | (high & 255) | (low & 0xFF00) | ((low & 255) << 16))


@kernel("void(u4[:,::1],i4[:,::1],i8,i8)")
def filter_linear_hilo(packed, ints, count, out):
    """As ``filter_linear``, on words of 16 bits. Measured: Bump_map's R16B16 captures."""
    separate_loop()
    po = uint64(out)
    for i in range(count):
        a, b = ints[R.I_FRACTION, i], ints[R.J_FRACTION, i]
        lower = lerp_hilo(packed[R.P00, i], packed[R.P10, i], a)
        upper = lerp_hilo(packed[R.P01, i], packed[R.P11, i], a)
        packed[po, i] = lerp_hilo(lower, upper, b)


@kernel
def lerp_lanes(p, q, weight):
    """(p (256 - w) + q w + 128) >> 8 on both components of words of wide texels, w in 0..256."""
    w, sixteen, lane = uint32(weight), uint32(16), uint32(0xFFFF)
    v = uint32(uint32(256) - w)
    low = uint32(uint32(uint32(p & lane) * v) + uint32(uint32(q & lane) * w))
    high = uint32(uint32(uint32(p >> sixteen) * v) + uint32(uint32(q >> sixteen) * w))
    low = uint32(uint32(low + uint32(128)) >> uint32(8))
    high = uint32(uint32(high + uint32(128)) >> uint32(8))
    return uint32(low | uint32(high << sixteen))


@kernel("void(u4[:,::1],i4[:,::1],i8,i8)")
def filter_linear_lanes(packed, ints, count, out):
    """As ``filter_linear``, on words of wide texels."""
    separate_loop()
    po = uint64(out)
    for i in range(count):
        a, b = ints[R.I_FRACTION, i], ints[R.J_FRACTION, i]
        lower = lerp_lanes(packed[R.P00, i], packed[R.P10, i], a)
        upper = lerp_lanes(packed[R.P01, i], packed[R.P11, i], a)
        packed[po, i] = lerp_lanes(lower, upper, b)


@kernel("void(u4[:,::1],i4[:,::1],i8,i8,i8,i8,i8)")
def blend(packed, ints, first, second, fraction, wide, count):
    """From column ``first`` to ``second`` by the 8-bit column ``fraction``, into ``first``: between mipmap
    levels (Measured: 61440 of 61440 pixels, LODBias) or layers. ``wide``: of words of wide texels.
    """
    separate_loop()
    p0, p1, pf = uint64(first), uint64(second), uint64(fraction)
    if wide:
        for i in range(count):
            packed[p0, i] = lerp_lanes(packed[p0, i], packed[p1, i], ints[pf, i])
        return
    for i in range(count):
        packed[p0, i] = lerp_packed(packed[p0, i], packed[p1, i], ints[pf, i])


@kernel("void(u4[:,::1],i4[:,::1],i4,i8,i8)")
def choose_magnified(packed, ints, threshold, word, count):
    """Take the magnified texel where lambda is not above the threshold, into TEXEL_0. ``word``: 0, or WIDE
    for the second words of wide texels.
    """
    separate_loop()
    to, of = uint64(R.TEXEL_0 + word), uint64(R.MAGNIFIED + word)
    for i in range(count):
        if ints[R.LOD, i] <= threshold:
            packed[to, i] = packed[of, i]


@kernel("void(u4[:,::1],i8,i8,i2[:,::1],i8)")
def unpack(packed, source, count, registers, plane):
    """A packed column to four register planes from ``plane`` on."""
    separate_loop()
    ps, red, green, blue, alpha = (
        uint64(source),
        uint64(plane),
        uint64(plane + 1),
        uint64(plane + 2),
        uint64(plane + 3),
    )
    for i in range(count):
        p = packed[ps, i]
        registers[red, i] = int16(p & uint32(255))
        registers[green, i] = int16(uint32(p >> uint32(8)) & uint32(255))
        registers[blue, i] = int16(uint32(p >> uint32(16)) & uint32(255))
        registers[alpha, i] = int16(p >> uint32(24))


@kernel("void(u4[:,::1],i8,u4,i8,i2[:,::1],i8)")
def unpack_signed(packed, source, signed, count, registers, plane):
    """As ``unpack``, where ``signed`` has 0x80 in components whose bytes are s + 128: these become 2 s.

    Measured: 732800 of 732800 pixels (Texture_signed_component_tests).
    """
    separate_loop()
    ps = uint64(source)
    for c in range(4):
        shift, pc = uint32(8 * c), uint64(plane + c)
        twice = uint32(uint32(signed >> shift) & uint32(128)) != uint32(0)
        factor, less = int32(2 if twice else 1), int32(256 if twice else 0)
        for i in range(count):
            byte = int32(uint32(packed[ps, i] >> shift) & uint32(255))
            registers[pc, i] = int16(int32(byte * factor) - less)


@kernel("void(u4[:,::1],i8,i8,i2[:,::1],i8)")
def unpack_lanes(packed, source, count, registers, plane):
    """A packed column of wide texels to four register planes from ``plane`` on."""
    separate_loop()
    first, second, to = uint64(source), uint64(source + R.WIDE), uint64(plane)
    lane, sixteen = uint32(0xFFFF), uint32(16)
    for i in range(count):
        low, high = packed[first, i], packed[second, i]
        registers[to, i], registers[to + uint64(1), i] = int16(low & lane), int16(low >> sixteen)
        registers[to + uint64(2), i], registers[to + uint64(3), i] = (
            int16(high & lane),
            int16(high >> sixteen),
        )

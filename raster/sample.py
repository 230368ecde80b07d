"""Texture sampling over a batch (docs/numbers.md, sections 6 and 7).

A texture's levels lie one behind another in one ``uint32`` array of packed register bytes (red in the low byte),
rows bottom first; a cube map's level holds its six faces in order. Every fragment has its own level, so the size
of a level is a column too. A nearest filter is a linear one with a fraction of zero.
"""

import numpy as np
from numba import float64, int16, int32, int64, uint32, uint64

from raster import rows as R
from raster.kernel import bits_of, float_of, kernel, separate_function, separate_loop

TAU = 2.0**-24  # texels: the bias that decides exact ties (docs/numbers.md, section 6)

# 2 ** (k / 128) for k = 0 .. 127, each the nearest float64: thresholds of the mantissa of rho squared.
# Computed from the integer root: floor(2**(52 + k/128) + 1/2) by exact comparison of 128th powers.


def _powers_of_two():
    table = np.empty(128, np.float64)
    for k in range(128):
        guess = int(2.0 ** (52 + k / 128))
        # twice the mantissa, compared exactly: (2 m + 1) ** 128 against 2 ** (128 + 52 * 128 + k)
        while (2 * guess + 1) ** 128 <= 1 << (128 + 52 * 128 + k):
            guess += 1
        while (2 * guess - 1) ** 128 > 1 << (128 + 52 * 128 + k):
            guess -= 1
        table[k] = guess * 2.0**-52
    return table


POWERS_OF_TWO = _powers_of_two()
FAR = int32(1 << 20)  # a lambda beyond every level


@kernel
def log2_q7(x):
    """floor(128 log2 x) of a positive finite float64, by exponent and comparison with exact powers."""
    bits = bits_of(x)
    exponent = (bits >> int64(52)) - int64(1023)
    mantissa = float_of((bits & int64((1 << 52) - 1)) | int64(1023 << 52))  # in [1, 2)
    low, high = 0, 127
    while low < high:
        middle = (low + high + 1) >> 1
        if mantissa >= POWERS_OF_TWO[middle]:
            low = middle
        else:
            high = middle - 1
    return int32(int64(128) * exponent + low)


@kernel
def major_axis(s, t, r):
    """Which face a cube map direction selects: 0..5 for +x, -x, +y, -y, +z, -z; x before y before z when equal."""
    if abs(s) >= abs(t) and abs(s) >= abs(r):
        return 0 if s >= 0.0 else 1
    if abs(t) >= abs(r):
        return 2 if t >= 0.0 else 3
    return 4 if r >= 0.0 else 5


@kernel
def on_face(face, s, t, r):
    """(sc, tc, ma) of EXT_texture_cube_map's table for a face; ma is not positive when the face is not the major."""
    if face == 0:
        return -r, -t, s
    if face == 1:
        return r, -t, -s
    if face == 2:
        return s, r, t
    if face == 3:
        return s, -r, -t
    if face == 4:
        return s, -t, r
    return -s, -t, -r


@kernel("void(f8[::1],f8[::1],f8[::1],i8,i4[::1],f8[::1],f8[::1])")
def cube_faces(s, t, r, count, face, u, v):
    """The face of each direction and (sc/|ma| + 1)/2, (tc/|ma| + 1)/2 times two (texel coordinate over size/2)."""
    separate_loop()
    for i in range(count):
        f = major_axis(s[i], t[i], r[i])
        sc, tc, ma = on_face(f, s[i], t[i], r[i])
        face[i] = int32(f)
        u[i] = sc / ma + 1.0 if ma > 0.0 else 1.0
        v[i] = tc / ma + 1.0 if ma > 0.0 else 1.0


@kernel("void(f8[::1],f8[::1],i8)")
def divide_by_q(coordinate, q, count):
    """Projective coordinates, in place; a q of zero counts as one."""
    separate_loop()
    for i in range(count):
        coordinate[i] = coordinate[i] / (q[i] if q[i] != 0.0 else 1.0)


@kernel("void(f8[::1],f8[::1],f8,f8[::1],i8,f8[::1])")
def texel_coordinates(coordinate, size, scale, bias, count, out):
    """T = s * (scale * size) + bias; scale is 1, or 1/2 for the doubled coordinates of a cube face."""
    separate_loop()
    for i in range(count):
        out[i] = coordinate[i] * (scale * size[i]) + bias[i]


@kernel("void(f8[::1],f8[::1],i8,i8,i4[::1],i4[::1],i4[::1])")
def wrap_repeat(texel, size, count, linear, first, second, fraction):
    """REPEAT: two neighbouring texels and the 8-bit fraction between them."""
    separate_loop()
    if linear:
        for i in range(count):
            n = size[i]
            t = texel[i] - n * np.floor(texel[i] * (1.0 / n))
            t = t if t > 0.0 else 0.0  # also where t is not a number
            t = t if t < n else n
            f = int32(np.floor((t - 0.5) * 256.0))
            last = int32(int32(n) - int32(1))
            k = int32(f >> int32(8))
            fraction[i] = int32(f & int32(255))
            first[i] = last if k < int32(0) else k
            second[i] = int32(0) if k >= last else int32(k + int32(1))
    else:
        for i in range(count):
            n = size[i]
            t = texel[i] - n * np.floor(texel[i] * (1.0 / n))
            t = t if t > 0.0 else 0.0
            t = t if t < n else n
            k = int32(t)
            k = int32(0) if k >= int32(n) else k
            fraction[i] = int32(0)
            first[i] = k
            second[i] = k


@kernel("void(f8[::1],f8[::1],i8,i8,i8,f8,i8,i4[::1],i4[::1],i4[::1])")
def wrap_clamp(texel, size, count, linear, mirrored, margin, border, first, second, fraction):
    """The other wrap modes: T limited to [-margin, size + margin]; outside texels are clamped or -1 (border)."""
    separate_loop()
    for i in range(count):
        n = size[i]
        t = texel[i]
        if mirrored:
            t = t - (2.0 * n) * np.floor(t * (1.0 / (2.0 * n)))
            t = 2.0 * n - t if t > n else t
        t = t if t > -margin else -margin  # also where t is not a number
        t = t if t < n + margin else n + margin
        last = int32(int32(n) - int32(1))
        if linear:
            f = int32(np.floor((t - 0.5) * 256.0))
            a = int32(f >> int32(8))
            b = int32(a + int32(1))
            fraction[i] = int32(f & int32(255))
        else:
            a = int32(np.floor(t))
            b = a
            fraction[i] = int32(0)
        if border:
            first[i] = a if a >= int32(0) and a <= last else int32(-1)
            second[i] = b if b >= int32(0) and b <= last else int32(-1)
        else:
            first[i] = min(max(a, int32(0)), last)
            second[i] = min(max(b, int32(0)), last)


@kernel
def wrap_axis(mode, texel, size, count, linear, first, second, fraction):
    """Choose the loop of a wrap mode (codes of pipeline.enums.WrapMode)."""
    if mode == 0:
        wrap_repeat(texel, size, count, linear, first, second, fraction)
    elif mode == 1:
        wrap_clamp(texel, size, count, linear, 0, 0.0, linear, first, second, fraction)
    elif mode == 2:
        wrap_clamp(texel, size, count, linear, 0, -0.5, 0, first, second, fraction)
    elif mode == 3:
        wrap_clamp(texel, size, count, linear, 0, 0.5, 1, first, second, fraction)
    else:
        wrap_clamp(texel, size, count, linear, 1, 0.0, 0, first, second, fraction)


@kernel("void(u4[::1],i4[::1],i4[::1],i8,i4[::1],i4[::1],u4[::1])")
def fetch_nearest(texels, base, width, count, column, row, out):
    """Packed texels at (column, row)."""
    separate_loop()
    for i in range(count):
        out[i] = texels[uint32(int32(base[i] + int32(row[i] * width[i])) + column[i])]


@kernel("void(u4[::1],i4[::1],i4[::1],i8,i4[::1],i4[::1],i4[::1],i4[::1],u4[::1],u4[::1],u4[::1],u4[::1])")
def fetch_linear(texels, base, width, count, i0, i1, j0, j1, p00, p10, p01, p11):
    """The four packed texels of a linear filter."""
    separate_function()
    for i in range(count):
        lower = int32(base[i] + int32(j0[i] * width[i]))
        upper = int32(base[i] + int32(j1[i] * width[i]))
        p00[i] = texels[uint32(lower + i0[i])]
        p10[i] = texels[uint32(lower + i1[i])]
        p01[i] = texels[uint32(upper + i0[i])]
        p11[i] = texels[uint32(upper + i1[i])]


@kernel("void(u4[::1],i4[::1],i4[::1],i8,i4[::1],i4[::1],u4,u4[::1])")
def fetch_bordered(texels, base, width, count, column, row, border, out):
    """Packed texels at (column, row); -1 in either reads the border colour."""
    separate_function()
    for i in range(count):
        if column[i] < 0 or row[i] < 0:
            out[i] = border
        else:
            out[i] = texels[uint32(int32(base[i] + int32(row[i] * width[i])) + column[i])]


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


@kernel("void(u4[::1],u4[::1],u4[::1],u4[::1],i4[::1],i4[::1],i8,u4[::1])")
def filter_linear(p00, p10, p01, p11, a, b, count, out):
    """Both rows horizontally, each rounded to bytes, then vertically."""
    separate_loop()
    for i in range(count):
        out[i] = lerp_packed(lerp_packed(p00[i], p10[i], a[i]), lerp_packed(p01[i], p11[i], a[i]), b[i])


@kernel("void(u4[::1],u4[::1],i4[::1],i8)")
def blend_levels(first, second, fraction, count):
    """Between two mipmap levels, each already bytes, into ``first``. Measured: 61440 of 61440 pixels (LODBias)."""
    separate_loop()
    for i in range(count):
        first[i] = lerp_packed(first[i], second[i], fraction[i])


@kernel("void(u4[::1],u4[::1],i4[::1],i4,i8)")
def choose_magnified(minified, magnified, lod, threshold, count):
    """Take the magnified texel where lambda is not above the threshold, into ``minified``."""
    separate_loop()
    for i in range(count):
        minified[i] = magnified[i] if lod[i] <= threshold else minified[i]


@kernel("void(u4[::1],i8,i2[:,::1],i8)")
def unpack(packed, count, registers, plane):
    """Packed texels to four register planes from ``plane`` on."""
    separate_loop()
    red, green, blue, alpha = uint64(plane), uint64(plane + 1), uint64(plane + 2), uint64(plane + 3)
    for i in range(count):
        p = packed[i]
        registers[red, i] = int16(p & uint32(255))
        registers[green, i] = int16(uint32(p >> uint32(8)) & uint32(255))
        registers[blue, i] = int16(uint32(p >> uint32(16)) & uint32(255))
        registers[alpha, i] = int16(p >> uint32(24))


@kernel("void(i4[::1],i4,i4,i4,i8,i4[::1])")
def select_level(lod, levels, rounding, step, count, out):
    """Level of each fragment: (clamp(lambda) + rounding) >> 8, plus ``step``, at most the last."""
    separate_loop()
    for i in range(count):
        clamped = min(max(lod[i], int32(0)), int32(int32(levels - int32(1)) * int32(256)))
        level = int32(int32(clamped + rounding) >> int32(8))
        out[i] = min(int32(level + step), int32(levels - int32(1)))


@kernel("void(i4[::1],i4,i8,i4[::1])")
def level_fraction(lod, levels, count, out):
    """The 8-bit position of lambda between two levels."""
    separate_loop()
    for i in range(count):
        out[i] = int32(min(max(lod[i], int32(0)), int32(int32(levels - int32(1)) * int32(256))) & int32(255))


@kernel("void(i4[:,::1],i4[::1],i4[::1],i8,i8,i4[::1],i4[::1],f8[::1],f8[::1])")
def level_sizes(levels, level, face, cube, count, base, width, s_size, t_size):
    """Where each fragment's level begins (its face for a cube map), and its size."""
    separate_function()
    for i in range(count):
        k = uint32(level[i])
        base[i] = int32(levels[k, 0] + int32(int32(face[i] * levels[k, 1]) * levels[k, 2])) if cube else levels[k, 0]
        width[i] = levels[k, 1]
        s_size[i] = float64(levels[k, 1])
        t_size[i] = float64(levels[k, 2])


@kernel("void(f8[::1],i8,f8)")
def fill_float(column, count, value):
    """Fill a float64 column."""
    separate_loop()
    for i in range(count):
        column[i] = value


@kernel("void(i4[::1],i8,i4)")
def fill_int(column, count, value):
    """Fill an int32 column."""
    separate_loop()
    for i in range(count):
        column[i] = value


@kernel("void(u4[::1],i4[:,::1],i8[::1],i8,i8,i8,f8[:,::1],i4[:,::1],u4[:,::1],u4[::1])")
def sample_level(texels, levels, unit, count, linear, many, floats, ints, packed, out):
    """One filtered texel per fragment, packed: from level 0, or (``many``) from each fragment's level.

    floats: rows 0, 1 the coordinates (s, t; or a cube face's doubled ones), 2, 3 nearest filters' tie biases,
    4..7 scratch. ints: row 0 the cube face, 9 the level, 1..8 scratch. packed: rows 0..3 scratch.
    """
    separate_function()
    cube, flat = unit[R.TARGET] == 2, unit[R.TARGET] == 0
    base, width, i0, i1, a, j0, j1, b = ints[1], ints[2], ints[3], ints[4], ints[5], ints[6], ints[7], ints[8]
    s_size, t_size, texel, bias = floats[4], floats[5], floats[6], floats[7]
    if many or cube:
        level_sizes(levels, ints[9], ints[0], cube, count, base, width, s_size, t_size)
    else:
        fill_int(base, count, levels[0, 0])
        fill_int(width, count, levels[0, 1])
        fill_float(s_size, count, float64(levels[0, 1]))
        fill_float(t_size, count, float64(levels[0, 2]))
    scale = 0.5 if cube else 1.0
    tied = not linear and not cube
    fill_float(bias, count, TAU)
    texel_coordinates(floats[0], s_size, scale, floats[2] if tied else bias, count, texel)
    wrap_axis(2 if cube else unit[R.WRAP_S], texel, s_size, count, linear, i0, i1, a)
    if flat:
        fill_int(j0, count, int32(0))
        fill_int(j1, count, int32(0))
        fill_int(b, count, int32(0))
    else:
        texel_coordinates(floats[1], t_size, scale, floats[3] if tied else bias, count, texel)
        wrap_axis(2 if cube else unit[R.WRAP_T], texel, t_size, count, linear, j0, j1, b)
    s_border = unit[R.WRAP_S] == 3 or (linear and unit[R.WRAP_S] == 1)
    t_border = not flat and (unit[R.WRAP_T] == 3 or (linear and unit[R.WRAP_T] == 1))
    bordered = (s_border or t_border) and not cube
    border = uint32(unit[R.BORDER])
    if not linear:
        if bordered:
            fetch_bordered(texels, base, width, count, i0, j0, border, out)
        else:
            fetch_nearest(texels, base, width, count, i0, j0, out)
        return
    if bordered:
        fetch_bordered(texels, base, width, count, i0, j0, border, packed[0])
        fetch_bordered(texels, base, width, count, i1, j0, border, packed[1])
        fetch_bordered(texels, base, width, count, i0, j1, border, packed[2])
        fetch_bordered(texels, base, width, count, i1, j1, border, packed[3])
    else:
        fetch_linear(texels, base, width, count, i0, i1, j0, j1, packed[0], packed[1], packed[2], packed[3])
    filter_linear(packed[0], packed[1], packed[2], packed[3], a, b, count, out)


@kernel("void(u4[::1],i4[:,::1],i8[::1],i8,i4[::1],f8[:,::1],i4[:,::1],u4[:,::1],i2[:,::1],i8)")
def sample_unit(texels, levels, unit, count, lod, floats, ints, packed, registers, plane):
    """Filter a texture unit's fragments into four planes of ``registers`` (int16[., batch]) from ``plane`` on.

    unit: int64[UNIT_SIZE] (rows.py); lod: lambda of each fragment with its bias, when the filters need it;
    floats, ints, packed: columns as ``sample_level`` says, with packed rows 4..6 and ints row 10 used here.
    """
    separate_function()
    levels_count = int32(unit[R.LEVELS])
    result = packed[4]
    mipmap, mag_linear, min_linear = unit[R.MIPMAP], unit[R.MAG_LINEAR], unit[R.MIN_LINEAR]
    if mipmap == 0 and mag_linear == min_linear:
        fill_int(ints[9], count, int32(0))
        sample_level(texels, levels, unit, count, mag_linear, 0, floats, ints, packed, result)
    else:
        rounding = int32(127) if mipmap == 1 else int32(0)
        select_level(lod, levels_count if mipmap else int32(1), rounding, int32(0), count, ints[9])
        sample_level(texels, levels, unit, count, min_linear, 1, floats, ints, packed, result)
        if mipmap == 2:
            select_level(lod, levels_count, int32(0), int32(1), count, ints[9])
            sample_level(texels, levels, unit, count, min_linear, 1, floats, ints, packed, packed[5])
            level_fraction(lod, levels_count, count, ints[10])
            blend_levels(result, packed[5], ints[10], count)
        fill_int(ints[9], count, int32(0))
        sample_level(texels, levels, unit, count, mag_linear, 0, floats, ints, packed, packed[6])
        choose_magnified(result, packed[6], lod, int32(unit[R.THRESHOLD]), count)
    unpack(result, count, registers, plane)

"""Texture sampling over a batch (docs/numbers.md, sections 6 and 7).

A texture's levels lie one behind another in one ``uint32`` array of packed texels (``portable.texels``), the
second words of wide ones behind all the first, rows bottom first; a cube map's level holds its six faces in
order. Every fragment has its own level, so the size of a level is a column too. A nearest filter is a linear
one with a fraction of zero.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int32, int64, uint32, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import type_of
from fixedpipe.raster.fixed import projected
from fixedpipe.raster.floats import EXPONENT_BIAS, FRACTION, FRACTION_BITS, TAU
from fixedpipe.raster.kernel import bits_of, float_of, kernel, separate_function, separate_loop
from fixedpipe.raster.portable.combine import convert_plane
from fixedpipe.raster.portable.shadow import compare_texels
from fixedpipe.raster.portable.texels import (
    blend,
    choose_magnified,
    filter_linear,
    filter_linear_hilo,
    filter_linear_lanes,
    unpack,
    unpack_lanes,
    unpack_signed,
)

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
    exponent = (bits >> int64(FRACTION_BITS)) - int64(EXPONENT_BIAS)
    mantissa = float_of((bits & int64(FRACTION)) | int64(EXPONENT_BIAS << FRACTION_BITS))  # in [1, 2)
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
    """A direction's face; x before y before z when equal."""
    if abs(s) >= abs(t) and abs(s) >= abs(r):
        return C.FACE_POSITIVE_X if s >= 0.0 else C.FACE_NEGATIVE_X
    if abs(t) >= abs(r):
        return C.FACE_POSITIVE_Y if t >= 0.0 else C.FACE_NEGATIVE_Y
    return C.FACE_POSITIVE_Z if r >= 0.0 else C.FACE_NEGATIVE_Z


@kernel
def on_face(face, s, t, r):
    """(sc, tc, ma) of EXT_texture_cube_map's table; ma <= 0 where the face is not the major one."""
    if face == C.FACE_POSITIVE_X:
        return -r, -t, s
    if face == C.FACE_NEGATIVE_X:
        return r, -t, -s
    if face == C.FACE_POSITIVE_Y:
        return s, r, t
    if face == C.FACE_NEGATIVE_Y:
        return s, -r, -t
    if face == C.FACE_POSITIVE_Z:
        return s, -t, r
    return -s, -t, -r  # FACE_NEGATIVE_Z


@kernel("void(f8[:,::1],i8,i4[:,::1])")
def cube_faces(floats, count, ints):
    """From s, t (S, T) and r (EXTRA): each direction's FACE, and in S and T sc/|ma| + 1 and tc/|ma| + 1; 0
    where there is no direction.

    Measured: no direction reads face +x's first texel, 70 of 70 pixels (DotReflectSpec_1_-1to1 capture).
    """
    separate_loop()
    for i in range(count):
        s, t, r = floats[R.S, i], floats[R.T, i], floats[R.EXTRA, i]
        face = major_axis(s, t, r)
        sc, tc, ma = on_face(face, s, t, r)
        ints[R.FACE, i] = int32(face)
        floats[R.S, i] = sc / ma + 1.0 if ma > 0.0 else 0.0
        floats[R.T, i] = tc / ma + 1.0 if ma > 0.0 else 0.0


@kernel("void(f8[:,::1],i8,i8)")
def divide_by_q(floats, axis, count):
    """A projective coordinate, column ``axis``, by q (EXTRA)."""
    separate_loop()
    pa = uint64(axis)
    for i in range(count):
        floats[pa, i] = projected(floats[pa, i], floats[R.EXTRA, i])


@kernel("void(f8[:,::1],i8,i8,f8,f8,i8)")
def texel_coordinates(floats, axis, size, bias, scale, count):
    """TEXEL = coordinate * (scale * size) + bias, for columns ``axis`` and ``size``.

    ``scale``: 1, or 1/2 for a cube face's doubled coordinates, or 0 for coordinates that count texels
    already.
    """
    separate_loop()
    pa, ps = uint64(axis), uint64(size)
    if scale == 0.0:
        for i in range(count):
            floats[R.TEXEL, i] = floats[pa, i] + bias
    else:
        for i in range(count):
            floats[R.TEXEL, i] = floats[pa, i] * (scale * floats[ps, i]) + bias


@kernel("void(f8[:,::1],i8,i8,i8,i4[:,::1],i8)")
def wrap_repeat(floats, size, count, linear, ints, first):
    """REPEAT of TEXEL: two neighbours and the 8-bit fraction between them, from column ``first``."""
    separate_loop()
    ps, p0, p1, pf = uint64(size), uint64(first), uint64(first + 1), uint64(first + 2)
    if linear:
        for i in range(count):
            n, t = floats[ps, i], floats[R.TEXEL, i]
            t = t - n * np.floor(t * (1.0 / n))
            t = t if t > 0.0 else 0.0  # also where t is not a number
            t = t if t < n else n
            f = int32(np.floor((t - 0.5) * 256.0))
            last = int32(int32(n) - int32(1))
            k = int32(f >> int32(8))
            ints[pf, i] = int32(f & int32(255))
            ints[p0, i] = last if k < int32(0) else k
            ints[p1, i] = int32(0) if k >= last else int32(k + int32(1))
    else:
        for i in range(count):
            n, t = floats[ps, i], floats[R.TEXEL, i]
            t = t - n * np.floor(t * (1.0 / n))
            t = t if t > 0.0 else 0.0
            t = t if t < n else n
            k = int32(t)
            ints[p0, i] = int32(0) if k >= int32(n) else k


@kernel
def mirrored_index(k, n):
    """The texel of index k, -1 to 2n, where every other copy of the texture runs backwards."""
    j = int32(-1) - k if k < int32(0) else (k - int32(2 * n) if k >= int32(2 * n) else k)
    return int32(int32(2 * n) - int32(1)) - j if j >= n else j


@kernel("void(f8[:,::1],i8,i8,i8,i4[:,::1],i8)")
def wrap_mirrored(floats, size, count, linear, ints, first):
    """MIRRORED_REPEAT of TEXEL: the indices are mirrored, not the coordinate.

    Measured: nearest, 48768 of 48768 pixels (CylinderWrapping). Inferred: linear.
    """
    separate_loop()
    ps, p0, p1, pf = uint64(size), uint64(first), uint64(first + 1), uint64(first + 2)
    for i in range(count):
        n, t = floats[ps, i], floats[R.TEXEL, i]
        twice = 2.0 * n
        t = t - twice * np.floor(t * (1.0 / twice))
        t = t if t > 0.0 else 0.0  # also where t is not a number
        t = t if t < twice else twice
        if linear:
            f = int32(np.floor((t - 0.5) * 256.0))
            k = int32(f >> int32(8))
            ints[pf, i] = int32(f & int32(255))
            ints[p0, i] = mirrored_index(k, int32(n))
            ints[p1, i] = mirrored_index(int32(k + int32(1)), int32(n))
        else:
            ints[p0, i] = mirrored_index(int32(t), int32(n))


@kernel("void(f8[:,::1],i8,i8,i8,f8,i8,i4[:,::1],i8)")
def wrap_clamp(floats, size, count, linear, margin, border, ints, first):
    """The other wrap modes: T limited to [-margin, size + margin]; texels outside are clamped or -1."""
    separate_loop()
    ps, p0, p1, pf = uint64(size), uint64(first), uint64(first + 1), uint64(first + 2)
    for i in range(count):
        n, t = floats[ps, i], floats[R.TEXEL, i]
        t = t if t > -margin else -margin  # also where t is not a number
        t = t if t < n + margin else n + margin
        last = int32(int32(n) - int32(1))
        if linear:
            f = int32(np.floor((t - 0.5) * 256.0))
            a = int32(f >> int32(8))
            b = int32(a + int32(1))
            ints[pf, i] = int32(f & int32(255))
        else:
            a = int32(np.floor(t))
            b = a
        if border:
            ints[p0, i] = a if (a >= int32(0)) & (a <= last) else int32(-1)
            ints[p1, i] = b if (b >= int32(0)) & (b <= last) else int32(-1)
        else:
            ints[p0, i] = min(max(a, int32(0)), last)
            ints[p1, i] = min(max(b, int32(0)), last)


@kernel
def wrap_axis(mode, floats, size, count, linear, ints, first):
    """Choose the loop of a wrap mode."""
    if mode == C.WRAP_REPEAT:
        wrap_repeat(floats, size, count, linear, ints, first)
    elif mode == C.WRAP_CLAMP:
        wrap_clamp(floats, size, count, linear, 0.0, linear, ints, first)
    elif mode == C.WRAP_CLAMP_TO_EDGE:
        wrap_clamp(floats, size, count, linear, -0.5, 0, ints, first)
    elif mode == C.WRAP_CLAMP_TO_BORDER:
        wrap_clamp(floats, size, count, linear, 0.5, 1, ints, first)
    else:  # WRAP_MIRRORED_REPEAT
        wrap_mirrored(floats, size, count, linear, ints, first)


@kernel("void(u4[::1],i4[:,::1],i8,u4[:,::1],i8)")
def fetch_nearest(texels, ints, count, packed, out):
    """The texel at (I0, J0)."""
    separate_loop()
    po = uint64(out)
    for i in range(count):
        row = int32(ints[R.BASE, i] + int32(ints[R.J0, i] * ints[R.WIDTH, i]))
        packed[po, i] = texels[uint32(row + ints[R.I0, i])]


@kernel("void(u4[::1],i4[:,::1],i8,u4[:,::1])")
def fetch_linear(texels, ints, count, packed):
    """The four texels of a linear filter into P00, P10, P01, P11."""
    separate_function()
    for i in range(count):
        lower = int32(ints[R.BASE, i] + int32(ints[R.J0, i] * ints[R.WIDTH, i]))
        upper = int32(ints[R.BASE, i] + int32(ints[R.J1, i] * ints[R.WIDTH, i]))
        packed[R.P00, i] = texels[uint32(lower + ints[R.I0, i])]
        packed[R.P10, i] = texels[uint32(lower + ints[R.I1, i])]
        packed[R.P01, i] = texels[uint32(upper + ints[R.I0, i])]
        packed[R.P11, i] = texels[uint32(upper + ints[R.I1, i])]


@kernel("void(u4[::1],i4[:,::1],i8,i8,i8,u4,u4[:,::1],i8)")
def fetch_bordered(texels, ints, count, column, row, border, packed, out):
    """The texel at columns (column, row) of ``ints``; -1 in either reads the border colour."""
    separate_function()
    pc, pr, po = uint64(column), uint64(row), uint64(out)
    for i in range(count):
        x, y = ints[pc, i], ints[pr, i]
        if x < 0 or y < 0:
            packed[po, i] = border
        else:
            packed[po, i] = texels[uint32(int32(ints[R.BASE, i] + int32(y * ints[R.WIDTH, i])) + x)]


@kernel("void(i4[:,::1],i4,i4,i4,i8)")
def select_level(ints, levels, rounding, step, count):
    """LEVEL of each fragment: (clamp(lambda) + rounding) >> 8, plus ``step``, at most the last."""
    separate_loop()
    last = int32(levels - int32(1))
    for i in range(count):
        clamped = min(max(ints[R.LOD, i], int32(0)), int32(last * int32(256)))
        level = int32(int32(clamped + rounding) >> int32(8))
        ints[R.LEVEL, i] = min(int32(level + step), last)


@kernel("void(i4[:,::1],i4,i8)")
def level_fraction(ints, levels, count):
    """FRACTION: the 8-bit position of lambda between two levels."""
    separate_loop()
    for i in range(count):
        clamped = min(max(ints[R.LOD, i], int32(0)), int32(int32(levels - int32(1)) * int32(256)))
        ints[R.FRACTION, i] = int32(clamped & int32(255))


@kernel("void(i4[:,::1],i4[:,::1],i8,i8,f8[:,::1])")
def level_sizes(levels, ints, cube, count, floats):
    """BASE (of the FACE for a cube map), WIDTH, S_SIZE and T_SIZE of each fragment's LEVEL."""
    separate_function()
    for i in range(count):
        k = uint32(ints[R.LEVEL, i])
        area = int32(levels[k, 1] * levels[k, 2])
        ints[R.BASE, i] = int32(levels[k, 0] + int32(ints[R.FACE, i] * area)) if cube else levels[k, 0]
        ints[R.WIDTH, i] = levels[k, 1]
        floats[R.S_SIZE, i] = float64(levels[k, 1])
        floats[R.T_SIZE, i] = float64(levels[k, 2])


@kernel("void(i4[:,::1],i4[:,::1],i4,i8,f8[:,::1])")
def layer_sizes(levels, ints, layers, count, floats):
    """WIDTH and the three sizes of each fragment's LEVEL of a 3D texture with ``layers`` at level 0."""
    separate_function()
    for i in range(count):
        k = ints[R.LEVEL, i]
        ints[R.WIDTH, i] = levels[uint32(k), 1]
        floats[R.S_SIZE, i] = float64(levels[uint32(k), 1])
        floats[R.T_SIZE, i] = float64(levels[uint32(k), 2])
        floats[R.P_SIZE, i] = float64(max(int32(layers >> k), int32(1)))


@kernel("void(i4[:,::1],i4[:,::1],i8,i8)")
def layer_base(levels, ints, layer, count):
    """BASE of the layer in column ``layer``; the first layer's where that is -1, the border."""
    separate_function()
    pl = uint64(layer)
    for i in range(count):
        k = uint32(ints[R.LEVEL, i])
        n = max(ints[pl, i], int32(0))
        ints[R.BASE, i] = int32(levels[k, 0] + int32(n * int32(levels[k, 1] * levels[k, 2])))


@kernel("void(i4[:,::1],i8,u4,i8,u4[:,::1],i8)")
def border_layer(ints, layer, border, count, packed, out):
    """The border colour where column ``layer`` is -1."""
    separate_loop()
    pl, po = uint64(layer), uint64(out)
    for i in range(count):
        if ints[pl, i] < int32(0):
            packed[po, i] = border


@kernel("void(i4[:,::1],i4[:,::1],i8,f8[:,::1])")
def base_sizes(levels, ints, count, floats):
    """BASE, WIDTH, S_SIZE and T_SIZE where every fragment reads level 0."""
    separate_loop()
    base, width, s_size, t_size = levels[0, 0], levels[0, 1], float64(levels[0, 1]), float64(levels[0, 2])
    for i in range(count):
        ints[R.BASE, i] = base
        ints[R.WIDTH, i] = width
        floats[R.S_SIZE, i] = s_size
        floats[R.T_SIZE, i] = t_size


@kernel("void(i4[:,::1],i8,i8,i4)")
def fill_int(ints, column, count, value):
    """Fill a column."""
    separate_loop()
    p = uint64(column)
    for i in range(count):
        ints[p, i] = value


class Fetch(NamedTuple):
    """How texels are fetched.

    linear    whether four are, and filtered, or one
    bordered  whether some may lie outside
    border    what those are, packed
    function  of a shadow comparison, or one of UNCOMPARED
    held      what a comparison gives where it holds
    failed    and where it fails
    """

    linear: int
    bordered: int
    border: int
    function: int
    held: int
    failed: int


FETCH = type_of(Fetch, int64, int64, uint32, int64, uint32, uint32)


@kernel(void(uint32[::1], int32[:, ::1], FETCH, int64, uint32[:, ::1], int64))
def fetch_and_filter(texels, ints, fetch, count, packed, out):
    """The texel at (I0, J0), or the linear filter of the four at I0, I1, J0, J1, into a packed column."""
    separate_function()
    linear, bordered, border, function, held, failed = fetch
    if not linear:
        if bordered:
            fetch_bordered(texels, ints, count, R.I0, R.J0, border, packed, out)
        else:
            fetch_nearest(texels, ints, count, packed, out)
        if function not in C.UNCOMPARED:
            compare_texels(packed, out, ints, int32(function), held, failed, count)
        return
    if bordered:
        fetch_bordered(texels, ints, count, R.I0, R.J0, border, packed, R.P00)
        fetch_bordered(texels, ints, count, R.I1, R.J0, border, packed, R.P10)
        fetch_bordered(texels, ints, count, R.I0, R.J1, border, packed, R.P01)
        fetch_bordered(texels, ints, count, R.I1, R.J1, border, packed, R.P11)
    else:
        fetch_linear(texels, ints, count, packed)
    if function not in C.UNCOMPARED:
        for column in (R.P00, R.P10, R.P01, R.P11):
            compare_texels(packed, column, ints, int32(function), held, failed, count)
    if function == C.UNCOMPARED_WORDS:
        filter_linear_hilo(packed, ints, count, out)
    elif function == C.UNCOMPARED_LANES:
        filter_linear_lanes(packed, ints, count, out)
    else:  # bytes, UNCOMPARED_BYTES or of a comparison
        filter_linear(packed, ints, count, out)


@kernel
def reads_border(mode, linear):
    """Whether a wrap mode can read the border colour."""
    return mode == C.WRAP_CLAMP_TO_BORDER or (linear and mode == C.WRAP_CLAMP)


class Columns(NamedTuple):
    """Columns of a batch (``rows``)."""

    floats: np.ndarray
    ints: np.ndarray
    packed: np.ndarray


COLUMNS = type_of(Columns, float64[:, ::1], int32[:, ::1], uint32[:, ::1])


@kernel(void(uint32[::1], int32[:, ::1], int64[::1], int64, int64, int64, COLUMNS, int64))
def sample_level(texels, levels, unit, count, linear, many, columns, out):
    """One filtered texel per fragment into a packed column: from level 0, or (``many``) from its LEVEL."""
    separate_function()
    floats, ints, packed = columns
    target = unit[R.TARGET]
    flat, cube, layered = target == C.TARGET_1D, target == C.TARGET_CUBE_MAP, target == C.TARGET_3D
    if layered:
        layer_sizes(levels, ints, int32(unit[R.LAYERS]), count, floats)
    elif many or cube:
        level_sizes(levels, ints, cube, count, floats)
    else:
        base_sizes(levels, ints, count, floats)
    scale = 0.5 if cube else (0.0 if target == C.TARGET_RECTANGLE else 1.0)
    operation = unit[R.OPERATION]
    iterated = operation == C.OPERATION_NONE or operation in C.OPERATIONS_WITH_OFFSET
    # A direction that a stage made is not lifted. Measured: DotSTR3D_-1to1, DotReflectConst_1_-1to1.
    bias = TAU if cube == iterated else 0.0
    edge = int64(C.WRAP_CLAMP_TO_EDGE)
    wrap_s, wrap_t = (edge, edge) if cube else (unit[R.WRAP_S], unit[R.WRAP_T])
    texel_coordinates(floats, R.S, R.S_SIZE, bias, scale, count)
    wrap_axis(wrap_s, floats, R.S_SIZE, count, linear, ints, R.I0)
    if flat:
        fill_int(ints, R.J0, count, int32(0))
        fill_int(ints, R.J1, count, int32(0))
        fill_int(ints, R.J_FRACTION, count, int32(0))
    else:
        texel_coordinates(floats, R.T, R.T_SIZE, bias, scale, count)
        wrap_axis(wrap_t, floats, R.T_SIZE, count, linear, ints, R.J0)
    bordered = reads_border(wrap_s, linear) or (not flat and reads_border(wrap_t, linear))
    wrap_r = unit[R.WRAP_R]
    if layered:
        texel_coordinates(floats, R.P, R.P_SIZE, bias, scale, count)
        wrap_axis(wrap_r, floats, R.P_SIZE, count, linear, ints, R.K0)
    wide = unit[R.TEXEL_BITS] != R.BITS_OF_BYTES
    plain = int64(C.UNCOMPARED_LANES if wide else C.UNCOMPARED_BYTES)
    uncompared = int64(C.UNCOMPARED_WORDS) if unit[R.HILO] else plain
    function = unit[R.COMPARE_FUNCTION] if unit[R.COMPARE] else uncompared
    held, failed = uint32(unit[R.COMPARE_HELD]), uint32(unit[R.COMPARE_FAILED])
    for word in range(2 if wide else 1):
        words = texels[word * (texels.shape[0] // 2) :]  # the second words lie behind all the first
        border, to = uint32(unit[R.BORDER + word]), out + word * R.WIDE
        if not layered:
            fetch = Fetch(linear, int64(bordered), border, function, held, failed)
            fetch_and_filter(words, ints, fetch, count, packed, to)
            continue
        for k in range(2 if linear else 1):
            layer, column = (R.K1, R.LAYER_1) if k == 1 else (R.K0, to)
            layer_base(levels, ints, layer, count)
            fetch = Fetch(linear, int64(bordered), border, plain, held, failed)
            fetch_and_filter(words, ints, fetch, count, packed, column)
            if reads_border(wrap_r, linear):
                border_layer(ints, layer, border, count, packed, column)
        if linear:
            blend(packed, ints, to, R.LAYER_1, R.K_FRACTION, wide, count)


@kernel("void(u4[::1],i4[:,::1],i8[::1],i8,f8[:,::1],i4[:,::1],u4[:,::1])")
def filter_unit(texels, levels, unit, count, floats, ints, packed):
    """Filter a texture unit's fragments into TEXEL_0.

    unit: int64[UNIT_SIZE]; floats, ints, packed: scratch columns (rows.py), with S and T (P of a 3D texture),
    the FACE for a cube map and LOD for filters that need it filled in.
    """
    separate_function()
    columns = Columns(floats, ints, packed)
    levels_count = int32(unit[R.LEVELS])
    mipmap, mag_linear, min_linear = unit[R.MIPMAP], unit[R.MAG_LINEAR], unit[R.MIN_LINEAR]
    fill_int(ints, R.LEVEL, count, int32(0))
    wide = unit[R.TEXEL_BITS] != R.BITS_OF_BYTES
    words = 2 * R.WIDE if wide else R.WIDE
    if mipmap == C.MIPMAP_NONE and mag_linear == min_linear:
        sample_level(texels, levels, unit, count, mag_linear, 0, columns, R.TEXEL_0)
    else:
        sample_level(texels, levels, unit, count, mag_linear, 0, columns, R.MAGNIFIED)
        if mipmap != C.MIPMAP_NONE:
            rounding = int32(127) if mipmap == C.MIPMAP_NEAREST else int32(0)
            select_level(ints, levels_count, rounding, int32(0), count)
        sample_level(texels, levels, unit, count, min_linear, 1, columns, R.TEXEL_0)
        if mipmap == C.MIPMAP_LINEAR:
            select_level(ints, levels_count, int32(0), int32(1), count)
            sample_level(texels, levels, unit, count, min_linear, 1, columns, R.TEXEL_1)
            level_fraction(ints, levels_count, count)
            for word in range(0, words, R.WIDE):
                blend(packed, ints, R.TEXEL_0 + word, R.TEXEL_1 + word, R.FRACTION, wide, count)
        for word in range(0, words, R.WIDE):
            choose_magnified(packed, ints, int32(unit[R.THRESHOLD]), word, count)


@kernel("void(i8[::1],i8,u4[:,::1],i2[:,::1],i8,i4)")
def unpack_unit(unit, count, packed, registers, plane, bits):
    """TEXEL_0 to four planes of ``registers`` (int16[., batch]) from ``plane`` on, of ``bits`` bits."""
    if unit[R.SIGNED]:
        unpack_signed(packed, R.TEXEL_0, uint32(unit[R.SIGNED]), count, registers, plane)
    elif unit[R.TEXEL_BITS] != R.BITS_OF_BYTES:
        unpack_lanes(packed, R.TEXEL_0, count, registers, plane)
    else:
        unpack(packed, R.TEXEL_0, count, registers, plane)
    if unit[R.TEXEL_BITS] != bits:
        for c in range(4):
            convert_plane(registers, plane + c, count, int32(unit[R.TEXEL_BITS]), bits)

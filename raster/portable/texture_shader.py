"""Texture shader stages: coordinates made from earlier stages' texels (docs/numbers.md, section 12).

A stage's filtered texel, packed, is kept in column STAGE0 + unit, before it becomes a register; dot products
stay in DOT0 + unit.
"""

import numpy as np
from numba import float32, float64, int32, int64, uint8, uint32, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import SEGMENTS
from fixedpipe.raster.fixed import signed_reciprocal
from fixedpipe.raster.kernel import float_of, kernel, separate_function, separate_loop
from fixedpipe.raster.portable.arrays import SCRATCH
from fixedpipe.raster.portable.interpolate import cut_sum, iterate_coordinate, product_sum
from fixedpipe.raster.portable.sample import major_axis, on_face
from fixedpipe.raster.portable.texels import unpack


@kernel
def signed_byte(packed, shift):
    """A byte of a packed texel as two's complement."""
    return int32(int32(uint32(packed << uint32(24 - shift))) >> int32(24))


@kernel
def real_byte(value):
    """The byte of a texture shader's real number: twelve fraction bits, one added, 255/256 of it.

    Measured: 98304 of 98304 pixels (BumpEnvMapLuminance capture).
    """
    v = value if value > 0.0 else 0.0  # also where it is not a number
    v = v if v < 1.0 else 1.0
    p = int32(int32(np.floor(v * 4096.0)) + int32(1))
    return min(int32(int32(p * int32(255)) >> int32(12)), int32(255))


@kernel("void(f8[:,::1],i8,i8,u4[:,::1],i8)")
def pass_through(floats, first, count, packed, out):
    """The coordinates in columns ``first``.. as a colour."""
    separate_loop()
    p, po = uint64(first), uint64(out)
    for i in range(count):
        word = uint32(real_byte(floats[p, i]))
        word |= uint32(uint32(real_byte(floats[p + uint64(1), i])) << uint32(8))
        word |= uint32(uint32(real_byte(floats[p + uint64(2), i])) << uint32(16))
        packed[po, i] = word | uint32(uint32(real_byte(floats[p + uint64(3), i])) << uint32(24))


@kernel("void(f8[:,::1],i8,i8,i8,u1[::1])")
def cull_fragment(floats, first, count, modes, alive):
    """Discard where a coordinate fails its cull mode (bit k of ``modes``).

    Measured: 296284 of 296284 pixels (ClipPlane capture).
    """
    separate_loop()
    p = uint64(first)
    for i in range(count):
        keep = uint8(1)
        for k in range(4):
            less = floats[p + uint64(k), i] < 0.0
            if less != (((modes >> k) & 1) == C.CULL_MODE_LESS):
                keep = uint8(0)
        alive[i] = uint8(alive[i] & keep)


@kernel("void(f8[:,::1],u4[:,::1],i8,i8,f8,f8,f8,f8)")
def offset_coordinates(floats, packed, previous, count, a1, a2, a3, a4):
    """S and T moved by the previous texel's blue and green, in units of 1/128, times the offset matrix: the
    three terms are added as a coordinate's are.

    Measured: all pixels of BumpEnvMap and of 16 Bump_map, Bump_env_lum captures whose offsets end on texels'
    edges for up to 780 pixels (BumpMap_G8B8_B_R90).
    """
    separate_loop()
    p = uint64(previous)
    for i in range(count):
        ds = float64(signed_byte(packed[p, i], 16)) * (1.0 / 128.0)
        dt = float64(signed_byte(packed[p, i], 8)) * (1.0 / 128.0)
        floats[R.S, i] = cut_sum(floats[R.S, i], a1 * ds, a3 * dt)
        floats[R.T, i] = cut_sum(floats[R.T, i], a2 * ds, a4 * dt)


@kernel("void(u4[:,::1],i8,i8,f8,f8,f8)")
def scale_texel(packed, previous, count, scale, bias, largest):
    """TEXEL_0's colour times the previous texel's magnitude (red), scaled and biased, ``largest`` at most;
    alpha stays.

    Measured: 98304 of 98304 pixels (BumpEnvMapLuminance capture).
    """
    separate_loop()
    p = uint64(previous)
    for i in range(count):
        magnitude = (float64(packed[p, i] & uint32(255)) / 255.0) * scale + bias
        magnitude = magnitude if magnitude < largest else largest
        word = packed[R.TEXEL_0, i]
        red = real_byte(float64(word & uint32(255)) * magnitude / 255.0)
        green = real_byte(float64(uint32(word >> uint32(8)) & uint32(255)) * magnitude / 255.0)
        blue = real_byte(float64(uint32(word >> uint32(16)) & uint32(255)) * magnitude / 255.0)
        color = uint32(red) | uint32(uint32(green) << uint32(8)) | uint32(uint32(blue) << uint32(16))
        packed[R.TEXEL_0, i] = (word & uint32(0xFF000000)) | color


@kernel("void(f8[:,::1],u4[:,::1],i8,i8,i8,i8)")
def dependent_coordinates(floats, packed, previous, s_shift, t_shift, count):
    """S and T from two bytes of the previous texel. Measured: 65536 of 65536 pixels (StageDependent)."""
    separate_loop()
    p, ks, kt = uint64(previous), uint32(s_shift), uint32(t_shift)
    for i in range(count):
        floats[R.S, i] = float64(uint32(packed[p, i] >> ks) & uint32(255)) / 255.0
        floats[R.T, i] = float64(uint32(packed[p, i] >> kt) & uint32(255)) / 255.0


@kernel
def mapped_component(byte, mapping):
    """A byte as a dot product reads it. Measured: 56909 pixels for each mapping (DotSTRCube captures)."""
    if mapping == C.DOT_MAPPING_EXPAND_NORMAL:
        return (float64(byte) - 128.0) / 127.0
    signed = float64(byte) if byte < 128 else float64(byte) - 256.0
    if mapping == C.DOT_MAPPING_SIGNED_ODD:
        return (2.0 * signed + 1.0) / 255.0
    if mapping == C.DOT_MAPPING_SIGNED_IDENTITY:
        return signed / 127.0
    return float64(byte) / 255.0  # DOT_MAPPING_UNSIGNED_IDENTITY; words have a loop of their own


@kernel("void(f8[:,::1],u4[:,::1],i8,i8,i8,i8)")
def dot_products(floats, packed, previous, mapping, count, out):
    """``(s x + t y) + r z`` of (S, T, EXTRA) and the previous texel, a single, into a column.

    Measured: DotZW, 65536 of 65536; 56909 pixels for each mapping (DotSTRCube captures).
    """
    separate_loop()
    p, po = uint64(previous), uint64(out)
    for i in range(count):
        word = packed[p, i]
        red, green = int32(word & uint32(255)), int32(uint32(word >> uint32(8)) & uint32(255))
        blue, alpha = int32(uint32(word >> uint32(16)) & uint32(255)), int32(word >> uint32(24))
        if mapping >= C.FIRST_MAPPING_OF_WORDS:
            high, low = int32(int32(alpha * int32(256)) + red), int32(int32(green * int32(256)) + blue)
            if mapping == C.DOT_MAPPING_UNSIGNED_HILO:
                x, y, z = float64(high) / 65535.0, float64(low) / 65535.0, 1.0
            else:
                # The third component is a whole root of whole numbers, of 15 bits.
                first = float64(high if high < 32768 else high - 65536)
                second = float64(low if low < 32768 else low - 65536)
                rest = max((1073741824.0 - first * first) - second * second, 0.0)
                x, y, z = first / 32767.0, second / 32767.0, np.floor(np.sqrt(rest)) / 32768.0
        else:
            x = mapped_component(red, mapping)
            y = mapped_component(green, mapping)
            z = mapped_component(blue, mapping)
        floats[po, i] = product_sum(
            floats[R.S, i], float64(float32(x)),
            floats[R.T, i], float64(float32(y)),
            floats[R.EXTRA, i], float64(float32(z)),
        )  # fmt: skip


@kernel("void(f8[:,::1],u4[:,::1],i8,i8,i8)")
def brdf_coordinates(floats, packed, eye, light, count):
    """(S, T, EXTRA) from two texels of directions, HI theta and LO phi: eye's theta, light's theta, and
    light's phi less eye's.

    Measured: 614 of 614 pixels (Texture_BRDF capture). Assumed: the divisors, 65535 and 65536 (a whole turn).
    """
    separate_loop()
    pe, pl = uint64(eye), uint64(light)
    for i in range(count):
        e, k = packed[pe, i], packed[pl, i]
        eye_theta = uint32(uint32(e >> uint32(24)) << uint32(8)) | uint32(e & uint32(255))
        light_theta = uint32(uint32(k >> uint32(24)) << uint32(8)) | uint32(k & uint32(255))
        eye_phi = uint32(e & uint32(0xFF00)) | uint32(uint32(e >> uint32(16)) & uint32(255))
        light_phi = uint32(k & uint32(0xFF00)) | uint32(uint32(k >> uint32(16)) & uint32(255))
        floats[R.S, i] = float64(eye_theta) / 65535.0
        floats[R.T, i] = float64(light_theta) / 65535.0
        floats[R.EXTRA, i] = (float64(light_phi) - float64(eye_phi)) / 65536.0


@kernel("void(f8[:,::1],i8,i8,i8)")
def reflect(floats, normal, eye, count):
    """(S, T, EXTRA): the reflection vector of three columns of normals and three of eyes, not normalised:
    ``2 n (n e) - e (n n)``.

    Measured: DotReflect captures.
    """
    separate_loop()
    pn, pe = uint64(normal), uint64(eye)
    for i in range(count):
        nx, ny, nz = floats[pn, i], floats[pn + uint64(1), i], floats[pn + uint64(2), i]
        ex, ey, ez = floats[pe, i], floats[pe + uint64(1), i], floats[pe + uint64(2), i]
        twice = 2.0 * product_sum(nx, ex, ny, ey, nz, ez)
        square = product_sum(nx, nx, ny, ny, nz, nz)
        floats[R.S, i] = nx * twice - ex * square
        floats[R.T, i] = ny * twice - ey * square
        floats[R.EXTRA, i] = nz * twice - ez * square


@kernel("void(f8[:,::1],i8,i8,i8)")
def copy_column(floats, source, target, count):
    """Copy a column."""
    separate_loop()
    ps, pt = uint64(source), uint64(target)
    for i in range(count):
        floats[pt, i] = floats[ps, i]


@kernel("void(f8[:,::1],i8,f8,i8)")
def fill_column(floats, target, value, count):
    """Fill a column."""
    separate_loop()
    p = uint64(target)
    for i in range(count):
        floats[p, i] = value


@kernel("void(f8[:,::1],i8,i8,f8,i4[::1],u1[::1],i4)")
def replace_depth(floats, numerator, count, scale, depth, alive, maximum):
    """The fragment's depth: floor of one dot product by the next one's reciprocal; none outside the depth
    buffer's range.

    Measured: 65536 of 65536 pixels (DotZW capture). Source: NV_texture_shader (range).
    """
    separate_loop()
    p = uint64(numerator)
    for i in range(count):
        z = floats[p, i] * signed_reciprocal(floats[p + uint64(1), i]) * scale
        inside = (z >= 0.0) & (z <= float64(maximum))  # false where it is not a number
        depth[i] = int32(np.floor(z)) if inside else int32(0)
        alive[i] = uint8(alive[i] & uint8(inside))


@kernel("void(f8[:,::1],i8,i4[:,::1])")
def flat_face(floats, count, ints):
    """A three-dimensional access to a cube map: face 0, s and t as they are, t downwards.

    Measured: 56909 of 56909 pixels (DotSTR3D captures).
    """
    separate_loop()
    for i in range(count):
        ints[R.FACE, i] = int32(0)
        floats[R.S, i] = floats[R.S, i] + 1.0
        floats[R.T, i] = 1.0 - floats[R.T, i]


@kernel("void(f8[:,::1],i8)")
def face_planes(floats, count):
    """A cube map's access to a two-dimensional texture: s = sc/|ma|, t = -tc/|ma| on any face.

    Measured: 113818 of 113818 pixels (Texture_2D_as_cubemap captures).
    """
    separate_loop()
    for i in range(count):
        s, t, r = floats[R.S, i], floats[R.T, i], floats[R.EXTRA, i]
        sc, tc, ma = on_face(major_axis(s, t, r), s, t, r)
        floats[R.S, i] = sc / ma if ma > 0.0 else 0.0
        floats[R.T, i] = -tc / ma if ma > 0.0 else 0.0


@kernel("void(u4[:,::1],i8,i8,u4,i8)")
def copy_texel(packed, source, target, inverted, count):
    """Copy a packed column with some bits inverted: those that made signed bytes s into s + 128."""
    separate_loop()
    ps, pt = uint64(source), uint64(target)
    for i in range(count):
        packed[pt, i] = packed[ps, i] ^ inverted


@kernel("void(u4[:,::1],i8,i8)")
def no_texel(packed, out, count):
    """(0, 0, 0, 0) for a stage without a result. Source: NV_texture_shader, table 3.D."""
    separate_loop()
    p = uint64(out)
    for i in range(count):
        packed[p, i] = uint32(0)


@kernel(
    void(
        SEGMENTS, int32[:, ::1], float64[:, :, ::1], int64, int64[:, ::1], int64, float64[:, ::1],
        uint32[:, ::1],
    )
)  # fmt: skip
def stage_dot_product(segments, triangles, coordinates, unit, units, count, floats, packed):
    """A unit's dot product into DOT0 + unit."""
    separate_function()
    iterate_coordinate(segments, triangles, coordinates, unit, 0, floats, R.S)
    iterate_coordinate(segments, triangles, coordinates, unit, 1, floats, R.T)
    iterate_coordinate(segments, triangles, coordinates, unit, 2, floats, R.EXTRA)
    previous, mapping = R.STAGE0 + units[unit, R.PREVIOUS], units[unit, R.MAPPING]
    dot_products(floats, packed, previous, mapping, count, R.DOT0 + unit)


@kernel(int64(int64, int64[:, ::1], SEGMENTS, int32[:, ::1], float64[:, :, ::1], int64, SCRATCH, int32))
def shader_stage(unit, units, segments, triangles, coordinates, count, scratch, maximum):
    """One stage up to its texture access: coordinates in S, T and EXTRA; returns whether it has an access.

    A stage without one has its register and its STAGE0 + unit filled in.
    """
    separate_function()
    row, u = units[unit], unit
    floats, packed, alive = scratch.floats, scratch.packed, scratch.alive
    operation = row[R.OPERATION]
    if operation == C.OPERATION_TEXTURE_CUBE_MAP:
        for k in range(3):
            column = (R.S, R.T, R.EXTRA)[k]
            iterate_coordinate(segments, triangles, coordinates, u, k, floats, column)
        return 1
    if operation == C.OPERATION_BRDF_TEXTURE_3D:
        brdf_coordinates(floats, packed, R.STAGE0 + u - 2, R.STAGE0 + u - 1, count)
        return 1
    if operation <= C.OPERATION_CULL_FRAGMENT:  # or PASS_THROUGH: rows have NONE for those before it
        for k in range(4):
            iterate_coordinate(segments, triangles, coordinates, u, k, floats, R.COORDINATE0 + k)
        if operation == C.OPERATION_PASS_THROUGH:
            pass_through(floats, R.COORDINATE0, count, packed, R.STAGE0 + u)
        else:  # OPERATION_CULL_FRAGMENT
            cull_fragment(floats, R.COORDINATE0, count, row[R.CULL_MODES], alive)
            no_texel(packed, R.STAGE0 + u, count)
    elif operation in C.OPERATIONS_WITH_OFFSET or operation in C.DEPENDENT_OPERATIONS:
        previous = R.STAGE0 + row[R.PREVIOUS]
        if operation == C.OPERATION_DEPENDENT_AR_TEXTURE_2D:
            dependent_coordinates(floats, packed, previous, 24, 0, count)
        elif operation == C.OPERATION_DEPENDENT_GB_TEXTURE_2D:
            dependent_coordinates(floats, packed, previous, 8, 16, count)
        else:  # OPERATIONS_WITH_OFFSET
            iterate_coordinate(segments, triangles, coordinates, u, 0, floats, R.S)
            iterate_coordinate(segments, triangles, coordinates, u, 1, floats, R.T)
            offset_coordinates(
                floats,
                packed,
                previous,
                count,
                float_of(row[R.OFFSET_MATRIX]),
                float_of(row[R.OFFSET_MATRIX + 1]),
                float_of(row[R.OFFSET_MATRIX + 2]),
                float_of(row[R.OFFSET_MATRIX + 3]),
            )
        return 1
    else:  # OPERATION_DOT_PRODUCT and those that are named after it
        stage_dot_product(segments, triangles, coordinates, u, units, count, floats, packed)
        if operation == C.OPERATION_DOT_PRODUCT:
            no_texel(packed, R.STAGE0 + u, count)
        elif operation == C.OPERATION_DOT_PRODUCT_DEPTH_REPLACE:
            scale = float_of(row[R.COORDINATE_DEPTH])
            replace_depth(floats, R.DOT0 + u - 1, count, scale, scratch.depth, alive, maximum)
            no_texel(packed, R.STAGE0 + u, count)
        else:  # OPERATIONS_OF_TWO_DOT_PRODUCTS or of three, OPERATION_DOT_PRODUCT_DIFFUSE_CUBE_MAP
            if operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
                copy_column(floats, R.DOT0 + u - 1, R.S, count)
                copy_column(floats, R.DOT0 + u, R.T, count)
            elif operation == C.OPERATION_DOT_PRODUCT_DIFFUSE_CUBE_MAP:
                stage_dot_product(segments, triangles, coordinates, u + 1, units, count, floats, packed)
                for k in range(3):
                    copy_column(floats, R.DOT0 + u - 1 + k, (R.S, R.T, R.EXTRA)[k], count)
            elif operation in C.OPERATIONS_REFLECTING:
                for k in range(3):
                    if operation == C.OPERATION_DOT_PRODUCT_REFLECT_CUBE_MAP:
                        column = R.COORDINATE0 + k
                        iterate_coordinate(segments, triangles, coordinates, u - 2 + k, 3, floats, column)
                    else:
                        fill_column(floats, R.COORDINATE0 + k, float_of(row[R.CONSTANT_EYE + k]), count)
                reflect(floats, R.DOT0 + u - 2, R.COORDINATE0, count)
            else:  # the others of OPERATIONS_OF_THREE_DOT_PRODUCTS
                for k in range(3):
                    copy_column(floats, R.DOT0 + u - 2 + k, (R.S, R.T, R.EXTRA)[k], count)
            return 1
    unpack(packed, R.STAGE0 + u, count, scratch.registers, (C.REGISTER_TEXTURE0 + u) * 4)
    return 0

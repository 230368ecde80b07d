"""A texture unit over a batch: which of the steps of sampling its state asks for."""

from numba import int32, int64, uint32, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS, SEGMENTS
from fixedpipe.raster.fixed import clamp
from fixedpipe.raster.kernel import float_of, kernel, separate_function
from fixedpipe.raster.portable.anisotropic import filter_along, footprints
from fixedpipe.raster.portable.arrays import PASS, SCRATCH
from fixedpipe.raster.portable.combine import fill_plane
from fixedpipe.raster.portable.footprint import assemble_probes
from fixedpipe.raster.portable.interpolate import iterate_coordinate
from fixedpipe.raster.portable.level_of_detail import level_of_detail
from fixedpipe.raster.portable.roughness import rough_footprints
from fixedpipe.raster.portable.sample import cube_faces, divide_by_q, filter_unit, unpack_unit
from fixedpipe.raster.portable.shadow import shadow_reference
from fixedpipe.raster.portable.texels import unpack
from fixedpipe.raster.portable.texture_shader import (
    copy_column,
    copy_texel,
    face_planes,
    fill_column,
    flat_face,
    scale_texel,
    shader_stage,
)


@kernel
def unbound_texture(registers, unit, count, one):
    """The register of a disabled unit: (0, 0, 0, 1). Measured: unbound textures (combiner captures)."""
    for c in range(4):
        fill_plane(registers, (C.REGISTER_TEXTURE0 + unit) * 4 + c, count, one if c == 3 else int32(0))


@kernel
def convert_ycbcr(registers, plane, count):
    """The register from ``plane`` on: R, G and B of the bytes Y, Cb and Cr that it holds as red, green, blue.

    Measured: BumpMap_UYVY_L and three like it, 1213620 of 1213620 pixels. Assumed: what is below 0 is 0.
    """
    reds, greens, blues = registers[plane], registers[plane + 1], registers[plane + 2]
    for i in range(count):
        y, cb, cr = max(int32(reds[i]), 0), max(int32(greens[i]), 0), max(int32(blues[i]), 0)
        light, c, d = (298 * y - 4864) >> 8, cb - 128, cr - 128
        reds[i] = clamp(light + 2 * ((409 * d + 128) >> 9), 0, 255)
        greens[i] = clamp(light + 1 - 2 * ((100 * c) >> 9) - 2 * ((208 * d) >> 9), 0, 255)
        blues[i] = clamp(light + ((516 * c) >> 8), 0, 255)


@kernel(void(PASS, int64, int64, SEGMENTS, RUNS, SCRATCH))
def sample_unit(p, u, count, segments, runs, scratch):
    """Texture unit ``u`` of a batch into its register: coordinates, texture shader stage, filter."""
    separate_function()
    draw, triangles = p.state.draw, p.triangles
    coordinates, units = p.vertices.coordinates, p.textures.units
    texels, levels = p.textures.texels[u], p.textures.levels[u]
    floats, ints, packed, registers = scratch.floats, scratch.ints, scratch.packed, scratch.registers
    row = units[u]
    if not row[R.ENABLED]:
        return
    if row[R.OPERATION]:
        maximum = int32(draw[R.DEPTH_MAX])
        if not shader_stage(u, units, segments, triangles, coordinates, count, scratch, maximum):
            return
        if row[R.TARGET] == C.TARGET_3D:
            copy_column(floats, R.EXTRA, R.P, count)
    else:
        iterate_coordinate(segments, triangles, coordinates, u, 0, floats, R.S)
        iterate_coordinate(segments, triangles, coordinates, u, 1, floats, R.T)
        if row[R.TARGET] == C.TARGET_3D:
            iterate_coordinate(segments, triangles, coordinates, u, 2, floats, R.P)
        if row[R.TARGET] == C.TARGET_CUBE_MAP:
            iterate_coordinate(segments, triangles, coordinates, u, 2, floats, R.EXTRA)
        elif row[R.PROJECTIVE]:
            iterate_coordinate(segments, triangles, coordinates, u, 3, floats, R.EXTRA)
            divide_by_q(floats, R.S, count)
            divide_by_q(floats, R.T, count)
            if row[R.TARGET] == C.TARGET_3D:
                divide_by_q(floats, R.P, count)
    if row[R.TARGET] == C.TARGET_CUBE_MAP:
        if row[R.OPERATION] == C.OPERATION_DOT_PRODUCT_TEXTURE_3D:
            flat_face(floats, count, ints)
        else:
            cube_faces(floats, count, ints)
    elif row[R.OPERATION] in C.OPERATIONS_OF_DIRECTIONS:
        face_planes(floats, count)
    if row[R.COMPARE]:
        divided = row[R.PROJECTIVE] and not row[R.OPERATION]
        if row[R.COMPARE] == C.COMPARE_MODE_ZERO_TO_TEXTURE:
            fill_column(floats, R.COORDINATE0, 0.0, count)
        else:
            iterate_coordinate(segments, triangles, coordinates, u, 2, floats, R.COORDINATE0)
        shadow_reference(
            floats, R.COORDINATE0, divided, count, float_of(row[R.COORDINATE_DEPTH]),
            row[R.DEPTH_TEXEL_FORMAT], int32(row[R.DEPTH_TEXEL_MAX]), ints,
        )  # fmt: skip
    if row[R.ROUGHNESS]:
        if row[R.OPERATION] in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
            for k in range(4):
                iterate_coordinate(
                    segments, triangles, coordinates, u - 1 + k // 2, k % 2, floats, R.COORDINATE0 + k
                )
        rough_footprints(p, u, runs, scratch)
        if row[R.PROBES] > 1:
            assemble_probes(texels, levels, row, count, floats, ints, packed)
        else:
            filter_unit(texels, levels, row, count, floats, ints, packed)
    elif row[R.ANISOTROPY] or row[R.PROBES] > 1:
        footprints(p, u, runs, scratch)
        if row[R.PROBES] > 1:
            assemble_probes(texels, levels, row, count, floats, ints, packed)
        else:
            filter_along(texels, levels, row, count, floats, ints, packed)
    else:
        if row[R.MIPMAP] != C.MIPMAP_NONE or row[R.MAG_LINEAR] != row[R.MIN_LINEAR]:
            level_of_detail(p, u, runs, scratch)
        filter_unit(texels, levels, row, count, floats, ints, packed)
    unpack_unit(row, count, packed, registers, (C.REGISTER_TEXTURE0 + u) * 4, int32(draw[R.BITS]))
    if draw[R.TEXTURE_SHADER]:
        copy_texel(packed, R.TEXEL_0, R.STAGE0 + u, uint32(row[R.SIGNED]), count)
        if row[R.OPERATION] in C.OPERATIONS_WITH_SCALE:  # of the register alone: later stages read the texel
            scale, bias = float_of(row[R.OFFSET_SCALE]), float_of(row[R.OFFSET_BIAS])
            largest = float_of(row[R.OFFSET_LARGEST])
            scale_texel(packed, R.STAGE0 + row[R.PREVIOUS], count, scale, bias, largest)
            unpack(packed, R.TEXEL_0, count, registers, (C.REGISTER_TEXTURE0 + u) * 4)
    if row[R.COLORLESS]:
        for c in range(4):
            fill_plane(registers, (C.REGISTER_TEXTURE0 + u) * 4 + c, count, int32(0))
    if draw[R.YCBCR]:  # of the register alone: other stages read the texel
        convert_ycbcr(registers, (C.REGISTER_TEXTURE0 + u) * 4, count)

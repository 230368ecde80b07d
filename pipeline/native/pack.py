"""Turn validated state into the rows that kernels read (``raster/rows.py``). Nothing else builds those rows.

What is disabled packs to zero and what cannot matter is not asked for, so two states that cannot differ in
their result give equal rows, and kernels do no work whose result nobody reads.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    ColorWeights,
    CombinerBias,
    ComparisonFunction,
    DepthFormat,
    Face,
    FogArithmetic,
    FogMode,
    FrontFace,
    InternalFormat,
    LineRasterization,
    LogicOperation,
    MagnificationThreshold,
    Mapping,
    MuxSelect,
    ProductRounding,
    Register,
    ShadeModel,
    StencilOperation,
    TextureCompareMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
)
from fixedpipe.pipeline.framebuffers.framebuffer import SURFACE_WORDS, to_byte
from fixedpipe.pipeline.programs.combiner_rules import WITH_FOG, combiner_program
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.programs.texture_shader_rules import (
    CONVENTIONAL,
    DISCARDING,
    WITHOUT_TEXTURE,
    shader_stages,
)
from fixedpipe.pipeline.state import CombinerInput, PassState
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    DEPTH_TEXELS,
    KEPT,
    depth_texture_mode,
    register_components,
)
from fixedpipe.pipeline.vertices.fog import table
from fixedpipe.pipeline.vertices.strokes import whole_size
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.primitives.vertices import single_depths


class PackedState(NamedTuple):
    """The rows of one pass: see ``raster/rows.py`` for their layout."""

    draw: np.ndarray
    draw_float: np.ndarray
    program: np.ndarray
    final: np.ndarray
    constants: np.ndarray
    arithmetic: np.ndarray
    factors: np.ndarray
    units: np.ndarray
    fog_thresholds: np.ndarray
    depths: np.ndarray  # float64 [n]: every vertex's depth in depth units, a single
    reads: tuple  # of each unit that reads a texture: its number, the texture's name, the bits inverted
    area: int  # pixels of the scissor box
    derived: dict  # what others make of these rows, which is kept with them


# The mappings as min(max(x, low) * factor + addend, 255); the addends of the EXPAND pair depend on
# expand_half. Source: NV_register_combiners table 4; Inferred: the halves (docs/numbers.md, section 8).
def _mapping(mapping, expand_half):
    one = 256 if expand_half == 128 else 255
    return {
        Mapping.UNSIGNED_IDENTITY: (0, 1, 0),
        Mapping.UNSIGNED_INVERT: (0, -1, 255),
        Mapping.EXPAND_NORMAL: (0, 2, -one),
        Mapping.EXPAND_NEGATE: (0, -2, one),
        Mapping.HALF_BIAS_NORMAL: (0, 1, -128),
        Mapping.HALF_BIAS_NEGATE: (0, -1, 128),
        Mapping.SIGNED_IDENTITY: (-256, 1, 0),
        Mapping.SIGNED_NEGATE: (-256, -1, 0),
    }[mapping]


_ZERO_MAPPINGS = frozenset({Mapping.UNSIGNED_IDENTITY, Mapping.SIGNED_IDENTITY, Mapping.SIGNED_NEGATE})


def _is_zero(variable):
    return variable.register == Register.ZERO and variable.mapping in _ZERO_MAPPINGS


def _normalized(portion):
    """The same portion with its sum written as AB where CD is zero: equal values, half the work."""
    plain = (
        not portion.mux_sum
        and portion.cd_output == Register.DISCARD
        and portion.ab_output == Register.DISCARD
    )
    if plain and (_is_zero(portion.c) or _is_zero(portion.d)):
        return replace(portion, ab_output=portion.sum_output, sum_output=Register.DISCARD)
    return portion


def _blue_to_alpha(portion):
    """For the AB and the CD output: whether its blue goes to its register's alpha."""
    return [
        portion.ab_blue_to_alpha and portion.ab_output != Register.DISCARD,
        portion.cd_blue_to_alpha and portion.cd_output != Register.DISCARD,
    ]


def _pack_portion(portion, alpha, expand_half, mux_select):
    blue = [0, 0] if alpha else _blue_to_alpha(portion)
    portion, row = _normalized(portion), []
    for variable in (portion.a, portion.b, portion.c, portion.d):
        row += [variable.register, variable.usage, *_mapping(variable.mapping, expand_half)]
    outputs = [portion.ab_output, portion.cd_output, portion.sum_output]
    row += [-1 if register == Register.DISCARD else int(register) for register in outputs]
    row += [0, 0] if alpha else [portion.ab_dot_product, portion.cd_dot_product]
    bias = -128 if portion.bias == CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0
    mux = (1 if mux_select == MuxSelect.LSB else 128) if portion.mux_sum else 0
    return [*row, mux, bias, portion.scale, *blue]


def _color_bytes(color):
    return [to_byte(component) for component in color]


def _registers_read(program):
    """Registers that some input of the program names, with what the pseudo-registers stand for."""
    inputs = []
    for stage in program.general:
        for portion in (stage.rgb, stage.alpha):
            if any(r != Register.DISCARD for r in (portion.ab_output, portion.cd_output, portion.sum_output)):
                inputs += [portion.a, portion.b, portion.c, portion.d]
            if portion.mux_sum and portion.sum_output != Register.DISCARD:
                inputs.append(CombinerInput(Register.SPARE0))  # its alpha selects
    final = program.final
    inputs += [final.a, final.b, final.c, final.d, final.g]
    used = {i.register for i in inputs}
    if Register.E_TIMES_F in used:
        used |= {final.e.register, final.f.register}
    if Register.SPARE0_PLUS_SECONDARY_COLOR in used:
        used |= {Register.SPARE0, Register.SECONDARY_COLOR}
    return used


def _discards(state):
    """Whether a texture shader stage may discard fragments, or change their depth."""
    stages = state.texture_shader or ()
    return any(stage.operation in DISCARDING for stage in stages[: len(state.texture_units)])


def _pack_combiners(state, profile, textures, draw):
    program = combiner_program(state, profile, textures)
    if program is None and _discards(state):
        program = WITH_FOG  # the primary colour, too, but texture shader stages run before it
    if program is None:
        draw[R.DIRECT] = 1
        zero = np.zeros
        return (
            zero((0, 2, R.PORTION_SIZE), np.int32),
            zero((7, R.FINAL_SIZE), np.int32),
            zero((1, 8), np.int16),
            set(),
        )
    half, select = profile.expand_half, program.mux_select
    stages = [
        [_pack_portion(stage.rgb, False, half, select), _pack_portion(stage.alpha, True, half, select)]
        for stage in program.general
    ]
    final = program.final
    inputs = (final.a, final.b, final.c, final.d, final.e, final.f, final.g)
    packed_final = [[i.register, i.usage, i.mapping == Mapping.UNSIGNED_INVERT] for i in inputs]
    own = [_color_bytes(program.constant_color0), _color_bytes(program.constant_color1)]
    constants = [
        [
            *(own[0] if stage.constant_color0 is None else _color_bytes(stage.constant_color0)),
            *(own[1] if stage.constant_color1 is None else _color_bytes(stage.constant_color1)),
        ]
        for stage in program.general
    ]
    constants.append([*own[0], *own[1]])  # the final combiner's
    used = _registers_read(program)
    draw[R.STAGES] = len(stages)
    for on, bit in (
        (program.color_sum_clamp, C.COLOR_SUM_CLAMP),
        (program.invert_spare0, C.COLOR_SUM_INVERT_SPARE0),
        (program.invert_secondary_color, C.COLOR_SUM_INVERT_SECONDARY),
    ):
        draw[R.COLOR_SUM] |= bit if on else 0
    draw[R.USES_E_TIMES_F] = Register.E_TIMES_F in used
    draw[R.USES_SPARE0_PLUS_SECONDARY] = Register.SPARE0_PLUS_SECONDARY_COLOR in used
    written = {
        register
        for stage in program.general
        for portion in (stage.rgb, stage.alpha)
        for register in (portion.ab_output, portion.cd_output, portion.sum_output)
    }
    draw[R.WRITES_TEXTURE] = any(Register.TEXTURE0 <= register <= Register.TEXTURE3 for register in written)
    draw[R.STAGE_CONSTANTS] = any(row != constants[0] for row in constants)
    return (
        np.array(stages, np.int32).reshape(len(stages), 2, R.PORTION_SIZE),
        np.array(packed_final, np.int32),
        np.array(constants, np.int16),
        used,
    )


_NO_FOG = np.zeros(255, np.float64)


def _pack_fog(state, profile, used, draw):
    """Fog's entries; returns its thresholds or table, or zeros."""
    if Register.FOG not in used or state.fog is None:
        return _NO_FOG
    draw[R.FOG_RED : R.FOG_BLUE + 1] = _color_bytes(state.fog.color)[:3]
    if profile.fog_arithmetic == FogArithmetic.TABLE:
        draw[R.FOG_ENABLED] = C.FOG_BY_TABLE
        return table(state.fog.mode).copy()  # kernels take writable arrays
    draw[R.FOG_ENABLED] = C.FOG_BY_THRESHOLDS
    draw[R.FOG_RISING] = state.fog.mode == FogMode.LINEAR and state.fog.start > state.fog.end
    return fog_thresholds(state.fog).copy()


def _pack_stencil_operation(operation, reference):
    return {
        StencilOperation.KEEP: (255, 0, 0, 0, 255),
        StencilOperation.ZERO: (0, 0, 0, 0, 255),
        StencilOperation.REPLACE: (0, reference, 0, 0, 255),
        StencilOperation.INCR: (255, 0, 1, 0, 255),
        StencilOperation.DECR: (255, 0, -1, 0, 255),
        StencilOperation.INVERT: (255, 255, 0, 0, 255),
        StencilOperation.INCR_WRAP: (255, 0, 1, -1, 256),
        StencilOperation.DECR_WRAP: (255, 0, -1, -1, 256),
    }[operation]


# The depth of a format's largest word.
FARTHEST = {
    DepthFormat.FIXED_16: 65535.0,
    DepthFormat.FIXED_23: 8388607.0,
    DepthFormat.FIXED_24: 16777215.0,
    DepthFormat.FLOAT_16: 511.9375,
    DepthFormat.FLOAT_24: (2.0 - 2.0**-16) * 2.0**127,
}
DEPTH_ROWS = {  # code, largest word
    DepthFormat.FIXED_16: (C.DEPTH_FIXED, 0xFFFF),
    DepthFormat.FIXED_23: (C.DEPTH_FIXED, 0x7FFFFF),
    DepthFormat.FIXED_24: (C.DEPTH_FIXED, 0xFFFFFF),
    DepthFormat.FLOAT_16: (C.DEPTH_FLOAT_16, 0xFFFF),
    DepthFormat.FLOAT_24: (C.DEPTH_FLOAT_24, 0xFEFFFF),
}


def _pack_depth(state, framebuffer, draw, draw_float):
    depth_format, test, polygon = framebuffer.depth_format, state.depth_test, state.polygon
    draw[R.DEPTH_FORMAT], draw[R.DEPTH_MAX] = DEPTH_ROWS[depth_format]
    draw_float[R.DEPTH_HIGH] = FARTHEST[depth_format]
    limits = state.depth_clamp
    if limits is not None:
        draw_float[R.DEPTH_LOW] = limits.minimum
        if limits.maximum is not None:
            draw_float[R.DEPTH_HIGH] = limits.maximum
        draw[R.DEPTH_CULL] = limits.cull
    tests = test is not None and (test.function != ComparisonFunction.ALWAYS or test.write)
    if not (tests or draw[R.DEPTH_CULL]):
        return
    draw[R.NEEDS_DEPTH] = 1
    draw[R.DEPTH_FUNCTION] = test.function if tests else ComparisonFunction.ALWAYS
    draw[R.DEPTH_WRITE] = tests and test.write
    draw[R.W_BUFFERING] = state.w_buffering
    if polygon.offset_factor or polygon.offset_units:
        draw[R.POLYGON_OFFSET] = polygon.offset_fill
        draw[R.OFFSET_LINE], draw[R.OFFSET_POINT] = polygon.offset_line, polygon.offset_point
        draw_float[R.OFFSET_FACTOR] = polygon.offset_factor
        draw_float[R.OFFSET_UNITS] = polygon.offset_units


def _single(depths, scale=1.0):
    """Depths times ``scale`` as the chip has them: single precision, nothing between 0 and the least normal
    number.

    Measured: vertices below 2**-126 have depth 0 (DepthFmt_z24 FZy captures); Assumed: to nearest.
    """
    single = np.empty(len(depths))
    single_depths(depths, scale, single)
    return single


def depth_units(state, framebuffer, primitives):
    """Every vertex's depth in depth units: clip w, z in these units, or window z, which a fixed format's
    farthest scales. Source: NV_depth_buffer_float (floats hold window z itself).
    """
    with np.errstate(all="ignore"):  # what overflows is limited; what is no number becomes one
        if state.w_buffering:
            return _single(1.0 / primitives.inverse_w)
        is_float = framebuffer.depth_format < 0
        if is_float or state.vertex.depth_units:
            return _single(primitives.z)
        return _single(primitives.z, FARTHEST[framebuffer.depth_format])


def _pack_tests(state, framebuffer, draw, draw_float):
    if state.alpha_test is not None and state.alpha_test.function != ComparisonFunction.ALWAYS:
        draw[R.ALPHA_TEST] = 1
        draw[R.ALPHA_FUNCTION] = state.alpha_test.function
        draw[R.ALPHA_REFERENCE] = to_byte(state.alpha_test.reference)
    stencil = state.stencil_test
    if stencil is not None:
        reference = min(max(stencil.reference, 0), 255)
        draw[R.STENCIL_TEST] = 1
        draw[R.STENCIL_FUNCTION] = stencil.function
        draw[R.STENCIL_REFERENCE] = reference
        draw[R.STENCIL_MASK] = int(stencil.mask)
        draw[R.STENCIL_WRITE_MASK] = int(stencil.write_mask)
        for at, operation in (
            (R.STENCIL_FAIL, stencil.fail),
            (R.STENCIL_DEPTH_FAIL, stencil.depth_fail),
            (R.STENCIL_DEPTH_PASS, stencil.depth_pass),
        ):
            draw[at : at + R.STENCIL_OPERATION_SIZE] = _pack_stencil_operation(operation, reference)
    _pack_depth(state, framebuffer, draw, draw_float)


# A blend factor's terms: masks of S, D, As, Ad and the saturate term, whether it is the constant, one minus.
_FACTOR_TERMS = {
    BlendFactor.ZERO: ((0, 0, 0, 0, 0), None, 0),
    BlendFactor.ONE: ((0, 0, 0, 0, 0), None, 255),
    BlendFactor.SRC_COLOR: ((255, 0, 0, 0, 0), None, 0),
    BlendFactor.ONE_MINUS_SRC_COLOR: ((255, 0, 0, 0, 0), None, 255),
    BlendFactor.DST_COLOR: ((0, 255, 0, 0, 0), None, 0),
    BlendFactor.ONE_MINUS_DST_COLOR: ((0, 255, 0, 0, 0), None, 255),
    BlendFactor.SRC_ALPHA: ((0, 0, 255, 0, 0), None, 0),
    BlendFactor.ONE_MINUS_SRC_ALPHA: ((0, 0, 255, 0, 0), None, 255),
    BlendFactor.DST_ALPHA: ((0, 0, 0, 255, 0), None, 0),
    BlendFactor.ONE_MINUS_DST_ALPHA: ((0, 0, 0, 255, 0), None, 255),
    BlendFactor.SRC_ALPHA_SATURATE: ((0, 0, 0, 0, 255), None, 0),
    BlendFactor.CONSTANT_COLOR: ((0, 0, 0, 0, 0), "color", 0),
    BlendFactor.ONE_MINUS_CONSTANT_COLOR: ((0, 0, 0, 0, 0), "color", 255),
    BlendFactor.CONSTANT_ALPHA: ((0, 0, 0, 0, 0), "alpha", 0),
    BlendFactor.ONE_MINUS_CONSTANT_ALPHA: ((0, 0, 0, 0, 0), "alpha", 255),
}


def _pack_factor(factor, color):
    masks, constant, xor = _FACTOR_TERMS[factor]
    row = []
    for channel in range(4):
        term = 0 if constant is None else color[channel if constant == "color" else 3]
        row += [*masks, term, xor]
    return row


def _pack_writing(state, framebuffer, draw):
    factors = np.zeros((2, 4 * R.FACTOR_SIZE), np.int32)
    mask = state.color_mask
    for channel, on in enumerate((mask.red, mask.green, mask.blue, mask.alpha)):
        draw[R.COLOR_MASK] |= (0xFF if on else 0) << (8 * channel)
    draw[R.SURFACE] = framebuffer.color_format != ColorFormat.A8R8G8B8
    draw[R.SURFACE_KEEP], draw[R.SURFACE_PAD], draw[R.SURFACE_ALPHA] = SURFACE_WORDS[framebuffer.color_format]
    if state.logic_op is not None:
        if state.logic_op != LogicOperation.COPY:
            draw[R.BLEND], draw[R.LOGIC_OPERATION] = C.BLEND_LOGIC, state.logic_op
        return factors
    blending = state.blending
    if blending is None:
        return factors
    source, destination, equation = blending.source, blending.destination, blending.equation
    if equation == BlendEquation.FUNC_ADD and source == BlendFactor.ONE:
        if destination == BlendFactor.ZERO:
            return factors
        if destination == BlendFactor.ONE and not draw[R.SURFACE]:
            draw[R.BLEND] = C.BLEND_ADD
            return factors
    draw[R.BLEND], draw[R.BLEND_EQUATION] = C.BLEND_GENERAL, equation
    if equation in (BlendEquation.FUNC_ADD_SIGNED, BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED):
        draw[R.SURFACE] = 1
    color = _color_bytes(blending.color)
    factors[0], factors[1] = _pack_factor(source, color), _pack_factor(destination, color)
    return factors


def border_texel(color, internal_format):
    """The packed register bytes of a border colour: through the texture's base format."""
    rgba = np.array(_color_bytes(color), np.uint8)
    r, g, b, a = register_components(
        rgba[list(KEPT[BASE_FORMAT[internal_format]])], BASE_FORMAT[internal_format], 255
    )
    return int(r) | int(g) << 8 | int(b) << 16 | int(a) << 24


def signed_bits(signed):
    """SignedComponents as the bits that tell s + 128 from s in a packed texel."""
    flags = (signed.red, signed.green, signed.blue, signed.alpha)
    return sum(0x80 << (8 * channel) for channel, flag in enumerate(flags) if flag)


def _pattern(value):
    """The bit pattern of a float64."""
    return np.float64(value).view(np.int64)


def _pack_shader_stage(stage, target, profile, maximum, row):
    foreign = stage.operation == TextureShaderOperation.TEXTURE_CUBE_MAP
    foreign &= target != TextureTarget.TEXTURE_CUBE_MAP
    if stage.operation not in CONVENTIONAL or foreign:
        row[R.OPERATION] = stage.operation
    row[R.PREVIOUS], row[R.MAPPING] = stage.previous_texture_input, stage.dot_product_mapping
    row[R.CULL_MODES] = sum(int(mode) << k for k, mode in enumerate(stage.cull_modes))
    row[R.OFFSET_MATRIX : R.OFFSET_MATRIX + 4] = [_pattern(a) for a in stage.offset_texture_matrix]
    row[R.OFFSET_SCALE], row[R.OFFSET_BIAS] = (
        _pattern(stage.offset_texture_scale),
        _pattern(stage.offset_texture_bias),
    )
    row[R.CONSTANT_EYE : R.CONSTANT_EYE + 3] = [_pattern(e) for e in stage.constant_eye]
    row[R.COORDINATE_DEPTH] = _pattern(1.0 if profile.depth_units_in_coordinates else maximum)


def _pack_comparison(sampler, internal_format, profile, row):
    """A depth texture's entries. Its border is refused (``fixedpipe.pipeline.validation``)."""
    row[R.COMPARE], row[R.COMPARE_FUNCTION] = sampler.compare_mode, sampler.compare_function
    base, failed = depth_texture_mode(sampler, profile), to_byte(sampler.compare_fail_value)
    for at, byte in ((R.COMPARE_HELD, 255), (R.COMPARE_FAILED, failed)):
        texel = register_components(np.array([byte], np.uint8), base, np.uint8(255))
        row[at] = int.from_bytes(texel.tobytes(), "little")
    row[R.DEPTH_TEXEL_MAX], row[R.DEPTH_TEXEL_MANTISSA] = DEPTH_TEXELS[internal_format]
    units = profile.depth_units_in_coordinates
    row[R.COORDINATE_DEPTH] = _pattern(1.0 if units else row[R.DEPTH_TEXEL_MAX])


# Which levels a minification filter reads (section 3.8.5).
_MIPMAPS = {
    TextureFilter.NEAREST: C.MIPMAP_NONE,
    TextureFilter.LINEAR: C.MIPMAP_NONE,
    TextureFilter.NEAREST_MIPMAP_NEAREST: C.MIPMAP_NEAREST,
    TextureFilter.LINEAR_MIPMAP_NEAREST: C.MIPMAP_NEAREST,
    TextureFilter.NEAREST_MIPMAP_LINEAR: C.MIPMAP_LINEAR,
    TextureFilter.LINEAR_MIPMAP_LINEAR: C.MIPMAP_LINEAR,
}


def _pack_units(state, profile, textures, used, draw):
    """The units' rows, and the numbers of those whose coordinates are divided by q where it varies."""
    units, divided = np.zeros((max(len(state.texture_units), 1), R.UNIT_SIZE), np.int64), []
    stages = shader_stages(state)
    for i, unit in enumerate(state.texture_units):
        # SPARE0's alpha begins as texture 0's alpha.
        needed = Register.TEXTURE0 + i in used or (i == 0 and Register.SPARE0 in used)
        stage = None if stages is None else stages[i]
        if stage is not None:
            needed = stage.operation != TextureShaderOperation.NONE  # a later stage may need it
        if unit is None or not needed:
            continue
        if stage is not None:
            draw[R.TEXTURE_SHADER] = 1
            draw[R.DISCARDS] |= stage.operation in DISCARDING
            target = None if unit.texture is None else textures[unit.texture].target
            _pack_shader_stage(stage, target, profile, draw[R.DEPTH_MAX], units[i])
            if stage.operation in WITHOUT_TEXTURE:
                units[i, R.ENABLED] = 1
                continue
        texture, sampler = textures[unit.texture], unit.sampler
        mag_linear = sampler.mag_filter == TextureFilter.LINEAR
        minification = sampler.min_filter
        levels = min(len(texture.levels), sampler.max_level + 1)
        mipmap = _MIPMAPS[minification] if levels > 1 else C.MIPMAP_NONE
        linear = minification in (
            TextureFilter.LINEAR,
            TextureFilter.LINEAR_MIPMAP_NEAREST,
            TextureFilter.LINEAR_MIPMAP_LINEAR,
        )
        row = units[i]
        row[R.ENABLED], row[R.TARGET], row[R.LEVELS] = 1, texture.target, levels
        row[R.WRAP_S], row[R.WRAP_T] = sampler.wrap_s, sampler.wrap_t
        if texture.target == TextureTarget.TEXTURE_3D:
            row[R.WRAP_R], row[R.LAYERS] = sampler.wrap_r, texture.depth
        row[R.MAG_LINEAR], row[R.MIN_LINEAR], row[R.MIPMAP] = mag_linear, linear, mipmap
        row[R.LOD_BIAS] = int(256 * float(unit.lod_bias))  # Assumed: truncation (docs/numbers.md, section 7)
        row[R.MIN_LOD], row[R.MAX_LOD] = (int(256 * float(lod)) for lod in (sampler.min_lod, sampler.max_lod))
        if sampler.max_anisotropy > 1:
            row[R.ANISOTROPY] = np.float64(sampler.max_anisotropy).view(np.int64)
        if sampler.max_probes > 1:
            row[R.PROBES] = sampler.max_probes
        if (
            profile.magnification_threshold == MagnificationThreshold.OPENGL_C
            and mag_linear
            and minification in (TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST_MIPMAP_LINEAR)
        ):
            row[R.THRESHOLD] = 128
        row[R.HILO] = texture.internal_format == InternalFormat.HILO16
        row[R.SIGNED] = signed_bits(sampler.signed_components)
        if row[R.HILO]:  # words have the signs of their high bytes (Measured: BumpEnvLum_R16B16)
            row[R.SIGNED] &= 0x80008000
        if sampler.compare_mode != TextureCompareMode.NONE:
            _pack_comparison(sampler, texture.internal_format, profile, row)
        else:
            row[R.BORDER] = border_texel(sampler.border_color, texture.internal_format) ^ int(row[R.SIGNED])
        # A cube map reads a direction as it is, and what a stage makes is not divided either.
        if texture.target != TextureTarget.TEXTURE_CUBE_MAP and not row[R.OPERATION]:
            divided.append(i)
    return units, divided


def _pack_facing(state, draw):
    """Culling; returns the sign of a polygon's area that is its back."""
    polygon = state.polygon
    # With y down, a positive area is clockwise as seen with y up.
    front = -1 if polygon.front_face == FrontFace.CCW else 1
    culled = polygon.cull_face
    draw[R.CULL_POSITIVE] = culled == Face.FRONT_AND_BACK or culled == (
        Face.FRONT if front > 0 else Face.BACK
    )
    draw[R.CULL_NEGATIVE] = culled == Face.FRONT_AND_BACK or culled == (
        Face.FRONT if front < 0 else Face.BACK
    )
    return -front


def eighths(size):
    """A line's width or a point's size in 1/8 pixel, as the chip is given it. Assumed: truncated."""
    return int(8.0 * size)


def _pack_lines(line, profile, draw):
    steps = line.rasterization == LineRasterization.STEPS
    draw[R.LINE_STEPS] = C.LINE_IN_STEPS if steps else C.LINE_AS_RECTANGLE
    draw[R.LINE_WIDTH] = eighths(line.width)
    if profile.diamond_exit_lines:
        draw[R.LINE_STEPS] = C.LINE_IN_DIAMONDS
        draw[R.LINE_WIDTH] = R.PIXEL_WIDE * whole_size(line.width)
    if line.stipple is not None:
        draw[R.LINE_FACTOR], draw[R.LINE_PATTERN] = line.stipple


def _pack_holes(state, framebuffer, draw):
    """What stipple and window clip leave, in device pixels."""
    height = framebuffer.height
    if state.polygon.stipple is not None:
        draw[R.STIPPLE] = 1
        words = np.frombuffer(state.polygon.stipple, ">u4")
        draw[R.STIPPLE_WORD : R.STIPPLE_WORD + 32] = words[(height - 1 - np.arange(32)) % 32]
    clip = state.window_clip
    if clip is not None:
        draw[R.WINDOW_CLIP] = C.WINDOW_CLIP_OUTSIDE if clip.exclusive else C.WINDOW_CLIP_INSIDE
        draw[R.CLIP_RECTANGLES] = len(clip.rectangles)
        for k, box in enumerate(clip.rectangles):
            draw[R.CLIP_RECTANGLE + 4 * k :][:4] = _device_edges(box, height)


def _device_edges(box, height):
    """A window rectangle's left, top, right and bottom in device pixels."""
    x, y, across, up = int(box.x), int(box.y), int(box.width), int(box.height)
    return x, height - y - up, x + across, height - y


def scissor_box(state, framebuffer):
    """(x0, y0, x1, y1) in device pixels, half open: the screen cut by the scissor box."""
    width, height = framebuffer.width, framebuffer.height
    box = state.scissor
    if box is None:
        return 0, 0, width, height
    left, top, right, bottom = _device_edges(box, height)
    x0, x1 = max(left, 0), min(right, width)
    y0, y1 = max(top, 0), min(bottom, height)
    return x0, y0, max(x0, x1), max(y0, y1)


def pack(state: PassState, profile, framebuffer, textures, primitives):
    """Rows of a validated pass. ``textures`` maps names to Texture; ``primitives`` say what varies.

    Rows are shared by all that pack the same: they are not written to.
    """
    rows = _rows_of(state, profile, framebuffer, textures)
    flat = C.COLORS_SMOOTH
    if rows.reads_color and (rows.flat or primitives.constant_color):
        flat = C.COLORS_FLAT if rows.flat else C.COLORS_EQUAL
    varies = (
        primitives.two_side,
        len(primitives.strokes) > 0,
        flat,
        *[primitives.projective[unit] for unit in rows.divided],
    )
    draw, units, derived = rows.varied.get(varies) or rows.vary(varies)
    depths = depth_units(state, framebuffer, primitives) if rows.needs_depth else primitives.z
    shared = rows.shared
    return PackedState(
        draw, rows.draw_float, *shared, units, rows.fog_thresholds, depths, rows.reads, rows.area, derived
    )


def _rows_of(state, profile, framebuffer, textures):
    """The rows of a pass as far as no vertex matters, kept for the next time.

    Found by identity, for equal states may differ in bits (0.0 and -0.0); what is kept holds state and
    profile, so that no other object has theirs.
    """
    height, width, _ = framebuffer.color.shape
    key = (
        id(state),
        id(profile),
        width,
        height,
        framebuffer.depth_format,
        framebuffer.color_format,
        *[_kind(textures, unit) for unit in state.texture_units],
    )
    rows = _rows.get(key)
    if rows is None:
        if len(_rows) >= _MOST_ROWS:
            _rows.clear()
        rows = _rows[key] = _StateRows(state, profile, framebuffer, textures)
    return rows


_rows, _MOST_ROWS = {}, 1024


def _kind(textures, unit):
    """What rows know of a unit's texture."""
    if unit is None or unit.texture is None:
        return None
    texture = textures[unit.texture]
    return texture.target, texture.internal_format, len(texture.levels), texture.depth


class _StateRows:
    """The rows of a pass as far as no vertex matters, and those that do for each way in which they vary."""

    def __init__(self, state, profile, framebuffer, textures):
        self.held = state, profile
        draw = np.zeros(R.DRAW_SIZE, np.int64)
        self.draw_float = np.zeros(R.DRAW_FLOAT_SIZE, np.float64)
        draw[R.X0], draw[R.Y0], draw[R.X1], draw[R.Y1] = scissor_box(state, framebuffer)
        self.back_sign = _pack_facing(state, draw)
        _pack_lines(state.line, profile, draw)
        _pack_holes(state, framebuffer, draw)
        _pack_tests(state, framebuffer, draw, self.draw_float)
        factors = _pack_writing(state, framebuffer, draw)
        draw[R.NEEDS_COLOR] = draw[R.COLOR_MASK] != 0 or draw[R.ALPHA_TEST]
        program, final, constants, used = _pack_combiners(state, profile, textures, draw)
        self.units, self.divided = _pack_units(state, profile, textures, used, draw)
        draw[R.NEEDS_COLOR] |= draw[R.DISCARDS]
        draw[R.UNITS] = len(state.texture_units)
        self.fog_thresholds = _pack_fog(state, profile, used, draw)
        draw[R.NEEDS_PRIMARY] = Register.PRIMARY_COLOR in used
        draw[R.NEEDS_SECONDARY] = Register.SECONDARY_COLOR in used
        self.flat = state.polygon.shade_model == ShadeModel.FLAT
        self.reads_color = bool(
            draw[R.NEEDS_COLOR] and (draw[R.DIRECT] or draw[R.NEEDS_PRIMARY] or draw[R.NEEDS_SECONDARY])
        )
        eight_bits = profile.color_weights == ColorWeights.EIGHT_BITS
        self.color_weights = C.WEIGHTS_EIGHT_BITS if eight_bits else C.WEIGHTS_EXACT
        self.textured = bool((self.units[:, R.ENABLED] != 0).any())
        self.needs_depth = bool(draw[R.NEEDS_DEPTH])
        self.area = int((draw[R.X1] - draw[R.X0]) * (draw[R.Y1] - draw[R.Y0]))
        self.reads = tuple(
            (i, unit.texture, int(self.units[i, R.SIGNED]))
            for i, unit in enumerate(state.texture_units)
            if unit is not None and unit.texture is not None and self.units[i, R.ENABLED]
        )
        arithmetic = np.array(
            [
                profile.product_rounding == ProductRounding.PER_PRODUCT,
                profile.round_before_scale,
                profile.clamp_low,
            ],
            np.int32,
        )
        self.draw, self.shared = draw, (program, final, constants, arithmetic, factors)
        self.varied = {}

    def vary(self, varies):
        """(draw, units, what is derived) for primitives that are two-sided, hold strokes, have one colour and
        vary in q, or not.
        """
        two_side, strokes, flat, *projective = varies
        draw, units = self.draw.copy(), self.units.copy()
        draw[R.BACK_SIGN] = self.back_sign if two_side else 0
        draw[R.STROKES], draw[R.FLAT] = strokes, flat
        units[self.divided, R.PROJECTIVE] = projective
        if draw[R.NEEDS_COLOR]:
            iterates = self.reads_color and flat == C.COLORS_SMOOTH
            draw[R.NEEDS_COLOR_WEIGHTS] = self.color_weights if iterates else C.WEIGHTS_NONE
            eight_bits = draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EIGHT_BITS
            draw[R.NEEDS_ITERATION_WEIGHTS] = eight_bits or self.textured
            draw[R.NEEDS_WEIGHTS] = draw[R.FOG_ENABLED]
        self.varied[varies] = made = draw, units, {}
        return made

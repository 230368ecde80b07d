"""The rows of texture units: samplers, texture shader stages and comparisons of depth textures."""

from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.enums import (
    MagnificationThreshold,
    Register,
    TextureCompareMode,
    TextureShaderOperation,
    TextureTarget,
)
from fixedpipe.pipeline.framebuffers.framebuffer import color_codes, to_code
from fixedpipe.pipeline.programs.texture_shader_rules import (
    CONVENTIONAL,
    DISCARDING,
    WITHOUT_TEXTURE,
    shader_stages,
)
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    COLORLESS_FORMATS,
    DEPTH_TEXELS,
    FORMATS_OF_WORDS,
    border_components,
    depth_texture_mode,
    register_components,
    with_signs,
)
from fixedpipe.pipeline.textures.sampled import sampled_texture
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.columns.numbers import fixed, one_of


@lru_cache(1024)
def border_texel(color, internal_format, bits, as_given):
    """The words of a border colour as a packed texel with components of ``bits`` bits.

    ``as_given``: the profile's ``border_color_as_given``.
    """
    one, base = one_of(bits), BASE_FORMAT[internal_format]
    codes = np.array(color_codes(color, one), np.int64)
    r, g, b, a = border_components(codes, base, one, as_given=as_given).tolist()
    if bits == R.BITS_OF_BYTES:
        return r | g << 8 | b << 16 | a << 24, 0
    return r | g << 16, b | a << 16


def signed_bits(signed):
    """SignedComponents as the bits in which s + 128 and s differ in a packed texel."""
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
    row[R.OFFSET_LARGEST] = _pattern(1.0 if profile.texture_shaders.offset_scale_clamped else np.inf)
    row[R.CONSTANT_EYE : R.CONSTANT_EYE + 3] = [_pattern(e) for e in stage.constant_eye]
    row[R.COORDINATE_DEPTH] = _pattern(1.0 if profile.textures.depth_units_in_coordinates else maximum)
    if stage.roughness is not None:
        row[R.ROUGHNESS], row[R.ROUGHNESS_SCALE] = 1 + stage.roughness, _pattern(stage.roughness_scale)


def _pack_comparison(sampler, internal_format, profile, row):
    """Write a depth texture's entries."""
    row[R.COMPARE], row[R.COMPARE_FUNCTION] = sampler.compare_mode, sampler.compare_function
    base, failed = depth_texture_mode(sampler, profile), to_code(sampler.compare_fail_value)
    for at, byte in ((R.COMPARE_HELD, 255), (R.COMPARE_FAILED, failed)):
        texel = register_components(np.array([byte], np.uint8), base, np.uint8(255))
        row[at] = int.from_bytes(texel.tobytes(), "little")
    words = DEPTH_TEXELS[internal_format]
    row[R.DEPTH_TEXEL_FORMAT], row[R.DEPTH_TEXEL_MAX] = words.code, words.largest
    row[R.BORDER] = fixed(sampler.border_color[0], words.largest)
    units = profile.textures.depth_units_in_coordinates
    row[R.COORDINATE_DEPTH] = _pattern(1.0 if units else row[R.DEPTH_TEXEL_MAX])


def pack_units(state, profile, textures, used, draw):
    """The units' rows, and the numbers of the units whose coordinates are divided by a varying q."""
    units, divided = np.zeros((max(len(state.texture_units), 1), R.UNIT_SIZE), np.int64), []
    stages = shader_stages(state)
    for i, unit in enumerate(with_signs(state, textures).texture_units):
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
                units[i, R.ENABLED], units[i, R.TEXEL_BITS] = 1, R.BITS_OF_BYTES
                continue
        texture, sampler = sampled_texture(unit, textures), unit.sampler
        magnification, minification = sampler.mag_filter, sampler.min_filter
        levels = min(len(texture.levels), sampler.max_level - sampler.base_level + 1)
        row = units[i]
        row[R.ENABLED], row[R.TARGET], row[R.LEVELS] = 1, texture.target, levels
        row[R.WRAP_S], row[R.WRAP_T] = sampler.wrap_s, sampler.wrap_t
        if texture.target == TextureTarget.TEXTURE_3D:
            row[R.WRAP_R], row[R.LAYERS] = sampler.wrap_r, texture.depth
        row[R.MAG_LINEAR], row[R.MIN_LINEAR] = magnification.is_linear, minification.is_linear
        row[R.MIPMAP] = minification.mipmap if levels > 1 else C.MIPMAP_NONE
        row[R.LOD_BIAS] = int(256 * float(unit.lod_bias))  # Assumed: truncation (docs/numbers.md, section 7)
        row[R.MIN_LOD], row[R.MAX_LOD] = (int(256 * float(lod)) for lod in (sampler.min_lod, sampler.max_lod))
        if sampler.max_anisotropy > 1:
            row[R.ANISOTROPY] = np.float64(sampler.max_anisotropy).view(np.int64)
        if sampler.max_probes > 1:
            row[R.PROBES], row[R.EXACT_PROBES] = sampler.max_probes, sampler.exact_probes
        if (
            profile.arithmetic.magnification_threshold == MagnificationThreshold.OPENGL_C
            and sampler.magnifies_late
        ):
            row[R.THRESHOLD] = 128
        row[R.TEXEL_BITS] = texture.bits
        row[R.HILO] = texture.internal_format in FORMATS_OF_WORDS
        row[R.COLORLESS] = texture.internal_format in COLORLESS_FORMATS and not profile.textures.hilo_as_color
        row[R.SIGNED] = signed_bits(sampler.signed_components)
        if row[R.HILO]:  # A word has the sign of its high byte. (Measured: BumpEnvLum_R16B16)
            row[R.SIGNED] &= 0x80008000
        if sampler.compare_mode != TextureCompareMode.NONE:
            _pack_comparison(sampler, texture.internal_format, profile, row)
        else:
            as_given = profile.textures.border_color_as_given
            row[R.BORDER : R.BORDER + 2] = border_texel(
                sampler.border_color, texture.internal_format, texture.bits, as_given
            )
            row[R.BORDER] ^= row[R.SIGNED]
        # A cube map reads an undivided direction, and a stage's computed coordinates are not divided either.
        if texture.target != TextureTarget.TEXTURE_CUBE_MAP and not row[R.OPERATION]:
            divided.append(i)
    return units, divided

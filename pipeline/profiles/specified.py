"""What OpenGL 1.2.1 specifies: sets that machines take whole, and evidence that holds of any machine."""

from typing import Any

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    Clamp,
    LightingArithmetic,
    MagnificationThreshold,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.textures.images import COMPONENT_BITS

# Evidence for what a machine lacks because OpenGL does not ask for it, and for the imaging subset.
NOT_CORE = "Source: OpenGL 1.2.1: no part of it"
OF_SUBSET_ALONE = "Source: OpenGL 1.2.1 section 3.6.2: part of the imaging subset alone"
# Section 3.6.5 names GetTexImage under convolution; SGI's Sample Implementation 1.2.1 keeps to section 6.1.4.
UNTOUCHED_QUERIES = "Source: OpenGL 1.2.1 section 6.1.4: no pixel transfer operations"
TRANSFERRED_QUERIES = "Source: EXT_convolution, EXT_texture3D, of images that GetTexImage returns"
OF_SUBSET = "Source: OpenGL 1.2.1 section 3.6.2, the imaging subset"

# Sections 3.8, 3.8.1 (table 3.16, up to eight bits), 3.8.4, 2.10.4, 3.8.9 and 4.1.4.
CORE_TARGETS = frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_3D})
CORE_FORMATS = frozenset(COMPONENT_BITS)
CORE_WRAP_MODES = frozenset({WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE})
CORE_TEXGEN_MODES = frozenset(
    {TexGenMode.NONE, TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR, TexGenMode.SPHERE_MAP}
)
CORE_ENVIRONMENTS = frozenset(
    {
        TextureEnvironmentMode.MODULATE,
        TextureEnvironmentMode.REPLACE,
        TextureEnvironmentMode.DECAL,
        TextureEnvironmentMode.BLEND,
    }
)
CORE_STENCIL_OPERATIONS = frozenset(StencilOperation) - {
    StencilOperation.INCR_WRAP,
    StencilOperation.DECR_WRAP,
}

# Tables 4.1 and 4.2, and what the imaging subset (or EXT_blend_color) adds to both.
CONSTANT_FACTORS = frozenset(
    {
        BlendFactor.CONSTANT_COLOR,
        BlendFactor.ONE_MINUS_CONSTANT_COLOR,
        BlendFactor.CONSTANT_ALPHA,
        BlendFactor.ONE_MINUS_CONSTANT_ALPHA,
    }
)
CORE_SOURCE_FACTORS = (
    frozenset(BlendFactor) - CONSTANT_FACTORS - {BlendFactor.SRC_COLOR, BlendFactor.ONE_MINUS_SRC_COLOR}
)
CORE_DESTINATION_FACTORS = (
    frozenset(BlendFactor)
    - CONSTANT_FACTORS
    - {BlendFactor.DST_COLOR, BlendFactor.ONE_MINUS_DST_COLOR, BlendFactor.SRC_ALPHA_SATURATE}
)

# Section 4.1.6: the imaging subset's, which are also those of EXT_blend_minmax and EXT_blend_subtract.
SUBSET_EQUATIONS = frozenset(
    {
        BlendEquation.FUNC_ADD,
        BlendEquation.FUNC_SUBTRACT,
        BlendEquation.FUNC_REVERSE_SUBTRACT,
        BlendEquation.MIN,
        BlendEquation.MAX,
    }
)

# What OpenGL 1.2.1 says of any machine, by the fields of a profile.
CORE: dict[str, Any] = {
    "max_texture_units": known(1, "Source: OpenGL 1.2.1 section 3.8: one texture unit"),
    "max_cube_map_texture_size": known(0, NOT_CORE),
    "power_of_two_textures": known(True, "Source: OpenGL 1.2.1 section 3.8.1"),
    "texture_targets": known(CORE_TARGETS, "Source: OpenGL 1.2.1 section 3.8"),
    "internal_formats": known(
        CORE_FORMATS, "Source: OpenGL 1.2.1 table 3.16 (requested resolutions are kept)"
    ),
    "texture_borders": known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
    "wrap_modes": known(CORE_WRAP_MODES, "Source: OpenGL 1.2.1 section 3.8.4"),
    "cylinder_wrap": known(False, "Source: no OpenGL extension has it"),
    "signed_components": known(False, NOT_CORE),
    "border_color_as_given": known(False, "Source: OpenGL 1.2.1 section 3.8.5"),
    "hilo_as_color": known(False, NOT_CORE),
    "max_lod_bias": known(0.0, NOT_CORE),
    "max_anisotropy": known(1.0, NOT_CORE),
    "max_probes": known(1, NOT_CORE),
    "exact_probes": known(False, NOT_CORE),
    "texture_color_table": known(False, NOT_CORE),
    "color_key_operations": known(frozenset(), NOT_CORE),
    "evaluate_before_filtering": known(
        False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"
    ),
    "texture_compare_modes": known(frozenset({TextureCompareMode.NONE}), NOT_CORE),
    "shadow_functions": known(frozenset(), NOT_CORE),
    "shadow_ambient": known(False, NOT_CORE),
    "depth_texture_modes": known((), NOT_CORE),
    "depths_as_colors": known(False, NOT_CORE),
    "depth_units_in_coordinates": known(False, NOT_CORE),
    "texture_shader_operations": known(frozenset(), NOT_CORE),
    "dot_product_mappings": known(frozenset(), NOT_CORE),
    "foreign_texture_targets": known(False, NOT_CORE),
    "offset_scale_clamped": known(False, NOT_CORE),
    "roughness_lookups": known(False, NOT_CORE),
    "texture_environment_modes": known(CORE_ENVIRONMENTS, "Source: OpenGL 1.2.1 section 3.8.9"),
    "combine_functions": known(frozenset(), NOT_CORE),
    "texture_environment_crossbar": known(False, NOT_CORE),
    "max_general_combiners": known(0, NOT_CORE),
    "per_stage_constants": known(False, NOT_CORE),
    "combiner_functions": known(frozenset(), NOT_CORE),
    "combiner_lookup": known(False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"),
    "max_lights": known(8, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
    "max_clip_planes": known(6, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
    "max_shininess": known(128.0, "Source: OpenGL 1.2.1 table 2.7"),
    "separate_specular_color": known(True, "Source: OpenGL 1.2.1 section 2.13.1"),
    "texgen_modes": known(CORE_TEXGEN_MODES, "Source: OpenGL 1.2.1 section 2.10.4"),
    "fog_coordinate": known(False, NOT_CORE),
    "point_parameters": known(False, NOT_CORE),
    "composite_matrix": known(False, NOT_CORE),
    "vertex_weighting": known(False, NOT_CORE),
    "line_stipple": known(True, "Source: OpenGL 1.2.1 section 3.4.2"),
    "smoothing_samples": known(
        (), "Source: OpenGL 1.2.1, section 3.2 leaves coverage to the machine; unseen"
    ),
    "point_sprite_units": known(frozenset(), NOT_CORE),
    "perspective_hint": known(False, "Source: OpenGL 1.2.1 section 5.6 (a hint may be ignored)"),
    "spherical_interpolation": known(
        False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"
    ),
    "color_sum": known(False, "Source: OpenGL 1.2.1 section 3.9: lighting's specular term alone"),
    "fog_registers": known(False, NOT_CORE),
    "depth_clamp": known(False, NOT_CORE),
    "w_buffering": known(False, NOT_CORE),
    "max_window_rectangles": known(0, NOT_CORE),
    "stencil_operations": known(CORE_STENCIL_OPERATIONS, "Source: OpenGL 1.2.1 section 4.1.4"),
    "blend_factors_source": known(CORE_SOURCE_FACTORS, "Source: OpenGL 1.2.1 table 4.1"),
    "blend_factors_destination": known(CORE_DESTINATION_FACTORS, "Source: OpenGL 1.2.1 table 4.2"),
    "blend_equations": known(
        frozenset({BlendEquation.FUNC_ADD}),
        "Source: OpenGL 1.2.1 section 4.1.6: others are the imaging subset's",
    ),
    "logic_op": known(True, "Source: OpenGL 1.2.1 section 4.1.8"),
    "samples": known((1,), NOT_CORE),
    "shades_samples": known(True, "Source: OpenGL 1.2.1, section 3: one sample, a pixel's middle"),
    "surface_formats": known(frozenset(), NOT_CORE),
    "shared_depth": known(False, NOT_CORE),
    "transfers_texture_queries": known(False, UNTOUCHED_QUERIES),
    "color_matrix": known(False, OF_SUBSET_ALONE),
    "color_tables": known(False, OF_SUBSET_ALONE),
    "max_color_table_size": known(0, OF_SUBSET_ALONE),
    "convolution": known(False, OF_SUBSET_ALONE),
    "max_convolution_size": known(0, OF_SUBSET_ALONE),
    "histogram": known(False, OF_SUBSET_ALONE),
    "pixel_texture": known(False, NOT_CORE),
    "pixel_texture_sgis": known(False, NOT_CORE),
    "impact_pixel_texture": known(False, NOT_CORE),
    "exact": known(
        False,
        "Source: OpenGL 1.2.1 section 2.1.1: floating-point or fixed-point, here fixed-point colours",
    ),
    "clamps": known(frozenset(Clamp), "Source: OpenGL 1.2.1 sections 2.13.6, 3.8.9, 3.9, 3.10, 4.1.6"),
    "lighting": known(LightingArithmetic.EQUATIONS, "Source: OpenGL 1.2.1 section 2.13.1"),
    "color_mantissa_bits": known(
        53, "Source: OpenGL 1.2.1 section 2.13.9 (rounded to nearest, nothing cut before)"
    ),
    "subpixel_bits": known(4, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
    "diamond_exit_lines": known(True, "Source: OpenGL 1.2.1 section 3.4.1"),
    "magnification_threshold": known(MagnificationThreshold.OPENGL_C, "Source: OpenGL 1.2.1 section 3.8.5"),
    "dithered_s3tc_dxt1": known(False, NOT_CORE),
    "add_signed_scale_by_four": known(False, NOT_CORE),
    "clamps_color_matrix": known(
        False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
    ),
}

# What a machine with the imaging subset has instead.
SUBSET: dict[str, Any] = {
    "blend_factors_source": known(CORE_SOURCE_FACTORS | CONSTANT_FACTORS, OF_SUBSET),
    "blend_factors_destination": known(CORE_DESTINATION_FACTORS | CONSTANT_FACTORS, OF_SUBSET),
    "blend_equations": known(SUBSET_EQUATIONS, OF_SUBSET),
    "color_matrix": known(True, OF_SUBSET),
    "color_tables": known(True, OF_SUBSET),
    "convolution": known(True, OF_SUBSET),
    "histogram": known(True, OF_SUBSET),
}

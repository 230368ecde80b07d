"""SGI's RealityEngine and InfiniteReality: the imaging subset, shadow maps, multisampling, twelve bits.

No picture of one was at hand, nor a manual: what no paper or extension says is Assumed.
"""

from fixedpipe.pipeline.enums import (
    BaseFormat,
    Clamp,
    ColorWeights,
    ComparisonFunction,
    FogArithmetic,
    InternalFormat,
    LightingArithmetic,
    MagnificationThreshold,
    ProductRounding,
    TextureCompareMode,
    WindowOrigin,
    WrapMode,
)
from fixedpipe.pipeline.profiles.known import known
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.sections import (
    Arithmetic,
    Combiners,
    Fragments,
    Framebuffers,
    Pixels,
    Primitives,
    Textures,
    TextureShaders,
    Vertices,
)
from fixedpipe.pipeline.profiles.specified import (
    CONSTANT_FACTORS,
    CORE_DESTINATION_FACTORS,
    CORE_ENVIRONMENTS,
    CORE_FORMATS,
    CORE_SOURCE_FACTORS,
    CORE_STENCIL_OPERATIONS,
    CORE_TARGETS,
    CORE_TEXGEN_MODES,
    CORE_WRAP_MODES,
    NOT_CORE,
    OF_SUBSET,
    SUBSET_EQUATIONS,
    TRANSFERRED_QUERIES,
)
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS

_DRIVER = "Assumed: as on the plain board; a query of an InfiniteReality's driver would settle it"
_SUBSET = "Assumed: as on the imaging board; a query of an InfiniteReality's driver would settle it"
_PICTURE = "Assumed: as on the plain board; a picture of an InfiniteReality would settle it"
_NO_COMBINERS = "Assumed: does not matter; an InfiniteReality has no register combiners"

INFINITE_REALITY = Profile(
    name="SGI InfiniteReality",
    description="SGI RealityEngine, InfiniteReality: shadow maps, multisampling, twelve bits",
    textures=Textures(
        max_texture_units=known(1, "Source: OpenGL 1.2.1 section 3.8: one texture unit"),
        max_texture_size=known(2048, _DRIVER),
        max_cube_map_texture_size=known(0, NOT_CORE),
        max_3d_texture_size=known(256, _DRIVER),
        power_of_two_textures=known(True, "Source: OpenGL 1.2.1 section 3.8.1"),
        texture_targets=known(CORE_TARGETS, "Source: OpenGL 1.2.1 section 3.8"),
        internal_formats=known(
            CORE_FORMATS
            | TWELVE_BIT_FORMATS
            | {InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24},
            "Source: OpenGL 1.2.1 table 3.16, SGIX_depth_texture; twelve bits Assumed",
        ),
        texture_borders=known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
        wrap_modes=known(
            CORE_WRAP_MODES | {WrapMode.CLAMP_TO_BORDER},
            "Assumed: edge and border clamp; an InfiniteReality's driver that lists "
            "SGIS_texture_border_clamp would settle it",
        ),
        cylinder_wrap=known(False, "Source: no OpenGL extension has it"),
        signed_components=known(False, NOT_CORE),
        hilo_as_color=known(False, NOT_CORE),
        max_lod_bias=known(0.0, NOT_CORE),
        max_anisotropy=known(1.0, NOT_CORE),
        max_probes=known(1, NOT_CORE),
        exact_probes=known(False, NOT_CORE),
        texture_color_table=known(
            True, "Assumed: as on the Octane; a driver's list of SGI_texture_color_table would settle it"
        ),
        color_key_operations=known(frozenset(), NOT_CORE),
        evaluate_before_filtering=known(
            False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"
        ),
        texture_compare_modes=known(
            frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE}),
            "Source: SGIX_shadow",
        ),
        shadow_functions=known(
            frozenset({ComparisonFunction.LEQUAL, ComparisonFunction.GEQUAL}),
            "Source: SGIX_shadow (TEXTURE_GEQUAL_R is LEQUAL, TEXTURE_LEQUAL_R GEQUAL)",
        ),
        shadow_ambient=known(True, "Source: SGIX_shadow_ambient"),
        depth_texture_modes=known((BaseFormat.LUMINANCE,), "Source: SGIX_shadow (as if LUMINANCE)"),
        depths_as_colors=known(
            True,
            "Assumed: SGIX_depth_texture names uses of depths beside shadows and leaves them open; a picture "
            "of a depth texture with TEXTURE_COMPARE off, drawn by an InfiniteReality, would settle it",
        ),
        depth_units_in_coordinates=known(
            False, "Inferred: from SGIX_shadow, which compares r with depths in [0, 1]"
        ),
    ),
    texture_shaders=TextureShaders(
        texture_shader_operations=known(frozenset(), NOT_CORE),
        dot_product_mappings=known(frozenset(), NOT_CORE),
        foreign_texture_targets=known(False, NOT_CORE),
        offset_scale_clamped=known(False, NOT_CORE),
        roughness_lookups=known(False, NOT_CORE),
    ),
    combiners=Combiners(
        texture_environment_modes=known(CORE_ENVIRONMENTS, "Source: OpenGL 1.2.1 section 3.8.9"),
        combine_functions=known(frozenset(), NOT_CORE),
        texture_environment_crossbar=known(False, NOT_CORE),
        max_general_combiners=known(0, NOT_CORE),
        per_stage_constants=known(False, NOT_CORE),
        combiner_functions=known(frozenset(), NOT_CORE),
        combiner_lookup=known(False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"),
        blue_to_alpha=known(False, _NO_COMBINERS),
        ycbcr_conversion=known(False, _NO_COMBINERS),
        final_alpha_from_blue=known(False, _NO_COMBINERS),
        combiner_flags=known(False, _NO_COMBINERS),
    ),
    vertices=Vertices(
        max_lights=known(8, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        max_clip_planes=known(6, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        max_shininess=known(128.0, "Source: OpenGL 1.2.1 table 2.7"),
        separate_specular_color=known(True, "Source: OpenGL 1.2.1 section 2.13.1"),
        texgen_modes=known(CORE_TEXGEN_MODES, "Source: OpenGL 1.2.1 section 2.10.4"),
        fog_coordinate=known(False, NOT_CORE),
        point_parameters=known(False, NOT_CORE),
        composite_matrix=known(False, NOT_CORE),
        vertex_weighting=known(False, NOT_CORE),
    ),
    primitives=Primitives(
        max_point_size=known(64.0, _DRIVER),
        max_line_width=known(64.0, _DRIVER),
        line_stipple=known(True, "Source: OpenGL 1.2.1 section 3.4.2"),
        smoothing_samples=known(
            (), "Source: OpenGL 1.2.1, section 3.2 leaves coverage to the machine; unseen"
        ),
        point_sprite_units=known(frozenset(), NOT_CORE),
        perspective_hint=known(False, "Source: OpenGL 1.2.1 section 5.6 (a hint may be ignored)"),
        spherical_interpolation=known(
            False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"
        ),
    ),
    fragments=Fragments(
        color_sum=known(False, "Source: OpenGL 1.2.1 section 3.9: lighting's specular term alone"),
        fog_registers=known(False, NOT_CORE),
        depth_clamp=known(False, NOT_CORE),
        w_buffering=known(False, NOT_CORE),
        max_window_rectangles=known(0, NOT_CORE),
        stencil_operations=known(CORE_STENCIL_OPERATIONS, "Source: OpenGL 1.2.1 section 4.1.4"),
        blend_factors_source=known(CORE_SOURCE_FACTORS | CONSTANT_FACTORS, OF_SUBSET),
        blend_factors_destination=known(CORE_DESTINATION_FACTORS | CONSTANT_FACTORS, OF_SUBSET),
        blend_equations=known(SUBSET_EQUATIONS, OF_SUBSET),
        logic_op=known(True, "Source: OpenGL 1.2.1 section 4.1.8"),
    ),
    framebuffers=Framebuffers(
        max_viewport=known(2048, _DRIVER),
        color_bits=known((12, 8), "Assumed: 12, or 8; Montrym, Baum, Dignam, Migdal 1997 would settle it"),
        depth_bits=known((23,), "Assumed: 23; Montrym, Baum, Dignam, Migdal 1997 would settle it"),
        stencil_bits=known(8, _DRIVER),
        accumulation_bits=known(
            24, "Assumed: 24 with the sign, in hardware; Montrym, Baum, Dignam, Migdal 1997 would settle it"
        ),
        auxiliary_buffers=known(4, "Assumed: 4; a query of AUX_BUFFERS would settle it"),
        samples=known((1, 4, 8), "Assumed: 1, 4 or 8; Montrym, Baum, Dignam, Migdal 1997 would settle it"),
        shades_samples=known(True, "Assumed: as docs/decisions, page 0012, says"),
        surface_formats=known(frozenset(), NOT_CORE),
        shared_depth=known(False, NOT_CORE),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(256, _DRIVER),
        transfers_texture_queries=known(True, TRANSFERRED_QUERIES),
        color_matrix=known(True, OF_SUBSET),
        color_tables=known(True, OF_SUBSET),
        max_color_table_size=known(4096, _SUBSET),
        convolution=known(True, OF_SUBSET),
        max_convolution_size=known(11, _SUBSET),
        histogram=known(True, OF_SUBSET),
        pixel_texture=known(False, NOT_CORE),
        pixel_texture_sgis=known(False, NOT_CORE),
        impact_pixel_texture=known(False, NOT_CORE),
    ),
    arithmetic=Arithmetic(
        exact=known(
            False,
            "Source: OpenGL 1.2.1 section 2.1.1: floating-point or fixed-point, here fixed-point colours",
        ),
        clamps=known(frozenset(Clamp), "Source: OpenGL 1.2.1 sections 2.13.6, 3.8.9, 3.9, 3.10, 4.1.6"),
        lighting=known(LightingArithmetic.EQUATIONS, "Source: OpenGL 1.2.1 section 2.13.1"),
        color_mantissa_bits=known(
            53, "Source: OpenGL 1.2.1 section 2.13.9 (rounded to nearest, nothing cut before)"
        ),
        fog_arithmetic=known(FogArithmetic.ROUNDED, _PICTURE),
        subpixel_bits=known(4, _DRIVER),
        guard_band=known(8192, _PICTURE),
        device_origin=known(WindowOrigin.UPPER_LEFT, _PICTURE),
        color_weights=known(ColorWeights.EXACT, _PICTURE),
        diamond_exit_lines=known(True, "Source: OpenGL 1.2.1 section 3.4.1"),
        magnification_threshold=known(MagnificationThreshold.OPENGL_C, "Source: OpenGL 1.2.1 section 3.8.5"),
        filter_fraction_bits=known(8, _PICTURE),
        texture_bits=known(
            12, "Assumed: 12, as the colour buffer; Montrym, Baum, Dignam, Migdal 1997 would settle it"
        ),
        dithered_s3tc_dxt1=known(False, NOT_CORE),
        combiner_bits=known(
            12,
            "Assumed: 12, environments as wide as the colour buffer; Montrym, Baum, Dignam, Migdal 1997 "
            "would settle it",
        ),
        combiner_range=known(1.0, _NO_COMBINERS),
        clamp_low=known(-256, _NO_COMBINERS),
        offset_fraction=known(
            False, "Assumed: whole units; a slope drawn on an InfiniteReality would settle it"
        ),
        expand_half=known(128, "Assumed: as on the plain board, 128; no stage of an InfiniteReality expands"),
        product_rounding=known(ProductRounding.JOINT, _PICTURE),
        round_before_scale=known(True, _PICTURE),
        add_signed_scale_by_four=known(False, NOT_CORE),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

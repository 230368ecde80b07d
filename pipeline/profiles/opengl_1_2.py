"""A plain board of the time, as OpenGL 1.2.1 describes it; and the same with the imaging subset."""

from fixedpipe.pipeline.enums import (
    BlendEquation,
    Clamp,
    ColorWeights,
    FogArithmetic,
    LightingArithmetic,
    MagnificationThreshold,
    ProductRounding,
    TextureCompareMode,
    WindowOrigin,
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
    OF_SUBSET_ALONE,
    SUBSET_EQUATIONS,
    UNTOUCHED_QUERIES,
)

_NO_COMBINERS = "Assumed: does not matter; the machine has no register combiners"

OPENGL_1_2 = Profile(
    name="OpenGL 1.2",
    description="a plain board of the time: one texture unit, texture environments",
    textures=Textures(
        max_texture_units=known(1, "Source: OpenGL 1.2.1 section 3.8: one texture unit"),
        max_texture_size=known(
            2048, "Assumed: 2048, beyond table 6.24's minimum of 64; no board is meant in particular"
        ),
        max_cube_map_texture_size=known(0, NOT_CORE),
        max_3d_texture_size=known(
            256, "Assumed: 256, beyond table 6.24's minimum of 16; no board is meant in particular"
        ),
        power_of_two_textures=known(True, "Source: OpenGL 1.2.1 section 3.8.1"),
        texture_targets=known(CORE_TARGETS, "Source: OpenGL 1.2.1 section 3.8"),
        internal_formats=known(
            CORE_FORMATS, "Source: OpenGL 1.2.1 table 3.16 (requested resolutions are kept)"
        ),
        texture_borders=known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
        wrap_modes=known(CORE_WRAP_MODES, "Source: OpenGL 1.2.1 section 3.8.4"),
        cylinder_wrap=known(False, "Source: no OpenGL extension has it"),
        signed_components=known(False, NOT_CORE),
        hilo_as_color=known(False, NOT_CORE),
        max_lod_bias=known(0.0, NOT_CORE),
        max_anisotropy=known(1.0, NOT_CORE),
        max_probes=known(1, NOT_CORE),
        exact_probes=known(False, NOT_CORE),
        texture_color_table=known(False, NOT_CORE),
        color_key_operations=known(frozenset(), NOT_CORE),
        evaluate_before_filtering=known(
            False, "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"
        ),
        texture_compare_modes=known(frozenset({TextureCompareMode.NONE}), NOT_CORE),
        shadow_functions=known(frozenset(), NOT_CORE),
        shadow_ambient=known(False, NOT_CORE),
        depth_texture_modes=known((), NOT_CORE),
        depths_as_colors=known(False, NOT_CORE),
        depth_units_in_coordinates=known(False, NOT_CORE),
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
        max_point_size=known(
            64.0, "Assumed: 64, beyond table 6.25's minimum of 1; no board is meant in particular"
        ),
        max_line_width=known(
            64.0, "Assumed: 64, beyond table 6.25's minimum of 1; no board is meant in particular"
        ),
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
        blend_factors_source=known(CORE_SOURCE_FACTORS, "Source: OpenGL 1.2.1 table 4.1"),
        blend_factors_destination=known(CORE_DESTINATION_FACTORS, "Source: OpenGL 1.2.1 table 4.2"),
        blend_equations=known(
            frozenset({BlendEquation.FUNC_ADD}),
            "Source: OpenGL 1.2.1 section 4.1.6: others are the imaging subset's",
        ),
        logic_op=known(True, "Source: OpenGL 1.2.1 section 4.1.8"),
    ),
    framebuffers=Framebuffers(
        max_viewport=known(2048, "Assumed: 2048; no board is meant in particular"),
        color_bits=known(
            (8,), "Assumed: 8, the usual width; no board is meant in particular (table 6.26: RED_BITS)"
        ),
        depth_bits=known((16, 24), "Assumed: 16 and 24, the usual ones"),
        stencil_bits=known(8, "Assumed: 8, the usual width; the minimum is 1"),
        accumulation_bits=known(16, "Assumed: 16 with the sign, what PC drivers of the time gave"),
        auxiliary_buffers=known(
            2, "Assumed: 2, beyond table 6.25's minimum of none; no board is meant in particular"
        ),
        samples=known((1,), NOT_CORE),
        shades_samples=known(True, "Source: OpenGL 1.2.1, section 3: one sample, a pixel's middle"),
        surface_formats=known(frozenset(), NOT_CORE),
        shared_depth=known(False, NOT_CORE),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(
            256, "Assumed: 256; OpenGL 1.2.1 section 3.6.3 asks for 32, and no board is meant in particular"
        ),
        transfers_texture_queries=known(False, UNTOUCHED_QUERIES),
        color_matrix=known(False, OF_SUBSET_ALONE),
        color_tables=known(False, OF_SUBSET_ALONE),
        max_color_table_size=known(0, OF_SUBSET_ALONE),
        convolution=known(False, OF_SUBSET_ALONE),
        max_convolution_size=known(0, OF_SUBSET_ALONE),
        histogram=known(False, OF_SUBSET_ALONE),
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
        fog_arithmetic=known(
            FogArithmetic.ROUNDED, "Assumed: rounding to nearest; OpenGL 1.2.1 section 3.10 leaves it open"
        ),
        subpixel_bits=known(4, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        guard_band=known(8192, "Assumed: wide enough for what is drawn about the screen"),
        device_origin=known(
            WindowOrigin.UPPER_LEFT,
            "Source: OpenGL 1.2.1 section 2.10.1: window y upwards; the board's count is Assumed",
        ),
        color_weights=known(
            ColorWeights.EXACT, "Assumed: exact, rounded to nearest; what section 3.5.1's equation 3.5 gives"
        ),
        diamond_exit_lines=known(True, "Source: OpenGL 1.2.1 section 3.4.1"),
        magnification_threshold=known(MagnificationThreshold.OPENGL_C, "Source: OpenGL 1.2.1 section 3.8.5"),
        filter_fraction_bits=known(8, "Assumed: 8, as on the NV2A"),
        texture_bits=known(8, "Assumed: 8, as the colour buffer"),
        dithered_s3tc_dxt1=known(False, NOT_CORE),
        combiner_bits=known(8, "Assumed: environments are as wide as the colour buffer"),
        combiner_range=known(1.0, _NO_COMBINERS),
        clamp_low=known(-256, _NO_COMBINERS),
        offset_fraction=known(False, "Assumed: whole units; OpenGL 1.2.1 section 3.5.5 does not say"),
        expand_half=known(
            128, "Assumed: 128, where normal maps of the time put zero; no stage of OpenGL 1.2.1 expands"
        ),
        product_rounding=known(ProductRounding.JOINT, "Assumed: one rounding after the sum, as blending's"),
        round_before_scale=known(True, "Assumed: as on the NV2A"),
        add_signed_scale_by_four=known(False, NOT_CORE),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

OPENGL_1_2_IMAGING = OPENGL_1_2.descendant(
    name="OpenGL 1.2 with the imaging subset",
    description="the same with the imaging subset: colour tables, convolution, colour matrix, histogram",
    blend_factors_source=known(CORE_SOURCE_FACTORS | CONSTANT_FACTORS, OF_SUBSET),
    blend_factors_destination=known(CORE_DESTINATION_FACTORS | CONSTANT_FACTORS, OF_SUBSET),
    blend_equations=known(SUBSET_EQUATIONS, OF_SUBSET),
    color_matrix=known(True, OF_SUBSET),
    color_tables=known(True, OF_SUBSET),
    max_color_table_size=known(4096, "Assumed: 4096, for each value of twelve bits; no board in particular"),
    convolution=known(True, OF_SUBSET),
    max_convolution_size=known(11, "Assumed: 11, beyond table 6.25's minimum of 3; no board in particular"),
    histogram=known(True, OF_SUBSET),
)

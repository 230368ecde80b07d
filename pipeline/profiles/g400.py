"""Matrox G400 (1999): two texture units, environment-mapped bump mapping.

Its stages add, subtract and multiply; there is no dot product of colours (D3DTOP_DOTPRODUCT3, DOT3_RGB).
What no extension says of it is as on the plain board.
"""

from fixedpipe.pipeline.enums import (
    BlendEquation,
    Clamp,
    ColorKeyOperation,
    ColorWeights,
    CombineFunction,
    FogArithmetic,
    InternalFormat,
    LightingArithmetic,
    MagnificationThreshold,
    ProductRounding,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
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
    CORE_DESTINATION_FACTORS,
    CORE_FORMATS,
    CORE_SOURCE_FACTORS,
    CORE_STENCIL_OPERATIONS,
    CORE_TEXGEN_MODES,
    CORE_WRAP_MODES,
    NOT_CORE,
    OF_SUBSET_ALONE,
    UNTOUCHED_QUERIES,
)

_NO_VOLUMES = "Assumed: no 3D textures; a G400's driver that lists EXT_texture3D would settle it"
_DRIVER = "Assumed: as on the plain board; a query of a G400's driver would settle it"
_PICTURE = "Assumed: as on the plain board; a picture of a G400 would settle it"
_NO_COMBINERS = "Assumed: does not matter; the G400 has no register combiners"

G400 = Profile(
    name="Matrox G400",
    description="Matrox G400, 1999: two texture units, environment-mapped bump mapping by a 2x2 matrix",
    textures=Textures(
        max_texture_units=known(
            2, "Source: Kautz, Seidel 2000, section 5 (most implementations: two texture maps)"
        ),
        max_texture_size=known(2048, _DRIVER),
        max_cube_map_texture_size=known(0, NOT_CORE),
        max_3d_texture_size=known(0, _NO_VOLUMES),
        power_of_two_textures=known(True, "Source: OpenGL 1.2.1 section 3.8.1"),
        texture_targets=known(frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}), _NO_VOLUMES),
        internal_formats=known(
            CORE_FORMATS | {InternalFormat.DSDT8, InternalFormat.DSDT8_MAG8},
            "Source: OpenGL 1.2.1 table 3.16 (requested resolutions are kept); ATI_envmap_bumpmap (DU8DV8); "
            "with a magnitude Assumed, as the scaled lookup: the board's manual would settle it",
        ),
        texture_borders=known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
        wrap_modes=known(CORE_WRAP_MODES, "Source: OpenGL 1.2.1 section 3.8.4"),
        cylinder_wrap=known(False, "Source: no OpenGL extension has it"),
        signed_components=known(True, "Source: ATI_envmap_bumpmap (the offsets of DU8DV8 have signs)"),
        hilo_as_color=known(False, "Source: ATI_envmap_bumpmap (a bump map's unit passes its colour on)"),
        max_lod_bias=known(
            4.0, "Assumed: 4; a MAX_TEXTURE_LOD_BIAS_EXT query of a G400's driver would settle it"
        ),
        max_anisotropy=known(1.0, NOT_CORE),
        max_probes=known(1, NOT_CORE),
        exact_probes=known(False, NOT_CORE),
        texture_color_table=known(False, NOT_CORE),
        color_key_operations=known(
            frozenset({ColorKeyOperation.KILL}),
            "Assumed: as Direct3D 7 asks; a G400's driver with D3DPTEXTURECAPS_TRANSPARENCY would settle it",
        ),
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
        texture_shader_operations=known(
            frozenset(
                {
                    TextureShaderOperation.NONE,
                    TextureShaderOperation.TEXTURE_2D,
                    TextureShaderOperation.OFFSET_TEXTURE_2D,
                    TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE,
                }
            ),
            "Source: Heidrich and others 2000, section 3.3 (a restricted dependent lookup); "
            "ATI_envmap_bumpmap (offsets through a 2x2 matrix); the scaled one Assumed: the board's manual "
            "would settle it",
        ),
        dot_product_mappings=known(frozenset(), NOT_CORE),
        foreign_texture_targets=known(False, NOT_CORE),
        offset_scale_clamped=known(
            True, "Source: WineHQ dlls/d3d9/tests/visual.c, fixed_function_bumpmap_test (1000 L - 1 gives 1)"
        ),
        roughness_lookups=known(False, NOT_CORE),
    ),
    combiners=Combiners(
        texture_environment_modes=known(
            frozenset(TextureEnvironmentMode) - {TextureEnvironmentMode.COMBINE4},
            "Source: EXT_texture_env_add, EXT_texture_env_combine; ATI_envmap_bumpmap (a bump map's unit "
            "passes its colour on)",
        ),
        combine_functions=known(
            frozenset(
                {
                    CombineFunction.REPLACE,
                    CombineFunction.MODULATE,
                    CombineFunction.ADD,
                    CombineFunction.ADD_SIGNED,
                    CombineFunction.INTERPOLATE,
                }
            ),
            "Source: ARB_texture_env_combine (SUBTRACT is what it adds to the EXT one). No DOT3: Source: "
            "Mesa's mga driver (a stage of TDUALSTAGE0 or 1 selects an argument, a sum or a product); "
            "AnandTech, Gigabyte GA-MG400, 2000 (bumps by environment maps, not by Dot Product 3)",
        ),
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
        color_sum=known(
            True, "Assumed: as EXT_secondary_color has it; a G400's driver that lists it would settle it"
        ),
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
        max_viewport=known(2048, _DRIVER),
        color_bits=known((8,), _DRIVER),
        depth_bits=known((16, 24), _DRIVER),
        stencil_bits=known(8, _DRIVER),
        accumulation_bits=known(16, _DRIVER),
        auxiliary_buffers=known(
            0, "Assumed: none; a query of AUX_BUFFERS of a G400's driver would settle it"
        ),
        samples=known((1,), NOT_CORE),
        shades_samples=known(True, "Source: OpenGL 1.2.1, section 3: one sample, a pixel's middle"),
        surface_formats=known(frozenset(), NOT_CORE),
        shared_depth=known(False, NOT_CORE),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(256, _DRIVER),
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
        fog_arithmetic=known(FogArithmetic.ROUNDED, _PICTURE),
        subpixel_bits=known(4, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        guard_band=known(8192, _PICTURE),
        device_origin=known(WindowOrigin.UPPER_LEFT, _PICTURE),
        color_weights=known(ColorWeights.EXACT, _PICTURE),
        diamond_exit_lines=known(True, "Source: OpenGL 1.2.1 section 3.4.1"),
        magnification_threshold=known(MagnificationThreshold.OPENGL_C, "Source: OpenGL 1.2.1 section 3.8.5"),
        filter_fraction_bits=known(8, _PICTURE),
        texture_bits=known(8, _PICTURE),
        dithered_s3tc_dxt1=known(False, NOT_CORE),
        combiner_bits=known(
            8, "Assumed: environments are as wide as the colour buffer; a picture of a G400 would settle it"
        ),
        combiner_range=known(1.0, _NO_COMBINERS),
        clamp_low=known(-256, _NO_COMBINERS),
        offset_fraction=known(False, "Assumed: whole units; a slope drawn on a G400 would settle it"),
        expand_half=known(
            128, "Assumed: as on the NV2A, 128; ADD_SIGNED takes it, and a picture of a G400 would settle it"
        ),
        product_rounding=known(ProductRounding.JOINT, _PICTURE),
        round_before_scale=known(True, _PICTURE),
        add_signed_scale_by_four=known(
            True, "Assumed: as EXT_texture_env_combine has it; the board would settle it"
        ),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

"""NVIDIA NV2A (2001), the Xbox's graphics chip: what captures of the chip itself say.

Thousands of framebuffer captures exist; ``fixedpipe conformance`` redraws them (docs/silicon.md).
"""

from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendEquation,
    BlendFactor,
    Clamp,
    ColorFormat,
    ColorKeyOperation,
    ColorWeights,
    CombineFunction,
    CombinerFunction,
    ComparisonFunction,
    DepthFormat,
    DotProductMapping,
    FogArithmetic,
    InternalFormat,
    LightingArithmetic,
    MagnificationThreshold,
    ProductRounding,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureShaderOperation,
    TextureTarget,
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
from fixedpipe.pipeline.profiles.specified import UNTOUCHED_QUERIES
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS

_NOT_ASKED = "Assumed: none; no capture asks for it"

NV2A = Profile(
    name="NV2A",
    description="NVIDIA NV2A, 2001: texture shaders, eight general combiners, four texture units",
    textures=Textures(
        max_texture_units=known(4, "Measured: four texture units (Pixel_shader captures)"),
        max_texture_size=known(4096, "Assumed: 4096; a capture of a larger texture would settle it"),
        max_cube_map_texture_size=known(
            4096, "Assumed: 4096; a capture of a larger cube map would settle it"
        ),
        max_3d_texture_size=known(512, "Assumed: 512; a capture of a larger volume would settle it"),
        power_of_two_textures=known(
            True, "Measured: powers of two but for rectangles (Texture_format captures)"
        ),
        texture_targets=known(
            frozenset(TextureTarget),
            "Measured: 3D and unnormalised coordinates (Volume_texture, Texture_format captures)",
        ),
        internal_formats=known(
            frozenset(InternalFormat) - TWELVE_BIT_FORMATS,
            "Measured: Texture_format, Volume_texture and Texture_DXT captures. Source: the Xbox's Direct3D, "
            "where Direct3D 8's signed words are names of such formats",
        ),
        texture_borders=known(
            frozenset({0, 4}),
            "Measured: four texels on either side (Texture_border BorderTex captures); Inferred: no other "
            "number, as a texture has one bit for it (nxdk_pgraph_tests, texture_stage)",
        ),
        wrap_modes=known(
            frozenset(WrapMode), "Measured: five wrap modes, 78720 of 78720 pixels (Texture_border captures)"
        ),
        cylinder_wrap=known(True, "Measured: CylinderWrapping capture"),
        signed_components=known(
            True, "Measured: 732800 of 732800 pixels (Texture_signed_component_tests captures)"
        ),
        border_color_as_given=known(True, "Measured: 19 formats (Texture_border_color capture)"),
        hilo_as_color=known(True, "Measured: 304348 of 304348 pixels (Texture_format R16B16_L capture)"),
        max_lod_bias=known(16.0, "Measured: s5.8, biases of -15 to 15 (LODBias capture)"),
        max_anisotropy=known(8.0, "Source: nxdk_pgraph_tests, texture_anisotropy_tests (1, 2, 4 and 8)"),
        max_probes=known(1, _NOT_ASKED),
        exact_probes=known(False, _NOT_ASKED),
        texture_color_table=known(False, _NOT_ASKED),
        color_key_operations=known(
            frozenset(ColorKeyOperation),
            "Measured: all three, 2727494 of 2727494 pixels (Color_key captures)",
        ),
        evaluate_before_filtering=known(False, _NOT_ASKED),
        texture_compare_modes=known(
            frozenset(TextureCompareMode),
            "Measured: 8150016 of 8150016 pixels of each (Texture_shadow_comparator)",
        ),
        shadow_functions=known(
            frozenset(ComparisonFunction), "Measured: all eight (Texture_shadow_comparator captures)"
        ),
        shadow_ambient=known(False, _NOT_ASKED),
        depth_texture_modes=known(
            (BaseFormat.INTENSITY,),
            "Measured: 255 in all four components (Texture_shadow_comparator captures)",
        ),
        depths_as_colors=known(
            False,
            "Inferred: its depth formats are compared by one of eight functions, NEVER among them "
            "(Texture_shadow_comparator); its method has no value for none",
        ),
        depth_units_in_coordinates=known(True, "Measured: Texture_shadow_comparator and DotZW captures"),
    ),
    texture_shaders=TextureShaders(
        texture_shader_operations=known(
            frozenset(TextureShaderOperation),
            "Measured: Pixel_shader, Texture_cubemap, Texture_BRDF; rectangles Inferred",
        ),
        dot_product_mappings=known(
            frozenset(DotProductMapping), "Measured: six mappings, 56909 pixels each (DotSTRCube captures)"
        ),
        foreign_texture_targets=known(
            True, "Measured: 56909 pixels each (DotSTR3D, Texture_2D_as_cubemap captures)"
        ),
        offset_scale_clamped=known(False, "Measured: 98304 of 98304 pixels (BumpEnvMapLuminance captures)"),
        roughness_lookups=known(False, "Source: NV_texture_shader (made coordinates have no level)"),
    ),
    combiners=Combiners(
        texture_environment_modes=known(
            frozenset(TextureEnvironmentMode), "Source: NV_texture_env_combine4, NV_texture_shader (NONE)"
        ),
        combine_functions=known(frozenset(CombineFunction), "Assumed: all; register combiners compute them"),
        texture_environment_crossbar=known(False, _NOT_ASKED),
        max_general_combiners=known(8, "Source: NV_register_combiners2 (MAX_GENERAL_COMBINERS_NV 8)"),
        per_stage_constants=known(True, "Measured: constants change from stage to stage (Combiner captures)"),
        combiner_functions=known(
            frozenset({CombinerFunction.NONE}), "Source: NV_register_combiners, which names none"
        ),
        combiner_lookup=known(False, _NOT_ASKED),
        blue_to_alpha=known(True, "Measured: 110441 of 110441 pixels (Combiner captures)"),
        ycbcr_conversion=known(True, "Measured: Bump_map, Bump_env_lum UYVY_L, YUY2_L captures"),
        final_alpha_from_blue=known(
            True, "Source: SET_COMBINER_SPECULAR_FOG_CW1, whose G takes alpha or else blue"
        ),
        combiner_flags=known(True, "Measured: 110441 of 110441 pixels (Combiner captures)"),
    ),
    vertices=Vertices(
        max_lights=known(8, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        max_clip_planes=known(6, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        max_shininess=known(128.0, "Source: OpenGL 1.2.1 table 2.7"),
        separate_specular_color=known(True, "Source: OpenGL 1.2.1 section 2.13.1"),
        texgen_modes=known(
            frozenset(TexGenMode),
            "Source: OpenGL 1.2.1 section 2.10.4; EXT_texture_cube_map; NV_texgen_reflection",
        ),
        fog_coordinate=known(True, "Source: EXT_fog_coord"),
        point_parameters=known(True, "Measured: 192 of 192 points (Point_params Scale_0_0_1_FF capture)"),
        composite_matrix=known(True, "Measured: Viewport, TopLeftRaster_Fixed captures"),
        vertex_weighting=known(
            True, "Source: SET_SKIN_MODE 2G: two matrices and one weight, the other generated"
        ),
    ),
    primitives=Primitives(
        max_point_size=known(63.875, "Measured: 6.3 bits (Point_size, Point_sprite captures)"),
        max_line_width=known(63.875, "Source: SET_LINE_WIDTH, 6.3 bits"),
        line_stipple=known(True, "Assumed: as OpenGL 1.2.1 section 3.4.2 says; no capture asks for it"),
        smoothing_samples=known(
            ((0, 0), (-8, 8), (2, -6), (-2, 6), (4, 4), (-4, -4), (6, -2), (-6, 2)),
            "Measured: 2142 of 2142 pixels on edges; a least-squares fit of a grid of 289 places gives these "
            "eight (3D_primitive Triangles-ps)",
        ),
        point_sprite_units=known(
            frozenset({3}), "Source: point_params_tests.cpp of nxdk_pgraph_tests (unit 3 alone)"
        ),
        perspective_hint=known(
            True, "Measured: colours and texels linear on the screen (Texture_perspective captures)"
        ),
        spherical_interpolation=known(False, _NOT_ASKED),
    ),
    fragments=Fragments(
        color_sum=known(True, "Source: OpenGL 1.2.1 section 3.9; EXT_secondary_color"),
        fog_registers=known(
            True, "Measured: bias, multiplier, PLANAR (Fog captures); other generations Assumed"
        ),
        depth_clamp=known(True, "Measured: Depth_Clamp captures"),
        w_buffering=known(True, "Measured: Depth_Clamp captures"),
        max_window_rectangles=known(8, "Source: SET_WINDOW_CLIP_HORIZONTAL and _VERTICAL, eight of each"),
        stencil_operations=known(frozenset(StencilOperation), "Measured: Stencil captures"),
        blend_factors_source=known(
            frozenset(BlendFactor), "Measured: all of them, in 1673 captures (Blend_tests)"
        ),
        blend_factors_destination=known(
            frozenset(BlendFactor), "Measured: all of them, in 1673 captures (Blend_tests)"
        ),
        blend_equations=known(frozenset(BlendEquation), "Measured: 1673 captures (Blend_tests)"),
        logic_op=known(True, "Source: OpenGL 1.2.1 section 4.1.8"),
    ),
    framebuffers=Framebuffers(
        max_viewport=known(4096, "Assumed: 4096; a capture of a larger surface would settle it"),
        color_bits=known((8,), "Measured: surfaces of 8 bits a component and less (Blend_surface captures)"),
        depth_bits=known(
            (DepthFormat.FIXED_16, DepthFormat.FIXED_24, DepthFormat.FLOAT_16, DepthFormat.FLOAT_24),
            "Measured: fixed and float formats of 16 and 24 bits (Depth_buffer captures)",
        ),
        stencil_bits=known(8, "Measured: 24-bit depth, 8-bit stencil (Stencil captures)"),
        accumulation_bits=known(16, "Assumed: as on the GeForce 256; no capture asks for it"),
        auxiliary_buffers=known(0, _NOT_ASKED),
        samples=known(
            (1, 2), "Source: nv_objects.h, CENTER_1, CENTER_CORNER_2; Measured: Swath_width captures"
        ),
        shades_samples=known(False, "Measured: one colour for a pixel, two coverages (Swath_width captures)"),
        surface_formats=known(frozenset(ColorFormat), "Source: nv_objects.h, SET_SURFACE_FORMAT_COLOR"),
        shared_depth=known(
            True, "Source: nv_objects.h, SET_SURFACE_COLOR_OFFSET and SET_SURFACE_ZETA_OFFSET apart"
        ),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(256, "Assumed: as on the GeForce 256; no capture asks for it"),
        transfers_texture_queries=known(False, UNTOUCHED_QUERIES),
        color_matrix=known(False, _NOT_ASKED),
        color_tables=known(False, _NOT_ASKED),
        max_color_table_size=known(0, _NOT_ASKED),
        convolution=known(False, _NOT_ASKED),
        max_convolution_size=known(0, _NOT_ASKED),
        histogram=known(False, _NOT_ASKED),
        pixel_texture=known(False, _NOT_ASKED),
        pixel_texture_sgis=known(False, _NOT_ASKED),
        impact_pixel_texture=known(False, "Source: SGIX_impact_pixel_texture (for the Impact)"),
    ),
    arithmetic=Arithmetic(
        exact=known(False, "Measured: 8-bit combiner registers (Combiner captures)"),
        clamps=known(
            frozenset(Clamp),
            "Source: NV_register_combiners; OpenGL 1.2.1 sections 2.13.6, 3.8.9, 3.9, 3.10, 4.1.6",
        ),
        lighting=known(
            LightingArithmetic.LIGHTING_UNIT,
            "Measured: as envytools models the NV10's unit (Lighting_*, Material_alpha captures)",
        ),
        color_mantissa_bits=known(14, "Measured: 1984 of 1984 colours (Depth_buffer captures)"),
        fog_arithmetic=known(
            FogArithmetic.TABLE, "Measured: all but 1 pixel in each of 2 captures (Fog, Fog_vsh, FogGen)"
        ),
        subpixel_bits=known(4, "Measured: 294000 of 294000 pixels (TopLeftRaster capture)"),
        guard_band=known(
            1 << 20,
            "Measured: vertices 513421 pixels away stay unclipped, 235200 of 235200 depths (W_buffering "
            "WBuf24D_FloorQuad_V0_ZB0_ZS0); how much farther, Assumed",
        ),
        device_origin=known(WindowOrigin.UPPER_LEFT, "Measured: TopLeftRaster capture"),
        color_weights=known(
            ColorWeights.EIGHT_BITS, "Measured: weights of eight bits (Depth_buffer captures)"
        ),
        diamond_exit_lines=known(False, "Measured: steps, not diamonds (3D_primitive captures)"),
        magnification_threshold=known(
            MagnificationThreshold.ZERO, "Measured: 61440 of 61440 pixels (LODBias capture)"
        ),
        filter_fraction_bits=known(8, "Measured: 349524 of 349524 texels (Texture_DXT captures)"),
        texture_bits=known(8, "Measured: texels of 8 bits (Texture_format captures)"),
        dithered_s3tc_dxt1=known(True, "Measured: 2048 of 2048 texels (Texture_DXT captures)"),
        combiner_bits=known(8, "Measured: 8-bit combiner registers (Combiner captures)"),
        combiner_range=known(1.0, "Source: NV_register_combiners (registers hold -1 to 1)"),
        clamp_low=known(
            -256, "Assumed: -256, the lowest 9-bit value; a capture of a negative sum would settle it"
        ),
        offset_fraction=known(
            True, "Measured: 11 depth buffers (W_buffering ZBuf captures), 22320 depths a word more with it"
        ),
        expand_half=known(
            128, "Inferred: the output half is 128 (CombinerOps capture); no capture uses EXPAND"
        ),
        product_rounding=known(
            ProductRounding.JOINT,
            "Inferred: from the blender: one rounding after the sum (Blend_tests captures)",
        ),
        round_before_scale=known(True, "Measured: bias before scale (CombinerOps capture)"),
        add_signed_scale_by_four=known(
            False, "Inferred: from the GeForce 256; its combiners scale a biased sum by two too"
        ),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

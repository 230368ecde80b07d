"""NVIDIA GeForce 3 (NV20, 2001), the NV2A's desktop sibling: no captures of its own, so inferred."""

from fixedpipe.pipeline.enums import (
    BaseFormat,
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
from fixedpipe.pipeline.profiles.profile import Driver, Profile
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
from fixedpipe.pipeline.profiles.specified import SUBSET_EQUATIONS, UNTOUCHED_QUERIES
from fixedpipe.pipeline.textures.images import TWELVE_BIT_FORMATS

_DRIVER = "Assumed: none; a driver of 2001 would settle it"

# Texture targets, formats and operations that came with Detonator XP.
_BEFORE_XP = (
    "Source: tecchannel.de, Test: NVIDIAs Titanium-Grafikchips (2001): shadow buffers and 3D textures are of "
    "every GeForce 3, and Detonator XP turned them on"
)
_XP = "Source: SGIX_shadow, SGIX_depth_texture; ARB_shadow was approved on February 14, 2002"
_DEPTHS = frozenset(f for f in InternalFormat if f.name.startswith("DEPTH_COMPONENT"))
_VOLUMES = frozenset({TextureShaderOperation.TEXTURE_3D, TextureShaderOperation.DOT_PRODUCT_TEXTURE_3D})
_OPERATIONS = frozenset(TextureShaderOperation) - {TextureShaderOperation.BRDF_TEXTURE_3D}
_DRIVERS = (
    Driver(
        name="before Detonator XP",
        since="spring 2001, with the board",
        facts={
            "max_3d_texture_size": known(0, _BEFORE_XP),
            "texture_targets": known(frozenset(TextureTarget) - {TextureTarget.TEXTURE_3D}, _BEFORE_XP),
            "internal_formats": known(frozenset(InternalFormat) - TWELVE_BIT_FORMATS - _DEPTHS, _BEFORE_XP),
            "texture_compare_modes": known(frozenset({TextureCompareMode.NONE}), _BEFORE_XP),
            "shadow_functions": known(frozenset(), _BEFORE_XP),
            "depth_texture_modes": known((), _BEFORE_XP),
            "depths_as_colors": known(False, _BEFORE_XP),
            "texture_shader_operations": known(_OPERATIONS - _VOLUMES, _BEFORE_XP),
        },
    ),
    Driver(
        name="Detonator XP",
        since="autumn 2001",
        facts={
            "shadow_functions": known(
                frozenset({ComparisonFunction.LEQUAL, ComparisonFunction.GEQUAL}),
                f"{_XP}, EXT_shadow_funcs is of March 22, 2002",
            ),
            "depth_texture_modes": known((BaseFormat.LUMINANCE,), f"{_XP}, ARB_depth_texture as well"),
        },
    ),
    Driver(name="a driver of 2002", since="spring 2002, once ARB_shadow was approved", facts={}),
)

GEFORCE_3 = Profile(
    name="GeForce 3",
    description="NVIDIA NV20, 2001: texture shaders, eight general combiners, four texture units",
    drivers=_DRIVERS,
    textures=Textures(
        max_texture_units=known(4, "Inferred: from the NV2A: four texture units (Pixel_shader captures)"),
        max_texture_size=known(4096, "Assumed: as on the NV2A; a MAX_TEXTURE_SIZE query would settle it"),
        max_cube_map_texture_size=known(
            4096, "Assumed: as on the NV2A; a MAX_CUBE_MAP_TEXTURE_SIZE query would settle it"
        ),
        max_3d_texture_size=known(
            512, "Assumed: as on the NV2A; a MAX_3D_TEXTURE_SIZE query would settle it"
        ),
        power_of_two_textures=known(
            True, "Inferred: from the NV2A: powers of two but for rectangles (Texture_format captures)"
        ),
        texture_targets=known(
            frozenset(TextureTarget),
            "Inferred: from the NV2A: 3D and unnormalised coordinates (Volume_texture, Texture_format "
            "captures)",
        ),
        internal_formats=known(
            frozenset(InternalFormat) - TWELVE_BIT_FORMATS,
            "Source: NV_texture_shader (HILO, DSDT and signed formats). Inferred: from the NV2A: "
            "Texture_format, Volume_texture and Texture_DXT captures",
        ),
        texture_borders=known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
        wrap_modes=known(
            frozenset(WrapMode),
            "Inferred: from the NV2A: five wrap modes, 78720 of 78720 pixels (Texture_border captures)",
        ),
        cylinder_wrap=known(True, "Inferred: from the NV2A: CylinderWrapping capture"),
        signed_components=known(
            True, "Inferred: from the NV2A: 732800 of 732800 pixels (Texture_signed_component_tests captures)"
        ),
        border_color_as_given=known(
            False, "Inferred: from OpenGL 1.2.1 section 3.8.5; the driver writes the color that follows it"
        ),
        hilo_as_color=known(
            False, "Source: NV_texture_shader table 3.D (0, 0, 0, 0 where the texel is no RGBA)"
        ),
        max_lod_bias=known(16.0, "Inferred: from the NV2A: s5.8, biases of -15 to 15 (LODBias capture)"),
        max_anisotropy=known(
            8.0, "Inferred: from the NV2A: nxdk_pgraph_tests, texture_anisotropy_tests (1, 2, 4 and 8)"
        ),
        max_probes=known(1, _DRIVER),
        exact_probes=known(False, _DRIVER),
        texture_color_table=known(False, _DRIVER),
        color_key_operations=known(
            frozenset(ColorKeyOperation), "Inferred: from the NV2A: all three (Color_key captures)"
        ),
        evaluate_before_filtering=known(False, _DRIVER),
        texture_compare_modes=known(
            frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE}),
            "Source: ARB_shadow",
        ),
        shadow_functions=known(frozenset(ComparisonFunction), "Source: EXT_shadow_funcs"),
        shadow_ambient=known(False, _DRIVER),
        depth_texture_modes=known(
            (BaseFormat.INTENSITY, BaseFormat.LUMINANCE, BaseFormat.ALPHA),
            "Inferred: INTENSITY, from the NV2A; the others: Source: ARB_depth_texture",
        ),
        depths_as_colors=known(True, "Source: ARB_shadow (TEXTURE_COMPARE_MODE NONE), ARB_depth_texture"),
        depth_units_in_coordinates=known(
            False, "Source: ARB_shadow, NV_texture_shader (DOT_PRODUCT_DEPTH_REPLACE)"
        ),
    ),
    texture_shaders=TextureShaders(
        texture_shader_operations=known(_OPERATIONS, "Source: NV_texture_shader, NV_texture_shader2"),
        dot_product_mappings=known(
            frozenset(DotProductMapping),
            "Inferred: from the NV2A: six mappings, 56909 pixels each (DotSTRCube captures)",
        ),
        foreign_texture_targets=known(False, "Source: NV_texture_shader, table 3.B (inconsistent)"),
        offset_scale_clamped=known(
            True,
            "Source: NV_texture_shader revision 30 (the factor is clamped to match the hardware); WineHQ "
            "dlls/d3d9/tests/visual.c, fixed_function_bumpmap_test",
        ),
        roughness_lookups=known(False, "Source: NV_texture_shader (made coordinates have no level)"),
    ),
    combiners=Combiners(
        texture_environment_modes=known(
            frozenset(TextureEnvironmentMode), "Source: NV_texture_env_combine4, NV_texture_shader (NONE)"
        ),
        combine_functions=known(
            frozenset(CombineFunction),
            "Source: ARB_texture_env_combine (of February 2001), ARB_texture_env_dot3",
        ),
        texture_environment_crossbar=known(False, _DRIVER),
        max_general_combiners=known(8, "Source: NV_register_combiners2 (MAX_GENERAL_COMBINERS_NV 8)"),
        per_stage_constants=known(
            True, "Inferred: from the NV2A: constants change from stage to stage (Combiner captures)"
        ),
        combiner_functions=known(
            frozenset({CombinerFunction.NONE}), "Source: NV_register_combiners, which names none"
        ),
        combiner_lookup=known(False, _DRIVER),
        blue_to_alpha=known(
            True,
            "Inferred: ps.1.1 has eight slots of arithmetic, and a dp3 of all four components takes one; "
            "from the NV2A: Combiner captures",
        ),
        ycbcr_conversion=known(False, "Assumed: none; no extension of its driver reaches one"),
        final_alpha_from_blue=known(True, "Source: NV_register_combiners (G takes BLUE)"),
        combiner_flags=known(False, "Source: NV_register_combiners2, which names none of them"),
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
        point_parameters=known(
            True, "Inferred: from the NV2A: 192 of 192 points (Point_params Scale_0_0_1_FF capture)"
        ),
        composite_matrix=known(True, "Inferred: from the NV2A: Viewport, TopLeftRaster_Fixed captures"),
        vertex_weighting=known(
            True, "Source: EXT_vertex_weighting, NVIDIA's, in drivers until November 2002"
        ),
    ),
    primitives=Primitives(
        max_point_size=known(63.875, "Inferred: from the NV2A: 6.3 bits (Point_size, Point_sprite captures)"),
        max_line_width=known(63.875, "Inferred: from the NV2A: SET_LINE_WIDTH, 6.3 bits"),
        line_stipple=known(
            True, "Assumed: as OpenGL 1.2.1 section 3.4.2 says; a driver of 2001 would settle it"
        ),
        smoothing_samples=known(
            ((0, 0), (-8, 8), (2, -6), (-2, 6), (4, 4), (-4, -4), (6, -2), (-6, 2)),
            "Inferred: from the NV2A's captures (3D_primitive)",
        ),
        point_sprite_units=known(
            frozenset({3}),
            "Inferred: from the NV2A: point_params_tests.cpp of nxdk_pgraph_tests (unit 3 alone)",
        ),
        perspective_hint=known(
            True,
            "Inferred: from the NV2A: colours and texels linear on the screen (Texture_perspective captures)",
        ),
        spherical_interpolation=known(False, _DRIVER),
    ),
    fragments=Fragments(
        color_sum=known(True, "Source: OpenGL 1.2.1 section 3.9; EXT_secondary_color"),
        fog_registers=known(
            True,
            "Inferred: from the NV2A: bias, multiplier, PLANAR (Fog captures); other generations Assumed",
        ),
        depth_clamp=known(True, "Inferred: from the NV2A: Depth_Clamp captures"),
        w_buffering=known(True, "Inferred: from the NV2A: Depth_Clamp captures"),
        max_window_rectangles=known(
            8, "Inferred: from the NV2A: SET_WINDOW_CLIP_HORIZONTAL and _VERTICAL, eight of each"
        ),
        stencil_operations=known(frozenset(StencilOperation), "Inferred: from the NV2A: Stencil captures"),
        blend_factors_source=known(
            frozenset(BlendFactor), "Inferred: from the NV2A: all of them, in 1673 captures (Blend_tests)"
        ),
        blend_factors_destination=known(
            frozenset(BlendFactor), "Inferred: from the NV2A: all of them, in 1673 captures (Blend_tests)"
        ),
        blend_equations=known(SUBSET_EQUATIONS, "Source: EXT_blend_minmax, EXT_blend_subtract"),
        logic_op=known(True, "Source: OpenGL 1.2.1 section 4.1.8"),
    ),
    framebuffers=Framebuffers(
        max_viewport=known(4096, "Assumed: as on the NV2A; a MAX_VIEWPORT_DIMS query would settle it"),
        color_bits=known(
            (8,), "Inferred: from the NV2A: surfaces of 8 bits a component and less (Blend_surface captures)"
        ),
        depth_bits=known(
            (DepthFormat.FIXED_16, DepthFormat.FIXED_24, DepthFormat.FLOAT_16, DepthFormat.FLOAT_24),
            "Inferred: from the NV2A: fixed and float formats of 16 and 24 bits (Depth_buffer captures)",
        ),
        stencil_bits=known(8, "Inferred: from the NV2A: 24-bit depth, 8-bit stencil (Stencil captures)"),
        accumulation_bits=known(
            16, "Assumed: as on the GeForce 256; a query of ACCUM_RED_BITS would settle it"
        ),
        auxiliary_buffers=known(0, _DRIVER),
        samples=known((1,), _DRIVER),
        shades_samples=known(True, "Source: OpenGL 1.2.1, section 3: one sample, a pixel's middle"),
        surface_formats=known(
            frozenset(ColorFormat), "Inferred: from the NV2A: nv_objects.h, SET_SURFACE_FORMAT_COLOR"
        ),
        shared_depth=known(
            True,
            "Inferred: from the NV2A's two offsets; Direct3D 8 keeps a depth surface with another target. "
            "WGL_ARB_pbuffer offers it to no OpenGL program",
        ),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(
            256, "Assumed: as on the GeForce 256; a MAX_PIXEL_MAP_TABLE query would settle it"
        ),
        transfers_texture_queries=known(False, UNTOUCHED_QUERIES),
        color_matrix=known(False, _DRIVER),
        color_tables=known(False, _DRIVER),
        max_color_table_size=known(0, _DRIVER),
        convolution=known(False, _DRIVER),
        max_convolution_size=known(0, _DRIVER),
        histogram=known(False, _DRIVER),
        pixel_texture=known(False, _DRIVER),
        pixel_texture_sgis=known(False, _DRIVER),
        impact_pixel_texture=known(False, "Source: SGIX_impact_pixel_texture (for the Impact)"),
    ),
    arithmetic=Arithmetic(
        exact=known(False, "Inferred: from the NV2A: 8-bit combiner registers (Combiner captures)"),
        clamps=known(
            frozenset(Clamp),
            "Source: NV_register_combiners; OpenGL 1.2.1 sections 2.13.6, 3.8.9, 3.9, 3.10, 4.1.6",
        ),
        lighting=known(
            LightingArithmetic.LIGHTING_UNIT,
            "Inferred: from the NV2A: as envytools models the NV10's unit (Lighting_*, Material_alpha "
            "captures)",
        ),
        color_mantissa_bits=known(
            14, "Inferred: from the NV2A: 1984 of 1984 colours (Depth_buffer captures)"
        ),
        fog_arithmetic=known(
            FogArithmetic.TABLE,
            "Inferred: from the NV2A: all but 1 pixel in each of 2 captures (Fog, Fog_vsh, FogGen)",
        ),
        subpixel_bits=known(4, "Inferred: from the NV2A: 294000 of 294000 pixels (TopLeftRaster capture)"),
        guard_band=known(
            8192,
            "Assumed: off-screen vertices are not clipped up to there; a picture would show how far",
        ),
        device_origin=known(WindowOrigin.UPPER_LEFT, "Inferred: from the NV2A: TopLeftRaster capture"),
        color_weights=known(
            ColorWeights.EIGHT_BITS, "Inferred: from the NV2A: weights of eight bits (Depth_buffer captures)"
        ),
        diamond_exit_lines=known(
            False, "Inferred: from the NV2A: steps, not diamonds (3D_primitive captures)"
        ),
        magnification_threshold=known(
            MagnificationThreshold.ZERO, "Inferred: from the NV2A: 61440 of 61440 pixels (LODBias capture)"
        ),
        filter_fraction_bits=known(
            8, "Inferred: from the NV2A: 349524 of 349524 texels (Texture_DXT captures)"
        ),
        texture_bits=known(8, "Inferred: from the NV2A: texels of 8 bits (Texture_format captures)"),
        dithered_s3tc_dxt1=known(True, "Inferred: from the NV2A: 2048 of 2048 texels (Texture_DXT captures)"),
        combiner_bits=known(8, "Inferred: from the NV2A: 8-bit combiner registers (Combiner captures)"),
        combiner_range=known(1.0, "Source: NV_register_combiners (registers hold -1 to 1)"),
        clamp_low=known(-256, "Assumed: -256, as on the NV2A; a picture of a negative sum would settle it"),
        offset_fraction=known(False, "Assumed: whole units; a slope drawn on a GeForce 3 would settle it"),
        expand_half=known(128, "Inferred: from the NV2A: the output half is 128 (CombinerOps capture)"),
        product_rounding=known(
            ProductRounding.JOINT,
            "Inferred: from the NV2A's blender: one rounding after the sum (Blend_tests captures)",
        ),
        round_before_scale=known(True, "Inferred: from the NV2A: bias before scale (CombinerOps capture)"),
        add_signed_scale_by_four=known(
            False, "Inferred: from the GeForce 256: combiners that scale a biased sum by two"
        ),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

"""NVIDIA GeForce 256 (NV10, 1999): two texture units, two general combiners, 9-bit signed registers."""

from typing import Any

from fixedpipe.pipeline.enums import (
    Clamp,
    ColorKeyOperation,
    ColorWeights,
    CombineFunction,
    CombinerFunction,
    FogArithmetic,
    InternalFormat,
    LightingArithmetic,
    MagnificationThreshold,
    ProductRounding,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
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
from fixedpipe.pipeline.profiles.specified import (
    CONSTANT_FACTORS,
    CORE_DESTINATION_FACTORS,
    CORE_FORMATS,
    CORE_SOURCE_FACTORS,
    SUBSET_EQUATIONS,
    UNTOUCHED_QUERIES,
)

_NO_IMAGING = "Assumed: none; a driver of 1999 that lists ARB_imaging would settle it"
_ASKED_FOR = "Source: Kautz, Seidel 2000, section 5.1 (asked for, so not there)"
_LATER = "Source: NV_texture_shader (GeForce 3 and later)"
_NO_SHADOW = "Assumed: none; a driver of 1999 that lists SGIX_shadow would settle it"
_OCTANES_ALONE = "Source: Kautz, Seidel 2000, section 5 (pixel textures on Octanes alone)"

# Its drivers. Release 4 and Release 5 are NV_register_combiners' names of NVIDIA's drivers of 2000.
_APPROVED = (
    "Source: ARB_texture_env_combine and ARB_texture_env_dot3 were approved on February 16, 2001; Assumed: "
    "no driver had their functions under another name; a list of its extensions would settle it"
)
_LISTED = (
    "Inferred: berkelium.com, NVIDIA OpenGL Extensions, lists EXT_point_parameters beside "
    "EXT_vertex_weighting, which came with this board; the list is undated"
)
_POINTS: dict[str, Any] = {"point_parameters": known(True, _LISTED)}
_WITHOUT_DOT3: dict[str, Any] = {
    "combine_functions": known(
        frozenset(CombineFunction)
        - {CombineFunction.SUBTRACT, CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA},
        _APPROVED,
    )
}
_S3TC: dict[str, Any] = {
    "internal_formats": known(
        CORE_FORMATS | frozenset(f for f in InternalFormat if "S3TC" in f.name),
        "Source: nvnews.net, Detonator Driver Report, part 2 (April 11, 2000): S3TC is new with 5.13; "
        "Assumed: its texels are decoded exactly, without dither; a picture of one would settle it",
    )
}
_DRIVERS = (
    Driver(
        name="Release 4",
        since="early 2000",
        facts=_POINTS
        | _WITHOUT_DOT3
        | {
            "final_alpha_from_blue": known(
                False, "Source: NV_register_combiners, Revision History, June 8, 2000 (refused by Release 4)"
            )
        },
    ),
    Driver(name="Release 5", since="June 2000", facts=_POINTS | _WITHOUT_DOT3 | _S3TC),
    Driver(
        name="a driver of 2001",
        since="spring 2001, once ARB_texture_env_combine was approved",
        facts=_POINTS
        | _S3TC
        | {"combine_functions": known(frozenset(CombineFunction), "Source: ARB_texture_env_combine")},
    ),
)

GEFORCE_256 = Profile(
    name="GeForce 256",
    description="NVIDIA NV10, 1999: register combiners, two texture units, cube maps",
    drivers=_DRIVERS,
    textures=Textures(
        max_texture_units=known(2, "Source: Kautz, Seidel 2000, section 5 (limited to two textures)"),
        max_texture_size=known(
            2048, "Assumed: 2048; a MAX_TEXTURE_SIZE query of a board of the time would settle it"
        ),
        max_cube_map_texture_size=known(
            512, "Assumed: 512; a MAX_CUBE_MAP_TEXTURE_SIZE query would settle it"
        ),
        max_3d_texture_size=known(0, "Source: EXT_texture3D is none of its extensions"),
        power_of_two_textures=known(True, "Source: OpenGL 1.2.1 section 3.8.1"),
        texture_targets=known(
            frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_CUBE_MAP}),
            "Source: OpenGL 1.2.1 section 3.8; EXT_texture_cube_map; no 3D textures",
        ),
        internal_formats=known(
            CORE_FORMATS, "Source: OpenGL 1.2.1 table 3.16 (requested resolutions are kept)"
        ),
        texture_borders=known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
        wrap_modes=known(
            frozenset(WrapMode), "Inferred: from the NV2A's five wrap modes (Texture_border captures)"
        ),
        cylinder_wrap=known(False, "Source: no OpenGL extension has it"),
        signed_components=known(False, "Source: NV_texture_shader (introduced with the GeForce 3)"),
        border_color_as_given=known(False, "Source: OpenGL 1.2.1 section 3.8.5"),
        hilo_as_color=known(False, "Source: NV_texture_shader (introduced with the GeForce 3)"),
        max_lod_bias=known(4.0, "Assumed: 4; a MAX_TEXTURE_LOD_BIAS_EXT query would settle it"),
        max_anisotropy=known(2.0, "Assumed: 2; a MAX_TEXTURE_MAX_ANISOTROPY_EXT query would settle it"),
        max_probes=known(1, "Assumed: none; no paper names such a board but Schilling's"),
        exact_probes=known(False, "Assumed: none; no paper names such a board but Schilling's"),
        texture_color_table=known(
            False, "Assumed: none; a driver of 1999 with SGI_texture_color_table would settle it"
        ),
        color_key_operations=known(
            frozenset({ColorKeyOperation.KILL}),
            "Assumed: as Direct3D 7 asks; a driver of 1999 with D3DPTEXTURECAPS_TRANSPARENCY would settle it",
        ),
        evaluate_before_filtering=known(False, _ASKED_FOR),
        texture_compare_modes=known(frozenset({TextureCompareMode.NONE}), _NO_SHADOW),
        shadow_functions=known(frozenset(), _NO_SHADOW),
        shadow_ambient=known(False, "Assumed: none; the machine compares no textures"),
        depth_texture_modes=known((), "Assumed: none; the machine compares no textures"),
        depths_as_colors=known(False, "Assumed: none; the machine compares no textures"),
        depth_units_in_coordinates=known(False, "Assumed: false; the machine has no such coordinates"),
    ),
    texture_shaders=TextureShaders(
        texture_shader_operations=known(frozenset(), _LATER),
        dot_product_mappings=known(frozenset(), _LATER),
        foreign_texture_targets=known(False, _LATER),
        offset_scale_clamped=known(False, _LATER),
        roughness_lookups=known(False, _LATER),
    ),
    combiners=Combiners(
        texture_environment_modes=known(
            frozenset(TextureEnvironmentMode) - {TextureEnvironmentMode.NONE},
            "Source: OpenGL 1.2.1 section 3.8.9, ARB_texture_env_add; NV_texture_env_combine4 (its "
            "implementation details name the GeForce)",
        ),
        combine_functions=known(
            frozenset(CombineFunction) - {CombineFunction.SUBTRACT},
            "Source: ARB_texture_env_combine (SUBTRACT is what it adds to the EXT one), ARB_texture_env_dot3",
        ),
        texture_environment_crossbar=known(
            False, "Source: NV_texture_env_combine4 alone names other units' textures"
        ),
        max_general_combiners=known(2, "Source: NV_register_combiners; Kautz, Seidel 2000, section 4.1"),
        per_stage_constants=known(False, "Source: NV_register_combiners2 (introduced with the GeForce 3)"),
        combiner_functions=known(
            frozenset({CombinerFunction.NONE}), "Source: NV_register_combiners, which names none"
        ),
        combiner_lookup=known(False, _ASKED_FOR),
        blue_to_alpha=known(False, "Source: NV_register_combiners, which has no such output"),
        ycbcr_conversion=known(False, "Assumed: none; NV_register_combiners has nothing like it"),
        final_alpha_from_blue=known(True, "Source: NV_register_combiners (G takes BLUE)"),
        combiner_flags=known(False, "Source: NV_register_combiners, which names none of them"),
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
            False, "Assumed: none; a driver of 1999 that lists EXT_point_parameters would settle it"
        ),
        composite_matrix=known(False, "Source: OpenGL 1.2.1 section 2.10: projection and viewport are apart"),
        vertex_weighting=known(
            True, "Source: EXT_vertex_weighting, NVIDIA's; NV10_3D_VERTEX_WEIGHT_ENABLE of nouveau"
        ),
    ),
    primitives=Primitives(
        max_point_size=known(63.875, "Inferred: from the NV2A's 6.3-bit sizes (Point_size captures)"),
        max_line_width=known(63.875, "Inferred: from the NV2A's 6.3-bit widths (Line_width captures)"),
        line_stipple=known(True, "Source: OpenGL 1.2.1 section 3.4.2"),
        smoothing_samples=known(
            (), "Source: OpenGL 1.2.1, section 3.2 leaves coverage to the machine; unseen"
        ),
        point_sprite_units=known(frozenset(), "Source: NV_point_sprite (introduced after the GeForce 256)"),
        perspective_hint=known(False, "Source: OpenGL 1.2.1 section 5.6 (a hint may be ignored)"),
        spherical_interpolation=known(False, _ASKED_FOR),
    ),
    fragments=Fragments(
        color_sum=known(True, "Source: OpenGL 1.2.1 section 3.9; EXT_secondary_color"),
        fog_registers=known(False, "Source: OpenGL 1.2.1 section 3.10 has no such parameters"),
        depth_clamp=known(False, "Source: NV_depth_clamp, an extension of later chips"),
        w_buffering=known(False, "Assumed: none; no extension of OpenGL reaches it"),
        max_window_rectangles=known(0, "Assumed: none; a capture would settle it"),
        stencil_operations=known(
            frozenset(StencilOperation), "Source: OpenGL 1.2.1 section 4.1.4; EXT_stencil_wrap"
        ),
        blend_factors_source=known(
            CORE_SOURCE_FACTORS | CONSTANT_FACTORS, "Source: OpenGL 1.2.1 table 4.1 with EXT_blend_color"
        ),
        blend_factors_destination=known(
            CORE_DESTINATION_FACTORS | CONSTANT_FACTORS, "Source: OpenGL 1.2.1 table 4.2 with EXT_blend_color"
        ),
        blend_equations=known(SUBSET_EQUATIONS, "Source: EXT_blend_minmax, EXT_blend_subtract"),
        logic_op=known(True, "Source: OpenGL 1.2.1 section 4.1.8"),
    ),
    framebuffers=Framebuffers(
        max_viewport=known(2048, "Assumed: 2048; a MAX_VIEWPORT_DIMS query would settle it"),
        color_bits=known((8,), "Inferred: from the NV2A's surface formats"),
        depth_bits=known(
            (16, 24), "Inferred: from the NV2A's 16- and 24-bit fixed formats (Depth_buffer captures)"
        ),
        stencil_bits=known(8, "Inferred: from the NV2A's 24-bit depth, 8-bit stencil format"),
        accumulation_bits=known(16, "Assumed: 16 with its sign; a query of ACCUM_RED_BITS would settle it"),
        auxiliary_buffers=known(0, "Assumed: none; a pixel format of a driver of 1999 would settle it"),
        samples=known((1,), "Assumed: 1; a driver that lists ARB_multisample would settle it"),
        shades_samples=known(True, "Source: OpenGL 1.2.1, section 3: one sample, a pixel's middle"),
        surface_formats=known(
            frozenset(), "Assumed: none; a driver of 1999 that lists WGL_ARB_pbuffer would settle it"
        ),
        shared_depth=known(False, "Source: WGL_ARB_pbuffer: each has its own buffers; here no pbuffers"),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(256, "Assumed: 256; OpenGL 1.2.1 section 3.6.3 asks for 32"),
        transfers_texture_queries=known(False, UNTOUCHED_QUERIES),
        color_matrix=known(False, _NO_IMAGING),
        color_tables=known(False, _NO_IMAGING),
        max_color_table_size=known(0, _NO_IMAGING),
        convolution=known(False, _NO_IMAGING),
        max_convolution_size=known(0, _NO_IMAGING),
        histogram=known(False, _NO_IMAGING),
        pixel_texture=known(False, _OCTANES_ALONE),
        pixel_texture_sgis=known(False, _OCTANES_ALONE),
        impact_pixel_texture=known(False, "Source: SGIX_impact_pixel_texture (for the Impact)"),
    ),
    arithmetic=Arithmetic(
        exact=known(
            False, "Source: NV_register_combiners, Issues: NV10 computes in 9-bit signed fixed point"
        ),
        clamps=known(
            frozenset(Clamp),
            "Source: NV_register_combiners; OpenGL 1.2.1 sections 2.13.6, 3.8.9, 3.9, 3.10, 4.1.6",
        ),
        lighting=known(
            LightingArithmetic.EQUATIONS,
            "Assumed: exact, so that lighting shows what a paper's equations give; envytools models the "
            "NV10's own unit, LIGHTING_UNIT",
        ),
        color_mantissa_bits=known(
            14, "Inferred: from the NV2A, 1984 of 1984 colours (Depth_buffer captures)"
        ),
        fog_arithmetic=known(
            FogArithmetic.ROUNDED, "Assumed: rounding to nearest; a capture of a smooth fog would settle it"
        ),
        subpixel_bits=known(4, "Inferred: from the NV2A, 294000 of 294000 pixels (TopLeftRaster capture)"),
        guard_band=known(
            8192,
            "Assumed: vertices so far off screen stay unclipped; a picture would settle it",
        ),
        device_origin=known(WindowOrigin.UPPER_LEFT, "Inferred: from the NV2A (TopLeftRaster capture)"),
        color_weights=known(
            ColorWeights.EIGHT_BITS, "Inferred: from the NV2A's eight-bit weights (Depth_buffer captures)"
        ),
        diamond_exit_lines=known(False, "Inferred: from the NV2A's steps (3D_primitive captures)"),
        magnification_threshold=known(
            MagnificationThreshold.ZERO, "Inferred: from the NV2A, 61440 of 61440 pixels (LODBias capture)"
        ),
        filter_fraction_bits=known(
            8, "Inferred: from the NV2A, 349524 of 349524 texels (Texture_DXT captures)"
        ),
        texture_bits=known(8, "Inferred: from the NV2A's texels (Texture_format captures)"),
        dithered_s3tc_dxt1=known(False, "Assumed: its formats here include no S3TC"),
        combiner_bits=known(
            8, "Source: NV_register_combiners, Issues: NV10's registers have 9 bits, one the sign"
        ),
        combiner_range=known(1.0, "Source: NV_register_combiners (registers hold -1 to 1)"),
        clamp_low=known(-256, "Assumed: -256, the lowest 9-bit value, as on the NV2A"),
        offset_fraction=known(False, "Assumed: whole units; a slope drawn on a GeForce 256 would settle it"),
        expand_half=known(
            128, "Inferred: from the NV2A's output half of 128, where normal maps of the time put zero"
        ),
        product_rounding=known(
            ProductRounding.JOINT,
            "Inferred: from the NV2A's blender: one rounding after the sum (Blend captures)",
        ),
        round_before_scale=known(
            True, "Inferred: from the NV2A's order of bias and scale (Combiner captures)"
        ),
        add_signed_scale_by_four=known(
            False, "Source: NV_texture_env_combine4, NVIDIA Implementation Details"
        ),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

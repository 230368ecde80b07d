"""Schilling's texture memory, TEXRAM (1996): footprint assembly, bump maps of offset vectors.

What Schilling's paper of 1997 does not say of it is as on the plain board.
"""

from fixedpipe.pipeline.enums import (
    BlendEquation,
    Clamp,
    ColorWeights,
    FogArithmetic,
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
    CORE_ENVIRONMENTS,
    CORE_FORMATS,
    CORE_SOURCE_FACTORS,
    CORE_STENCIL_OPERATIONS,
    CORE_TEXGEN_MODES,
    CORE_WRAP_MODES,
    NOT_CORE,
    OF_SUBSET_ALONE,
    UNTOUCHED_QUERIES,
)

_PAPER = "Assumed: as on the plain board; Schilling, Knittel, Strasser 1996 would settle it"
_NO_VOLUMES = "Assumed: no 3D textures; Schilling, Knittel, Strasser 1996 would settle it"
_NO_COMBINERS = "Assumed: does not matter; TEXRAM has no register combiners"

TEXRAM = Profile(
    name="TEXRAM",
    description="Schilling's texture memory, 1996: footprint assembly, offset-vector bump maps",
    textures=Textures(
        max_texture_units=known(
            2, "Inferred: from its bump maps: one unit has the offsets, one what they displace"
        ),
        max_texture_size=known(2048, _PAPER),
        max_cube_map_texture_size=known(0, NOT_CORE),
        max_3d_texture_size=known(0, _NO_VOLUMES),
        power_of_two_textures=known(True, "Source: OpenGL 1.2.1 section 3.8.1"),
        texture_targets=known(frozenset({TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}), _NO_VOLUMES),
        internal_formats=known(
            CORE_FORMATS, "Source: OpenGL 1.2.1 table 3.16 (requested resolutions are kept)"
        ),
        texture_borders=known(frozenset({0, 1}), "Source: OpenGL 1.2.1 section 3.8.1 (a border of 0 or 1)"),
        wrap_modes=known(CORE_WRAP_MODES, "Source: OpenGL 1.2.1 section 3.8.4"),
        cylinder_wrap=known(False, "Source: no OpenGL extension has it"),
        signed_components=known(True, "Inferred: from Schilling 1997's offset vectors, which have signs"),
        hilo_as_color=known(False, NOT_CORE),
        max_lod_bias=known(0.0, NOT_CORE),
        max_anisotropy=known(1.0, NOT_CORE),
        max_probes=known(8, "Assumed: 8; Schilling, Knittel, Strasser 1996 would settle it"),
        exact_probes=known(False, "Source: Schilling, Knittel, Strasser 1996 (a power of two, so a shift)"),
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
        texture_shader_operations=known(
            frozenset(
                {
                    TextureShaderOperation.NONE,
                    TextureShaderOperation.TEXTURE_2D,
                    TextureShaderOperation.OFFSET_TEXTURE_2D,
                }
            ),
            "Source: Schilling 1997, section 7 (bump maps of offset vectors); their form Assumed: as on the "
            "G400",
        ),
        dot_product_mappings=known(frozenset(), NOT_CORE),
        foreign_texture_targets=known(False, NOT_CORE),
        offset_scale_clamped=known(False, NOT_CORE),
        roughness_lookups=known(False, NOT_CORE),
    ),
    combiners=Combiners(
        texture_environment_modes=known(
            CORE_ENVIRONMENTS | {TextureEnvironmentMode.NONE},
            "Source: OpenGL 1.2.1 section 3.8.9; Inferred: a bump map's unit passes its colour on, as in "
            "ATI_envmap_bumpmap",
        ),
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
        max_point_size=known(64.0, _PAPER),
        max_line_width=known(64.0, _PAPER),
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
        max_viewport=known(2048, _PAPER),
        color_bits=known((8,), _PAPER),
        depth_bits=known((16, 24), _PAPER),
        stencil_bits=known(8, _PAPER),
        accumulation_bits=known(16, _PAPER),
        auxiliary_buffers=known(0, "Assumed: none; Schilling, Knittel, Strasser 1996 would settle it"),
        samples=known((1,), NOT_CORE),
        shades_samples=known(True, "Source: OpenGL 1.2.1, section 3: one sample, a pixel's middle"),
        surface_formats=known(frozenset(), NOT_CORE),
        shared_depth=known(False, NOT_CORE),
    ),
    pixels=Pixels(
        max_pixel_map_table=known(256, _PAPER),
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
        fog_arithmetic=known(FogArithmetic.ROUNDED, _PAPER),
        subpixel_bits=known(4, "Source: OpenGL 1.2.1 table 6.24 (the minimum)"),
        guard_band=known(8192, _PAPER),
        device_origin=known(WindowOrigin.UPPER_LEFT, _PAPER),
        color_weights=known(ColorWeights.EXACT, _PAPER),
        diamond_exit_lines=known(True, "Source: OpenGL 1.2.1 section 3.4.1"),
        magnification_threshold=known(MagnificationThreshold.OPENGL_C, "Source: OpenGL 1.2.1 section 3.8.5"),
        filter_fraction_bits=known(8, _PAPER),
        texture_bits=known(8, _PAPER),
        dithered_s3tc_dxt1=known(False, NOT_CORE),
        combiner_bits=known(
            8,
            "Assumed: environments are as wide as the colour buffer; Schilling, Knittel, Strasser 1996 "
            "would settle it",
        ),
        combiner_range=known(1.0, _NO_COMBINERS),
        clamp_low=known(-256, _NO_COMBINERS),
        offset_fraction=known(False, "Assumed: whole units; the chip was never sold"),
        expand_half=known(128, "Assumed: as on the plain board, 128; no stage of TEXRAM's expands"),
        product_rounding=known(ProductRounding.JOINT, _PAPER),
        round_before_scale=known(True, _PAPER),
        add_signed_scale_by_four=known(False, NOT_CORE),
        clamps_color_matrix=known(
            False, "Source: OpenGL 1.2.1 section 3.6.5 (no clamp after the color matrix)"
        ),
    ),
)

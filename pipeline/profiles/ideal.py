"""No machine at all: float64 everywhere, and limits only where a state could not say more.

``fixedpipe.pipeline.ideal.evaluate`` evaluates passes on it.
"""

from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendFactor,
    ColorKeyOperation,
    ColorWeights,
    CombineFunction,
    CombinerFunction,
    ComparisonFunction,
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
from fixedpipe.pipeline.profiles.specified import CORE_FORMATS, SUBSET_EQUATIONS
from fixedpipe.pipeline.textures.images import SIGNED_FORMATS, TWELVE_BIT_FORMATS


def _given(value):
    """A value by definition of the ideal machine."""
    return known(
        value, "Assumed: nothing; limits are what a state can say, or far beyond any machine of the time"
    )


IDEAL = Profile(
    name="ideal",
    description="no machine: float64 throughout, what the algorithm itself gives",
    textures=Textures(
        max_texture_units=_given(4),
        max_texture_size=_given(16384),
        max_cube_map_texture_size=_given(16384),
        max_3d_texture_size=_given(1024),
        power_of_two_textures=_given(False),
        texture_targets=_given(frozenset(TextureTarget) - {TextureTarget.TEXTURE_RECTANGLE}),
        internal_formats=_given(
            CORE_FORMATS
            | TWELVE_BIT_FORMATS
            | {InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24, InternalFormat.HILO16}
            | SIGNED_FORMATS
        ),
        texture_borders=_given(frozenset({0, 1, 4})),
        wrap_modes=_given(frozenset(WrapMode)),
        cylinder_wrap=_given(False),
        signed_components=_given(True),
        border_color_as_given=_given(False),
        hilo_as_color=_given(False),
        max_lod_bias=_given(16.0),
        max_anisotropy=_given(64.0),
        max_probes=_given(64),
        exact_probes=_given(True),
        texture_color_table=_given(True),
        color_key_operations=_given(frozenset(ColorKeyOperation)),
        evaluate_before_filtering=_given(True),
        texture_compare_modes=_given(
            frozenset({TextureCompareMode.NONE, TextureCompareMode.COMPARE_R_TO_TEXTURE})
        ),
        shadow_functions=_given(frozenset(ComparisonFunction)),
        shadow_ambient=_given(True),
        depth_texture_modes=_given((BaseFormat.LUMINANCE, BaseFormat.INTENSITY, BaseFormat.ALPHA)),
        depths_as_colors=_given(True),
        depth_units_in_coordinates=_given(False),
    ),
    texture_shaders=TextureShaders(
        # It has no textures whose coordinates count texels.
        texture_shader_operations=_given(
            frozenset(o for o in TextureShaderOperation if "RECTANGLE" not in o.name)
        ),
        dot_product_mappings=_given(frozenset(DotProductMapping)),
        foreign_texture_targets=_given(False),
        offset_scale_clamped=_given(True),
        roughness_lookups=_given(True),
    ),
    combiners=Combiners(
        texture_environment_modes=_given(frozenset(TextureEnvironmentMode)),
        combine_functions=_given(frozenset(CombineFunction)),
        texture_environment_crossbar=_given(True),
        max_general_combiners=_given(8),
        per_stage_constants=_given(True),
        combiner_functions=_given(frozenset(CombinerFunction)),
        combiner_lookup=_given(True),
        blue_to_alpha=_given(True),
        ycbcr_conversion=_given(False),
        final_alpha_from_blue=_given(True),
        combiner_flags=_given(False),
    ),
    vertices=Vertices(
        max_lights=_given(64),
        max_clip_planes=_given(64),
        max_shininess=_given(128.0),
        separate_specular_color=_given(True),
        texgen_modes=_given(frozenset(TexGenMode)),
        fog_coordinate=_given(True),
        point_parameters=_given(True),
        composite_matrix=_given(False),
        vertex_weighting=_given(True),
    ),
    primitives=Primitives(
        max_point_size=_given(64.0),
        max_line_width=_given(64.0),
        line_stipple=_given(True),
        # Coverage is a machine's: of those that show theirs, the NV2A's.
        smoothing_samples=_given(((0, 0), (-8, 8), (2, -6), (-2, 6), (4, 4), (-4, -4), (6, -2), (-6, 2))),
        point_sprite_units=_given(frozenset(range(4))),
        perspective_hint=_given(False),
        spherical_interpolation=_given(True),
    ),
    fragments=Fragments(
        color_sum=_given(True),
        fog_registers=_given(False),
        depth_clamp=_given(False),
        w_buffering=_given(False),
        max_window_rectangles=_given(0),
        stencil_operations=_given(frozenset(StencilOperation)),
        blend_factors_source=_given(frozenset(BlendFactor)),
        blend_factors_destination=_given(frozenset(BlendFactor)),
        blend_equations=_given(SUBSET_EQUATIONS),
        logic_op=_given(True),
    ),
    framebuffers=Framebuffers(
        max_viewport=_given(8192),
        color_bits=_given((8,)),
        depth_bits=_given((16, 24)),
        stencil_bits=_given(8),
        accumulation_bits=_given(16),
        auxiliary_buffers=_given(4),
        samples=_given((1,)),
        shades_samples=_given(True),
        surface_formats=_given(frozenset()),
        shared_depth=_given(False),
    ),
    pixels=Pixels(
        max_pixel_map_table=_given(65536),
        transfers_texture_queries=_given(True),
        color_matrix=_given(True),
        color_tables=_given(True),
        max_color_table_size=_given(65536),
        convolution=_given(True),
        max_convolution_size=_given(64),
        histogram=_given(True),
        pixel_texture=_given(True),
        pixel_texture_sgis=_given(True),
        impact_pixel_texture=_given(True),
    ),
    arithmetic=Arithmetic(
        exact=_given(True),
        clamps=_given(frozenset()),
        lighting=_given(LightingArithmetic.EQUATIONS),
        color_mantissa_bits=_given(14),
        fog_arithmetic=_given(FogArithmetic.ROUNDED),
        subpixel_bits=_given(4),
        guard_band=_given(8192),
        device_origin=_given(WindowOrigin.UPPER_LEFT),
        color_weights=_given(ColorWeights.EXACT),
        diamond_exit_lines=_given(True),
        magnification_threshold=_given(MagnificationThreshold.ZERO),
        filter_fraction_bits=_given(8),
        texture_bits=_given(8),
        dithered_s3tc_dxt1=_given(False),
        combiner_bits=_given(8),
        combiner_range=_given(1.0),
        clamp_low=_given(-256),
        offset_fraction=_given(True),
        expand_half=_given(127.5),
        product_rounding=_given(ProductRounding.JOINT),
        round_before_scale=_given(True),
        add_signed_scale_by_four=_given(True),
        clamps_color_matrix=_given(False),
    ),
)

"""What a machine has, by subject: the sections of a profile. Each field has its meaning beside it.

All but ``Arithmetic`` say what a machine has, and so what it refuses: numbers are the most that it takes (0:
it has none), sets are what it accepts. ``Arithmetic`` says how it computes what it accepts. No two sections
have a field of one name (``SECTION_OF``).
"""

from dataclasses import dataclass

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
from fixedpipe.pipeline.profiles.known import Section


@dataclass(frozen=True, kw_only=True)
class Textures(Section):
    """Texture units, images and samplers."""

    max_texture_units: int  # MAX_TEXTURE_UNITS_ARB
    max_texture_size: int  # texels along an edge
    max_cube_map_texture_size: int  # texels along an edge; 0: no cube maps
    max_3d_texture_size: int  # texels along an edge; 0: no 3D textures
    power_of_two_textures: bool  # whether edges must be powers of two
    texture_targets: frozenset[TextureTarget]
    internal_formats: frozenset[InternalFormat]
    texture_borders: frozenset[int]  # texels of a texture's border on either side that it may have
    wrap_modes: frozenset[WrapMode]
    cylinder_wrap: bool  # of a TextureUnit
    signed_components: bool  # of any texture, by its sampler
    hilo_as_color: bool  # whether registers receive the bytes of HILO and DSDT texels, or (0, 0, 0, 0)
    max_lod_bias: float  # levels, of either sign
    max_anisotropy: float  # 1: none
    max_probes: int  # of footprint assembly; 1: none
    exact_probes: bool  # any number of them, and not powers of two alone
    texture_color_table: bool  # SGI_texture_color_table
    color_key_operations: frozenset[ColorKeyOperation]  # of a unit's color key
    evaluate_before_filtering: bool  # a pass is evaluated at texels and its results are filtered
    texture_compare_modes: frozenset[TextureCompareMode]
    shadow_functions: frozenset[ComparisonFunction]  # of a texture comparison
    shadow_ambient: bool  # SGIX_shadow_ambient: what a texel in shadow is
    depth_texture_modes: tuple[BaseFormat, ...]  # what depth textures may be, the usual one first
    depths_as_colors: bool  # whether a depth texture is read without a comparison too
    # Whether depths that come from texture coordinates, those that a depth texture is compared with and those
    # of DOT_PRODUCT_DEPTH_REPLACE, are in depth-buffer units, not in [0, 1].
    depth_units_in_coordinates: bool


@dataclass(frozen=True, kw_only=True)
class TextureShaders(Section):
    """Dependent lookups of NV_texture_shader and its like."""

    texture_shader_operations: frozenset[TextureShaderOperation]  # none: no texture shaders
    dot_product_mappings: frozenset[DotProductMapping]
    foreign_texture_targets: bool  # whether cube maps are read as volumes, and 2D textures as either
    offset_scale_clamped: bool  # whether what OFFSET_TEXTURE_*_SCALE multiplies by is at most 1
    roughness_lookups: bool  # whether 2D lookups of bumps are filtered by their roughness


@dataclass(frozen=True, kw_only=True)
class Combiners(Section):
    """What makes one colour of texels and iterated colours: texture environments, register combiners."""

    texture_environment_modes: frozenset[TextureEnvironmentMode]
    combine_functions: frozenset[CombineFunction]  # of COMBINE
    texture_environment_crossbar: bool  # sources TEXTUREn
    max_general_combiners: int  # MAX_GENERAL_COMBINERS_NV; 0: no register combiners
    per_stage_constants: bool  # NV_register_combiners2
    combiner_functions: frozenset[CombinerFunction]  # of the future board
    combiner_lookup: bool  # CombinerLookup
    blue_to_alpha: bool  # ab_blue_to_alpha, cd_blue_to_alpha of RGB portions
    final_alpha_from_blue: bool  # whether the final combiner's G takes BLUE
    ycbcr_conversion: bool  # of texture units' registers
    combiner_flags: bool  # muxes by the lowest bit, inverted terms of the color sum


@dataclass(frozen=True, kw_only=True)
class Vertices(Section):
    """Lights and what else is computed at a vertex."""

    max_lights: int
    max_clip_planes: int
    max_shininess: float
    separate_specular_color: bool
    texgen_modes: frozenset[TexGenMode]
    fog_coordinate: bool  # EXT_fog_coord
    point_parameters: bool  # EXT_point_parameters
    composite_matrix: bool  # Composite, in place of projection and viewport
    vertex_weighting: bool  # EXT_vertex_weighting


@dataclass(frozen=True, kw_only=True)
class Primitives(Section):
    """Points, lines, and what is iterated over a primitive."""

    max_point_size: float  # pixels
    max_line_width: float  # pixels
    line_stipple: bool
    # Where in a pixel smooth lines and polygons are asked for what they cover, 1/16 pixel from its middle, y
    # up; none: nothing is smooth.
    smoothing_samples: tuple[tuple[int, int], ...]
    point_sprite_units: frozenset[int]  # texture units whose coordinates point sprites may replace
    perspective_hint: bool  # whether PERSPECTIVE_CORRECTION_HINT is followed
    spherical_interpolation: bool  # of vectors in texture coordinates


@dataclass(frozen=True, kw_only=True)
class Fragments(Section):
    """What is done to a fragment after it is coloured: sums, fog, tests, blending."""

    color_sum: bool
    fog_registers: bool  # FogRegisters, in place of a fog's density, start and end
    depth_clamp: bool  # NV_depth_clamp
    w_buffering: bool  # clip w as depth
    max_window_rectangles: int  # of a WindowClip
    stencil_operations: frozenset[StencilOperation]
    blend_factors_source: frozenset[BlendFactor]
    blend_factors_destination: frozenset[BlendFactor]
    blend_equations: frozenset[BlendEquation]
    logic_op: bool


@dataclass(frozen=True, kw_only=True)
class Framebuffers(Section):
    """Buffers of a window and of pbuffers."""

    max_viewport: int  # pixels along an edge
    color_bits: tuple[int, ...]  # widths that a component may have, the usual one first
    # Formats that a depth buffer may have; a fixed format is its width.
    depth_bits: tuple[DepthFormat | int, ...]
    stencil_bits: int
    accumulation_bits: int  # of a component, with its sign; 0: no accumulation buffer
    auxiliary_buffers: int
    samples: tuple[int, ...]  # how many a pixel may have, the usual number first
    shades_samples: (
        bool  # of several each computes its own fragment; else all take that of the pixel's middle
    )
    surface_formats: frozenset[ColorFormat]  # of pbuffers' colours; none: no pbuffers
    shared_depth: bool  # whether a pbuffer's depths may be the window's or another pbuffer's


@dataclass(frozen=True, kw_only=True)
class Pixels(Section):
    """Rectangles of pixels on their way: pixel transfer and pixel textures."""

    max_pixel_map_table: int  # entries of a pixel map
    transfers_texture_queries: bool  # whether what GetTexImage returns goes through pixel transfer
    color_matrix: bool
    color_tables: bool  # of pixel transfer
    max_color_table_size: int  # entries of a colour table and of a histogram
    convolution: bool
    max_convolution_size: int  # pixels along a filter's edge
    histogram: bool  # and minmax
    pixel_texture: bool  # SGIX_pixel_texture
    pixel_texture_sgis: bool  # SGIS_pixel_texture
    impact_pixel_texture: bool  # SGIX_impact_pixel_texture


@dataclass(frozen=True, kw_only=True)
class Arithmetic(Section):
    """How the machine computes what it accepts; docs/numbers.md has each rule."""

    exact: bool  # float64 without limits (the ideal machine; the fields below then do not matter)
    clamps: frozenset[Clamp]  # those that are on
    lighting: (
        LightingArithmetic  # OpenGL's equations in float64, or a unit's short floats and rational functions
    )
    color_mantissa_bits: int  # significant bits that a float vertex colour keeps on its way to a byte
    fog_arithmetic: FogArithmetic  # how the factor is computed
    subpixel_bits: int  # of a snapped window coordinate
    guard_band: int  # pixels around the screen that need no clipping
    device_origin: WindowOrigin  # where rows are counted from before snapping
    color_weights: ColorWeights  # of iterated colours
    # Whether lines draw the pixels whose diamond they leave (OpenGL 1.2.1, section 3.4.1), not those of the
    # NV2A's steps; it takes color_weights EXACT.
    diamond_exit_lines: bool
    magnification_threshold: (
        MagnificationThreshold  # the lambda up to which the magnification filter is taken
    )
    filter_fraction_bits: int  # of a linear filter's weights
    texture_bits: int  # of the widest texels' components
    dithered_s3tc_dxt1: bool  # DXT1's colours are ordered-dithered to 5, 6 and 5 bits when they are decoded
    combiner_bits: int  # of a combiner's value of one
    combiner_range: float  # registers hold values below this, of either sign
    clamp_low: int  # the least value of a general combiner's sum: -256 or -255
    offset_fraction: bool  # whether a fixed depth format adds a polygon offset's fraction too
    expand_half: float  # what an 8-bit EXPAND mapping takes as one half: 128 or 127.5
    product_rounding: ProductRounding
    round_before_scale: bool  # a general combiner's sum
    add_signed_scale_by_four: bool  # where not, an ADD_SIGNED texture environment takes a scale of 4 as 2
    clamps_color_matrix: bool  # components are clamped to [0, 1] after a colour matrix or its scale and bias


# The sections by their names in a profile, in order; the name of each field's section.
SECTIONS: dict[str, type[Section]] = {
    "textures": Textures,
    "texture_shaders": TextureShaders,
    "combiners": Combiners,
    "vertices": Vertices,
    "primitives": Primitives,
    "fragments": Fragments,
    "framebuffers": Framebuffers,
    "pixels": Pixels,
    "arithmetic": Arithmetic,
}
SECTION_OF = {name: section for section, kind in SECTIONS.items() for name in kind.names()}

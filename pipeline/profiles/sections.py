"""A machine's properties by subject: the sections of a profile. Each field's meaning stands beside it.

All sections except ``Arithmetic`` say what a machine has, and so what it refuses. Their numbers are the most
that it takes (0: it has none), and their sets are what it accepts. ``Arithmetic`` says how it computes what
it accepts. No two sections have a field of the same name (``SECTION_OF``).
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
    texture_borders: frozenset[int]  # border texels that a texture may have on either side
    wrap_modes: frozenset[WrapMode]
    cylinder_wrap: bool  # the field of a TextureUnit
    signed_components: bool  # whether a sampler can read any texture as signed
    border_color_as_given: bool  # whether every format has the border colour itself, or what its base keeps
    hilo_as_color: bool  # whether registers receive the bytes of HILO and DSDT texels, or (0, 0, 0, 0)
    max_lod_bias: float  # levels, of either sign
    max_anisotropy: float  # 1: no anisotropic filter
    max_probes: int  # of footprint assembly; 1: no footprint assembly
    exact_probes: bool  # any number of probes, and not only powers of two
    texture_color_table: bool  # SGI_texture_color_table
    color_key_operations: frozenset[ColorKeyOperation]  # of a unit's color key
    evaluate_before_filtering: bool  # a pass is evaluated at texels and its results are filtered
    texture_compare_modes: frozenset[TextureCompareMode]
    shadow_functions: frozenset[ComparisonFunction]  # of a texture comparison
    shadow_ambient: bool  # SGIX_shadow_ambient: the value of a texel in shadow
    depth_texture_modes: tuple[BaseFormat, ...]  # the modes of depth textures, the default first
    depths_as_colors: bool  # whether a depth texture can be read without a comparison
    # Whether depths from texture coordinates are in depth-buffer units, and not in [0, 1]. A depth texture is
    # compared with such depths, and DOT_PRODUCT_DEPTH_REPLACE computes them.
    depth_units_in_coordinates: bool


@dataclass(frozen=True, kw_only=True)
class TextureShaders(Section):
    """Dependent lookups: NV_texture_shader and similar extensions."""

    texture_shader_operations: frozenset[TextureShaderOperation]  # empty: no texture shaders
    dot_product_mappings: frozenset[DotProductMapping]
    foreign_texture_targets: bool  # whether cube maps are read as volumes, and 2D textures as either
    offset_scale_clamped: bool  # whether the factor of OFFSET_TEXTURE_*_SCALE is at most 1
    roughness_lookups: bool  # whether roughness filters 2D lookups of bumps


@dataclass(frozen=True, kw_only=True)
class Combiners(Section):
    """How texels and iterated colours become one colour: texture environments, register combiners."""

    texture_environment_modes: frozenset[TextureEnvironmentMode]
    combine_functions: frozenset[CombineFunction]  # of COMBINE
    texture_environment_crossbar: bool  # sources TEXTUREn
    max_general_combiners: int  # MAX_GENERAL_COMBINERS_NV; 0: no register combiners
    per_stage_constants: bool  # NV_register_combiners2
    combiner_functions: frozenset[CombinerFunction]  # the future board's
    combiner_lookup: bool  # CombinerLookup
    blue_to_alpha: bool  # ab_blue_to_alpha, cd_blue_to_alpha of RGB portions
    final_alpha_from_blue: bool  # whether the final combiner's G takes BLUE
    ycbcr_conversion: bool  # of the units' results, before the combiners
    combiner_flags: bool  # muxes by the lowest bit, inverted terms of the color sum


@dataclass(frozen=True, kw_only=True)
class Vertices(Section):
    """Lights and the other computations at a vertex."""

    max_lights: int
    max_clip_planes: int
    max_shininess: float
    separate_specular_color: bool
    texgen_modes: frozenset[TexGenMode]
    fog_coordinate: bool  # EXT_fog_coord
    point_parameters: bool  # EXT_point_parameters
    composite_matrix: bool  # Composite, which replaces projection and viewport
    vertex_weighting: bool  # EXT_vertex_weighting


@dataclass(frozen=True, kw_only=True)
class Primitives(Section):
    """Points, lines, and iteration over a primitive."""

    max_point_size: float  # pixels
    max_line_width: float  # pixels
    line_stipple: bool
    # The places in a pixel that decide its coverage by smooth lines and polygons, in 1/16 pixel from its
    # middle, y up; empty: nothing is smooth.
    smoothing_samples: tuple[tuple[int, int], ...]
    point_sprite_units: frozenset[int]  # texture units whose coordinates point sprites may replace
    perspective_hint: bool  # whether the machine follows PERSPECTIVE_CORRECTION_HINT
    spherical_interpolation: bool  # of vectors in texture coordinates


@dataclass(frozen=True, kw_only=True)
class Fragments(Section):
    """The operations on a coloured fragment: sums, fog, tests, blending."""

    color_sum: bool
    fog_registers: bool  # FogRegisters, which replace a fog's density, start and end
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
    """The buffers of a window and of pbuffers."""

    max_viewport: int  # pixels along an edge
    color_bits: tuple[int, ...]  # the widths of a component that it has, the default first
    # The formats of a depth buffer that it has; a fixed format is given by its width.
    depth_bits: tuple[DepthFormat | int, ...]
    stencil_bits: int
    accumulation_bits: int  # of a component, with its sign; 0: no accumulation buffer
    auxiliary_buffers: int
    samples: tuple[int, ...]  # the numbers of samples of a pixel that it has, the default first
    # Whether each of several samples computes its own fragment; else all take that of the pixel's middle.
    shades_samples: bool
    surface_formats: frozenset[ColorFormat]  # of pbuffers' colours; empty: no pbuffers
    shared_depth: bool  # whether a pbuffer can share the depths of the window or another pbuffer


@dataclass(frozen=True, kw_only=True)
class Pixels(Section):
    """Rectangles of pixels: pixel transfer and pixel textures."""

    max_pixel_map_table: int  # entries of a pixel map
    transfers_texture_queries: bool  # whether the results of GetTexImage pass through pixel transfer
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

    exact: bool  # float64 without limits (the ideal machine); the other fields then do not matter
    clamps: frozenset[Clamp]  # the clamps that are on
    # OpenGL's equations in float64, or a lighting unit's short floats and rational functions.
    lighting: LightingArithmetic
    color_mantissa_bits: int  # significant bits that a float vertex colour keeps before it becomes a byte
    fog_arithmetic: FogArithmetic  # how the machine computes the fog factor
    subpixel_bits: int  # of a snapped window coordinate
    guard_band: int  # pixels around the screen that need no clipping
    device_origin: WindowOrigin  # the row from which rows are counted before snapping
    color_weights: ColorWeights  # of iterated colours
    # Whether lines draw the pixels whose diamond they leave (OpenGL 1.2.1, section 3.4.1), instead of those
    # of the NV2A's steps; this needs color_weights EXACT.
    diamond_exit_lines: bool
    magnification_threshold: MagnificationThreshold  # the lambda up to which textures are magnified
    filter_fraction_bits: int  # of a linear filter's weights
    texture_bits: int  # of the widest texels' components
    dithered_s3tc_dxt1: bool  # whether decoding DXT1 dithers its colours to 5, 6 and 5 bits
    combiner_bits: int  # of a combiner's value of one
    combiner_range: float  # registers hold values below this, of either sign
    clamp_low: int  # the least value of a general combiner's sum: -256 or -255
    offset_fraction: bool  # whether a fixed depth format adds a polygon offset's fraction too
    expand_half: float  # the value that an 8-bit EXPAND mapping takes as one half: 128 or 127.5
    product_rounding: ProductRounding
    round_before_scale: bool  # a general combiner's sum is rounded before its scale
    add_signed_scale_by_four: bool  # if not, an ADD_SIGNED texture environment takes a scale of 4 as 2
    clamps_color_matrix: bool  # components are clamped to [0, 1] after a colour matrix or its scale and bias


# The sections by their names in a profile, in order; then the name of each field's section.
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

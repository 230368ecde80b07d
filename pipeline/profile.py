"""What a machine can do and how wide its numbers are.

One literal per machine in ``pipeline/profiles/``; every field is required and every field has an evidence tag
in ``evidence``. Code asks what a machine can do, never which machine it is.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields

from pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    DotProductMapping,
    FogArithmetic,
    InternalFormat,
    LightingArithmetic,
    MagnificationThreshold,
    ProductRounding,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureShaderOperation,
    TextureTarget,
    WindowOrigin,
    WrapMode,
)

EVIDENCE_TAGS = ("Source:", "Measured:", "Inferred:", "Assumed:")


@dataclass(frozen=True, kw_only=True)
class Profile:
    """A machine.

    Limits
        ``max_texture_units`` (MAX_TEXTURE_UNITS_ARB), ``max_general_combiners`` (MAX_GENERAL_COMBINERS_NV; 0:
        no register combiners), ``per_stage_constants`` (NV_register_combiners2), ``max_texture_size``,
        ``max_cube_map_texture_size``, ``max_3d_texture_size`` (texels along an edge),
        ``power_of_two_textures`` (texture edges must be
        powers of two), ``max_lod_bias`` (levels), ``max_anisotropy``, ``max_lights``, ``max_clip_planes``,
        ``max_viewport``
        (pixels along an edge), ``depth_bits`` (the DepthFormats a depth buffer may have; a fixed format is
        its width), ``stencil_bits``, ``max_shininess``, ``max_point_size`` and ``max_line_width`` (pixels),
        ``max_window_rectangles`` (of a WindowClip; 0: none).
    Sets
        ``texture_targets``, ``internal_formats``, ``wrap_modes``, ``texgen_modes``, ``blend_factors_source``,
        ``blend_factors_destination``, ``blend_equations``, ``stencil_operations``, ``surface_formats`` (of
        pbuffers' colours; none: no pbuffers), ``texture_shader_operations`` (none: no texture shaders),
        ``dot_product_mappings``, ``texture_compare_modes``, ``point_sprite_units`` (texture units whose
        coordinates point sprites may replace).
    Switches
        ``logic_op``, ``fog_coordinate``, ``separate_specular_color``, ``color_sum``,
        ``fog_registers`` (FogRegisters), ``composite_matrix`` (Composite), ``point_parameters``,
        ``depth_units_in_coordinates`` (depths that come from texture coordinates, those that a depth texture
        is compared with and those of DOT_PRODUCT_DEPTH_REPLACE, are in depth-buffer units, not in [0, 1]),
        ``combiner_flags`` (muxes by the lowest bit, blue to alpha, inverted terms of the color sum),
        ``foreign_texture_targets`` (texture shaders read cube maps as volumes and 2D textures as either),
        ``signed_components`` (of any texture), ``cylinder_wrap``, ``perspective_hint``
        (PERSPECTIVE_CORRECTION_HINT is followed),
        ``depth_clamp`` (NV_depth_clamp), ``w_buffering`` (clip w as depth).
    Arithmetic
        ``exact``: float64 without limits (the ideal machine; the fields below then do not matter).
        ``expand_half``: what an 8-bit EXPAND mapping takes as one half, 128 or 127.5. ``product_rounding``,
        ``round_before_scale``, ``clamp_low`` (-256 or -255): general combiner. ``color_mantissa_bits``:
        significant bits that a float vertex colour keeps on its way to a byte. ``subpixel_bits``: of a
        snapped window coordinate. ``guard_band``: pixels around the screen that need no clipping.
        ``device_origin``: where rows are counted from before snapping. ``magnification_threshold``: the
        lambda up to which the magnification filter is taken. ``fog_arithmetic``: how the factor is computed.
        ``dithered_s3tc_dxt1``: DXT1's colours are ordered-dithered to 5, 6 and 5 bits when they are decoded.
        ``lighting``: OpenGL's equations in float64, or a lighting unit's short floats and rational functions.
    """

    name: str
    description: str
    exact: bool

    max_texture_units: int
    max_general_combiners: int
    per_stage_constants: bool
    max_texture_size: int
    max_cube_map_texture_size: int
    max_3d_texture_size: int
    power_of_two_textures: bool
    max_lod_bias: float
    max_anisotropy: float
    max_lights: int
    max_clip_planes: int
    max_viewport: int
    max_shininess: float
    max_point_size: float
    max_line_width: float
    max_window_rectangles: int
    depth_bits: tuple[int, ...]
    stencil_bits: int

    texture_targets: frozenset[TextureTarget]
    internal_formats: frozenset[InternalFormat]
    wrap_modes: frozenset[WrapMode]
    texgen_modes: frozenset[TexGenMode]
    blend_factors_source: frozenset[BlendFactor]
    blend_factors_destination: frozenset[BlendFactor]
    blend_equations: frozenset[BlendEquation]
    stencil_operations: frozenset[StencilOperation]
    surface_formats: frozenset[ColorFormat]
    texture_shader_operations: frozenset[TextureShaderOperation]
    dot_product_mappings: frozenset[DotProductMapping]
    texture_compare_modes: frozenset[TextureCompareMode]
    point_sprite_units: frozenset[int]

    logic_op: bool
    fog_coordinate: bool
    separate_specular_color: bool
    color_sum: bool
    fog_registers: bool
    composite_matrix: bool
    depth_units_in_coordinates: bool
    combiner_flags: bool
    foreign_texture_targets: bool
    signed_components: bool
    cylinder_wrap: bool
    perspective_hint: bool
    point_parameters: bool
    depth_clamp: bool
    w_buffering: bool

    expand_half: float
    product_rounding: ProductRounding
    round_before_scale: bool
    clamp_low: int
    color_mantissa_bits: int
    subpixel_bits: int
    guard_band: int
    device_origin: WindowOrigin
    magnification_threshold: MagnificationThreshold
    fog_arithmetic: FogArithmetic
    dithered_s3tc_dxt1: bool
    lighting: LightingArithmetic

    evidence: Mapping[str, str]

    def __post_init__(self):
        named = {f.name for f in fields(self)} - {"name", "description", "evidence"}
        missing, unknown = named - set(self.evidence), set(self.evidence) - named
        if missing or unknown:
            raise ValueError(
                f"{self.name}: every field needs an evidence tag; missing {sorted(missing)}, "
                f"unknown {sorted(unknown)}"
            )
        for field, tag in self.evidence.items():
            if not tag.startswith(EVIDENCE_TAGS):
                raise ValueError(
                    f"{self.name}.{field}: evidence must start with one of {', '.join(EVIDENCE_TAGS)}"
                )

"""What a machine can do and how wide its numbers are.

A machine is one value of ``Profile``; this package has a module for each machine or family. Every field is
required and every field has an evidence tag in ``evidence``. Code asks what a machine can do, never which
machine it is.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from numbers import Integral

from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendEquation,
    BlendFactor,
    Clamp,
    ColorFormat,
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

EVIDENCE_TAGS = ("Source:", "Measured:", "Inferred:", "Assumed:")
# Bits of components, and subpixel bits, of the compiled kernels; the column engine alone draws at others.
NATIVE_BITS = 8
NATIVE_SUBPIXEL_BITS = 4


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
        ``max_window_rectangles`` (of a WindowClip; 0: none), ``max_probes`` (of footprint assembly; 1: none),
        ``max_color_table_size`` (entries of a colour table and of a histogram), ``max_convolution_size``
        (pixels along a filter's edge), ``max_pixel_map_table`` (entries of a pixel map),
        ``auxiliary_buffers``, ``accumulation_bits`` (a component's, with its sign; 0: none),
        ``color_bits`` (the widths that a colour buffer's components may have, the usual one first),
        ``samples`` (how many of them a pixel may have, the usual number first).
    Sets
        ``texture_targets``, ``internal_formats``, ``wrap_modes``, ``texgen_modes``, ``blend_factors_source``,
        ``blend_factors_destination``, ``blend_equations``, ``stencil_operations``, ``surface_formats`` (of
        pbuffers' colours; none: no pbuffers), ``texture_shader_operations`` (none: no texture shaders),
        ``dot_product_mappings``, ``texture_compare_modes``, ``point_sprite_units`` (texture units whose
        coordinates point sprites may replace), ``shadow_functions`` (of a texture comparison),
        ``depth_texture_modes`` (what its result may be, the usual one first),
        ``texture_environment_modes``, ``combine_functions``, ``combiner_functions``.
    Switches
        ``logic_op``, ``fog_coordinate``, ``separate_specular_color``, ``color_sum``,
        ``fog_registers`` (FogRegisters), ``composite_matrix`` (Composite), ``point_parameters``,
        ``depth_units_in_coordinates`` (depths that come from texture coordinates, those that a depth texture
        is compared with and those of DOT_PRODUCT_DEPTH_REPLACE, are in depth-buffer units, not in [0, 1]),
        ``combiner_flags`` (muxes by the lowest bit, blue to alpha, inverted terms of the color sum),
        ``foreign_texture_targets`` (texture shaders read cube maps as volumes and 2D textures as either),
        ``signed_components`` (of any texture), ``cylinder_wrap``, ``perspective_hint``
        (PERSPECTIVE_CORRECTION_HINT is followed),
        ``depth_clamp`` (NV_depth_clamp), ``w_buffering`` (clip w as depth), ``line_stipple``,
        ``texture_environment_crossbar`` (sources TEXTUREn), ``shadow_ambient``, ``texture_color_table``,
        ``color_matrix``, ``color_tables`` (of pixel transfer), ``convolution``, ``histogram`` (and minmax),
        ``pixel_texture`` (SGIX_pixel_texture), ``pixel_texture_sgis``, ``impact_pixel_texture``,
        ``combiner_lookup``, ``evaluate_before_filtering``, ``spherical_interpolation``.
    Arithmetic
        ``exact``: float64 without limits (the ideal machine; the fields below then do not matter).
        ``expand_half``: what an 8-bit EXPAND mapping takes as one half, 128 or 127.5. ``product_rounding``,
        ``round_before_scale``, ``clamp_low`` (-256 or -255): general combiner. ``add_signed_scale_by_four``:
        where not, an ADD_SIGNED texture environment takes a scale of 4 as 2. ``color_mantissa_bits``:
        significant bits that a float vertex colour keeps on its way to a byte. ``subpixel_bits``: of a
        snapped window coordinate. ``guard_band``: pixels around the screen that need no clipping.
        ``device_origin``: where rows are counted from before snapping. ``magnification_threshold``: the
        lambda up to which the magnification filter is taken. ``fog_arithmetic``: how the factor is computed.
        ``dithered_s3tc_dxt1``: DXT1's colours are ordered-dithered to 5, 6 and 5 bits when they are decoded.
        ``lighting``: OpenGL's equations in float64, or a lighting unit's short floats and rational functions.
        ``color_weights``: of iterated colours. ``diamond_exit_lines``: lines draw the pixels whose diamond
        they leave (section 3.4.1), not those of the NV2A's steps; it takes ``color_weights`` EXACT.
        ``clamps_color_matrix``: components are clamped to [0, 1] after the colour matrix's scale and bias.
        ``combiner_bits``: of a combiner's value of one; ``combiner_range``: registers hold values below this.
        ``texture_bits``: of the widest texels.
        ``filter_fraction_bits``: of a linear filter's weights. ``clamps``: those that are on.
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
    max_probes: int
    max_color_table_size: int
    max_convolution_size: int
    max_pixel_map_table: int
    auxiliary_buffers: int
    accumulation_bits: int
    color_bits: tuple[int, ...]
    samples: tuple[int, ...]
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
    shadow_functions: frozenset[ComparisonFunction]
    depth_texture_modes: tuple[BaseFormat, ...]
    texture_environment_modes: frozenset[TextureEnvironmentMode]
    combine_functions: frozenset[CombineFunction]
    combiner_functions: frozenset[CombinerFunction]

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
    line_stipple: bool
    texture_environment_crossbar: bool
    shadow_ambient: bool
    texture_color_table: bool
    color_matrix: bool
    color_tables: bool
    convolution: bool
    histogram: bool
    pixel_texture: bool
    pixel_texture_sgis: bool
    impact_pixel_texture: bool
    combiner_lookup: bool
    evaluate_before_filtering: bool
    spherical_interpolation: bool

    expand_half: float
    product_rounding: ProductRounding
    round_before_scale: bool
    clamp_low: int
    add_signed_scale_by_four: bool
    color_mantissa_bits: int
    subpixel_bits: int
    guard_band: int
    device_origin: WindowOrigin
    magnification_threshold: MagnificationThreshold
    fog_arithmetic: FogArithmetic
    dithered_s3tc_dxt1: bool
    lighting: LightingArithmetic
    color_weights: ColorWeights
    diamond_exit_lines: bool
    clamps_color_matrix: bool
    combiner_bits: int
    combiner_range: float
    texture_bits: int
    filter_fraction_bits: int
    clamps: frozenset[Clamp]

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
        # Weights of eight bits are measured between 0 and 1 and clamp nothing; a line of diamonds takes
        # values beyond its ends (docs/numbers.md, sections 4 and 11).
        if self.diamond_exit_lines and self.color_weights == ColorWeights.EIGHT_BITS:
            raise ValueError(
                f"{self.name}: diamond_exit_lines with color_weights EIGHT_BITS; what weights of eight bits "
                f"are beyond a line's ends is not defined. Give color_weights EXACT, or lines by the NV2A's "
                f"steps (diamond_exit_lines False)."
            )

    @property
    def widest_depth(self):
        """The widest fixed format that a depth buffer may have: the one it has where none is asked for."""
        return max(self.depth_bits)

    def with_precision(
        self,
        *,
        combiner_bits=None,
        texture_bits=None,
        framebuffer_bits=None,
        filter_fraction_bits=None,
        subpixel_bits=None,
    ):
        """The same machine with other widths, each of 4 to 16 bits; None: its own.

        ``combiner_bits``: of a value of one in combiners and texture environments (registers have a sign
        beside). ``texture_bits``: of texel components of the machine's widest formats. ``framebuffer_bits``:
        of a colour buffer's components. ``filter_fraction_bits``: of a linear filter's weights.
        ``subpixel_bits``: of window coordinates. Pbuffers keep their formats.

        Raises ValueError for a width that is not 4 to 16.
        """
        given = {
            "combiner_bits": combiner_bits,
            "texture_bits": texture_bits,
            "framebuffer_bits": framebuffer_bits,
            "filter_fraction_bits": filter_fraction_bits,
            "subpixel_bits": subpixel_bits,
        }
        given = {name: bits for name, bits in given.items() if bits is not None}
        for name, bits in given.items():
            if isinstance(bits, bool) or not isinstance(bits, Integral) or not 4 <= bits <= 16:
                raise ValueError(f"{name} is {bits!r}; a machine's numbers may have 4 to 16 bits.")
        if not given:
            return self
        words = ", ".join(f"{name} {bits}" for name, bits in given.items())
        widths = {name: int(bits) for name, bits in given.items()}
        if "framebuffer_bits" in widths:
            widths["color_bits"] = (widths.pop("framebuffer_bits"),)
        evidence = {**self.evidence, **dict.fromkeys(widths, "Assumed: nothing; a width that was asked for")}
        return replace(self, name=f"{self.name} with {words}", evidence=evidence, **widths)

    def without_clamps(self, *clamps):
        """The same machine with these of its clamps (``fixedpipe.pipeline.enums.Clamp``) switched off.

        Raises ValueError for what is no Clamp.
        """
        for clamp in clamps:
            if not isinstance(clamp, Clamp):
                raise ValueError(
                    f"{clamp!r} is no clamp; give members of Clamp: {', '.join(Clamp.__members__)}."
                )
        if not clamps:
            return self
        words = ", ".join(clamp.name for clamp in clamps)
        evidence = {**self.evidence, "clamps": "Assumed: nothing; clamps that were asked to be off"}
        name = f"{self.name} without clamps {words}"
        return replace(self, name=name, clamps=self.clamps - set(clamps), evidence=evidence)

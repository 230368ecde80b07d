"""Pass state: frozen dataclasses in the words of the OpenGL 1.2.1 specification, grouped by its sections.

Nothing is "current": a Draw carries a whole ``PassState``. Every default is the OpenGL initial value. Change
a state with ``dataclasses.replace``; equal states compare equal. What a machine cannot hold is refused by
``fixedpipe.pipeline.validation``, not here; what no machine could mean (three outputs to one register) is
refused there too.

Colours are RGBA tuples of floats; 1.0 is full intensity. Matrices are 4x4 tuples of rows, applied to column
vectors (``clip = projection @ modelview @ object``).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from numbers import Integral

from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendEquation,
    BlendFactor,
    ColorBuffer,
    ColorKeyOperation,
    ColorMaterialParameter,
    ColorSource,
    CombineFunction,
    CombineOperand,
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    CombineSource,
    ComparisonFunction,
    ComponentUsage,
    CullMode,
    DotProductMapping,
    Face,
    FogCoordinateSource,
    FogGeneration,
    FogMode,
    FrontFace,
    LineRasterization,
    LogicOperation,
    Mapping,
    Meaning,
    MuxSelect,
    PixelFragmentSource,
    PixelTexGenAlpha,
    PixelTexGenMode,
    PixelTexGenQ,
    PolygonMode,
    ProvokingVertex,
    Register,
    SecondaryColor,
    ShadeModel,
    StencilOperation,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    VertexStage,
    WrapMode,
)

Color = tuple[float, float, float, float]
Vector4 = tuple[float, float, float, float]
Matrix = tuple[Vector4, Vector4, Vector4, Vector4]

IDENTITY: Matrix = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


# ---------------------------------------------------------------------------------- vertices (chapter 2)


@dataclass(frozen=True, slots=True)
class Viewport:
    """Section 2.10.1. Width and height None: the whole framebuffer."""

    x: int = 0
    y: int = 0
    width: int | None = None
    height: int | None = None
    near: float = 0.0
    far: float = 1.0


@dataclass(frozen=True, slots=True)
class TexGen:
    """Texture coordinate generation for one coordinate (section 2.10.4).

    ``plane`` is the object plane, or the eye plane already in eye coordinates (OpenGL transforms it by the
    inverse modelview matrix when it is specified; here the caller does).
    """

    mode: TexGenMode = TexGenMode.NONE
    plane: Vector4 = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Material:
    """Table 2.8. ``specular_coefficients``: on a lighting unit, (a, b, c) of two rational functions
    (x + a)/(b x + c) that stand for x to the power ``shininess``, of the half vector's cosine where it is
    given and of the cosine's square elsewhere; None: the powers themselves.
    """

    ambient: Color = (0.2, 0.2, 0.2, 1.0)
    diffuse: Color = (0.8, 0.8, 0.8, 1.0)
    specular: Color = (0.0, 0.0, 0.0, 1.0)
    emission: Color = (0.0, 0.0, 0.0, 1.0)
    shininess: float = 0.0
    specular_coefficients: tuple[float, float, float, float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Spot:
    """A lighting unit's spotlight: x = axis . (unit vector to the light, 1), at most 1, lights with
    (x + a)/(b x + c), where x + a is positive and x is not negative. ``coefficients``: a, b, c.
    """

    axis: Vector4
    coefficients: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Light:
    """Table 2.8; position and spot direction in eye coordinates. position[3] == 0: directional.

    For a lighting unit alone: ``range``: the light does not reach farther; ``half_vector``: of a directional
    light, which then takes the position's x, y, z and this vector as they are, however long; ``spot``: a
    cone, instead of spot direction, exponent and cutoff, of which None: a driver computes one (N2.26);
    ``back_*``: the light's colours for back faces, None: the same.
    """

    ambient: Color = (0.0, 0.0, 0.0, 1.0)
    diffuse: Color = (1.0, 1.0, 1.0, 1.0)
    specular: Color = (1.0, 1.0, 1.0, 1.0)
    position: Vector4 = (0.0, 0.0, 1.0, 0.0)
    spot_direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    spot_exponent: float = 0.0
    spot_cutoff: float = 180.0
    constant_attenuation: float = 1.0
    linear_attenuation: float = 0.0
    quadratic_attenuation: float = 0.0
    range: float | None = None
    half_vector: tuple[float, float, float] | None = None
    spot: Spot | None = None
    back_ambient: Color | None = None
    back_diffuse: Color | None = None
    back_specular: Color | None = None


@dataclass(frozen=True, slots=True)
class ColorMaterial:
    """Section 2.13.3: which material parameters follow the vertex colour, on which face."""

    face: Face = Face.FRONT_AND_BACK
    parameter: ColorMaterialParameter = ColorMaterialParameter.AMBIENT_AND_DIFFUSE


@dataclass(frozen=True, slots=True)
class ColorSources:
    """A lighting unit's colour material: where each colour of a face's material comes from.

    An emission that comes from the vertices is multiplied by the material's, unless the ambient colour does
    too.
    """

    emission: ColorSource = ColorSource.MATERIAL
    ambient: ColorSource = ColorSource.MATERIAL
    diffuse: ColorSource = ColorSource.MATERIAL
    specular: ColorSource = ColorSource.MATERIAL


@dataclass(frozen=True, slots=True)
class Lighting:
    """Section 2.13.1. ``lights`` holds the enabled lights only. None in PassState: lighting disabled.

    For a lighting unit alone: ``front_sources``, ``back_sources``: instead of ``color_material``;
    ``back_model_ambient``: for back faces, None: the same; ``viewer_direction``: towards a viewer that is not
    local.
    """

    lights: tuple[Light, ...] = ()
    front: Material = Material()
    back: Material = Material()
    model_ambient: Color = (0.2, 0.2, 0.2, 1.0)
    local_viewer: bool = False
    two_side: bool = False
    separate_specular_color: bool = False
    color_material: ColorMaterial | None = None
    front_sources: ColorSources | None = None
    back_sources: ColorSources | None = None
    back_model_ambient: Color | None = None
    viewer_direction: tuple[float, float, float] = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Composite:
    """The NV2A's own transformation (SET_COMPOSITE_MATRIX, SET_VIEWPORT_OFFSET).

    ``matrix``: object coordinates to device pixels (y down) and depth units, each times w. ``offset``: added
    to device x, y and depth after the division.
    """

    matrix: Matrix = IDENTITY
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class VertexState:
    """Transformation, lighting and clipping (sections 2.10 to 2.13).

    ``clip_planes``: the enabled user planes, in eye coordinates. ``normalize``: NORMALIZE enabled;
    ``rescale_normal``: RESCALE_NORMAL enabled.

    ``composite``: takes the place of ``projection`` and ``viewport``; the modelview matrix still gives eye
    coordinates. ``modelview1`` (MODELVIEW1_EXT): VERTEX_WEIGHTING_EXT is enabled, and eye coordinates and
    normals are a mesh's by ``modelview`` times its weight plus those by ``modelview1`` times 1 - weight; the
    last rows of both are the same, and the composite matrix is then of eye coordinates. None: disabled.

    ``stage`` PROGRAM_RESULTS: the mesh holds what a vertex program wrote (NV_vertex_program's o[HPOS] after
    the viewport, o[COL0], o[TEX0] ...): positions are window x and y (y up), z in depth-buffer units and clip
    w; colours, texture and fog coordinates reach rasterization as they are. No matrix, viewport, lighting,
    clipping or texture coordinate generation takes part; the other fields must keep their defaults, but for
    ``two_side`` (VERTEX_PROGRAM_TWO_SIDE): back-facing triangles take the mesh's back colours.

    ``secondary_color``: on a machine with a lighting unit, of both stages.
    """

    modelview: Matrix = IDENTITY
    projection: Matrix = IDENTITY
    viewport: Viewport = Viewport()
    normalize: bool = False
    rescale_normal: bool = False
    lighting: Lighting | None = None
    clip_planes: tuple[Vector4, ...] = ()
    stage: VertexStage = VertexStage.FIXED_FUNCTION
    two_side: bool = False
    secondary_color: SecondaryColor = SecondaryColor.FROM_VERTEX
    composite: Composite | None = None
    modelview1: Matrix | None = None

    @property
    def modelviews(self) -> tuple[Matrix, ...]:
        """One modelview matrix, or both of vertex weighting."""
        return (self.modelview,) if self.modelview1 is None else (self.modelview, self.modelview1)

    @property
    def depth_units(self) -> bool:
        """Whether window z is in depth-buffer units, not in [0, 1]."""
        return self.stage == VertexStage.PROGRAM_RESULTS or self.composite is not None


# --------------------------------------------------------------------------- rasterization (chapter 3)


@dataclass(frozen=True, slots=True)
class PointParameters:
    """Point sizes that shrink with distance: ``(1 / sqrt(a + b d + c d^2) + bias) * range + minimum``.

    d is the vertex's distance from the eye, (a, b, c) the ``attenuation``; the term in parentheses is clamped
    to [0, 1]. This is how the NV2A is programmed (SET_POINT_PARAMS); EXT_point_parameters' sizes from m to M
    of a point of size s are range M - m, minimum m, bias -m / (M - m), and its attenuation times
    ((M - m) / s)^2. ``PointState.size`` then takes no part.
    """

    attenuation: tuple[float, float, float] = (1.0, 0.0, 0.0)
    bias: float = 0.0
    range: float = 0.0
    minimum: float = 1.0


@dataclass(frozen=True, slots=True)
class PointState:
    """Section 3.3, EXT_point_parameters, NV_point_sprite.

    ``sprite`` (POINT_SPRITE_NV): units with ``coord_replace`` take coordinates that run over the point.
    ``parameters`` None: every point has ``size``. ``program_size`` (VERTEX_PROGRAM_POINT_SIZE_NV): sizes come
    from the mesh, where a vertex program wrote them.
    """

    size: float = 1.0
    sprite: bool = False
    parameters: PointParameters | None = None
    program_size: bool = False


@dataclass(frozen=True, slots=True)
class LineState:
    """Section 3.4. ``smooth``: LINE_SMOOTH (section 3.4.4), of lines that are rectangles.

    ``stipple`` (section 3.4.2): (factor, pattern), 1 to 256 and 16 bits, the first in the lowest; None:
    disabled.
    """

    width: float = 1.0
    rasterization: LineRasterization = LineRasterization.STEPS
    stipple: tuple[int, int] | None = None
    smooth: bool = False


@dataclass(frozen=True, slots=True)
class PolygonState:
    """Section 3.5: culling, facing, polygon mode, stipple and depth offset, and section 2.13.7's shade model.

    ``stipple``: what PolygonStipple takes, 32 rows of 4 bytes, bottom row first, the leftmost pixel in the
    highest bit of a row's first byte, repeated over the window; None: disabled. It takes no part where
    polygons are drawn as points or lines. ``smooth``: POLYGON_SMOOTH (section 3.5.2): alpha times the share
    of a pixel that a triangle covers.
    """

    cull_face: Face | None = None
    front_face: FrontFace = FrontFace.CCW
    offset_fill: bool = False
    offset_factor: float = 0.0
    offset_units: float = 0.0
    shade_model: ShadeModel = ShadeModel.SMOOTH
    provoking_vertex: ProvokingVertex = ProvokingVertex.LAST
    front_mode: PolygonMode = PolygonMode.FILL
    back_mode: PolygonMode = PolygonMode.FILL
    offset_line: bool = False
    offset_point: bool = False
    stipple: bytes | None = None
    smooth: bool = False


@dataclass(frozen=True, slots=True)
class SignedComponents:
    """Which components of a texture's texels are two's complement bytes, s/127 (NV_texture_shader's signed
    formats, which the NV2A lets any texture be). A format that has signs of its own needs none of these.
    """

    red: bool = False
    green: bool = False
    blue: bool = False
    alpha: bool = False


def refuse_whole_numbers(what: str, numbers: Iterable[float]) -> None:
    """Raise ValueError, about ``what``, where a tuple of colours' components has a whole number that is
    neither 0 nor 1; what is no tuple, validation refuses.
    """
    for number in numbers if isinstance(numbers, tuple) else ():
        if type(number) is not float and isinstance(number, Integral) and number not in (0, 1):
            raise ValueError(
                f"{what} hold {number}, a whole number; 1.0 is one: / 255.0 if they are bytes, / 65535.0 if "
                "they are 16-bit."
            )


@dataclass(frozen=True, slots=True)
class ColorTable:
    """A colour lookup table (section 3.6.3, SGI_color_table, SGI_texture_color_table).

    ``entries``: 2**n colours; ``base_format`` says which of a colour's components the table replaces, and
    with what (table 3.14): an INTENSITY table's entries replace all four by their first, for instance.
    ``bits``: of each entry's components, rounded to nearest; None: as they are.

    Raises ValueError for whole numbers but 0 and 1: they are bytes, or words, whose one is another.
    """

    entries: tuple[Color, ...]
    base_format: BaseFormat = BaseFormat.RGBA
    bits: int | None = None

    def __post_init__(self) -> None:
        for entry in self.entries if isinstance(self.entries, tuple) else ():
            refuse_whole_numbers("A colour table's entries", entry)


@dataclass(frozen=True, slots=True)
class Sampler:
    """Texture parameters (table 3.17): how a texture image is sampled.

    ``compare_mode``, ``compare_function`` (ARB_shadow, EXT_shadow_funcs): of a depth texture; every texel
    read becomes one where "reference function texel" holds and zero elsewhere, and these are filtered. NONE:
    its depths are read as colours, and ``border_color``'s red is one; by register combiners as alpha alone.
    ``max_anisotropy``: EXT_texture_filter_anisotropic's.
    ``compare_fail_value`` (SGIX_shadow_ambient, ARB_shadow_ambient): what takes the place of zero.
    ``max_probes``: of footprint assembly, a power of two; 1: none. ``exact_probes``: a footprint takes as
    many as cover it, up to any ``max_probes``, and not a power of two.
    ``depth_texture_mode`` (ARB_depth_texture): whether a depth texture is LUMINANCE, INTENSITY or ALPHA;
    None: the machine's usual one.
    ``base_level`` (TEXTURE_BASE_LEVEL, SGIS_texture_lod): the level that is sampled as if it were level 0.
    ``min_lod`` and ``max_lod`` count from it, ``max_level`` counts from level 0.
    """

    min_filter: TextureFilter = TextureFilter.NEAREST_MIPMAP_LINEAR
    mag_filter: TextureFilter = TextureFilter.LINEAR
    wrap_s: WrapMode = WrapMode.REPEAT
    wrap_t: WrapMode = WrapMode.REPEAT
    border_color: Color = (0.0, 0.0, 0.0, 0.0)
    compare_mode: TextureCompareMode = TextureCompareMode.NONE
    compare_function: ComparisonFunction = ComparisonFunction.LEQUAL
    wrap_r: WrapMode = WrapMode.REPEAT
    min_lod: float = -1000.0
    max_lod: float = 1000.0
    max_level: int = 1000
    signed_components: SignedComponents = SignedComponents()
    max_anisotropy: float = 1.0
    compare_fail_value: float = 0.0
    max_probes: int = 1
    exact_probes: bool = False
    depth_texture_mode: BaseFormat | None = None
    base_level: int = 0

    @property
    def magnifies_late(self) -> bool:
        """Whether OpenGL magnifies up to a lambda of 1/2 instead of 0 (section 3.8.6)."""
        late = TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST_MIPMAP_LINEAR
        return self.mag_filter == TextureFilter.LINEAR and self.min_filter in late


@dataclass(frozen=True, slots=True)
class Combine:
    """One half, RGB or alpha, of a COMBINE or COMBINE4 environment (ARB_texture_env_combine, table 3.20).

    ``sources``, ``operands``: as many as ``function`` takes, or more: 1 for REPLACE, 3 for INTERPOLATE, 2 for
    the others; 4 with COMBINE4. ``scale``: RGB_SCALE or ALPHA_SCALE, 1, 2 or 4.
    """

    function: CombineFunction = CombineFunction.MODULATE
    sources: tuple[CombineSource, ...] = (
        CombineSource.TEXTURE,
        CombineSource.PREVIOUS,
        CombineSource.CONSTANT,
    )
    operands: tuple[CombineOperand, ...] = (
        CombineOperand.SRC_COLOR,
        CombineOperand.SRC_COLOR,
        CombineOperand.SRC_ALPHA,
    )
    scale: float = 1.0


@dataclass(frozen=True, slots=True)
class TextureEnvironment:
    """How a texture unit combines its texel with the colour that reaches it (section 3.8.9).

    ``color``: TEXTURE_ENV_COLOR. ``rgb``, ``alpha``: of COMBINE and COMBINE4 alone. Register combiners take
    the place of every unit's environment.
    """

    mode: TextureEnvironmentMode = TextureEnvironmentMode.MODULATE
    color: Color = (0.0, 0.0, 0.0, 0.0)
    rgb: Combine = Combine()
    alpha: Combine = Combine(operands=(CombineOperand.SRC_ALPHA,) * 3)


def _combine(words: Sequence[str], alpha: bool, scale: float) -> Combine:
    """A half of an environment, of its function's name and its arguments."""
    function, *arguments = words
    if function not in CombineFunction.__members__:
        raise ValueError(
            f"an environment has no function {function!r}; it has {', '.join(CombineFunction.__members__)}."
        )
    sources, operands = [], []
    for argument in arguments:
        name = argument.removeprefix("1 - ")
        inverted = name != argument
        of_alpha = alpha or name.endswith(".a")
        name = name.removesuffix(".a")
        if name == "1":
            name, inverted = "ZERO", not inverted
        if name not in CombineSource.__members__:
            raise ValueError(
                f"{function} has an argument {argument!r}, which names no source; sources are "
                f"{', '.join(CombineSource.__members__)}, and 1. Write 'TEXTURE', 'TEXTURE.a', '1 - TEXTURE' "
                "or '1 - TEXTURE.a', for instance."
            )
        sources.append(CombineSource[name])
        kind = "SRC_ALPHA" if of_alpha else "SRC_COLOR"
        operands.append(CombineOperand[f"ONE_MINUS_{kind}" if inverted else kind])
    return Combine(CombineFunction[function], tuple(sources), tuple(operands), scale)


def environment(
    rgb: Sequence[str],
    alpha: Sequence[str] = ("MODULATE", "TEXTURE", "PREVIOUS"),
    *,
    color: Color = (0.0, 0.0, 0.0, 0.0),
    rgb_scale: float = 1.0,
    alpha_scale: float = 1.0,
) -> TextureEnvironment:
    """A COMBINE environment in words: each half is its function and its arguments, by OpenGL's names.

    An argument is a source ("TEXTURE", "CONSTANT", "PRIMARY_COLOR", "PREVIOUS", "TEXTURE0" ..., "ZERO"), its
    alpha ("TEXTURE.a"), or one minus it ("1 - TEXTURE", "1 - TEXTURE.a"); "1" is one minus ZERO. In the alpha
    half every source is its alpha. Halves of four arguments make a COMBINE4 environment; then both have four.

    >>> faded = environment(("INTERPOLATE", "TEXTURE", "PREVIOUS", "CONSTANT.a"), color=(0, 0, 0, 0.25))
    >>> faded.rgb.operands
    (<CombineOperand.SRC_COLOR: 0>, <CombineOperand.SRC_COLOR: 0>, <CombineOperand.SRC_ALPHA: 2>)

    Raises ValueError for names that are not OpenGL's, for what is no sequence of names, and for halves of
    which one alone has four arguments.
    """
    for name, half in (("rgb", rgb), ("alpha", alpha)):
        words = (
            isinstance(half, Sequence) and not isinstance(half, str) and [isinstance(w, str) for w in half]
        )
        if not (words and all(words)):
            raise ValueError(
                f"the environment's {name} half is {half!r}; give the names of its function and its "
                "arguments, ('MODULATE', 'TEXTURE', 'PREVIOUS') for instance."
            )
    four = [len(half) == 5 for half in (rgb, alpha)]
    if any(four) and not all(four):
        raise ValueError(
            "one half of the environment has four arguments, which makes it COMBINE4, and the other has "
            "not; give both four, with 'ZERO' and '1' for those that are not needed."
        )
    return TextureEnvironment(
        mode=TextureEnvironmentMode.COMBINE4 if all(four) else TextureEnvironmentMode.COMBINE,
        color=color,
        rgb=_combine(rgb, False, rgb_scale),
        alpha=_combine(alpha, True, alpha_scale),
    )


@dataclass(frozen=True, slots=True)
class ColorKey:
    """A color key: texels that equal ``color``, stored as the texture's format stores it, are treated as
    ``operation`` says.

    Source: Direct3D's color keys (D3DRENDERSTATE_COLORKEYENABLE); docs/numbers.md, section 7.
    """

    color: Color
    operation: ColorKeyOperation = ColorKeyOperation.KILL


@dataclass(frozen=True, slots=True)
class TextureUnit:
    """One texture unit: which texture object it reads, how, and where its coordinates come from.

    ``texture``: the name under which the scene or a CopyTexImage command stored it; None where the unit's
    texture shader stage reads none. ``lod_bias`` is
    EXT_texture_lod_bias's per-unit bias. ``coordinates``: which of the mesh's texture coordinate sets feeds
    the unit. ``gen``: generation for s, t, r, q. ``cylinder_wrap``: for s, t, r, q whether a triangle's
    coordinates are brought within one half of each other before they are iterated (Direct3D's texture
    wrapping). ``coord_replace``: NV_point_sprite's. ``environment``: where register combiners are disabled.
    ``color_table``: SGI_texture_color_table's, applied to what the unit's filter gives. On a machine of the
    future, ``spherical_coordinates``: (s, t, r) is a unit vector that turns steadily from vertex to vertex.
    ``color_key``: of texels that are left out.
    """

    texture: str | None
    sampler: Sampler = Sampler()
    lod_bias: float = 0.0
    coordinates: int = 0
    gen: tuple[TexGen, TexGen, TexGen, TexGen] = (TexGen(), TexGen(), TexGen(), TexGen())
    matrix: Matrix = IDENTITY
    cylinder_wrap: tuple[bool, bool, bool, bool] = (False, False, False, False)
    coord_replace: bool = False
    environment: TextureEnvironment = TextureEnvironment()
    color_table: ColorTable | None = None
    spherical_coordinates: bool = False
    color_key: ColorKey | None = None


@dataclass(frozen=True, slots=True)
class TextureShaderStage:
    """NV_texture_shader: what a texture unit does with its coordinates and with earlier stages' texels.

    ``previous_texture_input``: the unit whose texel offsets, addresses or is multiplied.
    ``offset_texture_matrix``: (a1, a2, a3, a4), by columns. ``constant_eye``: CONST_EYE.
    ``roughness``: the unit whose texel holds D = [d_1 d_2; 0 d_3], how far the bumps that a texel of the
    previous texture input stands for deviate from it: d_1 in red and d_3 in blue, unsigned, d_2 in green,
    biased; times ``roughness_scale``, in the units of the offsets or of the dot products' vector. The lookup
    is filtered over what pixel and roughness cover; None: not filtered.
    """

    operation: TextureShaderOperation = TextureShaderOperation.NONE
    previous_texture_input: int = 0
    cull_modes: tuple[CullMode, CullMode, CullMode, CullMode] = (CullMode.GEQUAL,) * 4
    offset_texture_matrix: Vector4 = (1.0, 0.0, 0.0, 1.0)
    offset_texture_scale: float = 1.0
    offset_texture_bias: float = 0.0
    dot_product_mapping: DotProductMapping = DotProductMapping.UNSIGNED_IDENTITY
    constant_eye: tuple[float, float, float] = (0.0, 0.0, -1.0)
    roughness: int | None = None
    roughness_scale: float = 1.0


@dataclass(frozen=True, slots=True)
class CombinerInput:
    """A combiner variable: register, mapping, component usage; ``meaning``: what a pixel shader means by it,
    of which the ideal alone takes notice.
    """

    register: Register = Register.ZERO
    mapping: Mapping = Mapping.UNSIGNED_IDENTITY
    usage: ComponentUsage = ComponentUsage.RGB
    meaning: Meaning = Meaning.PLAIN


_ONE_RGB = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
_ZERO_ALPHA = CombinerInput(Register.ZERO, usage=ComponentUsage.ALPHA)


@dataclass(frozen=True, slots=True)
class RGBPortion:
    """RGB portion of a general combiner. Defaults: table NV_register_combiners.5, with the outputs the
    extension initialises (AB and CD discarded, the sum into SPARE0).

    ``ab_blue_to_alpha``, ``cd_blue_to_alpha`` (NV2A): the output's blue goes to its register's alpha as well.
    ``function``: what a machine of the future puts in the place of the sum.
    """

    a: CombinerInput = CombinerInput(Register.PRIMARY_COLOR)
    b: CombinerInput = _ONE_RGB
    c: CombinerInput = CombinerInput()
    d: CombinerInput = CombinerInput()
    ab_output: Register = Register.DISCARD
    cd_output: Register = Register.DISCARD
    sum_output: Register = Register.SPARE0
    scale: CombinerScale = CombinerScale.NONE
    bias: CombinerBias = CombinerBias.NONE
    ab_dot_product: bool = False
    cd_dot_product: bool = False
    mux_sum: bool = False
    ab_blue_to_alpha: bool = False
    cd_blue_to_alpha: bool = False
    function: CombinerFunction = CombinerFunction.NONE


@dataclass(frozen=True, slots=True)
class AlphaPortion:
    """Alpha portion of a general combiner; component usage ALPHA or BLUE. ``function``: as RGBPortion's."""

    a: CombinerInput = CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA)
    b: CombinerInput = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA)
    c: CombinerInput = _ZERO_ALPHA
    d: CombinerInput = _ZERO_ALPHA
    ab_output: Register = Register.DISCARD
    cd_output: Register = Register.DISCARD
    sum_output: Register = Register.SPARE0
    scale: CombinerScale = CombinerScale.NONE
    bias: CombinerBias = CombinerBias.NONE
    mux_sum: bool = False
    function: CombinerFunction = CombinerFunction.NONE


@dataclass(frozen=True, slots=True)
class CombinerLookup:
    """On a machine of the future: after a general combiner, texture unit ``unit``'s register takes the texel
    that its texture has, at level 0, where (s, t, r) are ``register``'s red, green and blue.
    """

    unit: int
    register: Register = Register.SPARE0


@dataclass(frozen=True, slots=True)
class GeneralCombiner:
    """One general combiner stage. ``constant_color0/1``: per-stage constants (NV_register_combiners2) where
    the profile has them; None: the program's own. ``lookup``: None everywhere but on a machine of the future.
    """

    rgb: RGBPortion = RGBPortion()
    alpha: AlphaPortion = AlphaPortion()
    constant_color0: Color | None = None
    constant_color1: Color | None = None
    lookup: CombinerLookup | None = None


@dataclass(frozen=True, slots=True)
class FinalCombiner:
    """Final combiner, table NV_register_combiners.6. Mappings UNSIGNED_IDENTITY and UNSIGNED_INVERT only."""

    a: CombinerInput = CombinerInput(Register.FOG, usage=ComponentUsage.ALPHA)
    b: CombinerInput = CombinerInput(Register.SPARE0_PLUS_SECONDARY_COLOR)
    c: CombinerInput = CombinerInput(Register.FOG)
    d: CombinerInput = CombinerInput()
    e: CombinerInput = CombinerInput()
    f: CombinerInput = CombinerInput()
    g: CombinerInput = CombinerInput(Register.SPARE0, usage=ComponentUsage.ALPHA)


@dataclass(frozen=True, slots=True)
class RegisterCombiners:
    """The whole of NV_register_combiners: one to eight general combiners (as the profile allows) and the
    final.

    ``mux_select``, and ``invert_spare0``, ``invert_secondary_color``: one minus that term of
    SPARE0_PLUS_SECONDARY_COLOR (NV2A).
    """

    general: tuple[GeneralCombiner, ...] = (GeneralCombiner(),)
    final: FinalCombiner = FinalCombiner()
    constant_color0: Color = (0.0, 0.0, 0.0, 0.0)
    constant_color1: Color = (0.0, 0.0, 0.0, 0.0)
    color_sum_clamp: bool = True
    mux_select: MuxSelect = MuxSelect.MSB
    invert_spare0: bool = False
    invert_secondary_color: bool = False


@dataclass(frozen=True, slots=True)
class FogRegisters:
    """The NV2A's own fog parameters: the factor is a function of ``multiplier * coordinate + bias``.

    LINEAR fog is that sum minus 1; EXP fog is 2^(16 x) and EXP2 fog 2^(-32 x^2) of the sum minus 1.5, x.
    ``plane``: of PLANAR and ABSOLUTE_PLANAR generation, in eye coordinates. ``absolute``: the magnitude (the
    modes with _ABS), of LINEAR's coordinate and EXP's x; EXP2 has no sign. After a vertex program the
    coordinate is the vertices' own, which may be infinite or no number.
    """

    bias: float = 1.0
    multiplier: float = 0.0
    generation: FogGeneration = FogGeneration.PLANAR
    plane: Vector4 = (0.0, 0.0, 1.0, 0.0)
    absolute: bool = False


@dataclass(frozen=True, slots=True)
class Fog:
    """Section 3.10. None in PassState: fog disabled (the FOG register is then the color with factor one).

    ``registers``: take the place of ``density``, ``start``, ``end`` and ``coordinate_source``.
    """

    mode: FogMode = FogMode.EXP
    density: float = 1.0
    start: float = 0.0
    end: float = 1.0
    color: Color = (0.0, 0.0, 0.0, 0.0)
    coordinate_source: FogCoordinateSource = FogCoordinateSource.FRAGMENT_DEPTH
    registers: FogRegisters | None = None


@dataclass(frozen=True, slots=True)
class RasterPosition:
    """Section 2.12: where a rectangle of pixels is drawn, and what its fragments have in common.

    ``position``: object coordinates, which with the values below go through the vertex state of the command
    as a vertex does: transformation, lighting, texture coordinate generation and matrices. One outside the
    view volume or a clip plane is invalid, and nothing is drawn. ``weight``: as a mesh's. ``window``
    (ARB_window_pos): the position is window x, y (y up) and a depth in [0, 1] of the viewport's depth range;
    it is always valid, and colours, texture and fog coordinates are taken as they are. ``move``: added to
    window x and y, as Bitmap does to the position that commands after it find.
    """

    position: Vector4 = (0.0, 0.0, 0.0, 1.0)
    window: bool = False
    move: tuple[float, float] = (0.0, 0.0)
    color: Color = (1.0, 1.0, 1.0, 1.0)
    secondary_color: Color = (0.0, 0.0, 0.0, 0.0)
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    texture_coordinates: tuple[Vector4, ...] = ()
    fog_coordinate: float = 0.0
    weight: float = 1.0

    def moved(self, x: float, y: float) -> "RasterPosition":
        """The position that is left by a Bitmap which moves it by (x, y) pixels."""
        return replace(self, move=(self.move[0] + x, self.move[1] + y))


@dataclass(frozen=True, slots=True)
class PixelTexture:
    """SGIX_pixel_texture, SGIS_pixel_texture: colour groups become texture coordinates, R, G, B, A as s, t,
    r, q, and lambda is zero.

    ``mode``: SGIX_pixel_texture's; None: SGIS_pixel_texture with ``rgb_source`` and ``alpha_source``.
    SGIX_impact_pixel_texture: with ``volumes`` the unit's 3D texture is four-dimensional: its layers are so
    many volumes, one behind the other, of which q, instead of dividing, chooses one as ``q_filter`` says.
    ``alpha_replace``: eight bits of the group's alpha, the most (MS) or the least significant (LS) of twelve,
    take the place of the texel's alpha, before a texture color table.
    """

    mode: PixelTexGenMode | None = PixelTexGenMode.NONE
    rgb_source: PixelFragmentSource = PixelFragmentSource.PIXEL_GROUP_COLOR
    alpha_source: PixelFragmentSource = PixelFragmentSource.PIXEL_GROUP_COLOR
    volumes: int | None = None
    q_filter: PixelTexGenQ = PixelTexGenQ.ROUND
    alpha_replace: bool = False
    alpha: PixelTexGenAlpha = PixelTexGenAlpha.MS


# --------------------------------------------------------------- per-fragment operations (chapter 4)


@dataclass(frozen=True, slots=True)
class Scissor:
    """Section 4.1.2, in window coordinates (y up). None in PassState: disabled."""

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class WindowClip:
    """The NV2A's window clip rectangles (later EXT_window_rectangles), in window coordinates.

    A fragment is kept inside any of the rectangles, or, ``exclusive``, outside all of them. None in
    PassState: disabled.
    """

    rectangles: tuple[Scissor, ...]
    exclusive: bool = False


@dataclass(frozen=True, slots=True)
class AlphaTest:
    """Section 4.1.3. None in PassState: disabled."""

    function: ComparisonFunction = ComparisonFunction.ALWAYS
    reference: float = 0.0


@dataclass(frozen=True, slots=True)
class StencilTest:
    """Section 4.1.4. None in PassState: disabled."""

    function: ComparisonFunction = ComparisonFunction.ALWAYS
    reference: int = 0
    mask: int = 0xFF
    fail: StencilOperation = StencilOperation.KEEP
    depth_fail: StencilOperation = StencilOperation.KEEP
    depth_pass: StencilOperation = StencilOperation.KEEP
    write_mask: int = 0xFF


@dataclass(frozen=True, slots=True)
class DepthTest:
    """Section 4.1.5. None in PassState: disabled (and then depth is not written either)."""

    function: ComparisonFunction = ComparisonFunction.LESS
    write: bool = True


@dataclass(frozen=True, slots=True)
class DepthClamp:
    """NV_depth_clamp, with the NV2A's limits. None in PassState: disabled.

    Nothing is clipped at the near and far planes; instead every fragment's depth is clamped to ``minimum``
    and ``maximum``, or, with ``cull``, the fragment ends where its depth lies outside. The limits are in
    depth units (the values of a float format; clip w with W buffering); ``maximum`` None: the farthest.
    """

    minimum: float = 0.0
    maximum: float | None = None
    cull: bool = False


@dataclass(frozen=True, slots=True)
class Blending:
    """Section 4.1.6. None in PassState: disabled."""

    source: BlendFactor = BlendFactor.ONE
    destination: BlendFactor = BlendFactor.ZERO
    equation: BlendEquation = BlendEquation.FUNC_ADD
    color: Color = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ColorMask:
    """Section 4.2.2."""

    red: bool = True
    green: bool = True
    blue: bool = True
    alpha: bool = True


@dataclass(frozen=True, slots=True)
class PassState:
    """Everything that a Draw needs to know.

    ``texture_units``: unit i reads ``texture_units[i]``; None: the unit is disabled.
    ``register_combiners`` None: NV_register_combiners disabled; the fragment's primary colour then goes
    through the texture units' environments, takes the secondary colour if ``color_sum``, then fog.
    ``perspective_correction`` False: Hint(PERSPECTIVE_CORRECTION_HINT, FASTEST), where a machine follows it:
    colours and coordinates are linear on the screen.
    ``logic_op`` None: disabled.
    ``texture_shader``: stage i is texture unit i's, NONE where there are fewer; None: TEXTURE_SHADER is
    disabled, and each enabled unit samples its texture.
    ``ycbcr_conversion``: every unit that reads a texture has Y, Cb and Cr in its red, green and blue: they
    become RGB on their way to the combiners; a texture shader's other stages read them as they are.
    ``w_buffering``: a fragment's depth is its clip w, in depth units, instead of its window z.
    ``draw_buffer``: which colour buffer is written (and blended with).
    On a machine of the future, ``evaluate_before_filtering``: the combiners are evaluated at each texel that
    the texture units' filters read, and their results are filtered; ``spherical_primary_color``,
    ``spherical_secondary_color``: the colour is a unit vector, as EXPAND_NORMAL reads it, that turns steadily
    from vertex to vertex.
    """

    vertex: VertexState = VertexState()
    polygon: PolygonState = PolygonState()
    texture_units: tuple[TextureUnit | None, ...] = ()
    register_combiners: RegisterCombiners | None = None
    color_sum: bool = False
    fog: Fog | None = None
    scissor: Scissor | None = None
    alpha_test: AlphaTest | None = None
    stencil_test: StencilTest | None = None
    depth_test: DepthTest | None = None
    blending: Blending | None = None
    logic_op: LogicOperation | None = None
    color_mask: ColorMask = field(default_factory=ColorMask)
    texture_shader: tuple[TextureShaderStage, ...] | None = None
    perspective_correction: bool = True
    point: PointState = PointState()
    line: LineState = LineState()
    window_clip: WindowClip | None = None
    depth_clamp: DepthClamp | None = None
    ycbcr_conversion: bool = False
    w_buffering: bool = False
    draw_buffer: ColorBuffer = ColorBuffer.BACK
    evaluate_before_filtering: bool = False
    spherical_primary_color: bool = False
    spherical_secondary_color: bool = False


_NORMAL_MODES = frozenset({TexGenMode.SPHERE_MAP, TexGenMode.NORMAL_MAP, TexGenMode.REFLECTION_MAP})


def texgen_modes(state: PassState) -> set[TexGenMode]:
    """The modes by which units generate texture coordinates."""
    return {gen.mode for unit in state.texture_units if unit is not None for gen in unit.gen}


def needs_normals(state: PassState) -> bool:
    """Whether the state reads the vertices' normals: lights, or a texture coordinate generated from them."""
    lighting = state.vertex.lighting
    lit = lighting is not None and len(lighting.lights) > 0
    return lit or not _NORMAL_MODES.isdisjoint(texgen_modes(state))

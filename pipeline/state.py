"""Pass state: frozen dataclasses in the words of the OpenGL 1.2.1 specification, grouped by its sections.

There is no current state. Each Draw carries a whole ``PassState``. Every default is the OpenGL initial value.
Change a state with ``dataclasses.replace``. Equal states compare equal.

These classes check almost nothing. ``fixedpipe.pipeline.validation`` refuses what a machine cannot hold and
what no machine could mean, for instance three outputs to one register.

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
    """The viewport transformation (section 2.10.1).

    A width and height of None mean the whole framebuffer.
    """

    x: int = 0
    y: int = 0
    width: int | None = None
    height: int | None = None
    near: float = 0.0
    far: float = 1.0


@dataclass(frozen=True, slots=True)
class TexGen:
    """Texture coordinate generation for one coordinate (section 2.10.4).

    ``plane`` is the object plane, or the eye plane in eye coordinates. OpenGL transforms an eye plane by the
    inverse modelview matrix when it is specified; here the caller does that.
    """

    mode: TexGenMode = TexGenMode.NONE
    plane: Vector4 = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Material:
    """The material of one face (table 2.8).

    ``specular_coefficients``, for a lighting unit alone: (a, b, c) of two rational functions (x + a)/(b x +
    c). They replace x to the power ``shininess``. The first takes the cosine to a given half vector, the
    second the cosine's square for every other light. None: the powers themselves.
    """

    ambient: Color = (0.2, 0.2, 0.2, 1.0)
    diffuse: Color = (0.8, 0.8, 0.8, 1.0)
    specular: Color = (0.0, 0.0, 0.0, 1.0)
    emission: Color = (0.0, 0.0, 0.0, 1.0)
    shininess: float = 0.0
    specular_coefficients: tuple[float, float, float, float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Spot:
    """A lighting unit's spotlight.

    x = ``axis`` . (unit vector to the light, 1), at most 1. The light is multiplied by (x + a)/(b x + c)
    where x + a is positive and x is not negative, and by 0 elsewhere. ``coefficients`` are a, b and c.
    """

    axis: Vector4
    coefficients: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Light:
    """One light (table 2.8). Position and spot direction are in eye coordinates.

    A light whose ``position[3]`` is 0 is directional.

    These fields are for a lighting unit alone:

    - ``range``: the greatest distance that the light reaches.
    - ``half_vector``: a directional light's half vector. The unit then uses it, and the position's x, y and
      z, without normalizing them.
    - ``spot``: replaces spot direction, exponent and cutoff. None: the driver computes it from them (N2.26).
    - ``back_ambient``, ``back_diffuse``, ``back_specular``: the colours for back faces. None: those for front
      faces.
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
    """Section 2.13.3: the material parameters that follow the vertex colour, and on which face."""

    face: Face = Face.FRONT_AND_BACK
    parameter: ColorMaterialParameter = ColorMaterialParameter.AMBIENT_AND_DIFFUSE


@dataclass(frozen=True, slots=True)
class ColorSources:
    """A lighting unit's colour material: where each colour of a face's material comes from.

    An emission from the vertices is multiplied by the material's emission, unless the ambient colour comes
    from the vertices too.
    """

    emission: ColorSource = ColorSource.MATERIAL
    ambient: ColorSource = ColorSource.MATERIAL
    diffuse: ColorSource = ColorSource.MATERIAL
    specular: ColorSource = ColorSource.MATERIAL


@dataclass(frozen=True, slots=True)
class Lighting:
    """Section 2.13.1. ``lights`` holds the enabled lights only. None in PassState: lighting is disabled.

    These fields are for a lighting unit alone:

    - ``front_sources``, ``back_sources``: replace ``color_material``.
    - ``back_model_ambient``: the model's ambient colour for back faces. None: that for front faces.
    - ``viewer_direction``: the direction to a viewer that is not local.
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

    ``matrix`` takes object coordinates to device pixels (y down) and depth units, each times w. ``offset`` is
    added to device x, y and depth after the division by w.
    """

    matrix: Matrix = IDENTITY
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class VertexState:
    """Transformation, lighting and clipping (sections 2.10 to 2.13).

    - ``clip_planes``: the enabled user planes, in eye coordinates.
    - ``normalize``, ``rescale_normal``: NORMALIZE and RESCALE_NORMAL.
    - ``composite``: replaces ``projection`` and ``viewport``. The modelview matrix still gives eye
      coordinates.
    - ``modelview1`` (MODELVIEW1_EXT): the second matrix of vertex weighting; None disables
      VERTEX_WEIGHTING_EXT. A vertex of weight w has the eye coordinates and the normal w times those by
      ``modelview`` plus 1 - w times those by ``modelview1``. Both matrices must have the same last row. A
      composite matrix then takes eye coordinates.
    - ``stage``: PROGRAM_RESULTS means that the mesh holds what a vertex program wrote (NV_vertex_program's
      o[HPOS] after the viewport, o[COL0], o[TEX0] ...). Positions are window x and y (y up), z in
      depth-buffer units and clip w. Colours, texture and fog coordinates reach rasterization unchanged. The
      other fields must keep their defaults, except ``two_side`` and ``secondary_color``.
    - ``two_side`` (VERTEX_PROGRAM_TWO_SIDE): back-facing triangles take the mesh's back colours.
    - ``secondary_color``: where the secondary colour comes from. A machine with a lighting unit uses it in
      both stages.
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
        """The modelview matrix, or the two of vertex weighting."""
        return (self.modelview,) if self.modelview1 is None else (self.modelview, self.modelview1)

    @property
    def depth_units(self) -> bool:
        """Whether window z is in depth-buffer units instead of [0, 1]."""
        return self.stage == VertexStage.PROGRAM_RESULTS or self.composite is not None


# --------------------------------------------------------------------------- rasterization (chapter 3)


@dataclass(frozen=True, slots=True)
class PointParameters:
    """Point sizes that shrink with distance: ``(1 / sqrt(a + b d + c d^2) + bias) * range + minimum``.

    d is the vertex's distance from the eye and (a, b, c) is ``attenuation``. The term in parentheses is
    clamped to [0, 1]. ``PointState.size`` has no effect. The NV2A is programmed in this form
    (SET_POINT_PARAMS).

    EXT_point_parameters' sizes from m to M, for a point of size s, are: range M - m, minimum m,
    bias -m / (M - m), and the extension's attenuation times ((M - m) / s)^2.
    """

    attenuation: tuple[float, float, float] = (1.0, 0.0, 0.0)
    bias: float = 0.0
    range: float = 0.0
    minimum: float = 1.0


@dataclass(frozen=True, slots=True)
class PointState:
    """Section 3.3, EXT_point_parameters, NV_point_sprite.

    - ``sprite`` (POINT_SPRITE_NV): units with ``coord_replace`` get coordinates that run over the point.
    - ``parameters``: None gives every point ``size``.
    - ``program_size`` (VERTEX_PROGRAM_POINT_SIZE_NV): sizes come from the mesh, where a vertex program wrote
      them.
    """

    size: float = 1.0
    sprite: bool = False
    parameters: PointParameters | None = None
    program_size: bool = False


@dataclass(frozen=True, slots=True)
class LineState:
    """Section 3.4.

    - ``stipple`` (section 3.4.2): (factor, pattern). The factor is 1 to 256. The pattern has 16 bits, used
      from the lowest. None: disabled.
    - ``smooth``: LINE_SMOOTH (section 3.4.4), for lines rasterized as rectangles.
    """

    width: float = 1.0
    rasterization: LineRasterization = LineRasterization.STEPS
    stipple: tuple[int, int] | None = None
    smooth: bool = False


@dataclass(frozen=True, slots=True)
class PolygonState:
    """Section 3.5 (culling, facing, polygon mode, stipple, depth offset) and section 2.13.7 (shade model).

    - ``stipple``: PolygonStipple's 32 rows of 4 bytes, bottom row first; the highest bit of a row's first
      byte is the leftmost pixel. It repeats over the window. None: disabled. Polygons drawn as points or
      lines ignore it.
    - ``smooth``: POLYGON_SMOOTH (section 3.5.2) multiplies alpha by the share of the pixel that a triangle
      covers.
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
    """The components of a texture's texels that are two's complement bytes, s/127.

    NV_texture_shader has such formats; the NV2A reads any texture so. A signed format needs none of these.
    """

    red: bool = False
    green: bool = False
    blue: bool = False
    alpha: bool = False


def refuse_whole_numbers(what: str, numbers: Iterable[float]) -> None:
    """Raise ValueError where a tuple of colour components holds a whole number other than 0 and 1.

    ``what`` begins the message. Values that are not tuples are left to validation.
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

    - ``entries``: 2**n colours.
    - ``base_format``: which components the table replaces, and with what (table 3.14). An INTENSITY table,
      for instance, replaces all four by an entry's first.
    - ``bits``: each entry's components are rounded to this many bits, to nearest. None: they stay as they
      are.

    Raises ValueError for whole numbers other than 0 and 1: they are bytes or words, where 1.0 is 255 or
    65535.
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

    - ``compare_mode``, ``compare_function`` (ARB_shadow, EXT_shadow_funcs): each depth texel becomes 1 where
      "reference function texel" holds and 0 elsewhere, before filtering. With NONE the depths are read as
      colours with ``border_color``'s red as the border; register combiners read them as alpha alone.
    - ``compare_fail_value`` (SGIX_shadow_ambient, ARB_shadow_ambient): replaces that 0.
    - ``depth_texture_mode`` (ARB_depth_texture): a depth texture is LUMINANCE, INTENSITY or ALPHA. None: the
      machine's default.
    - ``max_anisotropy``: EXT_texture_filter_anisotropic.
    - ``max_probes``: the most probes of footprint assembly, a power of two; 1 disables it. With
      ``exact_probes`` a footprint takes as many probes as cover it, up to ``max_probes``, and neither is a
      power of two.
    - ``base_level`` (TEXTURE_BASE_LEVEL, SGIS_texture_lod): the level that is sampled as level 0. ``min_lod``
      and ``max_lod`` count from it; ``max_level`` counts from level 0.
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

    ``sources`` and ``operands`` have at least as many members as ``function`` takes: 1 for REPLACE, 3 for
    INTERPOLATE, 2 for the others, and always 4 with COMBINE4. ``scale`` is RGB_SCALE or ALPHA_SCALE: 1, 2 or
    4.
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

    ``color`` is TEXTURE_ENV_COLOR. Only COMBINE and COMBINE4 use ``rgb`` and ``alpha``. Register combiners
    replace the environments of all units.
    """

    mode: TextureEnvironmentMode = TextureEnvironmentMode.MODULATE
    color: Color = (0.0, 0.0, 0.0, 0.0)
    rgb: Combine = Combine()
    alpha: Combine = Combine(operands=(CombineOperand.SRC_ALPHA,) * 3)


def _combine(words: Sequence[str], alpha: bool, scale: float) -> Combine:
    """A half of an environment from its function's name and its arguments' names."""
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
    """A COMBINE environment in words: each half names its function and its arguments, by OpenGL's names.

    An argument is a source ("TEXTURE", "CONSTANT", "PRIMARY_COLOR", "PREVIOUS", "TEXTURE0" ..., "ZERO"), its
    alpha ("TEXTURE.a"), or one minus either ("1 - TEXTURE", "1 - TEXTURE.a"). "1" is one minus ZERO. In the
    alpha half every source means its alpha. If one half has four arguments, both must, and the environment is
    COMBINE4.

    >>> faded = environment(("INTERPOLATE", "TEXTURE", "PREVIOUS", "CONSTANT.a"), color=(0, 0, 0, 0.25))
    >>> faded.rgb.operands
    (<CombineOperand.SRC_COLOR: 0>, <CombineOperand.SRC_COLOR: 0>, <CombineOperand.SRC_ALPHA: 2>)

    Raises ValueError for a name that is not OpenGL's, for a half that is no sequence of names, and where only
    one half has four arguments.
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
    """A color key: the unit treats texels that equal ``color`` as ``operation`` says.

    The comparison uses the texture's stored texels. Source: Direct3D's color keys
    (D3DRENDERSTATE_COLORKEYENABLE); docs/numbers.md, section 7.
    """

    color: Color
    operation: ColorKeyOperation = ColorKeyOperation.KILL


@dataclass(frozen=True, slots=True)
class TextureUnit:
    """One texture unit: the texture object that it reads, how, and where its coordinates come from.

    - ``texture``: the name under which the scene or a CopyTexImage command stored the texture. None where the
      unit's texture shader stage reads no texture.
    - ``lod_bias``: EXT_texture_lod_bias.
    - ``coordinates``: the number of the mesh's texture coordinate set that feeds the unit.
    - ``gen``: coordinate generation for s, t, r and q.
    - ``cylinder_wrap``, for s, t, r and q: whether a triangle's coordinates are brought within one half of
      each other before iteration (Direct3D's texture wrapping).
    - ``coord_replace``: NV_point_sprite.
    - ``environment``: used where register combiners are disabled.
    - ``color_table``: SGI_texture_color_table, applied to the filtered texel.
    - ``spherical_coordinates``, on a machine of the future: (s, t, r) is a unit vector that turns at a steady
      rate from vertex to vertex.
    - ``color_key``: which texels to leave out.
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

    - ``previous_texture_input``: the unit whose texel this stage uses as offset, address or factor.
    - ``offset_texture_matrix``: (a1, a2, a3, a4), by columns.
    - ``constant_eye``: CONST_EYE.
    - ``roughness``: the unit whose texel says how far the bumps deviate that one texel of the previous
      texture input stands for. The texel holds D = [d_1 d_2; 0 d_3]: d_1 in red and d_3 in blue, unsigned,
      and d_2 in green, biased. D times ``roughness_scale`` has the units of the offsets, or of the dot
      products' vector. The lookup is filtered over the area of pixel and roughness together. None: no such
      filter.
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
    """A combiner variable: register, mapping and component usage.

    ``meaning`` says what a pixel shader means by the value. Only the ideal uses it.
    """

    register: Register = Register.ZERO
    mapping: Mapping = Mapping.UNSIGNED_IDENTITY
    usage: ComponentUsage = ComponentUsage.RGB
    meaning: Meaning = Meaning.PLAIN


_ONE_RGB = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
_ZERO_ALPHA = CombinerInput(Register.ZERO, usage=ComponentUsage.ALPHA)


@dataclass(frozen=True, slots=True)
class RGBPortion:
    """The RGB portion of a general combiner (table NV_register_combiners.5).

    The default outputs are the extension's initial ones: AB and CD are discarded, the sum goes to SPARE0.
    ``ab_blue_to_alpha`` and ``cd_blue_to_alpha`` (NV2A) also write the output's blue to its register's alpha.
    ``function`` is what a machine of the future computes instead of the sum.
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
    """The alpha portion of a general combiner. Its inputs' component usage is ALPHA or BLUE.

    ``function`` has the meaning of ``RGBPortion.function``.
    """

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
    """A texture lookup after a general combiner, on a machine of the future.

    The register of texture unit ``unit`` takes the texel of its texture's level 0 at (s, t, r), which are
    ``register``'s red, green and blue.
    """

    unit: int
    register: Register = Register.SPARE0


@dataclass(frozen=True, slots=True)
class GeneralCombiner:
    """One general combiner.

    ``constant_color0`` and ``constant_color1`` are the stage's own constants (NV_register_combiners2), on a
    machine that has them. None: the program's constants. ``lookup`` is for a machine of the future alone.
    """

    rgb: RGBPortion = RGBPortion()
    alpha: AlphaPortion = AlphaPortion()
    constant_color0: Color | None = None
    constant_color1: Color | None = None
    lookup: CombinerLookup | None = None


@dataclass(frozen=True, slots=True)
class FinalCombiner:
    """The final combiner (table NV_register_combiners.6).

    Its mappings are UNSIGNED_IDENTITY and UNSIGNED_INVERT only.
    """

    a: CombinerInput = CombinerInput(Register.FOG, usage=ComponentUsage.ALPHA)
    b: CombinerInput = CombinerInput(Register.SPARE0_PLUS_SECONDARY_COLOR)
    c: CombinerInput = CombinerInput(Register.FOG)
    d: CombinerInput = CombinerInput()
    e: CombinerInput = CombinerInput()
    f: CombinerInput = CombinerInput()
    g: CombinerInput = CombinerInput(Register.SPARE0, usage=ComponentUsage.ALPHA)


@dataclass(frozen=True, slots=True)
class RegisterCombiners:
    """NV_register_combiners as a whole: one to eight general combiners (the profile says how many) and the
    final.

    ``mux_select``, ``invert_spare0`` and ``invert_secondary_color`` are the NV2A's. The two ``invert_``
    fields replace that term of SPARE0_PLUS_SECONDARY_COLOR by one minus it.
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
    """The NV2A's own fog parameters. The factor is a function of x = ``multiplier * coordinate + bias``.

    LINEAR fog is x - 1. EXP fog is 2^(16 y) and EXP2 fog is 2^(-32 y^2), where y = x - 1.5.

    - ``plane``: for PLANAR and ABSOLUTE_PLANAR generation, in eye coordinates.
    - ``absolute``: take the magnitude (the modes with _ABS) of LINEAR's coordinate and of EXP's y. EXP2 has
      no sign.

    After a vertex program the coordinate is the vertex's own. It may be infinite or no number.
    """

    bias: float = 1.0
    multiplier: float = 0.0
    generation: FogGeneration = FogGeneration.PLANAR
    plane: Vector4 = (0.0, 0.0, 1.0, 0.0)
    absolute: bool = False


@dataclass(frozen=True, slots=True)
class Fog:
    """Fog (section 3.10): a fragment's colour is blended with ``color`` by a factor of its fog coordinate.

    ``density``, which is not negative, belongs to EXP and EXP2, and ``start`` and ``end`` to LINEAR.
    ``registers`` replace these and ``coordinate_source``. None in PassState disables fog, and the combiners'
    FOG register then holds the colour with factor one.
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
    """Section 2.12: where a rectangle of pixels is drawn, and the values that all its fragments share.

    - ``position``: object coordinates. The position and the values below pass through the command's vertex
      state as a vertex does: transformation, lighting, texture coordinate generation and matrices. A position
      outside the view volume or a clip plane is invalid, and nothing is drawn.
    - ``weight``: the vertex weight, as in a mesh.
    - ``window`` (ARB_window_pos): the position is window x and y (y up) and a depth in [0, 1] of the
      viewport's depth range. It is always valid. Colours, texture and fog coordinates are taken unchanged.
    - ``move``: added to window x and y, as Bitmap moves the position for later commands.
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
        """The position after a Bitmap that moves it by (x, y) pixels."""
        return replace(self, move=(self.move[0] + x, self.move[1] + y))


@dataclass(frozen=True, slots=True)
class PixelTexture:
    """SGIX_pixel_texture, SGIS_pixel_texture: colour groups become texture coordinates; R, G, B, A are s, t,
    r, q.

    Lambda is zero.

    - ``mode``: SGIX_pixel_texture's. None: SGIS_pixel_texture, with ``rgb_source`` and ``alpha_source``.
    - ``volumes`` (SGIX_impact_pixel_texture): the unit's 3D texture is four-dimensional. Its layers are this
      many volumes, one after the other. q selects a volume as ``q_filter`` says, and does not divide.
    - ``alpha_replace``: eight of the twelve bits of the group's alpha replace the texel's alpha, before a
      texture color table. ``alpha`` selects the most (MS) or the least significant (LS) eight.
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
    """The scissor test (section 4.1.2): fragments outside this box of pixels are discarded.

    ``x`` and ``y`` are the box's lower left pixel in window coordinates (y up); ``width`` and ``height`` are
    not negative. None in PassState disables the test.
    """

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class WindowClip:
    """The NV2A's window clip rectangles (later EXT_window_rectangles), in window coordinates.

    A fragment is kept inside any of the rectangles or, if ``exclusive``, outside all of them. None in
    PassState: disabled.
    """

    rectangles: tuple[Scissor, ...]
    exclusive: bool = False


@dataclass(frozen=True, slots=True)
class AlphaTest:
    """The alpha test (section 4.1.3): a fragment passes if "alpha ``function`` ``reference``" holds.

    ``reference`` is clamped to [0, 1], as OpenGL does. None in PassState disables the test.
    """

    function: ComparisonFunction = ComparisonFunction.ALWAYS
    reference: float = 0.0


@dataclass(frozen=True, slots=True)
class StencilTest:
    """The stencil test (section 4.1.4): a fragment passes if "``reference`` ``function`` stored value" holds.

    Both sides of the comparison are first ANDed with ``mask``. ``fail``, ``depth_fail`` and ``depth_pass``
    say what happens to the stored value if the stencil test fails, if the depth test fails, and if both pass.
    Only the bits of ``write_mask`` are written. ``reference`` is clamped to 0..255. None in PassState
    disables the test.
    """

    function: ComparisonFunction = ComparisonFunction.ALWAYS
    reference: int = 0
    mask: int = 0xFF
    fail: StencilOperation = StencilOperation.KEEP
    depth_fail: StencilOperation = StencilOperation.KEEP
    depth_pass: StencilOperation = StencilOperation.KEEP
    write_mask: int = 0xFF


@dataclass(frozen=True, slots=True)
class DepthTest:
    """The depth test (section 4.1.5): a fragment passes if "its depth ``function`` stored depth" holds.

    With ``write`` its depth is then stored. None in PassState disables the test, and no depth is written.
    """

    function: ComparisonFunction = ComparisonFunction.LESS
    write: bool = True


@dataclass(frozen=True, slots=True)
class DepthClamp:
    """NV_depth_clamp, with the NV2A's limits. None in PassState: disabled.

    Nothing is clipped at the near and far planes. Instead every fragment's depth is clamped to ``minimum``
    and ``maximum``. With ``cull``, a fragment whose depth lies outside is discarded. The limits are in depth
    units: the values of a float format, or clip w with W buffering. ``maximum`` None: the farthest depth.
    """

    minimum: float = 0.0
    maximum: float | None = None
    cull: bool = False


@dataclass(frozen=True, slots=True)
class Blending:
    """Blending (section 4.1.6) of a fragment's colour with the stored colour, by ``equation``.

    ``source`` is the factor of the fragment's colour, and ``destination`` that of the stored colour.
    ``color`` is the constant colour, (red, green, blue, alpha) with 1.0 = full intensity, which the CONSTANT
    factors read. None in PassState disables blending.
    """

    source: BlendFactor = BlendFactor.ONE
    destination: BlendFactor = BlendFactor.ZERO
    equation: BlendEquation = BlendEquation.FUNC_ADD
    color: Color = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ColorMask:
    """Which components of the colour buffer a Draw writes (section 4.2.2)."""

    red: bool = True
    green: bool = True
    blue: bool = True
    alpha: bool = True


@dataclass(frozen=True, slots=True)
class PassState:
    """Everything that a Draw needs to know. A field of None disables its stage.

    - ``texture_units``: unit i reads ``texture_units[i]``.
    - ``register_combiners``: None disables NV_register_combiners. The fragment's primary colour then passes
      through the units' texture environments, adds the secondary colour if ``color_sum``, and is fogged.
    - ``texture_shader``: stage i belongs to texture unit i; missing stages are NONE. None disables
      TEXTURE_SHADER, and each enabled unit samples its texture.
    - ``perspective_correction``: False is Hint(PERSPECTIVE_CORRECTION_HINT, FASTEST). On a machine that
      follows the hint, colours and coordinates are then linear on the screen.
    - ``ycbcr_conversion``: every unit that reads a texture has Y, Cb and Cr in its red, green and blue. They
      become RGB on their way to the combiners. Later texture shader stages read them unconverted.
    - ``w_buffering``: a fragment's depth is its clip w, in depth units, instead of its window z.
    - ``draw_buffer``: the colour buffer that is written, and that blending reads.

    These fields are for a machine of the future:

    - ``evaluate_before_filtering``: the combiners run on each texel that the texture filters read, and their
      results are filtered.
    - ``spherical_primary_color``, ``spherical_secondary_color``: the colour is a unit vector, in
      EXPAND_NORMAL's encoding, that turns at a steady rate from vertex to vertex.
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
    """The modes by which the state's units generate texture coordinates."""
    return {gen.mode for unit in state.texture_units if unit is not None for gen in unit.gen}


def needs_normals(state: PassState) -> bool:
    """Whether lighting or a texture coordinate generation of the state reads the vertices' normals."""
    lighting = state.vertex.lighting
    lit = lighting is not None and len(lighting.lights) > 0
    return lit or not _NORMAL_MODES.isdisjoint(texgen_modes(state))

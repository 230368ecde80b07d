"""The tokens of OpenGL 1.2.1 and its extensions, without ``GL_`` and without vendor suffix.

The integer values are this project's own. ``raster/codes.py``, the one list of codes, has the values that
kernels test; ``pipeline/native/`` writes them into the rows that kernels read.

Source: OpenGL 1.2.1 (Segal, Akeley 1999); NV_register_combiners; EXT_texture_cube_map; NV_texgen_reflection;
EXT_stencil_wrap; EXT_blend_minmax; EXT_blend_subtract; EXT_texture_lod_bias; NV_texture_shader; ARB_shadow;
ARB_texture_env_combine; ARB_texture_env_dot3; NV_texture_env_combine4.
"""

from enum import IntEnum

from fixedpipe.raster import codes as C


class PrimitiveType(IntEnum):
    """The primitive types of Begin (section 2.6.1)."""

    TRIANGLES = 0
    TRIANGLE_STRIP = 1
    TRIANGLE_FAN = 2
    QUADS = 3
    QUAD_STRIP = 4
    POLYGON = 5
    POINTS = 6
    LINES = 7
    LINE_STRIP = 8
    LINE_LOOP = 9

    @property
    def is_polygons(self):
        """Whether it makes triangles or polygons, whose codes come before those of points and lines."""
        return self < PrimitiveType.POINTS


class VertexStage(IntEnum):
    """The stage that gives window coordinates.

    - FIXED_FUNCTION: the transformation of chapter 2.
    - PROGRAM_RESULTS: a vertex program, whose results the mesh holds.
    """

    FIXED_FUNCTION = 0
    PROGRAM_RESULTS = 1


class SecondaryColor(IntEnum):
    """The source of the secondary colour that a machine with a lighting unit passes on."""

    FROM_VERTEX = 0  # the vertex stage's, with its alpha
    OPAQUE = 1  # with an alpha of 1
    DISABLED = 2  # (0, 0, 0, 1); lighting then adds its specular terms to the primary colour


class ColorSource(IntEnum):
    """The source of a material's colour in a lighting unit: the material, or one of the vertex's colours."""

    MATERIAL = 0
    PRIMARY = 1
    SECONDARY = 2


class LightingArithmetic(IntEnum):
    """How a machine computes lighting: OpenGL's equations, or the NV10's lighting unit."""

    EQUATIONS = 0
    LIGHTING_UNIT = 1


class ComparisonFunction(IntEnum):
    """Alpha, stencil and depth functions (section 4.1)."""

    NEVER = C.COMPARISON_NEVER
    LESS = C.COMPARISON_LESS
    EQUAL = C.COMPARISON_EQUAL
    LEQUAL = C.COMPARISON_LEQUAL
    GREATER = C.COMPARISON_GREATER
    NOTEQUAL = C.COMPARISON_NOTEQUAL
    GEQUAL = C.COMPARISON_GEQUAL
    ALWAYS = C.COMPARISON_ALWAYS


class DepthFormat(IntEnum):
    """The words of a depth buffer. A fixed format's code is its width, a float format's is minus its width.

    The floats have no sign. 16 bits are 4 of exponent and 12 of fraction, up to 511.9375. 24 bits are 8 and
    16, up to almost 2**128. Their words grow with the depth, as a fixed format's do
    (``fixedpipe.pipeline.textures.depth_words``).
    """

    FIXED_16 = 16
    FIXED_23 = 23
    FIXED_24 = 24
    FLOAT_16 = -16
    FLOAT_24 = -24

    @property
    def is_float(self):
        """Whether words are floats."""
        return self < 0

    @property
    def bits(self):
        """The number of bits of a word."""
        return abs(self)


class StencilOperation(IntEnum):
    """Section 4.1.4 and EXT_stencil_wrap."""

    KEEP = C.STENCIL_KEEP
    ZERO = C.STENCIL_ZERO
    REPLACE = C.STENCIL_REPLACE
    INCR = C.STENCIL_INCR
    DECR = C.STENCIL_DECR
    INVERT = C.STENCIL_INVERT
    INCR_WRAP = C.STENCIL_INCR_WRAP
    DECR_WRAP = C.STENCIL_DECR_WRAP


class BlendFactor(IntEnum):
    """Tables 4.1 and 4.2. ``validate`` checks which factors a machine takes as source and as destination."""

    ZERO = C.FACTOR_ZERO
    ONE = C.FACTOR_ONE
    SRC_COLOR = C.FACTOR_SRC_COLOR
    ONE_MINUS_SRC_COLOR = C.FACTOR_ONE_MINUS_SRC_COLOR
    DST_COLOR = C.FACTOR_DST_COLOR
    ONE_MINUS_DST_COLOR = C.FACTOR_ONE_MINUS_DST_COLOR
    SRC_ALPHA = C.FACTOR_SRC_ALPHA
    ONE_MINUS_SRC_ALPHA = C.FACTOR_ONE_MINUS_SRC_ALPHA
    DST_ALPHA = C.FACTOR_DST_ALPHA
    ONE_MINUS_DST_ALPHA = C.FACTOR_ONE_MINUS_DST_ALPHA
    SRC_ALPHA_SATURATE = C.FACTOR_SRC_ALPHA_SATURATE
    CONSTANT_COLOR = C.FACTOR_CONSTANT_COLOR
    ONE_MINUS_CONSTANT_COLOR = C.FACTOR_ONE_MINUS_CONSTANT_COLOR
    CONSTANT_ALPHA = C.FACTOR_CONSTANT_ALPHA
    ONE_MINUS_CONSTANT_ALPHA = C.FACTOR_ONE_MINUS_CONSTANT_ALPHA


class BlendEquation(IntEnum):
    """Section 4.1.6 (imaging subset), EXT_blend_minmax, EXT_blend_subtract; signed: the NV2A's."""

    FUNC_ADD = C.EQUATION_FUNC_ADD
    FUNC_SUBTRACT = C.EQUATION_FUNC_SUBTRACT
    FUNC_REVERSE_SUBTRACT = C.EQUATION_FUNC_REVERSE_SUBTRACT
    MIN = C.EQUATION_MIN
    MAX = C.EQUATION_MAX
    FUNC_ADD_SIGNED = C.EQUATION_FUNC_ADD_SIGNED
    FUNC_REVERSE_SUBTRACT_SIGNED = C.EQUATION_FUNC_REVERSE_SUBTRACT_SIGNED


class LogicOperation(IntEnum):
    """Table 4.3, in its order: the value's bits are the truth table."""

    CLEAR = C.LOGIC_CLEAR
    AND = C.LOGIC_AND
    AND_REVERSE = C.LOGIC_AND_REVERSE
    COPY = C.LOGIC_COPY
    AND_INVERTED = C.LOGIC_AND_INVERTED
    NOOP = C.LOGIC_NOOP
    XOR = C.LOGIC_XOR
    OR = C.LOGIC_OR
    NOR = C.LOGIC_NOR
    EQUIV = C.LOGIC_EQUIV
    INVERT = C.LOGIC_INVERT
    OR_REVERSE = C.LOGIC_OR_REVERSE
    COPY_INVERTED = C.LOGIC_COPY_INVERTED
    OR_INVERTED = C.LOGIC_OR_INVERTED
    NAND = C.LOGIC_NAND
    SET = C.LOGIC_SET


class Face(IntEnum):
    """Section 3.5.1."""

    FRONT = 0
    BACK = 1
    FRONT_AND_BACK = 2


class FrontFace(IntEnum):
    """Section 3.5.1: the winding, in window coordinates with y up, of a front-facing polygon."""

    CCW = 0
    CW = 1


class PolygonMode(IntEnum):
    """Section 3.5.4: the part of a polygon that is drawn: its vertices, boundary edges or interior."""

    POINT = 0
    LINE = 1
    FILL = 2


class LineRasterization(IntEnum):
    """The pixels that a line draws.

    - STEPS: one for each step along its longer axis (section 3.4.1).
    - RECTANGLE: those inside the rectangle that has the line in its middle (section 3.4.3, without
      antialiasing).

    The NV2A's SET_SMOOTHING_CONTROL chooses: 0xFFFF0000 and 0xFFFF0001.
    """

    STEPS = 0
    RECTANGLE = 1


class ShadeModel(IntEnum):
    """Section 2.13.7."""

    SMOOTH = 0
    FLAT = 1


class ProvokingVertex(IntEnum):
    """The vertex that gives a flat-shaded primitive its colour.

    LAST is OpenGL 1.2.1's, table 2.12.
    """

    LAST = 0
    FIRST = 1


class TextureTarget(IntEnum):
    """Section 3.8, EXT_texture_cube_map and NV_texture_rectangle."""

    TEXTURE_1D = C.TARGET_1D
    TEXTURE_2D = C.TARGET_2D
    TEXTURE_CUBE_MAP = C.TARGET_CUBE_MAP
    TEXTURE_3D = C.TARGET_3D
    TEXTURE_RECTANGLE = C.TARGET_RECTANGLE


class InternalFormat(IntEnum):
    """Sized internal formats, table 3.16: base format and resolution of each component; extensions' formats.

    Only ``fixedpipe.pipeline.textures.words`` makes textures of the extensions' formats.
    """

    ALPHA4 = 0
    ALPHA8 = 1
    LUMINANCE4 = 2
    LUMINANCE8 = 3
    LUMINANCE4_ALPHA4 = 4
    LUMINANCE6_ALPHA2 = 5
    LUMINANCE8_ALPHA8 = 6
    INTENSITY4 = 7
    INTENSITY8 = 8
    R3_G3_B2 = 9
    RGB4 = 10
    RGB5 = 11
    R5_G6_B5 = 12
    RGB8 = 13
    RGBA2 = 14
    RGBA4 = 15
    RGB5_A1 = 16
    RGBA8 = 17
    COLOR_INDEX8 = 18  # EXT_paletted_texture
    COMPRESSED_RGBA_S3TC_DXT1 = 19  # EXT_texture_compression_s3tc
    COMPRESSED_RGBA_S3TC_DXT3 = 20
    COMPRESSED_RGBA_S3TC_DXT5 = 21
    YCBCR = 22  # MESA_ycbcr_texture
    HILO16 = 23  # NV_texture_shader: HI in alpha and red, LO in green and blue, high bytes first
    DEPTH_COMPONENT16 = 24  # ARB_depth_texture
    DEPTH_COMPONENT24 = 25
    DEPTH_COMPONENT16_FLOAT = 26  # the NV2A's own formats, from here on
    DEPTH_COMPONENT24_FLOAT = 27
    R6_G5_B5 = 28
    GREEN8_BLUE8 = 29  # blue also in red, green also in alpha
    RED8_BLUE8 = 30  # blue also in green, red also in alpha
    WHITE_ALPHA8 = 31  # red, green, blue 255
    LUMINANCE16 = 32  # red 255, the high byte in green, the low byte in blue, alpha 255
    ALPHA12 = 33  # table 3.16's twelve-bit formats, for machines with components of that width
    LUMINANCE12 = 34
    LUMINANCE12_ALPHA4 = 35
    LUMINANCE12_ALPHA12 = 36
    INTENSITY12 = 37
    RGB12 = 38
    RGBA12 = 39
    SIGNED_HILO16 = 40  # NV_texture_shader, from here on; like HILO16, with two's complement words
    DSDT8 = 41  # ds in blue and red, dt in green and alpha, all signed
    DSDT8_MAG8 = 42  # ds in blue and dt in green, signed; the magnitude in red
    SIGNED_RGBA8 = 43


class TexelWord(IntEnum):
    """The layout of a texel in memory, highest bits first: TexImage's format and type in one.

    The names are Direct3D's and the NV2A's, for EXT_bgra, the packed pixels of OpenGL 1.2 and
    MESA_ycbcr_texture.

    - YUY2, UYVY: words of 16 bits; the even word of a pair holds U (Cb), the odd one V (Cr).
    - V8U8, L6V5U5, X8L8V8U8, Q8W8V8U8, V16U16: Direct3D 8's; U, V, W and Q are two's complement.
    """

    A8R8G8B8 = 0
    X8R8G8B8 = 1
    A8B8G8R8 = 2
    B8G8R8A8 = 3
    R8G8B8A8 = 4
    A1R5G5B5 = 5
    X1R5G5B5 = 6
    A4R4G4B4 = 7
    R5G6B5 = 8
    R6G5B5 = 9
    G8B8 = 10
    R8B8 = 11
    A8Y8 = 12
    Y8 = 13
    AY8 = 14
    A8 = 15
    Y16 = 16
    R16B16 = 17
    YUY2 = 18
    UYVY = 19
    X8_Y24_FIXED = 20
    X8_Y24_FLOAT = 21
    Y16_FIXED = 22
    Y16_FLOAT = 23
    V8U8 = 24
    L6V5U5 = 25
    X8L8V8U8 = 26
    Q8W8V8U8 = 27
    V16U16 = 28


class BaseFormat(IntEnum):
    """Base internal formats, table 3.15."""

    ALPHA = 0
    LUMINANCE = 1
    LUMINANCE_ALPHA = 2
    INTENSITY = 3
    RGB = 4
    RGBA = 5


class TextureFilter(IntEnum):
    """Section 3.8.5; the magnification filter is one of the first two."""

    NEAREST = 0
    LINEAR = 1
    NEAREST_MIPMAP_NEAREST = 2
    LINEAR_MIPMAP_NEAREST = 3
    NEAREST_MIPMAP_LINEAR = 4
    LINEAR_MIPMAP_LINEAR = 5

    @property
    def is_linear(self):
        """Whether texels of a level are blended."""
        linear = TextureFilter.LINEAR, TextureFilter.LINEAR_MIPMAP_NEAREST, TextureFilter.LINEAR_MIPMAP_LINEAR
        return self in linear

    @property
    def mipmap(self):
        """The levels that are read: a ``MIPMAP_`` code of ``raster/codes.py``."""
        if self in (TextureFilter.NEAREST, TextureFilter.LINEAR):
            return C.MIPMAP_NONE
        nearest = TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.LINEAR_MIPMAP_NEAREST
        return C.MIPMAP_NEAREST if self in nearest else C.MIPMAP_LINEAR


class WrapMode(IntEnum):
    """Section 3.8.4, SGIS_texture_edge_clamp, ARB_texture_border_clamp, ARB_texture_mirrored_repeat."""

    REPEAT = C.WRAP_REPEAT
    CLAMP = C.WRAP_CLAMP
    CLAMP_TO_EDGE = C.WRAP_CLAMP_TO_EDGE
    CLAMP_TO_BORDER = C.WRAP_CLAMP_TO_BORDER
    MIRRORED_REPEAT = C.WRAP_MIRRORED_REPEAT


class TexGenMode(IntEnum):
    """Section 2.10.4, EXT_texture_cube_map, NV_texgen_reflection. NONE: generation is disabled."""

    NONE = 0
    OBJECT_LINEAR = 1
    EYE_LINEAR = 2
    SPHERE_MAP = 3
    NORMAL_MAP = 4
    REFLECTION_MAP = 5


class FogMode(IntEnum):
    """Section 3.10."""

    LINEAR = C.FOG_MODE_LINEAR
    EXP = C.FOG_MODE_EXP
    EXP2 = C.FOG_MODE_EXP2


class FogCoordinateSource(IntEnum):
    """EXT_fog_coord: the eye-space distance |z_e|, or the vertices' own fog coordinate."""

    FRAGMENT_DEPTH = 0
    FOG_COORDINATE = 1


class FogGeneration(IntEnum):
    """The source of the NV2A's fog coordinate (its SET_FOG_GEN_MODE)."""

    SECONDARY_ALPHA = 0
    RADIAL = 1
    PLANAR = 2
    ABSOLUTE_PLANAR = 3
    FOG_COORDINATE = 4


class FogArithmetic(IntEnum):
    """How a machine computes the fog factor (a profile field).

    - ROUNDED: the function of the iterated coordinate, rounded to nearest.
    - TABLE: the NV2A's table.
    """

    ROUNDED = 0
    TABLE = 1


class ColorMaterialParameter(IntEnum):
    """Section 2.13.3."""

    AMBIENT_AND_DIFFUSE = 0
    AMBIENT = 1
    DIFFUSE = 2
    SPECULAR = 3
    EMISSION = 4


class Register(IntEnum):
    """Combiner registers, table NV_register_combiners.1, and the final combiner's two pseudo-registers."""

    ZERO = C.REGISTER_ZERO
    CONSTANT_COLOR0 = C.REGISTER_CONSTANT_COLOR0
    CONSTANT_COLOR1 = C.REGISTER_CONSTANT_COLOR1
    FOG = C.REGISTER_FOG
    PRIMARY_COLOR = C.REGISTER_PRIMARY_COLOR
    SECONDARY_COLOR = C.REGISTER_SECONDARY_COLOR
    SPARE0 = C.REGISTER_SPARE0
    SPARE1 = C.REGISTER_SPARE1
    TEXTURE0 = C.REGISTER_TEXTURE0
    TEXTURE1 = C.REGISTER_TEXTURE1
    TEXTURE2 = C.REGISTER_TEXTURE2
    TEXTURE3 = C.REGISTER_TEXTURE3
    E_TIMES_F = C.REGISTER_E_TIMES_F
    SPARE0_PLUS_SECONDARY_COLOR = C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR
    DISCARD = C.REGISTER_DISCARD


class Mapping(IntEnum):
    """Input mappings, table NV_register_combiners.4."""

    UNSIGNED_IDENTITY = C.MAPPING_UNSIGNED_IDENTITY
    UNSIGNED_INVERT = C.MAPPING_UNSIGNED_INVERT
    EXPAND_NORMAL = C.MAPPING_EXPAND_NORMAL
    EXPAND_NEGATE = C.MAPPING_EXPAND_NEGATE
    HALF_BIAS_NORMAL = C.MAPPING_HALF_BIAS_NORMAL
    HALF_BIAS_NEGATE = C.MAPPING_HALF_BIAS_NEGATE
    SIGNED_IDENTITY = C.MAPPING_SIGNED_IDENTITY
    SIGNED_NEGATE = C.MAPPING_SIGNED_NEGATE


class Meaning(IntEnum):
    """What a program means by a combiner variable, where a machine holds the value in another form.

    A machine computes the same with each meaning; only the ideal uses it.

    - PLAIN: the register's contents.
    - SATURATED: the contents, clamped to [0, 1]. A machine's registers end at 1; the ideal's do not.
    - SIGNED_CONSTANT: a constant c with components of both signs. It is stored as (c + 256/255)/2 or as c +
      128/255, from whose bytes a machine's EXPAND_NORMAL or HALF_BIAS_NORMAL makes c.
    """

    PLAIN = 0
    SATURATED = 1
    SIGNED_CONSTANT = 2


class ComponentUsage(IntEnum):
    """The components of a register that a variable takes (NV_register_combiners, section 3.8.12.2)."""

    RGB = C.USAGE_RGB
    ALPHA = C.USAGE_ALPHA
    BLUE = C.USAGE_BLUE


class CombinerScale(IntEnum):
    """Output scale of a general combiner portion."""

    NONE = C.SCALE_NONE
    SCALE_BY_TWO = C.SCALE_BY_TWO
    SCALE_BY_FOUR = C.SCALE_BY_FOUR
    SCALE_BY_ONE_HALF = C.SCALE_BY_ONE_HALF


class CombinerBias(IntEnum):
    """Output bias of a general combiner portion."""

    NONE = 0
    BIAS_BY_NEGATIVE_ONE_HALF = 1


class MuxSelect(IntEnum):
    """The bit of SPARE0's alpha that selects a mux: NV_register_combiners' highest, or the lowest."""

    MSB = 0
    LSB = 1


class ProductRounding(IntEnum):
    """Where a general combiner divides by 255: once after the sum, or after every product."""

    JOINT = 0
    PER_PRODUCT = 1


class WindowOrigin(IntEnum):
    """The row from which the device counts before snapping (a profile field)."""

    UPPER_LEFT = 0
    LOWER_LEFT = 1


class ColorFormat(IntEnum):
    """A pbuffer's colour formats: the chip's surface formats, components from the word's high bits down.

    An X component is padding, stored as zeros (Z) or ones (O). Source: nv_objects.h, SURFACE_FORMAT_COLOR.
    """

    A8R8G8B8 = 0
    X8R8G8B8_Z8R8G8B8 = 1
    X8R8G8B8_O8R8G8B8 = 2
    X1A7R8G8B8_Z1A7R8G8B8 = 3
    X1A7R8G8B8_O1A7R8G8B8 = 4
    R5G6B5 = 5
    X1R5G5B5_Z1R5G5B5 = 6
    X1R5G5B5_O1R5G5B5 = 7


class MagnificationThreshold(IntEnum):
    """The lambda up to which a texture is magnified: always 0 (the chip), or OpenGL's c of section 3.8.6."""

    ZERO = 0
    OPENGL_C = 1


class TextureShaderOperation(IntEnum):
    """SHADER_OPERATION: NV_texture_shader, NV_texture_shader2 and, last, the NV2A's own operations."""

    NONE = C.OPERATION_NONE
    TEXTURE_1D = C.OPERATION_TEXTURE_1D
    TEXTURE_2D = C.OPERATION_TEXTURE_2D
    TEXTURE_RECTANGLE = C.OPERATION_TEXTURE_RECTANGLE
    TEXTURE_CUBE_MAP = C.OPERATION_TEXTURE_CUBE_MAP
    TEXTURE_3D = C.OPERATION_TEXTURE_3D
    PASS_THROUGH = C.OPERATION_PASS_THROUGH
    CULL_FRAGMENT = C.OPERATION_CULL_FRAGMENT
    OFFSET_TEXTURE_2D = C.OPERATION_OFFSET_TEXTURE_2D
    OFFSET_TEXTURE_2D_SCALE = C.OPERATION_OFFSET_TEXTURE_2D_SCALE
    OFFSET_TEXTURE_RECTANGLE = C.OPERATION_OFFSET_TEXTURE_RECTANGLE
    OFFSET_TEXTURE_RECTANGLE_SCALE = C.OPERATION_OFFSET_TEXTURE_RECTANGLE_SCALE
    DEPENDENT_AR_TEXTURE_2D = C.OPERATION_DEPENDENT_AR_TEXTURE_2D
    DEPENDENT_GB_TEXTURE_2D = C.OPERATION_DEPENDENT_GB_TEXTURE_2D
    DOT_PRODUCT = C.OPERATION_DOT_PRODUCT
    DOT_PRODUCT_TEXTURE_2D = C.OPERATION_DOT_PRODUCT_TEXTURE_2D
    DOT_PRODUCT_TEXTURE_RECTANGLE = C.OPERATION_DOT_PRODUCT_TEXTURE_RECTANGLE
    DOT_PRODUCT_TEXTURE_3D = C.OPERATION_DOT_PRODUCT_TEXTURE_3D
    DOT_PRODUCT_TEXTURE_CUBE_MAP = C.OPERATION_DOT_PRODUCT_TEXTURE_CUBE_MAP
    DOT_PRODUCT_REFLECT_CUBE_MAP = C.OPERATION_DOT_PRODUCT_REFLECT_CUBE_MAP
    DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP = C.OPERATION_DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP
    DOT_PRODUCT_DIFFUSE_CUBE_MAP = C.OPERATION_DOT_PRODUCT_DIFFUSE_CUBE_MAP
    DOT_PRODUCT_DEPTH_REPLACE = C.OPERATION_DOT_PRODUCT_DEPTH_REPLACE
    BRDF_TEXTURE_3D = C.OPERATION_BRDF_TEXTURE_3D  # PS_TEXTUREMODES_BRDF


class DotProductMapping(IntEnum):
    """How a dot product reads the previous stage's texel, by the numbers of the NV2A's SET_DOT_RGBMAPPING.

    The first two are RGBA_UNSIGNED_DOT_PRODUCT_MAPPING's. The HILO mappings read two words of 16 bits: alpha
    and red, green and blue.
    """

    UNSIGNED_IDENTITY = C.DOT_MAPPING_UNSIGNED_IDENTITY
    EXPAND_NORMAL = C.DOT_MAPPING_EXPAND_NORMAL
    SIGNED_ODD = C.DOT_MAPPING_SIGNED_ODD
    SIGNED_IDENTITY = C.DOT_MAPPING_SIGNED_IDENTITY
    UNSIGNED_HILO = C.DOT_MAPPING_UNSIGNED_HILO
    SIGNED_HILO_HEMISPHERE = C.DOT_MAPPING_SIGNED_HILO_HEMISPHERE


class CullMode(IntEnum):
    """CULL_MODES (NV_texture_shader): the coordinates that a CULL_FRAGMENT stage keeps."""

    GEQUAL = C.CULL_MODE_GEQUAL
    LESS = C.CULL_MODE_LESS


class TextureCompareMode(IntEnum):
    """TEXTURE_COMPARE_MODE (ARB_shadow), and the NV2A's 0, which its 2D stages compare instead of r."""

    NONE = C.COMPARE_MODE_NONE
    COMPARE_R_TO_TEXTURE = C.COMPARE_MODE_R_TO_TEXTURE
    COMPARE_ZERO_TO_TEXTURE = C.COMPARE_MODE_ZERO_TO_TEXTURE


class TextureEnvironmentMode(IntEnum):
    """Section 3.8.9, ARB_texture_env_add, ARB_texture_env_combine, NV_texture_env_combine4.

    NONE: the unit passes its colour on (NV_texture_shader's, for texels that later stages alone read).
    """

    MODULATE = 0
    REPLACE = 1
    DECAL = 2
    BLEND = 3
    ADD = 4
    COMBINE = 5
    COMBINE4 = 6
    NONE = 7


class ColorKeyOperation(IntEnum):
    """The result for a texel that equals a unit's color key.

    - ALPHA: its alpha is 0.
    - RGBA: all its components are 0.
    - KILL: its fragment is discarded.

    Source: the NV2A's color key modes (nxdk_pgraph_tests, color_key_tests). Direct3D up to 7 does KILL where
    D3DRENDERSTATE_COLORKEYENABLE is set.
    """

    ALPHA = 0
    RGBA = 1
    KILL = 2


class CombineFunction(IntEnum):
    """COMBINE_RGB and COMBINE_ALPHA: EXT_ and ARB_texture_env_combine (SUBTRACT: ARB_ alone), _dot3.

    A COMBINE4 environment takes ADD and ADD_SIGNED alone, each of two products.
    """

    REPLACE = 0
    MODULATE = 1
    ADD = 2
    ADD_SIGNED = 3
    INTERPOLATE = 4
    SUBTRACT = 5
    DOT3_RGB = 6
    DOT3_RGBA = 7


class CombineSource(IntEnum):
    """SOURCEn_RGB and SOURCEn_ALPHA.

    ZERO and the numbered textures are NV_texture_env_combine4's; the textures also
    ARB_texture_env_crossbar's.
    """

    TEXTURE = 0
    CONSTANT = 1
    PRIMARY_COLOR = 2
    PREVIOUS = 3
    ZERO = 4
    TEXTURE0 = 5
    TEXTURE1 = 6
    TEXTURE2 = 7
    TEXTURE3 = 8


class CombineOperand(IntEnum):
    """OPERANDn_RGB and OPERANDn_ALPHA; the latter takes only the two operands of alpha."""

    SRC_COLOR = 0
    ONE_MINUS_SRC_COLOR = 1
    SRC_ALPHA = 2
    ONE_MINUS_SRC_ALPHA = 3


class ColorBuffer(IntEnum):
    """The buffers of DrawBuffer and ReadBuffer (sections 4.2.1, 4.3.2): the window's or an auxiliary one."""

    BACK = 0
    AUX0 = 1
    AUX1 = 2
    AUX2 = 3
    AUX3 = 4


class ConvolutionBorderMode(IntEnum):
    """CONVOLUTION_BORDER_MODE (section 3.6.5): the pixels that a filter reads beyond an image's edge."""

    REDUCE = C.CONVOLUTION_REDUCE
    CONSTANT_BORDER = C.CONVOLUTION_CONSTANT_BORDER
    REPLICATE_BORDER = C.CONVOLUTION_REPLICATE_BORDER


class ColorWeights(IntEnum):
    """How a machine iterates colours (a profile field).

    - EIGHT_BITS: with weights of eight bits, as the NV2A does.
    - EXACT: exactly, rounded to the nearest value of a component.
    """

    EIGHT_BITS = 0
    EXACT = 1


class Clamp(IntEnum):
    """The places where a machine clamps; each can be switched off (``Profile.without_clamps``).

    - VERTEX_COLOR: colours of vertices before they are iterated.
    - MAPPING: the lower clamp of the unsigned input mappings and the upper one of UNSIGNED_INVERT.
    - GENERAL_COMBINER: the outputs of a general combiner.
    - TEXTURE_ENVIRONMENT: each unit's result.
    - COLOR_SUM: SPARE0_PLUS_SECONDARY_COLOR, and the color sum where combiners are disabled.
    - FINAL_COMBINER: its RGB and alpha, and a fragment's colour after fog.
    - BLENDING: the results of blending.
    """

    VERTEX_COLOR = 0
    MAPPING = 1
    GENERAL_COMBINER = 2
    TEXTURE_ENVIRONMENT = 3
    COLOR_SUM = 4
    FINAL_COMBINER = 5
    BLENDING = 6


class CombinerFunction(IntEnum):
    """A future general combiner's function in place of AB + CD (Kautz, Seidel 2000, section 5.1).

    - SQUARE_ROOT: of the sum, at least 0.
    - DIVIDE: AB by CD.
    - EXPONENTIAL: e to the power of the sum.
    """

    NONE = C.COMBINER_FUNCTION_NONE
    SQUARE_ROOT = C.COMBINER_FUNCTION_SQUARE_ROOT
    DIVIDE = C.COMBINER_FUNCTION_DIVIDE
    EXPONENTIAL = C.COMBINER_FUNCTION_EXPONENTIAL


class AccumOperation(IntEnum):
    """The operations of Accum (section 4.2.4)."""

    ACCUM = 0
    LOAD = 1
    RETURN = 2
    MULT = 3
    ADD = 4


class PixelCopyType(IntEnum):
    """The types of CopyPixels (section 4.3.3)."""

    COLOR = 0
    DEPTH = 1
    STENCIL = 2


class PixelTexGenMode(IntEnum):
    """PIXEL_TEX_GEN_MODE (SGIX_pixel_texture): the components that a fragment takes from the raster position.

    These are the current raster colour's. The other components are the pixel group's.
    """

    NONE = 0
    ALPHA = 1
    RGB = 2
    RGBA = 3


class PixelFragmentSource(IntEnum):
    """PIXEL_FRAGMENT_RGB_SOURCE and PIXEL_FRAGMENT_ALPHA_SOURCE (SGIS_pixel_texture)."""

    PIXEL_GROUP_COLOR = 0
    CURRENT_RASTER_COLOR = 1


class PixelTexGenQ(IntEnum):
    """How q selects a volume of a four-dimensional texture (SGIX_impact_pixel_texture).

    It is the nearest volume, or one of the two that a linear filter would take.
    """

    ROUND = C.TEX_GEN_Q_ROUND
    CEILING = C.TEX_GEN_Q_CEILING
    FLOOR = C.TEX_GEN_Q_FLOOR


class PixelTexGenAlpha(IntEnum):
    """The eight bits of a group's twelve bits of alpha that replace a texel's (SGIX_impact_pixel_texture)."""

    MS = 0
    LS = 1

"""The integer codes that rows, kernels and the column engine decide on: the ground floor.

A code's name begins with what kind of thing it is. ``pipeline/enums.py`` takes the values of OpenGL's tokens
from here; kinds that are no tokens are what ``pipeline/native/`` makes of a state. A kernel compares a row's
entry with one of these names, never with a number: to Numba they are constants. Where codes are ordered, or
made of bits, for a reason, the reason stands beside them.
"""

# ----------------------------------------------------------------------------------- texture units and fog

# Source: OpenGL 1.2.1 section 3.8, EXT_texture_cube_map, NV_texture_rectangle.
TARGET_1D, TARGET_2D, TARGET_CUBE_MAP, TARGET_3D, TARGET_RECTANGLE = range(5)

# A cube map's images, in their order in memory: twice the axis, and one for its negative half.
(
    FACE_POSITIVE_X,
    FACE_NEGATIVE_X,
    FACE_POSITIVE_Y,
    FACE_NEGATIVE_Y,
    FACE_POSITIVE_Z,
    FACE_NEGATIVE_Z,
) = range(6)

WRAP_REPEAT, WRAP_CLAMP, WRAP_CLAMP_TO_EDGE, WRAP_CLAMP_TO_BORDER, WRAP_MIRRORED_REPEAT = range(5)

# Which levels a minification filter reads: level 0 only, the nearest, two that it blends.
MIPMAP_NONE, MIPMAP_NEAREST, MIPMAP_LINEAR = range(3)

# What a texel is compared with (ARB_shadow): nothing, the coordinate r, zero.
COMPARE_MODE_NONE, COMPARE_MODE_R_TO_TEXTURE, COMPARE_MODE_ZERO_TO_TEXTURE = range(3)
# In a comparison function's place where texels are not compared: they are bytes, or two words of 16 bits that
# are one number each, or half a wide texel: two components.
UNCOMPARED = UNCOMPARED_BYTES, UNCOMPARED_WORDS, UNCOMPARED_LANES = -1, -2, -3

FOG_MODE_LINEAR, FOG_MODE_EXP, FOG_MODE_EXP2 = range(3)
# How a fragment's fog factor is found; zero: it has none.
FOG_BY_THRESHOLDS, FOG_BY_TABLE = 1, 2

# -------------------------------------------------------------------------------- texture shaders, by stage

# In the order of NV_texture_shader's and NV_texture_shader2's tables; the last is the NV2A's own. Rows have
# OPERATION_NONE for the operations that sample the unit's own texture, but for TEXTURE_CUBE_MAP where that
# texture is no cube map.
(
    OPERATION_NONE,
    OPERATION_TEXTURE_1D,
    OPERATION_TEXTURE_2D,
    OPERATION_TEXTURE_RECTANGLE,
    OPERATION_TEXTURE_CUBE_MAP,
    OPERATION_TEXTURE_3D,
    OPERATION_PASS_THROUGH,
    OPERATION_CULL_FRAGMENT,
    OPERATION_OFFSET_TEXTURE_2D,
    OPERATION_OFFSET_TEXTURE_2D_SCALE,
    OPERATION_OFFSET_TEXTURE_RECTANGLE,
    OPERATION_OFFSET_TEXTURE_RECTANGLE_SCALE,
    OPERATION_DEPENDENT_AR_TEXTURE_2D,
    OPERATION_DEPENDENT_GB_TEXTURE_2D,
    OPERATION_DOT_PRODUCT,
    OPERATION_DOT_PRODUCT_TEXTURE_2D,
    OPERATION_DOT_PRODUCT_TEXTURE_RECTANGLE,
    OPERATION_DOT_PRODUCT_TEXTURE_3D,
    OPERATION_DOT_PRODUCT_TEXTURE_CUBE_MAP,
    OPERATION_DOT_PRODUCT_REFLECT_CUBE_MAP,
    OPERATION_DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
    OPERATION_DOT_PRODUCT_DIFFUSE_CUBE_MAP,
    OPERATION_DOT_PRODUCT_DEPTH_REPLACE,
    OPERATION_BRDF_TEXTURE_3D,
) = range(24)
# Operations that are alike: those that move iterated coordinates, those of them that multiply what they read
# by a magnitude, those whose coordinates are two dot products or three, those of these that reflect an eye,
# those that take two bytes as coordinates, and those that read a direction's texel.
OPERATIONS_WITH_OFFSET = (
    OPERATION_OFFSET_TEXTURE_2D,
    OPERATION_OFFSET_TEXTURE_2D_SCALE,
    OPERATION_OFFSET_TEXTURE_RECTANGLE,
    OPERATION_OFFSET_TEXTURE_RECTANGLE_SCALE,
)
OPERATIONS_WITH_SCALE = (OPERATION_OFFSET_TEXTURE_2D_SCALE, OPERATION_OFFSET_TEXTURE_RECTANGLE_SCALE)
OPERATIONS_OF_TWO_DOT_PRODUCTS = (
    OPERATION_DOT_PRODUCT_TEXTURE_2D,
    OPERATION_DOT_PRODUCT_TEXTURE_RECTANGLE,
)
OPERATIONS_REFLECTING = (
    OPERATION_DOT_PRODUCT_REFLECT_CUBE_MAP,
    OPERATION_DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
)
OPERATIONS_OF_THREE_DOT_PRODUCTS = (
    OPERATION_DOT_PRODUCT_TEXTURE_3D,
    OPERATION_DOT_PRODUCT_TEXTURE_CUBE_MAP,
    *OPERATIONS_REFLECTING,
)
DEPENDENT_OPERATIONS = (OPERATION_DEPENDENT_AR_TEXTURE_2D, OPERATION_DEPENDENT_GB_TEXTURE_2D)
OPERATIONS_OF_DIRECTIONS = (
    OPERATION_TEXTURE_CUBE_MAP,
    OPERATION_DOT_PRODUCT_TEXTURE_CUBE_MAP,
    OPERATION_DOT_PRODUCT_REFLECT_CUBE_MAP,
    OPERATION_DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
    OPERATION_DOT_PRODUCT_DIFFUSE_CUBE_MAP,
)
# The tables list dot products by how many they take: from DOT_PRODUCT_TEXTURE_2D on an operation reads the
# stage before its own as well, from DOT_PRODUCT_TEXTURE_3D on the last two.
FIRST_AFTER_ONE_STAGE = OPERATION_DOT_PRODUCT_TEXTURE_2D
FIRST_AFTER_TWO_STAGES = OPERATION_DOT_PRODUCT_TEXTURE_3D
LAST_OPERATION = OPERATION_BRDF_TEXTURE_3D

# How a dot product reads a texel, as the NV2A's SET_DOT_RGBMAPPING numbers it: from 4 on its words.
DOT_MAPPING_UNSIGNED_IDENTITY = 0
DOT_MAPPING_EXPAND_NORMAL = 1
DOT_MAPPING_SIGNED_ODD = 2
DOT_MAPPING_SIGNED_IDENTITY = 3
DOT_MAPPING_UNSIGNED_HILO = 4
DOT_MAPPING_SIGNED_HILO_HEMISPHERE = 7
FIRST_MAPPING_OF_WORDS = DOT_MAPPING_UNSIGNED_HILO

# Which coordinates a CULL_FRAGMENT stage keeps: a bit of CULL_MODES each.
CULL_MODE_GEQUAL, CULL_MODE_LESS = range(2)

# --------------------------------------------------------------------------------------- register combiners

# Table NV_register_combiners.1 and the final combiner's two pseudo-registers; a register's four planes lie
# at four times its code. The last is none, and has no planes.
(
    REGISTER_ZERO,
    REGISTER_CONSTANT_COLOR0,
    REGISTER_CONSTANT_COLOR1,
    REGISTER_FOG,
    REGISTER_PRIMARY_COLOR,
    REGISTER_SECONDARY_COLOR,
    REGISTER_SPARE0,
    REGISTER_SPARE1,
    REGISTER_TEXTURE0,
    REGISTER_TEXTURE1,
    REGISTER_TEXTURE2,
    REGISTER_TEXTURE3,
    REGISTER_E_TIMES_F,
    REGISTER_SPARE0_PLUS_SECONDARY_COLOR,
    REGISTER_DISCARD,
) = range(15)

# Input mappings, table NV_register_combiners.4.
(
    MAPPING_UNSIGNED_IDENTITY,
    MAPPING_UNSIGNED_INVERT,
    MAPPING_EXPAND_NORMAL,
    MAPPING_EXPAND_NEGATE,
    MAPPING_HALF_BIAS_NORMAL,
    MAPPING_HALF_BIAS_NEGATE,
    MAPPING_SIGNED_IDENTITY,
    MAPPING_SIGNED_NEGATE,
) = range(8)

USAGE_RGB, USAGE_ALPHA, USAGE_BLUE = range(3)

# Output scales; the first three are by how many bits a value is shifted.
SCALE_NONE, SCALE_BY_TWO, SCALE_BY_FOUR, SCALE_BY_ONE_HALF = range(4)

# Where a general combiner's sum is rounded: product by product already, before its scale, or after it.
ROUNDING_DONE, ROUNDING_BEFORE_SCALE, ROUNDING_AFTER_SCALE = range(3)

# Bits of the color sum: it is clamped; it is of one minus SPARE0; and of one minus the secondary colour.
COLOR_SUM_CLAMP, COLOR_SUM_INVERT_SPARE0, COLOR_SUM_INVERT_SECONDARY = 1, 2, 4

# What the future board's combiners put in the place of AB + CD.
(
    COMBINER_FUNCTION_NONE,
    COMBINER_FUNCTION_SQUARE_ROOT,
    COMBINER_FUNCTION_DIVIDE,
    COMBINER_FUNCTION_EXPONENTIAL,
) = range(4)

# ------------------------------------------------------------------------------------------------- fragments

# Alpha, stencil, depth and texel comparisons: a bit each for less, equal and greater.
COMPARISON_NEVER = 0
COMPARISON_LESS = 1
COMPARISON_EQUAL = 2
COMPARISON_GREATER = 4
COMPARISON_LEQUAL = COMPARISON_LESS | COMPARISON_EQUAL
COMPARISON_NOTEQUAL = COMPARISON_LESS | COMPARISON_GREATER
COMPARISON_GEQUAL = COMPARISON_GREATER | COMPARISON_EQUAL
COMPARISON_ALWAYS = COMPARISON_LESS | COMPARISON_EQUAL | COMPARISON_GREATER

(
    STENCIL_KEEP,
    STENCIL_ZERO,
    STENCIL_REPLACE,
    STENCIL_INCR,
    STENCIL_DECR,
    STENCIL_INVERT,
    STENCIL_INCR_WRAP,
    STENCIL_DECR_WRAP,
) = range(8)

# What becomes of a fragment's colour: it replaces the framebuffer's, is blended with it by factors and an
# equation, is added to it (ONE, ONE, FUNC_ADD), or is combined with it by a logic operation.
BLEND_REPLACE, BLEND_GENERAL, BLEND_ADD, BLEND_LOGIC = range(4)

# Tables 4.1 and 4.2 of OpenGL 1.2.1.
(
    FACTOR_ZERO,
    FACTOR_ONE,
    FACTOR_SRC_COLOR,
    FACTOR_ONE_MINUS_SRC_COLOR,
    FACTOR_DST_COLOR,
    FACTOR_ONE_MINUS_DST_COLOR,
    FACTOR_SRC_ALPHA,
    FACTOR_ONE_MINUS_SRC_ALPHA,
    FACTOR_DST_ALPHA,
    FACTOR_ONE_MINUS_DST_ALPHA,
    FACTOR_SRC_ALPHA_SATURATE,
    FACTOR_CONSTANT_COLOR,
    FACTOR_ONE_MINUS_CONSTANT_COLOR,
    FACTOR_CONSTANT_ALPHA,
    FACTOR_ONE_MINUS_CONSTANT_ALPHA,
) = range(15)

(
    EQUATION_FUNC_ADD,
    EQUATION_FUNC_SUBTRACT,
    EQUATION_FUNC_REVERSE_SUBTRACT,
    EQUATION_MIN,
    EQUATION_MAX,
    EQUATION_FUNC_ADD_SIGNED,
    EQUATION_FUNC_REVERSE_SUBTRACT_SIGNED,
) = range(7)

# Table 4.3: a code's bits, lowest first, are the results for (s, d) = (1, 1), (1, 0), (0, 1), (0, 0).
(
    LOGIC_CLEAR,
    LOGIC_AND,
    LOGIC_AND_REVERSE,
    LOGIC_COPY,
    LOGIC_AND_INVERTED,
    LOGIC_NOOP,
    LOGIC_XOR,
    LOGIC_OR,
    LOGIC_NOR,
    LOGIC_EQUIV,
    LOGIC_INVERT,
    LOGIC_OR_REVERSE,
    LOGIC_COPY_INVERTED,
    LOGIC_OR_INVERTED,
    LOGIC_NAND,
    LOGIC_SET,
) = range(16)

# How the depth buffer's words are numbers.
DEPTH_FIXED, DEPTH_FLOAT_16, DEPTH_FLOAT_24 = range(3)

# A surface's alpha as a blend factor: the stored byte, always one, the byte's lower seven bits.
SURFACE_ALPHA_STORED, SURFACE_ALPHA_ONE, SURFACE_ALPHA_SEVEN_BITS = range(3)

# ------------------------------------------------------------------------------------- primitives and pixels

PRIMITIVE_TRIANGLE, PRIMITIVE_LINE, PRIMITIVE_POINT = range(3)

# A primitive's colours: iterated, its provoking vertex's, the same at all of its vertices.
COLORS_SMOOTH, COLORS_FLAT, COLORS_EQUAL = range(3)

# How colours are iterated: not at all, for they do not vary or nobody reads them; by weights of eight bits;
# exactly.
WEIGHTS_NONE, WEIGHTS_EIGHT_BITS, WEIGHTS_EXACT = range(3)

# Which pixels a line draws: those in a rectangle, one for each step along its longer axis as the NV2A takes
# it, one for each diamond that it leaves.
LINE_AS_RECTANGLE, LINE_IN_STEPS, LINE_IN_DIAMONDS = range(3)

# What window clip leaves: everything, what lies inside any of its rectangles, what lies outside all.
WINDOW_CLIP_NONE, WINDOW_CLIP_INSIDE, WINDOW_CLIP_OUTSIDE = range(3)

# CONVOLUTION_BORDER_MODE.
CONVOLUTION_REDUCE, CONVOLUTION_CONSTANT_BORDER, CONVOLUTION_REPLICATE_BORDER = range(3)

# Which volume of a four-dimensional texture q chooses (SGIX_impact_pixel_texture).
TEX_GEN_Q_ROUND, TEX_GEN_Q_CEILING, TEX_GEN_Q_FLOOR = range(3)

# Clipping planes, in the order in which ``fixedpipe.pipeline.vertices.clip.clip_planes`` clips.
PLANE_NEAR, PLANE_FAR, PLANE_LEFT, PLANE_RIGHT, PLANE_BOTTOM, PLANE_TOP = range(6)

# ----------------------------------------------------------------------------------------- the vector engine

# A queued command, and the bits of the buffers that a Clear clears.
JOB_CLEAR, JOB_DRAW = range(2)
BUFFER_COLOR, BUFFER_DEPTH, BUFFER_STENCIL = 1, 2, 4

# How a unit is sampled: not at all; from one level, by coordinates that are counted in texels as they are
# iterated; the same, by lambda; by computed coordinates (a cube map's, divided by q, compared as depths, or
# of any size); by the portable engine only.
PATH_DISABLED, PATH_ITERATED, PATH_MIPMAPPED, PATH_COMPUTED, PATH_FOOTPRINT, PATH_PORTABLE = range(6)

# What a row of a combiner plan does. From MULTIPLY on they are rare, and work on scratch planes.
(
    PLAN_MODULATE,  # A B of bytes
    PLAN_ADD_BYTES,  # A B + C D of bytes, at most one; bias, scale, clamp
    PLAN_ADD_SIGNED,  # A B + C D of any inputs; bias, scale, clamp
    PLAN_DOT_PRODUCT,  # A B + C D + E F of any inputs; bias, scale, clamp
    PLAN_LERP,  # A B + (1 - A) C + D of bytes, at most one
    PLAN_PACK,  # A, B, C, D as red, green, blue, alpha of the packed color
    PLAN_MULTIPLY,  # A B to scratch plane TARGET, rounded if ROUNDING is DONE
    PLAN_SUM_OF_THREE,  # scratch planes TARGET.. to the first of them
    PLAN_SUM_OF_TWO,  # scratch planes TARGET and SECOND to the total
    PLAN_SELECT,  # either of them to the total, by bit MUX of A, which is SPARE0's alpha
    PLAN_FINISH,  # scratch plane SECOND to plane TARGET: rounding, bias, scale, clamp
) = range(11)

# What min(max(x, low) * factor + addend, 255) leaves to do, from least to most, for the values that come.
(
    MAPS_NOTHING,  # they stay as they are
    MAPS_WITHIN,  # neither limit is reached
    MAPS_ALL,
) = range(3)

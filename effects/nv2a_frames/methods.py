"""The registers that a frame may set: methods of the NV2A's 3D class, 0x97, with the values of their fields.

Source: public headers of the class (nouveau's NV20_TCL_PRIMITIVE_3D, nxdk's nv_regs.h); the values of
functions, factors and operations are OpenGL's.
"""

from enum import IntEnum
from typing import Any

from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ComparisonFunction,
    DepthFormat,
    Face,
    FrontFace,
    InternalFormat,
    PolygonMode,
    PrimitiveType,
    ShadeModel,
    StencilOperation,
    TexelWord,
    TextureFilter,
    WrapMode,
)

MAGIC = b"NV2AFRM1"
WORDS, MEMORY, VERTICES = 1, 2, 3  # kinds of records
UNITS, UNIT_STRIDE = 4, 64  # texture units, and bytes from one's registers to the next one's


class Method(IntEnum):
    """Addresses of registers; those of texture unit 0."""

    ALPHA_TEST_ENABLE = 0x300
    BLEND_ENABLE = 0x304
    CULL_FACE_ENABLE = 0x308
    DEPTH_TEST_ENABLE = 0x30C
    LINE_SMOOTH_ENABLE = 0x320
    POLY_SMOOTH_ENABLE = 0x324
    STENCIL_TEST_ENABLE = 0x32C
    POLY_OFFSET_POINT_ENABLE = 0x330
    POLY_OFFSET_LINE_ENABLE = 0x334
    POLY_OFFSET_FILL_ENABLE = 0x338
    ALPHA_FUNC = 0x33C
    ALPHA_REF = 0x340
    BLEND_FUNC_SFACTOR = 0x344
    BLEND_FUNC_DFACTOR = 0x348
    BLEND_COLOR = 0x34C
    BLEND_EQUATION = 0x350
    DEPTH_FUNC = 0x354
    COLOR_MASK = 0x358
    DEPTH_MASK = 0x35C
    STENCIL_MASK = 0x360
    STENCIL_FUNC = 0x364
    STENCIL_FUNC_REF = 0x368
    STENCIL_FUNC_MASK = 0x36C
    STENCIL_OP_FAIL = 0x370
    STENCIL_OP_ZFAIL = 0x374
    STENCIL_OP_ZPASS = 0x378
    SHADE_MODE = 0x37C
    LINE_WIDTH = 0x380
    POLYGON_OFFSET_SCALE_FACTOR = 0x384
    POLYGON_OFFSET_BIAS = 0x388
    FRONT_POLYGON_MODE = 0x38C
    BACK_POLYGON_MODE = 0x390
    CULL_FACE = 0x39C
    FRONT_FACE = 0x3A0
    POINT_SIZE = 0x43C
    FLAT_SHADE_OP = 0x9FC
    POLYGON_STIPPLE_ENABLE = 0x147C
    POLYGON_STIPPLE_PATTERN = 0x1480
    BEGIN_END = 0x17FC
    EYE_VECTOR = 0x181C
    TEXTURE_OFFSET = 0x1B00
    TEXTURE_FORMAT = 0x1B04
    TEXTURE_ADDRESS = 0x1B08
    TEXTURE_CONTROL0 = 0x1B0C
    TEXTURE_CONTROL1 = 0x1B10
    TEXTURE_FILTER = 0x1B14
    TEXTURE_IMAGE_RECT = 0x1B1C
    TEXTURE_BORDER_COLOR = 0x1B24
    TEXTURE_BUMP_ENV_MAT = 0x1B28
    TEXTURE_BUMP_ENV_SCALE = 0x1B38
    TEXTURE_BUMP_ENV_OFFSET = 0x1B3C
    ZSTENCIL_CLEAR_VALUE = 0x1D8C
    COLOR_CLEAR_VALUE = 0x1D90
    CLEAR_SURFACE = 0x1D94
    CLEAR_RECT_HORIZONTAL = 0x1D98
    CLEAR_RECT_VERTICAL = 0x1D9C


CLEAR_Z, CLEAR_STENCIL, CLEAR_COLOR = 0x01, 0x02, 0xF0
CUBE_MAP, BORDER_COLOR, DIMENSIONS, COLOR, LEVELS, SIZES = 2, 3, 4, 8, 16, (20, 24, 28)  # of TEXTURE_FORMAT
ENABLED, MAX_LOD, MIN_LOD, LOD_BITS = 30, 6, 18, 12  # of TEXTURE_CONTROL0
MIN_FILTER, MAG_FILTER, SIGNED, BIAS_BITS = (
    16,
    24,
    (29, 30, 31, 28),
    13,
)  # of TEXTURE_FILTER: signed R, G, B, A

COMPARISONS = {kind: 0x200 + kind for kind in ComparisonFunction}
STENCIL_OPERATIONS = {
    StencilOperation.KEEP: 0x1E00,
    StencilOperation.ZERO: 0,
    StencilOperation.REPLACE: 0x1E01,
    StencilOperation.INCR: 0x1E02,
    StencilOperation.DECR: 0x1E03,
    StencilOperation.INVERT: 0x150A,
    StencilOperation.INCR_WRAP: 0x8507,
    StencilOperation.DECR_WRAP: 0x8508,
}
FACTORS = {
    BlendFactor.ZERO: 0,
    BlendFactor.ONE: 1,
    BlendFactor.SRC_COLOR: 0x300,
    BlendFactor.ONE_MINUS_SRC_COLOR: 0x301,
    BlendFactor.SRC_ALPHA: 0x302,
    BlendFactor.ONE_MINUS_SRC_ALPHA: 0x303,
    BlendFactor.DST_ALPHA: 0x304,
    BlendFactor.ONE_MINUS_DST_ALPHA: 0x305,
    BlendFactor.DST_COLOR: 0x306,
    BlendFactor.ONE_MINUS_DST_COLOR: 0x307,
    BlendFactor.SRC_ALPHA_SATURATE: 0x308,
    BlendFactor.CONSTANT_COLOR: 0x8001,
    BlendFactor.ONE_MINUS_CONSTANT_COLOR: 0x8002,
    BlendFactor.CONSTANT_ALPHA: 0x8003,
    BlendFactor.ONE_MINUS_CONSTANT_ALPHA: 0x8004,
}
EQUATIONS = {
    BlendEquation.FUNC_ADD: 0x8006,
    BlendEquation.MIN: 0x8007,
    BlendEquation.MAX: 0x8008,
    BlendEquation.FUNC_SUBTRACT: 0x800A,
    BlendEquation.FUNC_REVERSE_SUBTRACT: 0x800B,
    BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED: 0xF005,
    BlendEquation.FUNC_ADD_SIGNED: 0xF006,
}
FACES = {Face.FRONT: 0x404, Face.BACK: 0x405, Face.FRONT_AND_BACK: 0x408}
FRONT_FACES = {FrontFace.CW: 0x900, FrontFace.CCW: 0x901}
POLYGON_MODES = {PolygonMode.POINT: 0x1B00, PolygonMode.LINE: 0x1B01, PolygonMode.FILL: 0x1B02}
SHADE_MODELS = {ShadeModel.FLAT: 0x1D00, ShadeModel.SMOOTH: 0x1D01}
PRIMITIVES = {
    PrimitiveType.POINTS: 1,
    PrimitiveType.LINES: 2,
    PrimitiveType.LINE_LOOP: 3,
    PrimitiveType.LINE_STRIP: 4,
    PrimitiveType.TRIANGLES: 5,
    PrimitiveType.TRIANGLE_STRIP: 6,
    PrimitiveType.TRIANGLE_FAN: 7,
    PrimitiveType.QUADS: 8,
    PrimitiveType.QUAD_STRIP: 9,
    PrimitiveType.POLYGON: 10,
}
WRAPS = {
    WrapMode.REPEAT: 1,
    WrapMode.MIRRORED_REPEAT: 2,
    WrapMode.CLAMP_TO_EDGE: 3,
    WrapMode.CLAMP_TO_BORDER: 4,
    WrapMode.CLAMP: 5,
}
FILTERS = {
    TextureFilter.NEAREST: 1,
    TextureFilter.LINEAR: 2,
    TextureFilter.NEAREST_MIPMAP_NEAREST: 3,
    TextureFilter.LINEAR_MIPMAP_NEAREST: 4,
    TextureFilter.NEAREST_MIPMAP_LINEAR: 5,
    TextureFilter.LINEAR_MIPMAP_LINEAR: 6,
}
# Colour formats of textures: swizzled (None: there is none) and linear.
TEXEL_FORMATS = {
    TexelWord.A8R8G8B8: (0x06, 0x12),
    TexelWord.X8R8G8B8: (0x07, 0x1E),
    TexelWord.R5G6B5: (0x05, 0x11),
    TexelWord.A1R5G5B5: (0x02, 0x10),
    TexelWord.X1R5G5B5: (0x03, 0x1C),
    TexelWord.A4R4G4B4: (0x04, 0x1D),
    TexelWord.Y8: (0x00, 0x13),
    TexelWord.AY8: (0x01, 0x1B),
    TexelWord.A8: (0x19, 0x1F),
    TexelWord.A8Y8: (0x1A, 0x20),
    TexelWord.G8B8: (0x28, 0x17),
    TexelWord.R8B8: (0x29, 0x16),
    TexelWord.R6G5B5: (0x27, 0x37),
    TexelWord.A8B8G8R8: (0x3A, 0x3F),
    TexelWord.B8G8R8A8: (0x3B, 0x40),
    TexelWord.R8G8B8A8: (0x3C, 0x41),
}
TEXELS_OF = {
    code: (word, linear)
    for word, codes in TEXEL_FORMATS.items()
    for linear, code in zip((False, True), codes, strict=True)
}
DEPTHS = {
    DepthFormat.FIXED_16: 0,
    DepthFormat.FLOAT_16: 1,
    DepthFormat.FIXED_24: 2,
    DepthFormat.FLOAT_24: 3,
}
# Vertex attributes by their slots, and the arrays of a mesh that they are: the results of a vertex program.
POSITION, TEXTURE0 = 0, 9
ATTRIBUTES = {
    3: "colors",
    4: "secondary_colors",
    5: "fog_coordinates",
    6: "point_sizes",
    7: "back_colors",
    8: "back_secondary_colors",
}
SLOTS = 16
# Formats whose texels are stored as words of another format with the same register bytes.
STORED_AS = {InternalFormat.COLOR_INDEX8: TexelWord.A8R8G8B8}


def kind_of(table: dict[Any, int], value: int) -> Any:
    """The member whose value in a register it is, or None."""
    return next((member for member, known in table.items() if known == value), None)

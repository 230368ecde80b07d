"""The formats of images in a client's memory, and the textures that can read a surface's words."""

from typing import NamedTuple

from fixedpipe.pipeline.enums import ColorFormat, DepthFormat, InternalFormat

# The component, of R, G, B and A, of each element of an image's group; L is all three colours. Source: OpenGL
# 1.2.1 table 3.6 and section 3.6.4, Conversion to RGB and Final Expansion to RGBA.
IMAGE_FORMATS = {
    "RGBA": ("R", "G", "B", "A"),
    "RGB": ("R", "G", "B"),
    "BGRA": ("B", "G", "R", "A"),
    "BGR": ("B", "G", "R"),
    "RED": ("R",),
    "GREEN": ("G",),
    "BLUE": ("B",),
    "ALPHA": ("A",),
    "LUMINANCE": ("L",),
    "LUMINANCE_ALPHA": ("L", "A"),
}
DEPTH_FORMAT, STENCIL_FORMAT, COLOR_INDEX_FORMAT = "DEPTH_COMPONENT", "STENCIL_INDEX", "COLOR_INDEX"
INDEX_FORMATS = (STENCIL_FORMAT, COLOR_INDEX_FORMAT)

# The formats in which ReadPixels reads colours. Source: OpenGL 1.2.1 section 4.3.2.
READ_FORMATS = tuple(IMAGE_FORMATS)
# The types in which it returns them, and the NumPy types of these. Source: OpenGL 1.2.1 table 4.7.
COMPONENT_TYPES = {
    "UNSIGNED_BYTE": "uint8",
    "BYTE": "int8",
    "UNSIGNED_SHORT": "uint16",
    "SHORT": "int16",
    "UNSIGNED_INT": "uint32",
    "INT": "int32",
    "FLOAT": "float64",
}


class PackedType(NamedTuple):
    """A type whose words hold a whole group.

    - ``word``: the NumPy type of a word.
    - ``fields``: (lowest bit, number of bits) of the first component, the second and so on.
    """

    word: str
    fields: tuple[tuple[int, int], ...]


# Source: OpenGL 1.2.1 tables 3.9 to 3.11.
PACKED_TYPES = {
    "UNSIGNED_BYTE_3_3_2": PackedType("uint8", ((5, 3), (2, 3), (0, 2))),
    "UNSIGNED_BYTE_2_3_3_REV": PackedType("uint8", ((0, 3), (3, 3), (6, 2))),
    "UNSIGNED_SHORT_5_6_5": PackedType("uint16", ((11, 5), (5, 6), (0, 5))),
    "UNSIGNED_SHORT_5_6_5_REV": PackedType("uint16", ((0, 5), (5, 6), (11, 5))),
    "UNSIGNED_SHORT_4_4_4_4": PackedType("uint16", ((12, 4), (8, 4), (4, 4), (0, 4))),
    "UNSIGNED_SHORT_4_4_4_4_REV": PackedType("uint16", ((0, 4), (4, 4), (8, 4), (12, 4))),
    "UNSIGNED_SHORT_5_5_5_1": PackedType("uint16", ((11, 5), (6, 5), (1, 5), (0, 1))),
    "UNSIGNED_SHORT_1_5_5_5_REV": PackedType("uint16", ((0, 5), (5, 5), (10, 5), (15, 1))),
    "UNSIGNED_INT_8_8_8_8": PackedType("uint32", ((24, 8), (16, 8), (8, 8), (0, 8))),
    "UNSIGNED_INT_8_8_8_8_REV": PackedType("uint32", ((0, 8), (8, 8), (16, 8), (24, 8))),
    "UNSIGNED_INT_10_10_10_2": PackedType("uint32", ((22, 10), (12, 10), (2, 10), (0, 2))),
    "UNSIGNED_INT_2_10_10_10_REV": PackedType("uint32", ((0, 10), (10, 10), (20, 10), (30, 2))),
}
READ_TYPES = (*COMPONENT_TYPES, *PACKED_TYPES)


def packed_formats(packed: str) -> tuple[str, ...]:
    """The image formats whose groups a packed type holds. Source: OpenGL 1.2.1 table 3.8."""
    return ("RGB",) if len(PACKED_TYPES[packed].fields) == 3 else ("RGBA", "BGRA")


# The internal formats that can read a surface's words: those of its width and components. Source:
# WGL_ARB_render_texture (BIND_TO_TEXTURE_RGB_ARB and RGBA_ARB).
READABLE_AS = {
    **dict.fromkeys(
        (
            ColorFormat.A8R8G8B8,
            ColorFormat.X8R8G8B8_Z8R8G8B8,
            ColorFormat.X8R8G8B8_O8R8G8B8,
            ColorFormat.X1A7R8G8B8_Z1A7R8G8B8,
            ColorFormat.X1A7R8G8B8_O1A7R8G8B8,
        ),
        (InternalFormat.RGBA8, InternalFormat.RGB8),
    ),
    ColorFormat.R5G6B5: (InternalFormat.R5_G6_B5,),
    ColorFormat.X1R5G5B5_Z1R5G5B5: (InternalFormat.RGB5, InternalFormat.RGB5_A1),
    ColorFormat.X1R5G5B5_O1R5G5B5: (InternalFormat.RGB5, InternalFormat.RGB5_A1),
}

# The depth format that can read a surface's depth words. Source: WGL_NV_render_depth_texture.
DEPTH_READABLE_AS = {
    DepthFormat.FIXED_16: InternalFormat.DEPTH_COMPONENT16,
    DepthFormat.FIXED_24: InternalFormat.DEPTH_COMPONENT24,
    DepthFormat.FLOAT_16: InternalFormat.DEPTH_COMPONENT16_FLOAT,
    DepthFormat.FLOAT_24: InternalFormat.DEPTH_COMPONENT24_FLOAT,
}

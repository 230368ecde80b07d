"""The formats in which images lie in a client's memory, and which textures read a surface's words."""

from fixedpipe.pipeline.enums import ColorFormat, DepthFormat, InternalFormat

# Which of R, G, B and A each element of an image's group is: L is all three colours.
# Source: OpenGL 1.2.1 table 3.6 and section 3.6.4, Conversion to RGB and Final Expansion to RGBA.
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

# What ReadPixels reads colours as.  Source: OpenGL 1.2.1 section 4.3.2.
READ_FORMATS = tuple(name for name in IMAGE_FORMATS if name not in ("BGRA", "BGR"))
# What it returns them as: bits of a component, None: floats.  Source: OpenGL 1.2.1 table 4.7.
READ_TYPES = {"UNSIGNED_BYTE": 8, "UNSIGNED_SHORT": 16, "FLOAT": None}

# Which internal formats read a surface's words: those of its width and components.
# Source: WGL_ARB_render_texture (BIND_TO_TEXTURE_RGB_ARB and RGBA_ARB).
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

# Which depth format reads a surface's depth words. Source: WGL_NV_render_depth_texture.
DEPTH_READABLE_AS = {
    DepthFormat.FIXED_16: InternalFormat.DEPTH_COMPONENT16,
    DepthFormat.FIXED_24: InternalFormat.DEPTH_COMPONENT24,
    DepthFormat.FLOAT_16: InternalFormat.DEPTH_COMPONENT16_FLOAT,
    DepthFormat.FLOAT_24: InternalFormat.DEPTH_COMPONENT24_FLOAT,
}

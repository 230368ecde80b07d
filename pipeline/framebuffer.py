"""The framebuffer: colour, depth and stencil, top row first, and what reads and writes whole rectangles of
it.
"""

from dataclasses import dataclass

import numpy as np

from pipeline.enums import ColorFormat, DepthFormat, InternalFormat, WindowOrigin
from pipeline.textures import (
    BASE_FORMAT,
    COMPONENT_BITS,
    DEPTH_TEXELS,
    KEPT,
    Texture,
    depth_texels,
    pyramid,
    register_components,
    store_texels,
    widen_to_byte,
)

# A surface's 32-bit words, red in the low byte, each component at the top of its byte: the bits that it
# keeps, those that are always one, and its alpha as a factor: 0 the byte, 1 always 255, 2 seven bits,
# replicated.
# Measured: Blend_surface captures (16 of 16 pictures of 16384 pixels; DstAlpha pictures).
SURFACE_WORDS = {
    ColorFormat.A8R8G8B8: (0xFFFFFFFF, 0, 0),
    ColorFormat.X8R8G8B8_Z8R8G8B8: (0x00FFFFFF, 0, 1),
    ColorFormat.X8R8G8B8_O8R8G8B8: (0x00FFFFFF, 0xFF000000, 1),
    ColorFormat.X1A7R8G8B8_Z1A7R8G8B8: (0x7FFFFFFF, 0, 2),
    ColorFormat.X1A7R8G8B8_O1A7R8G8B8: (0x7FFFFFFF, 0x80000000, 2),
    ColorFormat.R5G6B5: (0x00F8FCF8, 0, 1),
    ColorFormat.X1R5G5B5_Z1R5G5B5: (0x00F8F8F8, 0, 1),
    ColorFormat.X1R5G5B5_O1R5G5B5: (0x00F8F8F8, 0x80000000, 1),
}


def surface_bytes(rgba, color_format):
    """A colour as a surface stores it: uint8 [4] to uint8 [4], components at the top of their bytes."""
    keep, pad, alpha = SURFACE_WORDS[color_format]
    word = int(rgba.view(np.uint32)[0])
    if alpha == 2:
        word = (word & 0x00FFFFFF) | ((word >> 1) & 0x7F000000)
    return np.array([(word & keep) | pad], np.uint32).view(np.uint8)


def to_byte(value):
    """``floor(255 c + 1/2)`` of c clamped to [0, 1]. Source: OpenGL 1.2.1 section 2.13.9."""
    return int(np.floor(255.0 * min(max(value, 0.0), 1.0) + 0.5))


@dataclass(eq=False)
class Framebuffer:
    """color uint8 [h, w, 4] RGBA; depth uint32 [h, w], 0 .. 2**depth_bits - 1; stencil uint8 [h, w]. Top row
    first.

    A new one holds zero colour, the farthest depth and stencil zero. A component narrower than a byte has its
    bits at the top of one, zeros below.
    """

    color: np.ndarray
    depth: np.ndarray
    stencil: np.ndarray
    depth_format: DepthFormat
    color_format: ColorFormat = ColorFormat.A8R8G8B8

    @classmethod
    def new(cls, width, height, depth_bits=24, color_format=ColorFormat.A8R8G8B8):
        """An empty framebuffer of ``width`` x ``height`` pixels."""
        return cls(
            np.zeros((height, width, 4), np.uint8),
            np.full((height, width), 2 ** abs(depth_bits) - 1, np.uint32),
            np.zeros((height, width), np.uint8),
            DepthFormat(depth_bits),
            color_format,
        )

    @property
    def depth_bits(self):
        """How wide a word of the depth buffer is."""
        return abs(self.depth_format)

    @property
    def width(self):
        """Pixels in a row."""
        return self.color.shape[1]

    @property
    def height(self):
        """Rows."""
        return self.color.shape[0]

    def image(self):
        """A copy of the colours for saving: uint8 [h, w, 4], top row first."""
        return self.color.copy()

    def _rows(self, x, y, width, height):
        """Slices of a window rectangle (origin lower left, y up) in rows from the top."""
        return slice(self.height - y - height, self.height - y), slice(x, x + width)

    def clear(self, command):
        """Section 4.2.3: through the scissor box and the masks."""
        box = command.scissor
        where = (slice(None), slice(None))
        if box is not None:
            left, right = max(box.x, 0), min(box.x + box.width, self.width)
            low, high = max(box.y, 0), min(box.y + box.height, self.height)
            where = self._rows(left, low, max(right - left, 0), max(high - low, 0))
        if command.color is not None:
            mask = command.color_mask
            written = (mask.red, mask.green, mask.blue, mask.alpha)
            value = surface_bytes(np.array([to_byte(c) for c in command.color], np.uint8), self.color_format)
            if all(written):  # whole pixels at once
                self.color.view(np.uint32)[(*where, 0)] = value.view(np.uint32)[0]
            else:
                for channel in np.flatnonzero(written):
                    self.color[(*where, channel)] = value[channel]
        if command.depth is not None:
            depth = min(max(command.depth, 0.0), 1.0)
            self.depth[where] = int(np.floor(depth * (2**self.depth_bits - 1) + 0.5))
        if command.stencil is not None:
            keep = 0xFF & ~command.stencil_write_mask
            self.stencil[where] = (self.stencil[where] & keep) | (
                command.stencil & command.stencil_write_mask
            )

    def rectangle(self, x, y, width, height):
        """Colours of a window rectangle, uint8 [h, w, 4], bottom row first."""
        return self.color[self._rows(x, y, width, height)][::-1]

    def read(self, command):
        """Section 4.3.2: see ``pipeline.commands.ReadPixels`` for the formats."""
        width = self.width - command.x if command.width is None else command.width
        height = self.height - command.y if command.height is None else command.height
        rows = self._rows(command.x, command.y, width, height)
        if command.format == "DEPTH_COMPONENT":
            return self.depth[rows][::-1].copy()
        if command.format == "STENCIL_INDEX":
            return self.stencil[rows][::-1].copy()
        rgba = self.rectangle(command.x, command.y, width, height)
        return READ_FORMATS[command.format](rgba).copy()


def _luminance(rgba):
    return np.minimum(rgba[..., :3].astype(np.uint16).sum(-1), 255).astype(np.uint8)


# Source: OpenGL 1.2.1 section 4.3.2, conversion of RGBA to luminance: R + G + B, clamped.
READ_FORMATS = {
    "RGBA": lambda rgba: rgba,
    "RGB": lambda rgba: rgba[..., :3],
    "RED": lambda rgba: rgba[..., 0],
    "GREEN": lambda rgba: rgba[..., 1],
    "BLUE": lambda rgba: rgba[..., 2],
    "ALPHA": lambda rgba: rgba[..., 3],
    "LUMINANCE": _luminance,
    "LUMINANCE_ALPHA": lambda rgba: np.stack([_luminance(rgba), rgba[..., 3]], -1),
}


def copied_texture(framebuffer, command):
    """CopyTexImage1D/2D: the texture that a framebuffer rectangle defines."""
    width = framebuffer.width - command.x if command.width is None else command.width
    height = framebuffer.height - command.y if command.height is None else command.height
    texels = store_texels(framebuffer.rectangle(command.x, command.y, width, height), command.internal_format)
    texels.setflags(write=False)
    levels = pyramid(texels[None]) if command.generate_mipmap else (texels[None],)
    return Texture(command.target, command.internal_format, levels)


def replaced_texture(framebuffer, command, texture):
    """CopyTexSubImage1D/2D: the texture with a rectangle of one level replaced."""
    rgba = framebuffer.rectangle(command.x, command.y, command.width, command.height)
    level = texture.levels[command.level].copy()
    rows = slice(command.y_offset, command.y_offset + command.height)
    columns = slice(command.x_offset, command.x_offset + command.width)
    level[command.face, rows, columns] = store_texels(rgba, texture.internal_format)
    level.setflags(write=False)
    if command.generate_mipmap:
        levels = pyramid(level)
    else:
        levels = (*texture.levels[: command.level], level, *texture.levels[command.level + 1 :])
    return Texture(texture.target, texture.internal_format, levels)


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
    16: InternalFormat.DEPTH_COMPONENT16,
    24: InternalFormat.DEPTH_COMPONENT24,
    -16: InternalFormat.DEPTH_COMPONENT16_FLOAT,
    -24: InternalFormat.DEPTH_COMPONENT24_FLOAT,
}


def bound_texture(framebuffer, command):
    """BindTexImage: the texture that a pbuffer's colours, or depths, are."""
    rows = slice(None, None, 1 if command.origin == WindowOrigin.UPPER_LEFT else -1)
    if command.internal_format in DEPTH_TEXELS:
        return Texture(
            command.target, command.internal_format, (depth_texels(framebuffer.depth[rows])[None],)
        )
    rgba = framebuffer.color[rows]
    base, bits = BASE_FORMAT[command.internal_format], COMPONENT_BITS[command.internal_format]
    components = np.stack(
        [widen_to_byte(rgba[..., kept] >> (8 - b), b) for kept, b in zip(KEPT[base], bits, strict=True)], -1
    )
    texels = register_components(components, base, np.uint8(255))
    return Texture(command.target, command.internal_format, (texels[None],))

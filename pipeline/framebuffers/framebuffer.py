"""The framebuffer: colour, depth and stencil, top row first; how it is cleared and read."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import (
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    ReadPixels,
    Saturate,
    box_read,
)
from fixedpipe.pipeline.enums import ColorBuffer, ColorFormat, DepthFormat
from fixedpipe.pipeline.framebuffers.bounds import scissored, scissored_part
from fixedpipe.pipeline.framebuffers.scaled_words import Words
from fixedpipe.pipeline.framebuffers.transfer import (
    PixelStatistics,
    packed_bytes,
    packed_colors,
    transfer_colors,
    transfer_depths,
    transfer_stencil,
)
from fixedpipe.pipeline.pixel_transfer import changes_nothing
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.pixel_formats import DEPTH_FORMAT, STENCIL_FORMAT
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.numbers import convert
from fixedpipe.raster.pixels.transfer import fixed

# A surface's 32-bit words, with red in the low byte and each component at the top of its byte. For each
# format: the bits that it keeps, the bits that are always one, and its alpha as a factor (seven bits:
# replicated). Measured: Blend_surface captures (16 of 16 pictures of 16384 pixels; DstAlpha pictures).
SURFACE_WORDS = {
    ColorFormat.A8R8G8B8: (0xFFFFFFFF, 0, C.SURFACE_ALPHA_STORED),
    ColorFormat.X8R8G8B8_Z8R8G8B8: (0x00FFFFFF, 0, C.SURFACE_ALPHA_ONE),
    ColorFormat.X8R8G8B8_O8R8G8B8: (0x00FFFFFF, 0xFF000000, C.SURFACE_ALPHA_ONE),
    ColorFormat.X1A7R8G8B8_Z1A7R8G8B8: (0x7FFFFFFF, 0, C.SURFACE_ALPHA_SEVEN_BITS),
    ColorFormat.X1A7R8G8B8_O1A7R8G8B8: (0x7FFFFFFF, 0x80000000, C.SURFACE_ALPHA_SEVEN_BITS),
    ColorFormat.R5G6B5: (0x00F8FCF8, 0, C.SURFACE_ALPHA_ONE),
    ColorFormat.X1R5G5B5_Z1R5G5B5: (0x00F8F8F8, 0, C.SURFACE_ALPHA_ONE),
    ColorFormat.X1R5G5B5_O1R5G5B5: (0x00F8F8F8, 0x80000000, C.SURFACE_ALPHA_ONE),
}


def surface_word(rgba: Sequence[int], color_format: ColorFormat) -> int:
    """The word that a surface stores for a colour of four bytes, with red in the low byte."""
    keep, pad, alpha = SURFACE_WORDS[color_format]
    red, green, blue, a = rgba
    stored = a >> 1 if alpha == C.SURFACE_ALPHA_SEVEN_BITS else a
    word = red | green << 8 | blue << 16 | stored << 24
    return (word & keep) | pad


def _write(words, value, mask, all_bits):
    """Write the bits of ``value`` that ``mask`` selects into an array of words or bytes."""
    if mask == all_bits:
        words[...] = value
    elif mask:
        words[...] = (words & (all_bits & ~mask)) | (value & mask)


def to_code(value: float, one: int = 255) -> int:
    """``floor(255 c + 1/2)`` of c clamped to [0, 1], or with another value of ``one``.

    Source: OpenGL 1.2.1 section 2.13.9.
    """
    return int(one * min(max(value, 0.0), 1.0) + 0.5)


@dataclass(eq=False)
class Framebuffer:
    """The colours, depths and stencil values of a window or pbuffer, top row first.

    - ``color``: uint8 [h, w, 4] RGBA, or int32 (below). A component narrower than a byte has its bits at the
      top of the byte, with zeros below.
    - ``depth``: uint32 [h, w], 0 .. 2**depth_bits - 1.
    - ``stencil``: uint8 [h, w].
    - ``color_bits``: the number of bits of a colour component.
    - ``accumulation``: int32 [h, w, 4] (docs/numbers.md, section 16); None until a command stores in it.
    - ``samples``: the number of samples of a pixel; with several, colours are their means.
    - ``shares_depth``, ``depth_of``: from the MakeCurrent. ``take_depths`` keeps such framebuffers equal.

    A new framebuffer holds zero colour, the farthest depth and stencil zero. Colours are int32 where
    ``color_bits`` is not 8 or blending does not clamp; 2**color_bits - 1 is then one. Values leave [0, one]
    only where blending does not clamp.
    """

    color: NDArray[np.uint8 | np.int32]
    depth: NDArray[np.uint32]
    stencil: NDArray[np.uint8]
    depth_format: DepthFormat
    color_format: ColorFormat = ColorFormat.A8R8G8B8
    color_bits: int = 8
    accumulation: NDArray[np.int32] | None = None
    samples: int = 1
    shares_depth: bool = False
    depth_of: str | None = None
    _auxiliary: dict[ColorBuffer, "Framebuffer"] = field(default_factory=dict)

    @classmethod
    def new(
        cls,
        width: int,
        height: int,
        depth_bits: int = 24,
        color_format: ColorFormat = ColorFormat.A8R8G8B8,
        color_bits: int = 8,
        clamped: bool = True,
        *,
        samples: int = 1,
        shares_depth: bool = False,
        depth_of: str | None = None,
    ) -> "Framebuffer":
        """An empty framebuffer of ``width`` x ``height`` pixels. ``clamped``: blending clamps."""
        return cls(
            np.zeros((height, width, 4), np.uint8 if color_bits == 8 and clamped else np.int32),
            np.full((height, width), 2 ** DepthFormat(depth_bits).bits - 1, np.uint32),
            np.zeros((height, width), np.uint8),
            DepthFormat(depth_bits),
            color_format,
            color_bits,
            samples=samples,
            shares_depth=shares_depth,
            depth_of=depth_of,
        )

    def take_depths(self, other: "Framebuffer") -> None:
        """Copy another's depths and stencil values to the pixels at the same distances from left and top."""
        both = slice(min(self.height, other.height)), slice(min(self.width, other.width))
        self.depth[both], self.stencil[both] = other.depth[both], other.stencil[both]

    @property
    def depth_bits(self) -> int:
        """The number of bits of a word of the depth buffer."""
        return self.depth_format.bits

    @property
    def width(self) -> int:
        """The number of pixels in a row."""
        return self.color.shape[1]

    @property
    def height(self) -> int:
        """The number of rows."""
        return self.color.shape[0]

    @cached_property
    def kind(self) -> str:
        """Its size and formats: equal for framebuffers that a pass has the same rows for."""
        formats = self.depth_format.name, self.color_format.name, self.color_bits, self.color.dtype
        return f"{self.width}x{self.height} {formats}"

    def buffer(self, which: ColorBuffer) -> "Framebuffer":
        """The framebuffer for a ColorBuffer: this one, or one with an auxiliary buffer's colours.

        An auxiliary buffer's colours are zero at first. Its framebuffer has the same depths and stencil
        values.
        """
        if which == ColorBuffer.BACK:
            return self
        if which not in self._auxiliary:
            self._auxiliary[which] = replace(self, color=np.zeros_like(self.color), _auxiliary={})
        return self._auxiliary[which]

    def copy(self) -> "Framebuffer":
        """A framebuffer with copies of all contents, including auxiliary buffers."""
        depth, stencil = self.depth.copy(), self.stencil.copy()
        held = {
            which: replace(other, color=other.color.copy(), depth=depth, stencil=stencil, _auxiliary={})
            for which, other in self._auxiliary.items()
        }
        return replace(
            self,
            color=self.color.copy(),
            depth=depth,
            stencil=stencil,
            accumulation=None if self.accumulation is None else self.accumulation.copy(),
            _auxiliary=held,
        )

    def image(self) -> NDArray[np.uint8]:
        """A copy of the colours for saving: uint8 [h, w, 4], top row first, clamped, rounded to nearest."""
        return self.as_bytes(self.color).copy()

    @property
    def is_bytes(self) -> bool:
        """Whether colours are the bytes that the native engines write."""
        return self.color.dtype == np.uint8

    def as_bytes(self, color: NDArray[Any]) -> NDArray[np.uint8]:
        """Colours of this buffer as bytes."""
        if self.is_bytes:
            return color
        one = 2**self.color_bits - 1
        return convert(np.clip(color, 0, one).astype(np.int64), one, 255).astype(np.uint8)

    def _rows(self, x, y, width, height):
        """Slices of a window rectangle (origin lower left, y up) in rows from the top."""
        return slice(self.height - y - height, self.height - y), slice(x, x + width)

    def clear_words(self, command: Clear) -> tuple[tuple[int, int, int, int], int, int, int, int, int, int]:
        """The words and masks that a Clear writes (section 4.2.3).

        Returns, in order: the box (x0, y0, x1, y1) in device pixels, half open; the buffers (bits:
        codes.BUFFER_...); the colour's word and its mask; the depth's word; the stencil's byte and its mask.
        """
        buffers, color, color_mask, depth = 0, 0, 0, 0
        if command.color is not None:
            buffers, channels = C.BUFFER_COLOR, command.color_mask
            color = surface_word([to_code(c) for c in command.color], self.color_format)
            for channel, on in enumerate((channels.red, channels.green, channels.blue, channels.alpha)):
                color_mask |= 0xFF << (8 * channel) if on else 0
        if command.depth is not None:
            buffers |= C.BUFFER_DEPTH
            depth = int(min(max(command.depth, 0.0), 1.0) * (2**self.depth_bits - 1) + 0.5)
        if command.stencil is not None:
            buffers |= C.BUFFER_STENCIL
        stencil = 0 if command.stencil is None else int(command.stencil)
        box, mask = scissored(command.scissor, self.width, self.height), int(command.stencil_write_mask)
        return box, buffers, color, color_mask, depth, stencil, mask

    def saturate(self, command: Saturate) -> None:
        """Clamp the colours in the scissor box to [0, 1]; bytes already are."""
        color = self.color[scissored_part(command.scissor, self.width, self.height)]
        np.clip(color, 0, 2**self.color_bits - 1, out=color)

    def clear(self, command: Clear) -> None:
        """Clear the buffers (section 4.2.3), through the scissor box and the masks."""
        (x0, y0, x1, y1), buffers, color, color_mask, depth, stencil, mask = self.clear_words(command)
        where = slice(y0, y1), slice(x0, x1)
        if buffers & C.BUFFER_COLOR and not self.is_bytes:
            on = command.color_mask
            channels = np.array([on.red, on.green, on.blue, on.alpha])
            wide = fixed(np.array(command.color), self.color_bits)
            self.color[where] = np.where(channels, wide, self.color[where])
        elif buffers & C.BUFFER_COLOR:
            _write(self.color.view(np.uint32)[..., 0][where], color, color_mask, 0xFFFFFFFF)
        if buffers & C.BUFFER_DEPTH:
            self.depth[where] = depth
        if buffers & C.BUFFER_STENCIL:
            _write(self.stencil[where], stencil, mask, 0xFF)

    def rectangle(self, x: int, y: int, width: int, height: int) -> NDArray[np.uint8 | np.int32]:
        """Colours of a window rectangle, [h, w, 4] of the buffer's type, bottom row first."""
        return self.color[self._rows(x, y, width, height)][::-1]

    def groups(self, x: int, y: int, width: int, height: int) -> Words:
        """Colours of a window rectangle as pixel groups [h, w, 4], bottom row first.

        Section 4.3.2, Conversion of RGBA values.
        """
        return Words(self.rectangle(x, y, width, height), (2**self.color_bits - 1,) * 4)

    def depths(self, x: int, y: int, width: int, height: int) -> NDArray[np.float64]:
        """Depths of a window rectangle, float64 [h, w] in [0, 1], bottom row first; fixed formats alone."""
        return self.depth[self._rows(x, y, width, height)][::-1] / float(2**self.depth_bits - 1)

    def box_of(
        self, command: ReadPixels | CopyPixels | CopyTexImage | CopyTexSubImage
    ) -> tuple[int, int, int, int]:
        """The box that a command reads: (x, y, width, height) in window coordinates."""
        return box_read(command, self.width, self.height)

    def part(
        self, plane: NDArray[Any], command: ReadPixels | CopyPixels | CopyTexImage | CopyTexSubImage
    ) -> NDArray[Any]:
        """A view of the part of a buffer of this size that a command reads, bottom row first."""
        return plane[self._rows(*self.box_of(command))][::-1]

    def read(self, command: ReadPixels, profile: Profile, statistics: PixelStatistics) -> NDArray[Any] | None:
        """Section 4.3.2: the pixels that ReadPixels returns; None where a sink took them.

        ``statistics`` are the machine's PixelStatistics.
        """
        box, transfer = self.box_of(command), command.transfer
        if command.format == DEPTH_FORMAT:
            if (transfer.depth_scale, transfer.depth_bias) == (1.0, 0.0):
                return self.part(self.depth, command).copy()
            return fixed(transfer_depths(self.depths(*box), transfer), self.depth_bits).astype(np.uint32)
        if command.format == STENCIL_FORMAT:
            indices = self.part(self.stencil, command).astype(np.int64)
            return (transfer_stencil(indices, transfer) & 0xFF).astype(np.uint8)
        if self.is_bytes and command.type == "UNSIGNED_BYTE" and changes_nothing(transfer):
            return packed_bytes(self.rectangle(*box), command.format)
        groups = transfer_colors(self.groups(*box), transfer, profile, statistics)
        return None if groups is None else packed_colors(groups, command.format, command.type)


def color_codes(color: Iterable[float], one: int = 255) -> list[int]:
    """A colour's components in [0, 1] as whole numbers: bytes, or with another value of ``one``."""
    return [to_code(component, one) for component in color]

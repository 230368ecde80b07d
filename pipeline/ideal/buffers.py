"""The ideal machine's framebuffer during a frame: clears, accumulation and reads."""

from copy import copy

import numpy as np

from fixedpipe.pipeline.commands import box_read
from fixedpipe.pipeline.enums import AccumOperation, ColorBuffer
from fixedpipe.pipeline.framebuffers import bounds
from fixedpipe.pipeline.framebuffers.transfer import (
    elements_of,
    transfer_colors,
    transfer_depths,
    transfer_stencil,
)
from fixedpipe.pipeline.pixel_transfer import changes_nothing
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.pixel_formats import DEPTH_FORMAT, STENCIL_FORMAT


class IdealBuffers:
    """The framebuffer during a frame, top row first. A fragment addresses it by flat index."""

    def __init__(self, width, height):
        # Its first contents are those of the machine's framebuffer.
        self.color = np.zeros((height, width, 4))
        self.depth = np.ones((height, width))
        self.stencil = np.zeros((height, width), np.uint8)
        self.accumulation = np.zeros((height, width, 4))
        self._auxiliary = {}

    def buffer(self, which):
        """The buffer that a ColorBuffer names: these buffers, or others that share their depths and stencil
        values.
        """
        if which is ColorBuffer.BACK:
            return self
        if which not in self._auxiliary:
            self._auxiliary[which] = copy(self)
            self._auxiliary[which].color = np.zeros_like(self.color)
        return self._auxiliary[which]

    def copy(self):
        """An independent copy of the buffers."""
        held, depth = IdealBuffers(*self.depth.shape[::-1]), self.depth.copy()
        for which in (ColorBuffer.BACK, *self._auxiliary):
            held.buffer(which).color = self.buffer(which).color.copy()
            held.buffer(which).depth, held.buffer(which).stencil = depth, self.stencil.copy()
        held.accumulation = self.accumulation.copy()
        return held

    def drawn_to(self, command):
        """The buffer that a command draws to. A command that draws to none gives the back buffer."""
        written = getattr(command, "state", command)
        return self.buffer(getattr(written, "draw_buffer", ColorBuffer.BACK))

    def box_of(self, command):
        """The box that a command reads: (x, y, width, height)."""
        height, width = self.depth.shape
        return box_read(command, width, height)

    def rows(self, plane, x, y, width, height):
        """A window rectangle (y up) of a buffer, bottom row first; a view."""
        return plane[::-1][y : y + height, x : x + width]


def written_channels(color_mask):
    """Which of red, green, blue and alpha a color mask lets through: bool [4]."""
    return np.array([color_mask.red, color_mask.green, color_mask.blue, color_mask.alpha])


def scissored(scissor, buffers):
    """x, y, width, height of the scissor box within the framebuffer."""
    height, width = buffers.depth.shape
    left, top, right, bottom = bounds.scissored(scissor, width, height)
    return left, height - bottom, right - left, bottom - top


def clear(command, buffers):
    """Clear the buffers inside the scissor box, through the masks (section 4.2.3)."""
    box = scissored(command.scissor, buffers)
    if command.color is not None:
        buffers.rows(buffers.color, *box)[..., written_channels(command.color_mask)] = np.array(
            command.color
        )[written_channels(command.color_mask)]
    if command.depth is not None:
        buffers.rows(buffers.depth, *box)[...] = command.depth
    if command.stencil is not None:
        kept = buffers.rows(buffers.stencil, *box)
        kept[...] = (kept & ~np.uint8(command.stencil_write_mask)) | np.uint8(
            command.stencil & command.stencil_write_mask
        )
    if command.accumulation is not None:
        buffers.rows(buffers.accumulation, *box)[...] = command.accumulation


def saturate(command, buffers):
    """Clamp the colours inside the scissor box to [0, 1]."""
    color = buffers.rows(buffers.color, *scissored(command.scissor, buffers))
    np.clip(color, 0.0, 1.0, out=color)


def accumulate(command, buffers):
    """Section 4.2.4 without any clamp, even for RETURN: colours may exceed 1, as after blending."""
    box, value = scissored(command.scissor, buffers), command.value
    sums = buffers.rows(buffers.accumulation, *box)
    match command.operation:
        case AccumOperation.LOAD | AccumOperation.ACCUM:
            read = value * buffers.rows(buffers.buffer(command.read_buffer).color, *box)
            sums[...] = read if command.operation is AccumOperation.LOAD else sums + read
        case AccumOperation.ADD:
            sums += value
        case AccumOperation.MULT:
            sums *= value
        case AccumOperation.RETURN:
            written, mask = buffers.rows(buffers.buffer(command.draw_buffer).color, *box), command.color_mask
            written[..., written_channels(mask)] = (value * sums)[..., written_channels(mask)]
        case _:
            raise ValueError(f"The ideal machine has no accumulation operation {command.operation.name}.")


def transferred(region, command, statistics, dimensions=2):
    """Colours after a command's pixel transfer; None: a sink took them."""
    if changes_nothing(command.transfer):
        return region
    return transfer_colors(region, command.transfer, IDEAL, statistics, dimensions)


def read_pixels(command, buffers, guide, statistics):
    """The pixels of a ReadPixels, bottom row first; None: a sink took them. ``guide``: a Result or None."""
    box, transfer = buffers.box_of(command), command.transfer
    if command.format == STENCIL_FORMAT:
        if guide:
            return guide.pixels[command.name]
        indices = transfer_stencil(buffers.rows(buffers.stencil, *box).astype(np.int64), transfer)
        return (indices & 0xFF).astype(np.uint8)
    if command.format == DEPTH_FORMAT:
        if guide:
            return guide.pixels[command.name] / (2.0**guide.framebuffer.depth_bits - 1.0)
        return transfer_depths(buffers.rows(buffers.depth, *box), transfer)
    color = transferred(buffers.rows(buffers.color, *box), command, statistics)
    if color is None:
        return None
    return elements_of(color, command.format)

"""Accum and the accumulation buffer's Clear (OpenGL 1.2.1 sections 4.2.3 and 4.2.4)."""

import numpy as np

from fixedpipe.pipeline.enums import AccumOperation
from fixedpipe.pipeline.framebuffers.bounds import scissored_part
from fixedpipe.raster.pixels.accumulation import added, from_colors, from_value, multiplied, to_colors


def _full(profile):
    """The buffer's word for 1.0."""
    return 2 ** (profile.framebuffers.accumulation_bits - 1) - 1


def accumulation_of(framebuffer):
    """The window's accumulation buffer, created with zeros at first use."""
    if framebuffer.accumulation is None:
        framebuffer.accumulation = np.zeros(framebuffer.color.shape, np.int32)
    return framebuffer.accumulation


def clear_accumulation(framebuffer, command, profile):
    """Clear the accumulation buffer, for a Clear with ``accumulation``."""
    box = scissored_part(command.scissor, framebuffer.width, framebuffer.height)
    full = _full(profile)
    accumulation_of(framebuffer)[box] = [from_value(component, full) for component in command.accumulation]


def accumulate(framebuffer, command, profile):
    """Execute an Accum; ``framebuffer`` is the window's."""
    box = scissored_part(command.scissor, framebuffer.width, framebuffer.height)
    buffer, full, value = accumulation_of(framebuffer)[box], _full(profile), float(command.value)
    one = 2**framebuffer.color_bits - 1
    with np.errstate(over="ignore"):  # Values that overflow are clamped.
        match command.operation:
            case AccumOperation.LOAD | AccumOperation.ACCUM:
                colors = framebuffer.buffer(command.read_buffer).color[box]
                loaded = from_colors(colors, one, value, full)
                loading = command.operation == AccumOperation.LOAD
                buffer[...] = loaded if loading else added(buffer, loaded, full)
            case AccumOperation.ADD:
                buffer[...] = added(buffer, from_value(value, full), full)
            case AccumOperation.MULT:
                buffer[...] = multiplied(buffer, value, full)
            case AccumOperation.RETURN:
                color, mask = framebuffer.buffer(command.draw_buffer).color[box], command.color_mask
                returned = to_colors(buffer, one, value, full)
                for channel, on in enumerate((mask.red, mask.green, mask.blue, mask.alpha)):
                    if on:
                        color[..., channel] = returned[..., channel]
            case _:
                raise ValueError(f"{command.operation!r} is no accumulation operation.")

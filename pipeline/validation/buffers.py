"""Validation of buffers, and of the commands that clear, accumulate and read them."""

from fixedpipe.pipeline.enums import AccumOperation, ColorBuffer, DepthFormat
from fixedpipe.pipeline.messages import count, depth_words
from fixedpipe.pipeline.pixel_transfer import has_sink
from fixedpipe.pipeline.textures.pixel_formats import (
    DEPTH_FORMAT,
    PACKED_TYPES,
    READ_FORMATS,
    READ_TYPES,
    STENCIL_FORMAT,
    packed_formats,
)
from fixedpipe.pipeline.validation import surfaces
from fixedpipe.pipeline.validation.transfer import transferred


def color_buffer(walk, which):
    """Refuse a colour buffer that does not exist."""
    most = walk.profile.framebuffers.auxiliary_buffers
    if which > most:
        walk.refuse(
            f"{walk.profile.name} has {count(most, 'auxiliary buffer')} and so no {which.name}; use "
            "BACK and keep what is still needed as a texture."
        )
    if which is not ColorBuffer.BACK and not walk.in_window:
        walk.refuse(f"a pbuffer has no {which.name}; make the window current first.")


def accumulation_buffer(walk):
    """Refuse the command where no accumulation buffer exists."""
    if walk.profile.framebuffers.accumulation_bits == 0:
        walk.refuse(
            f"{walk.profile.name} has no accumulation buffer; add up by blending with ONE, ONE instead."
        )
    if not walk.in_window:
        walk.refuse("a pbuffer has no accumulation buffer; make the window current first.")


def stencil_buffer(walk, what):
    """Refuse the command where no stencil buffer exists; ``what`` says what the command does with it."""
    if walk.profile.framebuffers.stencil_bits == 0:
        walk.refuse(f"it {what}, and {walk.profile.name} has none; choose a profile that has one.")


def stencil_value(walk, what, value):
    """Refuse a stencil value or mask of more than 8 bits."""
    if not 0 <= value <= 0xFF:
        walk.refuse(f"{what} is {value}; a stencil value has 8 bits: give 0 to 255.")


def fixed_depths(walk, read, what):
    """Refuse floating-point depths where the command computes with depths.

    ``read`` says whether the command does so, and ``what`` says how.
    """
    if read and DepthFormat(walk.depth_bits).is_float:
        walk.refuse(
            f"it {what} of {depth_words(walk.depth_bits)}; only fixed-point depths go through pixel "
            "transfer. Give the depth buffer a fixed format."
        )


def clear(walk, command):
    """Refuse a Clear of buffers that do not exist, or to values that they cannot hold."""
    if command.depth is not None and not 0 <= command.depth <= 1:
        walk.refuse(
            f"the clear depth is {command.depth}; depths run from 0 (near) to 1 (far). Give one of these."
        )
    if command.stencil is not None:
        stencil_buffer(walk, "clears the stencil buffer")
        stencil_value(walk, "the clear value of the stencil buffer", command.stencil)
    stencil_value(walk, "stencil_write_mask", command.stencil_write_mask)
    if command.scissor is not None:
        surfaces.scissor(walk, command.scissor)
    if command.accumulation is not None:
        accumulation_buffer(walk)
        if not all(-1 <= component <= 1 for component in command.accumulation):
            walk.refuse(
                f"the clear value of the accumulation buffer is {command.accumulation}; it holds -1 to 1."
            )
    color_buffer(walk, command.draw_buffer)
    if command.accumulation is None and command.draw_buffer is ColorBuffer.BACK:
        walk.taken.states.add(command)


def accum(walk, command):
    """Refuse an Accum of buffers that do not exist."""
    accumulation_buffer(walk)
    if command.scissor is not None:
        surfaces.scissor(walk, command.scissor)
    if command.operation is AccumOperation.RETURN:
        color_buffer(walk, command.draw_buffer)
    elif command.operation in (AccumOperation.LOAD, AccumOperation.ACCUM):
        color_buffer(walk, command.read_buffer)


def saturate(walk, command):
    """Refuse a Saturate of a buffer that does not exist."""
    color_buffer(walk, command.draw_buffer)
    if command.scissor is not None:
        surfaces.scissor(walk, command.scissor)


def read_as(walk, command, formats):
    """Refuse a name that is taken, a format outside ``formats``, or a type that cannot hold the format.

    The walk remembers the name.
    """
    what = type(command).__name__
    if command.format not in formats:
        walk.refuse(f"{what} knows no format {command.format!r}; give one of {', '.join(formats)}.")
    if command.name in walk.read:
        walk.refuse(
            f"an earlier ReadPixels or GetTexImage already has the name {command.name!r}; give this one "
            "another."
        )
    walk.read.add(command.name)
    if not has_sink(command.transfer):
        walk.given.add(command.name)
    if command.type not in READ_TYPES:
        walk.refuse(f"{what} knows no type {command.type!r}; give one of {', '.join(READ_TYPES)}.")
    if command.type in PACKED_TYPES and command.format not in packed_formats(command.type):
        walk.refuse(
            f"{command.type} holds groups of {' or '.join(packed_formats(command.type))}, and the format is "
            f"{command.format}; give that format, or a type of single components."
        )
    if command.format not in READ_FORMATS and command.type != "UNSIGNED_BYTE":
        walk.refuse(f"{command.format} is read in its own units whatever the type; leave type alone.")


def read_pixels(walk, command):
    """Refuse a ReadPixels of a buffer or rectangle that does not exist, or under a name that is taken."""
    read_as(walk, command, (*READ_FORMATS, DEPTH_FORMAT, STENCIL_FORMAT))
    if command.format == STENCIL_FORMAT:
        stencil_buffer(walk, "reads the stencil buffer")
    size = surfaces.framebuffer_rectangle(walk, command)
    color_buffer(walk, command.read_buffer)
    transferred(walk, command, *size, deep=command.format not in READ_FORMATS)
    scale = command.transfer.depth_scale, command.transfer.depth_bias
    fixed_depths(walk, command.format == DEPTH_FORMAT and scale != (1.0, 0.0), "scales depths")

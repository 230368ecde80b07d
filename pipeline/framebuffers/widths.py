"""The widths of fragments' colours and buffers' components, and the widths that kernels compute with."""

from fixedpipe.pipeline.profiles.profile import NATIVE_BITS
from fixedpipe.raster.rows import BITS_OF_BYTES, MOST_BITS


def fragment_bits(profile, framebuffer):
    """The width of fragments' colours in bits.

    It is the combiners' width, plus the number of bits by which the buffer exceeds the machine's usual width.
    """
    if framebuffer.color_bits not in profile.framebuffers.color_bits:  # a pbuffer of bytes
        return profile.arithmetic.combiner_bits
    return profile.arithmetic.combiner_bits + framebuffer.color_bits - profile.framebuffers.color_bits[0]


def widths_of(state, profile, framebuffer, textures):
    """The widths of all components that a pass computes with: fragments', the buffer's and each texture's."""
    return [
        fragment_bits(profile, framebuffer),
        framebuffer.color_bits,
        *[
            textures[unit.texture].bits
            for unit in state.texture_units
            if unit is not None and unit.texture is not None
        ],
    ]


def are_native(widths):
    """Whether all components are bytes."""
    return widths.count(NATIVE_BITS) == len(widths)


def are_for_kernels(widths):
    """Whether the portable engine's kernels compute with components of such widths."""
    return min(widths) >= BITS_OF_BYTES and max(widths) <= MOST_BITS

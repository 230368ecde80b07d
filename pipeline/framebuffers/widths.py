"""How wide fragments' colours are on their way to a buffer, and which widths kernels compute with."""

from fixedpipe.pipeline.profiles.profile import NATIVE_BITS
from fixedpipe.raster.rows import BITS_OF_BYTES, MOST_BITS


def fragment_bits(profile, framebuffer):
    """How wide fragments' colours are: as the combiners; where a buffer is wider than the machine's usual
    one, as much wider.
    """
    if framebuffer.color_bits not in profile.framebuffers.color_bits:  # a pbuffer's bytes
        return profile.arithmetic.combiner_bits
    return profile.arithmetic.combiner_bits + framebuffer.color_bits - profile.framebuffers.color_bits[0]


def widths_of(state, profile, framebuffer, textures):
    """How wide components are that a pass computes with: fragments', the buffer's and each texture's."""
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

"""What a surface's colour format keeps of a fragment, and what blending reads back."""

from fixedpipe.pipeline.enums import ColorFormat

# Bits of red, green, blue and alpha; the padding that fills the alpha byte from above, or None.
# Source: nv_objects.h, SURFACE_FORMAT_COLOR.
FORMATS = {
    ColorFormat.A8R8G8B8: (8, 8, 8, 8, None),
    ColorFormat.X8R8G8B8_Z8R8G8B8: (8, 8, 8, 0, "00000000"),
    ColorFormat.X8R8G8B8_O8R8G8B8: (8, 8, 8, 0, "11111111"),
    ColorFormat.X1A7R8G8B8_Z1A7R8G8B8: (8, 8, 8, 7, "0"),
    ColorFormat.X1A7R8G8B8_O1A7R8G8B8: (8, 8, 8, 7, "1"),
    ColorFormat.R5G6B5: (5, 6, 5, 0, "00000000"),
    ColorFormat.X1R5G5B5_Z1R5G5B5: (5, 5, 5, 0, "00000000"),
    ColorFormat.X1R5G5B5_O1R5G5B5: (5, 5, 5, 0, "10000000"),
}


def cut(byte, bits):
    """The highest ``bits`` bits of a byte, zeros below. Measured: Blend_surface captures."""
    return byte if bits == 8 else byte >> (8 - bits) << (8 - bits)


def to_surface(color, color_format):
    """Four bytes as a surface stores them: components at the top of their bytes, seven bits of alpha below
    their padding.

    Measured: Blend_surface captures (truncation in 16 of 16 pictures; seven bits from DstAlpha pictures).
    """
    *bits, alpha_bits, pad = FORMATS[color_format]
    rgb = [cut(c, b) for c, b in zip(color[:3], bits, strict=True)]
    if pad is None:
        return [*rgb, color[3]]
    return [*rgb, int(pad + format(color[3] >> 1, "07b"), 2) if alpha_bits else int(pad, 2)]


def padded(color, color_format):
    """Stored bytes with their padding written again, as a logic operation leaves them.

    Inferred: from the padding that blending writes (Blend_surface captures).
    """
    *bits, alpha_bits, pad = FORMATS[color_format]
    rgb = [cut(c, b) for c, b in zip(color[:3], bits, strict=True)]
    if pad is None:
        return [*rgb, color[3]]
    return [*rgb, int(pad + format(color[3] % 128, "07b"), 2) if alpha_bits else int(pad, 2)]


def blend_source(color, color_format):
    """The source of blending: its colour cut to the surface's bits, its alpha whole.

    Measured: Blend_surface captures (16 of 16 pictures).
    """
    bits = FORMATS[color_format][:3]
    return [*(cut(c, b) for c, b in zip(color[:3], bits, strict=True)), color[3]]


def blend_destination(stored, color_format):
    """The destination of blending: no alpha is 255, seven bits of it are replicated to eight.

    Measured: Blend_surface DstAlpha captures.
    """
    alpha_bits = FORMATS[color_format][3]
    if alpha_bits == 8:
        return stored
    return [*stored[:3], (stored[3] % 128 << 1) + (stored[3] % 128 >> 6) if alpha_bits else 255]

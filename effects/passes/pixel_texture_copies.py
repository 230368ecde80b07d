"""Passes with pixel textures, by copies of the framebuffer onto itself.

Material textures are loaded through a colour matrix. A polygon writes their dot products into channels of the
framebuffer, and the copies look them up. The stencil buffer marks the polygon's pixels, so copies leave the
others alone. ``through_host`` uses DrawPixels for the same, as Kautz, Seidel 2000, section 5, do (K15).

Source: SGIX_pixel_texture.
"""

import math
from functools import lru_cache

import numpy as np

from fixedpipe.effects.passes.arguments import one_of
from fixedpipe.effects.passes.draws import (
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MARK,
    MARKED,
    REPEATED,
    REPLACE,
    copy_of_panel,
)
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import Clear, CopyPixels, Draw, DrawPixels, HostStep, ReadPixels, TexImage
from fixedpipe.pipeline.enums import InternalFormat, PixelCopyType
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.state import (
    ColorMask,
    ColorTable,
    PassState,
    PixelTexture,
    TextureUnit,
)

TECHNIQUES = (Variant(("K15",), "the copies of which such passes are made"),)

RED = ColorMask(green=False, blue=False, alpha=False)
GREEN = ColorMask(red=False, blue=False, alpha=False)
BLUE = ColorMask(red=False, green=False, alpha=False)
ALPHA = ColorMask(red=False, green=False, blue=False)
GREEN_BLUE = ColorMask(red=False, alpha=False)
BLUE_ALPHA = ColorMask(red=False, green=False)
NOT_RED = ColorMask(red=False)
RGB = ColorMask(alpha=False)
RGBA = ColorMask()

# Rows of a colour matrix: what a component of the result is made of.
FROM_RED, FROM_GREEN, FROM_BLUE, FROM_ALPHA = (tuple(row) for row in np.eye(4).tolist())
NOTHING = (0.0, 0.0, 0.0, 0.0)

_FORMATS = {8: InternalFormat.RGBA8, 12: InternalFormat.RGBA12}


# ------------------------------------------------------------------------------------- parameter stage


def unchanged(index):
    """The index itself."""
    return index


def _square(index):
    """The square of d where the index is (d + 1) / 2."""
    return (2.0 * index - 1.0) ** 2


@lru_cache(maxsize=8)
def _color_table(functions, size):
    """A table after the color matrix: a function for each of R, G, B and A, of an index in [0, 1]."""
    index = np.arange(size) / (size - 1.0)
    return ColorTable(tuple(zip(*(function(index).tolist() for function in functions), strict=True)))


def color_table_size(profile):
    """How many entries a machine's color table has here."""
    # The Octane's largest, for each value of twelve bits; finer where nothing else is rounded.
    return min(profile.pixels.max_color_table_size, 1 << 14)


def tabulated(profile, *functions):
    """A ColorTable of a function for each of R, G, B and A, of an index in [0, 1]."""
    return _color_table(functions, color_table_size(profile))


def _clamped(profile):
    """What makes (.)+ of the color matrix's results: on machines what they are stored in is not negative."""
    return tabulated(profile, *[unchanged] * 4) if profile.arithmetic.exact else None


def flat_vector(vectors, what):
    """The one vector [3] that all vertices have. Raises ValueError, naming ``what``, where they differ."""
    spread = float(np.abs(vectors - vectors[0]).max())
    if not spread <= 1e-6:
        raise ValueError(
            f"The {what} changes by {spread:.2g} over the surface, and a color matrix holds one; give a flat "
            "surface, a directional light and an infinite viewer, or draw polygon after polygon."
        )
    return vectors[0]


def dot_with(vector, scale=1.0):
    """A row of the color matrix: the dot product of a texel's RGB with a vector, times ``scale``."""
    return (*(scale * float(c) for c in vector), 0.0)


def texture_format(bits):
    """The internal format of textures with 8 or 12 bits a component. Raises ValueError for others."""
    return _FORMATS[one_of(tuple(_FORMATS), bits, "The textures' bits")]


def float_image(values, alpha=1.0):
    """Floats [h, w, 3], or [h, w] for R, G and B alike, as an image; alpha is one, or floats [h, w]."""
    values = values[..., None] if values.ndim == 2 else values
    image = np.empty((*values.shape[:2], 4))
    image[..., :3], image[..., 3] = values, alpha
    return PixelImage(image)


def load_products(label, name, values, rows, profile, bits=8, *, alpha=1.0):
    """The command that loads float vectors [h, w, 3], and alphas, through a color matrix whose rows make dot
    products; negative ones are 0.
    """
    transfer = PixelTransfer(color_matrix=tuple(rows), post_color_matrix_color_table=_clamped(profile))
    return TexImage(
        label=label,
        texture=name,
        pixels=float_image(values, alpha),
        internal_format=texture_format(bits),
        transfer=transfer,
    )


def load_squares(label, name, vectors, half, profile, bits=8, *, scale=1.0):
    """The command that loads (v.h)^2 scale into R, G, B and A: products are biased to (d + 1)/2 to keep their
    sign, and squared by the table after the color matrix. Beyond 1 they are 1.
    """
    transfer = PixelTransfer(
        color_matrix=(dot_with(half, math.sqrt(scale)),) * 4,
        post_color_matrix_scale=(0.5,) * 4,
        post_color_matrix_bias=(0.5,) * 4,
        post_color_matrix_color_table=tabulated(profile, *[_square] * 4),
    )
    return TexImage(
        label=label,
        texture=name,
        pixels=float_image(vectors),
        internal_format=texture_format(bits),
        transfer=transfer,
    )


# ---------------------------------------------------------------------------------- copies and lookups


def begin(view):
    """The command that unmarks the panel's pixels."""
    return Clear(label="no pixel is the polygon's yet", stencil=0, scissor=view.panel.scissor)


def polygon(label, surface, view, texture=None, *, first=False, mask=RGBA, blending=None, sampler=REPEATED):
    """Draw the polygon with a texture, or white; the ``first`` time its pixels are marked."""
    units = () if texture is None else (TextureUnit(texture, sampler, environment=REPLACE),)
    state = PassState(
        vertex=view.vertex,
        texture_units=units,
        stencil_test=MARK if first else None,
        depth_test=FIRST_PASS if first else LATER_PASS,
        blending=blending,
        color_mask=mask,
    )
    return Draw(label=label, mesh=surface.mesh(), state=state)


def copied(label, view, rows, profile, *, mask=RGB, blending=None):
    """Copy the marked pixels of the panel onto themselves through a color matrix; negative results are 0."""
    return _copy(label, view, (*rows, NOTHING), mask, blending, table=_clamped(profile))


def looked_up(label, view, table, s, t=NOTHING, *, mask=RGB, blending=None):
    """A pixel texture: marked pixels become the texels of ``table`` at (s, t), rows of a color matrix."""
    unit = TextureUnit(table, EDGE, environment=REPLACE)
    return _copy(label, view, (s, t, NOTHING, NOTHING), mask, blending, (unit,), PixelTexture())


def _copy(label, view, rows, mask, blending, units=(), pixel_texture=None, table=None):
    state = PassState(texture_units=units, stencil_test=MARKED, blending=blending, color_mask=mask)
    # Alpha is one whatever the framebuffer's holds: q divides s and t.
    transfer = PixelTransfer(
        color_matrix=tuple(map(tuple, rows)),
        post_color_matrix_bias=(0.0, 0.0, 0.0, 1.0),
        post_color_matrix_color_table=table,
    )
    return copy_of_panel(label, view.panel, state, transfer, pixel_texture=pixel_texture)


def through_host(commands, type="UNSIGNED_BYTE"):
    """The commands with every copy of colours made through the host's memory: ReadPixels, then DrawPixels.

    DrawPixels has the copy's pixel transfer and pixel texture. ``type``: of ReadPixels; FLOAT keeps a
    framebuffer's twelve bits.
    """
    out = []
    for number, command in enumerate(commands):
        out += _by_host(command, f"copy {number}: {command.label}", type) if _copies(command) else (command,)
    return tuple(out)


def _copies(command):
    return isinstance(command, CopyPixels) and command.type is PixelCopyType.COLOR


def _by_host(copy, name, type):
    box = {"x": copy.x, "y": copy.y, "width": copy.width, "height": copy.height}
    same = {k: getattr(copy, k) for k in ("label", "state", "position", "zoom", "transfer", "pixel_texture")}

    def drawn(pixels):
        return (DrawPixels(image=PixelImage(pixels[name]), **same),)

    return (
        ReadPixels(label="read to host memory", name=name, type=type, read_buffer=copy.read_buffer, **box),
        HostStep(label=f"the host: {copy.label}", reads=(name,), commands=drawn),
    )

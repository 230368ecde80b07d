"""A pixel texture on a machine that has none: pixels are read back, looked up by the host, and drawn again.

Kautz and Seidel (2000), section 5, do this on the GeForce 256, which has no dependent lookups. The
intermediate picture goes to the host, which does what SGIX_pixel_texture does on the Octane. The lookups
depend on the pixels, so a HostStep stands between reading and drawing:

    commands = (*passes_before, *pixel_texture("look up F", texture), *passes_after)

The host's arithmetic is the machine's filter (docs/numbers.md, sections 6, 7 and 18). So at eight bits the
picture equals the Octane's bit for bit. On floats, which the ideal reads, the filter is exact.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.passes.draws import at_pixel
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import Draw, DrawPixels, HostStep, Mesh, ReadPixels, TexImage
from fixedpipe.pipeline.enums import (
    PrimitiveType,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import PassState, Sampler, TextureEnvironment, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Variant(("K15",), "by the host, where a board has no pixel textures"),)

_WRAPS = (WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE)


def pixel_texture(
    label,
    texture,
    *,
    texture_filter=TextureFilter.LINEAR,
    wrap=WrapMode.CLAMP_TO_EDGE,
    x=0,
    y=0,
    width=None,
    height=None,
    state=None,
    coordinates=None,
    by_quad=False,
):
    """Two commands that do in the window what CopyPixels with a pixel texture does: read, then look up and
    draw.

    Parameters
    ----------
    texture : fixedpipe.pipeline.textures.images.Texture
        What is looked up, of one or two dimensions with texels of eight bits.
    texture_filter, wrap
        As ``look_up`` takes them.
    x, y, width, height : int
        The rectangle; None: as far as the window reaches.
    state : fixedpipe.pipeline.state.PassState or None
        In which the rectangle is drawn, without texture units.
    coordinates : function or None
        From the pixels as they were read, [h, w, 4] of bytes or floats, to pixels of the same kind whose R/A
        and G/A are s and t: what a pixel transfer does in CopyPixels.
    by_quad : bool
        Draw a texture on a quad that fills the window, for boards whose DrawPixels is slow; the rectangle
        must be the window.
    """
    name = f"{label}: coordinates from ({x}, {y}) on"

    def looked_up(pixels):
        found = pixels[name] if coordinates is None else coordinates(pixels[name])
        found = look_up(found, texture, texture_filter, wrap)
        if by_quad:
            return textured_quad(label, found, f"{label}: texels", state=state)
        return (drawn(label, found, x=x, y=y, state=state),)

    return (
        read_back(name, x=x, y=y, width=width, height=height),
        HostStep(label=f"the host: {label}", reads=(name,), commands=looked_up),
    )


def read_back(name, *, x=0, y=0, width=None, height=None, label="read back for the host's lookup"):
    """The command that reads what ``look_up`` takes: ReadPixels of RGBA."""
    return ReadPixels(label=label, name=name, x=x, y=y, width=width, height=height)


def look_up(pixels, texture, texture_filter=TextureFilter.LINEAR, wrap=WrapMode.CLAMP_TO_EDGE):
    """The result of a pixel texture for each pixel: its texel at s = R/A, t = G/A, lambda zero.

    Parameters
    ----------
    pixels : array
        uint8 [h, w, 4], as ReadPixels gives them, or float64 of the ideal's. Where alpha is 0 it counts as
        one.
    texture : fixedpipe.pipeline.textures.images.Texture
        Of one or two dimensions, with texels of eight bits; level 0 is read.
    texture_filter : TextureFilter
        NEAREST or LINEAR.
    wrap : WrapMode
        REPEAT or CLAMP_TO_EDGE, in s and t.

    Returns
    -------
    array
        Of the pixels' type [h, w, 4]; one where the texture's base format has no alpha. Floats are of the
        texture's unrounded texels, where it has them.

    Raises
    ------
    ValueError
        For pixels, textures, filters or wrap modes of another kind.
    """
    pixels = np.asarray(pixels)
    if pixels.dtype not in (np.uint8, np.float64) or pixels.ndim != 3 or pixels.shape[-1] != 4:
        raise ValueError(
            f"The pixels are {pixels.dtype} of shape {pixels.shape}; give uint8 or float64 "
            "[height, width, 4], as ReadPixels returns RGBA."
        )
    if texture.target not in (TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D) or texture.bits != 8:
        raise ValueError(
            f"The texture is a {texture.target.name} of {texture.bits} bits; give a TEXTURE_1D or TEXTURE_2D "
            "of 8."
        )
    if texture_filter not in (TextureFilter.NEAREST, TextureFilter.LINEAR) or wrap not in _WRAPS:
        raise ValueError(
            f"The host looks up with NEAREST or LINEAR and REPEAT or CLAMP_TO_EDGE, not with "
            f"{texture_filter.name} and {wrap.name}; give one of these."
        )
    exact = pixels.dtype == np.float64
    if exact:
        image = texture.levels[0][0] / 255.0 if texture.ideal is None else texture.ideal[0][0]
    else:
        image = texture.levels[0][0].astype(np.int64)
    height, width = image.shape[:2]
    alpha = np.where(pixels[..., 3] <= 0, 1.0 if exact else 255.0, pixels[..., 3])
    columns, across = _along(pixels[..., 0] / alpha, width, wrap, texture_filter, exact)
    if texture.target is TextureTarget.TEXTURE_1D:
        rows, up = [np.zeros(alpha.shape, np.int64)], None
    else:
        rows, up = _along(pixels[..., 1] / alpha, height, wrap, texture_filter, exact)
    lines = [_blended([image[row, column] for column in columns], across, exact) for row in rows]
    return _blended(lines, up, exact).astype(pixels.dtype)


def _along(coordinate, size, wrap, texture_filter, exact):
    """Texel indices along an axis, one or two, and the fraction between them: of eight bits, or exact."""
    texel = coordinate * float(size)
    if wrap is WrapMode.REPEAT:
        texel = np.clip(texel - size * np.floor(texel * (1.0 / size)), 0.0, size)
    else:
        texel = np.clip(texel, 0.5, size - 0.5)
    if texture_filter is TextureFilter.NEAREST:
        return [_inside(np.floor(texel).astype(np.int64), size, wrap)], None
    if exact:
        first = np.floor(texel - 0.5).astype(np.int64)
        fraction = texel - 0.5 - first
    else:
        position = np.floor((texel - 0.5) * 256.0).astype(np.int64)
        first, fraction = position >> 8, position & 255
    return [_inside(first, size, wrap), _inside(first + 1, size, wrap)], fraction


def _inside(index, size, wrap):
    return index % size if wrap is WrapMode.REPEAT else np.clip(index, 0, size - 1)


def _blended(pair, fraction, exact):
    if len(pair) == 1:
        return pair[0]
    share = fraction[..., None]
    if exact:
        return pair[0] * (1.0 - share) + pair[1] * share
    return (pair[0] * (256 - share) + pair[1] * share + 128) >> 8


def drawn(label, image, *, x=0, y=0, state=None):
    """The command that draws the looked-up pixels, the lower left one at (x, y): DrawPixels."""
    return DrawPixels(
        label=label, image=PixelImage(image), position=at_pixel(x, y), state=state or PassState()
    )


def textured_quad(label, image, name, *, state=None):
    """As ``look_up``'s picture, by a texture and a quad that fills the window, for boards with a slow
    DrawPixels.

    ``image``: of the window's size; its texture is padded to powers of two. ``state``: its unit 0 reads the
    texture, nearest, in place of the colour. Returns two commands.
    """
    height, width = image.shape[:2]
    wide, high = (1 << (edge - 1).bit_length() for edge in (width, height))
    padded = np.zeros((high, wide, 4), image.dtype)
    padded[:height, :width] = image
    unit = TextureUnit(
        texture=name,
        sampler=Sampler(
            TextureFilter.NEAREST,
            TextureFilter.NEAREST,
            wrap_s=WrapMode.CLAMP_TO_EDGE,
            wrap_t=WrapMode.CLAMP_TO_EDGE,
        ),
        environment=TextureEnvironment(TextureEnvironmentMode.REPLACE),
    )
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    coordinates = (corners * 0.5 + 0.5) * (width / wide, height / high)
    quad = Mesh(corners, PrimitiveType.QUADS, texture_coordinates=(coordinates,))
    return (
        TexImage(label=f"{label}: the host's texels", texture=name, image=texture_2d(padded)),
        Draw(label=label, mesh=quad, state=replace(state or PassState(), texture_units=(unit,))),
    )

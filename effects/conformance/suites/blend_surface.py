"""Blend_surface: blending on surfaces of every colour format, shown on the window as textures.

Source: src/tests/blend_surface_tests.cpp of nxdk_pgraph_tests, with pbkitplusplus' texture generator.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import BindTexImage, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import BlendFactor, ColorFormat, InternalFormat, TexelWord, WindowOrigin
from fixedpipe.pipeline.state import Blending, ColorMask
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Blend_surface"

SURFACES = {  # and what their words are read as
    "X_Z1RGB5": (ColorFormat.X1R5G5B5_Z1R5G5B5, InternalFormat.RGB5_A1),
    "X_O1RGB5": (ColorFormat.X1R5G5B5_O1R5G5B5, InternalFormat.RGB5_A1),
    "R5G6B5": (ColorFormat.R5G6B5, InternalFormat.R5_G6_B5),
    "X_ZRGB8": (ColorFormat.X8R8G8B8_Z8R8G8B8, InternalFormat.RGBA8),
    "X_ORGB8": (ColorFormat.X8R8G8B8_O8R8G8B8, InternalFormat.RGBA8),
    "XA_Z1A7RGB8": (ColorFormat.X1A7R8G8B8_Z1A7R8G8B8, InternalFormat.RGBA8),
    "XA_O1A7RGB8": (ColorFormat.X1A7R8G8B8_O1A7R8G8B8, InternalFormat.RGBA8),
    "ARGB8": (ColorFormat.A8R8G8B8, InternalFormat.RGBA8),
}
BLENDINGS = {
    "Add_SrcA_1-SrcA": Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA),
    "Add_SrcA_DstA": Blending(BlendFactor.SRC_ALPHA, BlendFactor.DST_ALPHA),
}
WORDS = (  # the textures that are blended, in the order of the pictures
    TexelWord.A8B8G8R8,
    TexelWord.X8R8G8B8,
    TexelWord.R5G6B5,
    TexelWord.R6G5B5,
    TexelWord.X1R5G5B5,
    TexelWord.A1R5G5B5,
    TexelWord.A4R4G4B4,
)
BACKGROUNDS = (  # 0xAABBGGRR
    0x00000000,
    0x40000000,
    0x80000000,
    0xFF000000,
    0x00FF0000,
    0x40FF0000,
    0x80FF0000,
    0xFFFF0000,
)
FACTORS = {"DstAlpha": BlendFactor.DST_ALPHA, "1-DstAlpha": BlendFactor.ONE_MINUS_DST_ALPHA}
SIZE, HALF, SMALL = 128, 64, 8  # of the surface, the pattern and the squares, pixels
UNBLENDED = replace(scenes.DEFAULT, blending=None)
OPAQUE = replace(UNBLENDED, color_mask=ColorMask(alpha=False))  # the alpha shown is one


def ramps(size):
    """Words of 32 bits [size, size]: four quarters of ramps, alpha from 0 in the corners to 255 in the
    middle.
    """
    at = np.arange(size)
    ramp = (at % (size // 2)).astype(np.float32) * np.float32(255) / np.float32(size // 2)
    ramp = ramp.astype(np.int64)
    across, down = np.meshgrid(ramp, ramp)
    centre = np.float32(size // 2)
    square = (at.astype(np.float32) - centre) ** 2
    distance = square[None] + square[:, None]
    alpha = (np.float32(255) * (np.float32(1) - distance / (2 * centre * centre))).astype(np.int64)
    return alpha << 24 | (255 - down) << 16 | across << 8 | down


def _nibbles():
    """Words of 16 bits: four ramps of four bits, the highest from 0 in the corners to 15 in the middle."""
    last, fifteen, one = np.float32(HALF - 1), np.float32(15), np.float32(1)
    at = np.arange(HALF).astype(np.float32)
    unit, square = at / last, (at - last / 2) ** 2
    across, down = np.meshgrid(unit, unit)
    distance = square[None] + square[:, None]
    alpha = fifteen * (one - distance / (2 * (last / 2) ** 2))
    diagonal = (fifteen * across) * (one - down) + (fifteen * (one - across)) * down
    parts = [v.astype(np.int64) for v in (alpha, fifteen * down, diagonal, fifteen * (one - across))]
    return parts[0] << 12 | parts[1] << 8 | parts[2] << 4 | parts[3]


def _corners(left, top, width, height=None):
    """The XDK's viewport offset, 17/32 pixel, snaps to half a pixel. ``height``: by default the width."""
    bottom = top + (width if height is None else height)
    return scenes.rectangle(left + 0.5, top + 0.5, left + width + 0.5, bottom + 0.5)


def _words(word):
    """The pattern, a square of one faint grey, and one whose highest bits are zero."""
    wide = word in (TexelWord.A8R8G8B8, TexelWord.A8B8G8R8, TexelWord.X8R8G8B8)
    grey = np.full((SMALL, SMALL), 0x44444444 if wide else 0x4444)
    zero = np.full((SMALL, SMALL), 0x00FFFF55 if wide else 0x0FF5)
    return {"pattern": ramps(HALF) if wide else _nibbles(), "grey": grey, "zero": zero}


def _blended(blending, word, squares=True):
    """Draws on the surface: the pattern four times, and the squares in the corners once and four times."""
    far = SIZE - SMALL
    boxes = [("pattern", 12 * k, 12 * k, HALF) for k in range(1, 5)]
    if squares:
        boxes += [("grey", 0, 0, SMALL), *[("grey", far, 0, SMALL)] * 4]
        boxes += [("zero", 0, far, SMALL), *[("zero", far, far, SMALL)] * 4]
    state = replace(scenes.DEFAULT, blending=blending)
    return (
        *(
            TexImage(label=texture, texture=texture, image=texture_of_words((image,), word))
            for texture, image in _words(word).items()
        ),
        scenes.quad("background", _corners(0, 0, SIZE), (0.1, 0.1, 0.1, 0.7), UNBLENDED, SIZE),
        *(scenes.textured_quad(t, _corners(x, y, size), t, state, SIZE) for t, x, y, size in boxes),
    )


def _times_alpha(factor, word):
    """White times the destination's alpha, or one minus it, on a background."""
    state = replace(scenes.DEFAULT, blending=Blending(factor, BlendFactor.ZERO))
    corners = _corners(0, 0, SIZE)
    return (
        scenes.quad("background", corners, scenes.abgr(word), UNBLENDED, SIZE),
        scenes.quad("white", corners, scenes.abgr(0x22FFFFFF), state, SIZE),
    )


def _shown(surface, draws, *pictures):
    """The draws on a surface, and the surface on the window: (corners, state) of each picture of it."""
    color_format, internal_format = SURFACES[surface]
    return (
        MakeCurrent(label="surface", surface="surface", width=SIZE, height=SIZE, color_format=color_format),
        *draws,
        BindTexImage(
            label="surface",
            texture="shown",
            surface="surface",
            internal_format=internal_format,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        MakeCurrent(label="window"),
        *(scenes.textured_quad("shown", corners, "shown", state) for corners, state in pictures),
    )


def _blends(surface, blending):
    commands = [scenes.clear(0xFF555555)]
    for k, word in enumerate(WORDS):
        left, top = 32 + 144 * (k % 4), 92 + 144 * (k // 4)
        commands += _shown(surface, _blended(blending, word), (_corners(left, top, SIZE), OPAQUE))
    return Case(commands=tuple(commands))


def _scales(surface, factor):
    commands = [scenes.clear(0xFF555555)]
    for k, word in enumerate(BACKGROUNDS):
        left, top = 32 + 144 * (k % 4), 92 + 160 * (k // 4)
        halves = (
            (_corners(left, top, SIZE, SIZE // 2), scenes.DEFAULT),  # over the window by its alpha
            (_corners(left, top + SIZE // 2, SIZE, SIZE // 2), OPAQUE),
        )
        commands += _shown(surface, _times_alpha(factor, word), *halves)
    return Case(commands=tuple(commands))


def _first_version(surface):
    draws = _blended(BLENDINGS["Add_SrcA_1-SrcA"], TexelWord.A8R8G8B8, squares=False)
    picture = _corners(256, 176, SIZE), UNBLENDED
    return Case(commands=(scenes.clear(0xFF050505), *_shown(surface, draws, picture)))


CASES = {
    **{
        f"{s}_{name}": partial(_blends, s, blending) for s in SURFACES for name, blending in BLENDINGS.items()
    },
    **{f"{name}_{s}": partial(_scales, s, factor) for name, factor in FACTORS.items() for s in SURFACES},
    **{surface: partial(_first_version, surface) for surface in SURFACES},
}

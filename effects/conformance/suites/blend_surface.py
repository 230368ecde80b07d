"""Blend_surface: blending on surfaces of every colour format, shown on the window as textures.

Source: src/tests/blend_surface_tests.cpp of nxdk_pgraph_tests, with pbkitplusplus' texture generator.
"""

from dataclasses import replace

import numpy as np

from effects.conformance import scenes
from effects.conformance.case import Case
from pipeline.commands import BindTexImage, MakeCurrent, TexImage
from pipeline.enums import BlendFactor, ColorFormat, InternalFormat, TexelWord, WindowOrigin
from pipeline.state import Blending
from pipeline.texel_words import texture_of_words

SUITE = "Blend_surface"

SURFACES = {  # and what their words are read as
    "X_Z1RGB5": (ColorFormat.X1R5G5B5_Z1R5G5B5, InternalFormat.RGB5),
    "X_O1RGB5": (ColorFormat.X1R5G5B5_O1R5G5B5, InternalFormat.RGB5),
    "R5G6B5": (ColorFormat.R5G6B5, InternalFormat.R5_G6_B5),
    "X_ZRGB8": (ColorFormat.X8R8G8B8_Z8R8G8B8, InternalFormat.RGB8),
    "X_ORGB8": (ColorFormat.X8R8G8B8_O8R8G8B8, InternalFormat.RGB8),
    "XA_Z1A7RGB8": (ColorFormat.X1A7R8G8B8_Z1A7R8G8B8, InternalFormat.RGB8),
    "XA_O1A7RGB8": (ColorFormat.X1A7R8G8B8_O1A7R8G8B8, InternalFormat.RGB8),
    "ARGB8": (ColorFormat.A8R8G8B8, InternalFormat.RGB8),
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
SIZE, HALF, SMALL = 128, 64, 8  # of the surface, the pattern and the squares, pixels
UNBLENDED = replace(scenes.DEFAULT, blending=None)


def names():
    """Every case of the suite."""
    return [f"{s}_{b}" for s in SURFACES for b in BLENDINGS] + [f"DstAlpha_{s}" for s in SURFACES]


def _ramps():
    """Words of 32 bits: four quarters of ramps, alpha from 0 in the corners to 255 in the middle."""
    at = np.arange(HALF)
    ramp = (at % (HALF // 2)).astype(np.float32) * np.float32(255) / np.float32(HALF // 2)
    ramp = ramp.astype(np.int64)
    across, down = np.meshgrid(ramp, ramp)
    centre = np.float32(HALF // 2)
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


def _quad_corners(left, top, size):
    """The XDK's viewport offset, 17/32 pixel, snaps to half a pixel."""
    return scenes.rectangle(left + 0.5, top + 0.5, left + size + 0.5, top + size + 0.5)


def _textures(word):
    """The pattern, a square of one faint grey, and one whose highest bits are zero."""
    wide = word in (TexelWord.A8B8G8R8, TexelWord.X8R8G8B8)
    solid = np.full((SMALL, SMALL), 0x44444444 if wide else 0x4444)
    zero = np.full((SMALL, SMALL), 0x00FFFF55 if wide else 0x0FF5)
    images = {"pattern": _ramps() if wide else _nibbles(), "grey": solid, "zero": zero}
    return [TexImage(label=n, texture=n, image=texture_of_words((i,), word)) for n, i in images.items()]


def _blended(surface, blending, word):
    """Draws on the surface."""

    def textured(texture, left, top, size):
        state = replace(scenes.DEFAULT, blending=blending)
        return scenes.textured_quad(texture, _quad_corners(left, top, size), texture, state, SIZE)

    far = SIZE - SMALL
    return (
        *_textures(word),
        surface,
        scenes.quad("background", _quad_corners(0, 0, SIZE), (0.1, 0.1, 0.1, 0.7), UNBLENDED, SIZE),
        *(textured("pattern", 12 * k, 12 * k, HALF) for k in range(1, 5)),
        textured("grey", 0, 0, SMALL),
        *[textured("grey", far, 0, SMALL)] * 4,
        textured("zero", 0, far, SMALL),
        *[textured("zero", far, far, SMALL)] * 4,
    )


def _times_alpha(surface, word):
    """White times the destination's alpha on a background."""
    state = replace(scenes.DEFAULT, blending=Blending(BlendFactor.DST_ALPHA, BlendFactor.ZERO))
    corners = _quad_corners(0, 0, SIZE)
    return (
        surface,
        scenes.quad("background", corners, scenes.abgr(word), UNBLENDED, SIZE),
        scenes.quad("white", corners, scenes.abgr(0x22FFFFFF), state, SIZE),
    )


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    alpha = name.startswith("DstAlpha_")
    key = name.removeprefix("DstAlpha_") if alpha else name.split("_Add")[0]
    color_format, internal_format = SURFACES[key]
    surface = MakeCurrent(
        label="surface", surface="surface", width=SIZE, height=SIZE, color_format=color_format
    )
    commands = [scenes.clear(0xFF555555)]
    for k, what in enumerate(BACKGROUNDS if alpha else WORDS):
        left, top = 32 + 144 * (k % 4), 92 + (160 if alpha else 144) * (k // 4)
        drawn = (
            _times_alpha(surface, what) if alpha else _blended(surface, BLENDINGS[name[len(key) + 1 :]], what)
        )
        shown = scenes.textured_quad("shown", _quad_corners(left, top, SIZE), "shown", UNBLENDED)
        commands += (
            *drawn,
            BindTexImage(
                label="surface",
                texture="shown",
                surface="surface",
                internal_format=internal_format,
                origin=WindowOrigin.UPPER_LEFT,
            ),
            MakeCurrent(label="window"),
            shown,
        )
    return Case(commands=tuple(commands))

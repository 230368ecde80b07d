"""Blend_tests: every blend equation with every pair of factors, on a small surface, shown on the window.

Source: src/tests/blend_tests.cpp of nxdk_pgraph_tests. The surface is A8R8G8B8 and is read as A8B8G8R8, which
exchanges red and blue a second time. The colours here are those of the pictures.
"""

from dataclasses import replace
from functools import partial
from itertools import product

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import BindTexImage, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import BlendEquation, BlendFactor, WindowOrigin
from fixedpipe.pipeline.state import Blending, ColorMask
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Blend_tests"

FACTORS = {
    "0": BlendFactor.ZERO,
    "1": BlendFactor.ONE,
    "srcRGB": BlendFactor.SRC_COLOR,
    "1-srcRGB": BlendFactor.ONE_MINUS_SRC_COLOR,
    "srcA": BlendFactor.SRC_ALPHA,
    "1-srcA": BlendFactor.ONE_MINUS_SRC_ALPHA,
    "dstA": BlendFactor.DST_ALPHA,
    "1-dstA": BlendFactor.ONE_MINUS_DST_ALPHA,
    "dstRGB": BlendFactor.DST_COLOR,
    "1-dstRGB": BlendFactor.ONE_MINUS_DST_COLOR,
    "srcAsat": BlendFactor.SRC_ALPHA_SATURATE,
    "cRGB": BlendFactor.CONSTANT_COLOR,
    "1-cRGB": BlendFactor.ONE_MINUS_CONSTANT_COLOR,
    "cA": BlendFactor.CONSTANT_ALPHA,
    "1-cA": BlendFactor.ONE_MINUS_CONSTANT_ALPHA,
}
EQUATIONS = {
    "ADD": BlendEquation.FUNC_ADD,
    "SUB": BlendEquation.FUNC_SUBTRACT,
    "REVSUB": BlendEquation.FUNC_REVERSE_SUBTRACT,
    "MIN": BlendEquation.MIN,
    "MAX": BlendEquation.MAX,
    "SADD": BlendEquation.FUNC_ADD_SIGNED,
    "SREVSUB": BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED,
}
CONSTANT = scenes.argb(0x55555555)
RGB, ALPHA = ColorMask(alpha=False), ColorMask(red=False, green=False, blue=False)
NESTED = (0x7F00CC00, 0xFFCC0000, 0x800000FF, 0x00FFFFFF)  # squares one inside another, 0xAARRGGBB
SWATCHES = (0xDD00DD00, 0xDDDD0000, 0xDD0000DD, 0xDDFFFFFF)  # squares below one another


class _Surface:
    """A surface that begins as a checkerboard: the commands that draw on it and show it on the window."""

    def __init__(self, name, width, height, cell):
        image = scenes.checkerboard(0x33333333, 0xFF000000, cell, max(width, height))[:height, :width]
        self.name, self.size = name, (width, height)
        pattern = f"{name} pattern"
        self.commands = [
            TexImage(label=pattern, texture=pattern, image=texture_2d(image)),
            MakeCurrent(label=name, surface=name, width=width, height=height),
            scenes.textured_quad(
                pattern, scenes.rectangle(0, 0, width, height), pattern, self._state(None), height
            ),
        ]

    @staticmethod
    def _state(blending, mask=None):
        return replace(scenes.DEFAULT, blending=blending, color_mask=mask or ColorMask())

    def _square(self, word, left, top, size, blending, mask=None):
        corners = scenes.rectangle(left, top, left + size, top + size)
        state = self._state(blending, mask)
        self.commands.append(scenes.quad("square", corners, scenes.argb(word), state, self.size[1]))

    def nested(self, blending, left, top, size, inset):
        """RGB replaced, alpha blended."""
        for k, word in enumerate(NESTED):
            at = (word, left + k * inset, top + k * inset, size - 2 * k * inset)
            self._square(*at, None, RGB)
            self._square(*at, blending, ALPHA)

    def blended_colors(self, blending, left, top, size):
        """RGB blended, alpha replaced."""
        for k, word in enumerate(SWATCHES):
            self._square(word, left, top + k * size, size, blending, RGB)
            self._square(word, left, top + k * size, size, None, ALPHA)

    def blended(self, blending, left, top, size):
        """All four components blended."""
        for k, word in enumerate(reversed(SWATCHES)):
            self._square(word, left, top + k * size, size, blending)

    def shown(self, left, top):
        """The commands, and the window with the surface on it."""
        width, height = self.size
        corners = scenes.rectangle(left, top, left + width, top + height)
        return (
            *self.commands,
            BindTexImage(
                label=self.name, texture=self.name, surface=self.name, origin=WindowOrigin.UPPER_LEFT
            ),
            MakeCurrent(label="window"),
            scenes.textured_quad(self.name, corners, self.name),
        )


def _background(cell):
    image = scenes.checkerboard(0xFF202020, 0xFF000000, cell)
    return (
        TexImage(label="checkerboard", texture="checkerboard", image=texture_2d(image)),
        scenes.textured_quad("background", scenes.rectangle(0, 0, 640, 480), "checkerboard"),
    )


def _single(source, equation, destination):
    blending = Blending(source, destination, equation, CONSTANT)
    centre, left, right = (
        _Surface("nested", 256, 256, 16),
        *(_Surface(n, 64, 256, 16) for n in ("rgb", "rgba")),
    )
    centre.nested(blending, 0, 0, 256, 24)
    left.blended_colors(blending, 0, 0, 64)
    right.blended(blending, 0, 0, 64)
    return (*_background(24), *centre.shown(192, 112), *left.shown(16, 112), *right.shown(560, 112))


def _spot(source, equation):
    surface = _Surface("spots", 512, 512, 8)
    for k, destination in enumerate(FACTORS.values()):
        blending = Blending(source, destination, equation, CONSTANT)
        left, top = 103 * (k % 5), 136 * (k // 5)
        surface.blended_colors(blending, left, top, 24)
        surface.blended(blending, left + 24, top, 24)
        surface.nested(blending, left + 48, top, 51, 4)
    return (*_background(16), *surface.shown(64, 64))


CASES = {
    f"{s}_{e}_{d}": partial(Case.of, _single, FACTORS[s], EQUATIONS[e], FACTORS[d])
    for e, s, d in product(EQUATIONS, FACTORS, FACTORS)
    if (s, d) != ("0", "0")
} | {
    f"#spot_{s}_{e}": partial(Case.of, _spot, FACTORS[s], EQUATIONS[e])
    for e, s in product(EQUATIONS, FACTORS)
}

"""Texture_signed_component_tests: texels read as two's complement, blended over a checkerboard.

Source: src/tests/texture_signed_component_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.suites.texture_format import square
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import BlendEquation, PrimitiveType, TexelWord
from fixedpipe.pipeline.state import SignedComponents, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_signed_component_tests"

EQUATIONS = {
    "ADD": BlendEquation.FUNC_ADD,
    "SADD": BlendEquation.FUNC_ADD_SIGNED,
    "SREVSUB": BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED,
}
COMPONENTS = ("red", "green", "blue", "alpha")
BLOCKS = ((64, 0), (320, 0), (64, 240), (320, 240))  # left and top; red, green, blue and alpha rise
STRIP = (256, HEIGHT // 8)
OPACITIES = (0xFF, 0x7F)

# The flags' texture: a checkerboard with patches of smaller ones, three rows by component, six by alpha and
# values. Words A8B8G8R8.
SIZE = 256
PATCH, PATCHES, GAP = (SIZE // 7, SIZE // 5), (5, 10), 2
PATCH_ALPHAS, PATCH_VALUES = (0xFF, 0x7F, 0x00), ((0xFF, 0x7F), (0x80, 0x00))


def _unit(texture, signed):
    return replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(texture, replace(scenes.NEAREST, signed_components=signed)),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )


def _ramp(component, alpha):
    """RGBA bytes [1, 256, 4]: one component rises, the other colours are zero, or all is white."""
    texels = np.zeros((1, 256, 4), np.uint8)
    texels[..., 3] = alpha
    if component == 3:
        texels[...] = 255
    texels[0, :, component] = np.arange(256)
    return texels


def _ramps(equation):
    """Every block's four strips: unsigned and signed, opaque and half transparent."""
    for component, (left, top) in enumerate(BLOCKS):
        for alpha in OPACITIES:
            yield TexImage(label="ramp", texture="ramp", image=texture_2d(_ramp(component, alpha)))
            for signed in (SignedComponents(), SignedComponents(**{COMPONENTS[component]: True})):
                corners = scenes.rectangle(left, top, left + STRIP[0], top + STRIP[1], 1.0)
                mesh = scenes.window_mesh(corners, texture_coordinates=(scenes.UNIT_SQUARE,))
                state = replace(_unit("ramp", signed), blending=replace(scenes.BLENDED, equation=equation))
                yield Draw(label="ramp", mesh=mesh, state=state)
                top += STRIP[1]


def _written_background():
    """The checkerboard that the processor writes to the framebuffer: here a texture, texel for pixel."""
    y, x = np.mgrid[:HEIGHT, :WIDTH] // 12
    words = np.where((x + y) % 2 == 0, 0xFFFFFFFF, 0xFF7F7F7F)
    pixels = np.zeros((512, 1024), np.int64)  # edges that are powers of two
    pixels[:HEIGHT, :WIDTH] = words
    yield TexImage(label="board", texture="board", image=texture_of_words(pixels, TexelWord.A8R8G8B8))
    mesh = scenes.window_mesh(scenes.rectangle(0, 0, 1024, 512), texture_coordinates=(scenes.UNIT_SQUARE,))
    yield Draw(label="board", mesh=mesh, state=replace(_unit("board", SignedComponents()), blending=None))


def _board(first, second, cell, width, height):
    y, x = np.mgrid[:height, :width] // cell
    return np.where((x + y) % 2 == 0, first, second)


def patches():
    """The flags' texture."""
    words = _board(0xFFFEFDFC, 0x7F202122, 8, SIZE, SIZE)
    width, height = PATCH
    for component in range(3):
        x, y = PATCHES[0], PATCHES[1] + component * (height + GAP)
        for alpha in PATCH_ALPHAS:
            for pair in PATCH_VALUES:
                first, second = ((alpha << 24) | (value << (8 * component)) for value in pair)
                words[y : y + height, x : x + width] = _board(first, second, 4, width, height)
                x += width + GAP
    return texture_of_words(words, TexelWord.A8B8G8R8)


def _flagged(flags):
    alpha, red, green, blue = (bool(flags >> bit & 1) for bit in range(4))
    positions, coordinates = square()
    mesh = scenes.window_mesh(positions, PrimitiveType.TRIANGLES, texture_coordinates=(coordinates,))
    state = _unit("patches", SignedComponents(red, green, blue, alpha))
    yield scenes.clear(0xFE202020)
    yield TexImage(label="patches", texture="patches", image=patches())
    yield Draw(label="square", mesh=mesh, state=state)


def _blended(equation):
    return scenes.clear(0xFF000000), *_written_background(), *_ramps(equation)


CASES = {f"A8R8G8B8_0x{flags:04X}": partial(Case.of, _flagged, flags) for flags in range(16)} | {
    f"txt_A8R8G8B8_{name}": partial(Case.of, _blended, equation) for name, equation in EQUATIONS.items()
}

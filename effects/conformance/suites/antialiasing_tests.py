"""Antialiasing_tests: memory that the processor wrote, after draws to a surface of several samples there.

Source: src/tests/antialiasing_tests.cpp of nxdk_pgraph_tests. The tests also show the window. Empty draws to
such surfaces change no memory. FBSurfaceWithCenterCorner2 draws to the window's memory with two samples a
pixel, which lie side by side. So a row of pixels fills two rows of the window, and half of the rows are
visible. Not included: GPUAAWriteAfterCPUWrite, which draws with four samples; no capture here shows their
places.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, surface_memory
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.suites import texture_render_target
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import ColorFormat, TexelWord, TextureTarget, WindowOrigin
from fixedpipe.pipeline.state import TextureUnit

SUITE = "Antialiasing_tests"

SIZE, CELL, INSET = 128, 8, 64
BACKGROUND = 0xFF050505
BLUE = 0xFF3333C0
# The two colours of a small texture, and whether memory of 0xCC is left around it.
# Those of the window, which the processor writes.
DIAMOND_COLOR = (0.25, 0.95, 0.75)
DIAMOND = ((INSET, HEIGHT / 2), (WIDTH / 2, INSET), (WIDTH - INSET, HEIGHT / 2), (WIDTH / 2, HEIGHT - INSET))


def _texture(first, second, framed):
    """RGBA bytes of the small texture."""
    inside = scenes.checkerboard(first, second, CELL, SIZE)
    if not framed:
        return inside
    out = np.full((SIZE, SIZE, 4), 0xCC, np.uint8)
    out[2:-2, 2:-2] = inside[: SIZE - 4, : SIZE - 4]
    return out


def _image(rgba):
    memory = surface_memory.memory_of(surface_memory.words_of(rgba, ColorFormat.A8R8G8B8))
    return surface_memory.image_of(memory, TexelWord.A8R8G8B8, rgba.shape[1], rgba.shape[0])


def _diamond_of_texels():
    """The small texture on a diamond."""
    texels = scenes.UNIT_SQUARE * SIZE
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("texture", scenes.NEAREST),),
        register_combiners=texture_render_target.OPAQUE,
    )
    return Draw(label="diamond", mesh=scenes.window_mesh(DIAMOND, texture_coordinates=(texels,)), state=state)


def _two_samples(diamond):
    """The diamond on a surface of two samples a pixel, whose memory is the window's."""
    draws = []
    # Row y of the surface is rows 2 y and 2 y + 1 of the window: its left and its right half.
    unblended = replace(
        scenes.DEFAULT,
        blending=None,
        texture_units=(TextureUnit("samples", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    for y in range(HEIGHT // 2):
        for part in (0, 1):
            row = 2 * y + part
            texels = scenes.UNIT_SQUARE * (WIDTH, 1) + (WIDTH * part, y)
            mesh = scenes.window_mesh(scenes.rectangle(0, row, WIDTH, row + 1), texture_coordinates=(texels,))
            draws.append(Draw(label="row", mesh=mesh, state=unblended))
    return (
        MakeCurrent(label="samples", surface="samples", width=WIDTH, height=HEIGHT, samples=2),
        scenes.clear(BACKGROUND),
        diamond,
        BindTexImage(
            label="samples",
            texture="samples",
            surface="samples",
            target=TextureTarget.TEXTURE_RECTANGLE,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        MakeCurrent(label="window"),
        *draws,
    )


def _on_texture(*texels):
    texture = TexImage(label="texture", texture="texture", image=_image(_texture(*texels)))
    return Case(commands=(scenes.clear(BACKGROUND), texture, _diamond_of_texels()))


def _on_window(*colors):
    board = _image(scenes.checkerboard(*colors, CELL, WIDTH)[:HEIGHT])
    whole = scenes.rectangle(0, 0, WIDTH, HEIGHT)
    shown = surface_memory.shown("window", "window", whole, WIDTH, HEIGHT)
    return Case(commands=(TexImage(label="window", texture="window", image=board), shown))


def _drawn(samples):
    mesh = scenes.window_mesh(DIAMOND, colors=scenes.single([DIAMOND_COLOR] * 4))
    diamond = Draw(label="diamond", mesh=mesh, state=scenes.DEFAULT)
    if samples == 1:
        return Case(commands=(scenes.clear(BACKGROUND), diamond))
    return Case(commands=_two_samples(diamond))


CASES = {  # every case of the suite but one
    "CreateSurfaceWithCenter1": partial(_on_texture, 0xFF808080, BLUE, True),
    "CreateSurfaceWithCenterCorner2": partial(_on_texture, 0xFF808080, BLUE, True),
    "CreateSurfaceWithSquareOffset4": partial(_on_texture, 0xFF808080, BLUE, True),
    "CPUWriteIgnoresSurfaceConfig": partial(_on_texture, 0xFFCC3333, BLUE, False),
    "NonAACPURoundTrip": partial(_on_texture, 0xFF336666, 0xFF33FF33, False),
    "AAOnThenOffCPUWrite": partial(_on_window, 0xFF808080, 0xFF5555FF),
    "SurfaceStatesAreIndependent": partial(_on_window, 0xFF008080, BLUE),
    "FramebufferNotModifiedBySurfaceState": partial(_on_window, 0xFF222222, 0xFF88AA00),
    "FBSurfaceWithCenter1": partial(_drawn, 1),
    "FBSurfaceWithCenterCorner2": partial(_drawn, 2),
}

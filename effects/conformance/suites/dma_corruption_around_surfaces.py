"""DMA_corruption_around_surfaces: textures whose memory the processor or a file fills beside a surface.

Source: src/tests/dma_corruption_around_surface_tests.cpp of nxdk_pgraph_tests. The file is white.
"""

import numpy as np

from fixedpipe.effects.conformance import scenes, surface_memory, texture_memory
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.suites import texture_render_target
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import ColorFormat, TexelWord

SUITE = "DMA_corruption_around_surfaces"

SIZE, CELL, INSET = 128, 8, 64
DIAMOND = ((INSET, HEIGHT / 2), (WIDTH / 2, INSET), (WIDTH - INSET, HEIGHT / 2), (WIDTH / 2, HEIGHT - INSET))
WHITE = np.full((SIZE, SIZE), 0xFFFFFFFF, "<u4")


def pattern():
    """Words: blue grows downwards and red falls, green to the right, alpha is the sum of blue and green."""
    across, down = np.meshgrid(texture_memory.ramp(SIZE), texture_memory.ramp(SIZE))
    words = down + (across << 8) + ((255 - down) << 16) + ((across + down) << 24)
    return (words & 0xFFFFFFFF).astype("<u4")


def _texture(label, words):
    image = surface_memory.image_of(surface_memory.memory_of(words), TexelWord.A8R8G8B8, SIZE, SIZE)
    return TexImage(label=label, texture=label, image=image)


def _shown(label, corners):
    """A texture's colours, opaque."""
    return surface_memory.shown(label, label, corners, SIZE, SIZE, combiners=texture_render_target.OPAQUE)


def _overlap():
    board = scenes.checkerboard(0xFFCC3333, 0xFF3333C0, CELL, SIZE)
    words = surface_memory.words_of(board, ColorFormat.A8R8G8B8)
    return Case(commands=(scenes.clear(0xFF050505), _texture("memory", words), _shown("memory", DIAMOND)))


def _into_surface():
    return Case(commands=(scenes.clear(0xFF444444), _texture("memory", WHITE), _shown("memory", DIAMOND)))


def _into_texture():
    left, top = (WIDTH - 2 * SIZE) // 3, (HEIGHT - SIZE) // 2
    commands = [scenes.clear(0xFF111111)]
    for k, words in enumerate((pattern(), WHITE)):
        at, label = left + k * (left + SIZE), f"memory {k}"
        corners = scenes.rectangle(at, top, at + SIZE, top + SIZE)
        commands += [_texture(label, words), _shown(label, corners)]
    return Case(commands=tuple(commands))


CASES = {
    "DMAOverlap": _overlap,
    "xemuReadFromFileIntoSurface": _into_surface,
    "xemuReadFromFileIntoTexture": _into_texture,
}

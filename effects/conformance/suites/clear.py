"""Clear: clears under every write mask, and their results in surfaces of every colour format.

Source: src/tests/clear_tests.cpp of nxdk_pgraph_tests. Measured: CLEAR_SURFACE ignores the masks of colour,
depth and stencil, and writes the word of SET_COLOR_CLEAR_VALUE unchanged. A surface is shown as words
A8B8G8R8, whatever its own format; such a word holds two words of 16 bits.
"""

from dataclasses import replace
from functools import partial
from itertools import product

from fixedpipe.effects.conformance import scenes, surface_memory
from fixedpipe.effects.conformance.case import HEIGHT, SHOWS, WIDTH, Case
from fixedpipe.pipeline.commands import Clear, Draw, MakeCurrent, ReadPixels
from fixedpipe.pipeline.enums import ColorFormat, PrimitiveType, TexelWord

SUITE = "Clear"

MASKS = (0x00000000, 0x00000001, 0x00000100, 0x00010000, 0x01000000, 0x01010101)
SURFACES = {
    "SFC_A8R8G8B8": ColorFormat.A8R8G8B8,
    "SFC_X1R5G5B5_Z1R5G5B5": ColorFormat.X1R5G5B5_Z1R5G5B5,
    "SCF_X1R5G5B5_O1R5G5B5": ColorFormat.X1R5G5B5_O1R5G5B5,
    "SCF_R5G6B5": ColorFormat.R5G6B5,
    "SCF_X8R8G8B8_Z8R8G8B8": ColorFormat.X8R8G8B8_Z8R8G8B8,
    "SCF_X8R8G8B8_O8R8G8B8": ColorFormat.X8R8G8B8_O8R8G8B8,
    "SCF_X1A7R8G8B8_Z1A7R8G8B8": ColorFormat.X1A7R8G8B8_Z1A7R8G8B8,
    "SCF_X1A7R8G8B8_O1A7R8G8B8": ColorFormat.X1A7R8G8B8_O1A7R8G8B8,
}
CLEARS = (0x00DACABA, 0x011B2B3B, 0x7F3C2C1C, 0x804D5D6D, 0xFE0ECE3E, 0xFF8F9FAF)
SIZE, MARK, LEFT, TOP, STEP, COLUMNS = 128, 2, 48, 128, 144, 4
QUADS, QUAD_COLORS = 4, ((1.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))


def _masked(shows):
    """Quads, and a clear that the masks do not hold back."""
    width, height = WIDTH // (1 + 2 * QUADS), HEIGHT // 4
    draws = []
    for k in range(QUADS):
        left, top = width * (1 + 2 * k), HEIGHT // 2 - height // 2
        corners = scenes.rectangle(left, top, left + width, top + height, 10.0 - 0.5 * k)
        mesh = scenes.window_mesh(corners, PrimitiveType.POLYGON, colors=scenes.single(QUAD_COLORS))
        draws.append(Draw(label=f"quad {k}", mesh=mesh, state=scenes.DEFAULT))
    return Case(
        commands=(scenes.clear(0xFF000000), *draws, scenes.clear(0x7F7F7F7F)), shows=shows, depth_bits=16
    )


def _surfaces(color_format):
    """A surface cleared to each colour, with a black mark in its middle, shown as words of 32 bits."""
    commands = [scenes.clear(0xFF220022)]
    rows = SIZE * surface_memory.word_bytes(color_format) // 4

    def image(rgba):
        memory = surface_memory.memory_of(surface_memory.words_of(rgba, color_format))
        return surface_memory.image_of(memory, TexelWord.A8B8G8R8, SIZE, rows)

    middle = scenes.rectangle(SIZE // 2 - MARK, SIZE // 2 - MARK, SIZE // 2 + MARK, SIZE // 2 + MARK)
    unblended = replace(scenes.DEFAULT, blending=None)
    for k, word in enumerate(CLEARS):
        left, top = LEFT + STEP * (k % COLUMNS), TOP + STEP * (k // COLUMNS)
        corners, name = scenes.rectangle(left, top, left + SIZE, top + rows), f"surface {k}"
        commands += [
            MakeCurrent(
                label="surface", surface="surface", width=SIZE, height=SIZE, color_format=color_format
            ),
            Clear(label="surface", color=surface_memory.clear_color(word, color_format)),
            scenes.quad("mark", middle, (0.0, 0.0, 0.0, 1.0), height=SIZE),
            ReadPixels(label="surface", name=name),
            MakeCurrent(label="window"),
            surface_memory.host_picture(
                name, name, image, [surface_memory.shown(name, name, corners, SIZE, rows, unblended)]
            ),
        ]
    return Case(commands=tuple(commands))


CASES = {
    f"C{mask:08X}_Depth_{depth}{zeta}": partial(_masked, shows)
    for mask, depth, (zeta, shows) in product(MASKS, "yn", SHOWS.items())
} | {name: partial(_surfaces, color_format) for name, color_format in SURFACES.items()}

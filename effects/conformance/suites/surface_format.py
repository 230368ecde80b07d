"""Surface_format: a pattern on a surface of every colour format, whose memory is shown as words of 32 bits.

Source: src/tests/surface_format_tests.cpp of nxdk_pgraph_tests. The upper half of the window shows the
memory's first 640 by 240 words blended by their alpha over a checkerboard, the lower half the same with an
alpha of one.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes, surface_memory
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.suites import blend_surface, texture_render_target
from fixedpipe.pipeline.commands import Draw, MakeCurrent, ReadPixels, TexImage
from fixedpipe.pipeline.enums import ColorFormat, TexelWord
from fixedpipe.pipeline.state import TextureUnit

SUITE = "Surface_format"

SIZE, TOP, SPACING = 128, 96, 16
PATTERN, MEMORY = "pattern", "memory"
OPAQUE = texture_render_target.OPAQUE


def _pattern_draws(blended):
    """The pattern twice, with an alpha of one and its own."""
    left = (WIDTH - 2 * SIZE - SPACING) // 2
    for k, combiners in enumerate((OPAQUE, scenes.SHOWS_TEXTURE0)):
        at = left + k * (SIZE + SPACING)
        texels = scenes.UNIT_SQUARE * SIZE
        state = replace(
            scenes.DEFAULT,
            blending=scenes.BLENDED if blended else None,
            texture_units=(TextureUnit(PATTERN, scenes.NEAREST),),
            register_combiners=combiners,
        )
        corners = scenes.rectangle(at, TOP, at + SIZE, TOP + SIZE)
        yield Draw(
            label=PATTERN, mesh=scenes.window_mesh(corners, texture_coordinates=(texels,)), state=state
        )


def _shown():
    """Draws of the memory, blended above and opaque below."""
    for top, combiners in ((0, scenes.SHOWS_TEXTURE0), (HEIGHT // 2, OPAQUE)):
        texels = scenes.UNIT_SQUARE * (WIDTH, HEIGHT // 2)
        state = replace(
            scenes.DEFAULT,
            texture_units=(TextureUnit(MEMORY, scenes.NEAREST),),
            register_combiners=combiners,
        )
        corners = scenes.rectangle(0, top, WIDTH, top + HEIGHT // 2)
        yield Draw(label=MEMORY, mesh=scenes.window_mesh(corners, texture_coordinates=(texels,)), state=state)


def _case(color_format, low_bytes=None):

    def image(rgba):
        words = surface_memory.words_of(rgba, color_format)
        if low_bytes:
            words = words.astype(f"<u{low_bytes}")  # the low bytes are blue and green
        return surface_memory.image_of(
            surface_memory.memory_of(words), TexelWord.A8R8G8B8, WIDTH, HEIGHT // 2
        )

    words = blend_surface.ramps(SIZE)
    pattern = surface_memory.image_of(
        surface_memory.memory_of(words.astype("<u4")), TexelWord.A8R8G8B8, SIZE, SIZE
    )
    checkers = scenes.checkerboard(0xFF202020, 0xFF000000, 8, WIDTH)[:HEIGHT]
    board = surface_memory.image_of(
        surface_memory.memory_of(surface_memory.words_of(checkers, ColorFormat.A8R8G8B8)),
        TexelWord.A8R8G8B8,
        WIDTH,
        HEIGHT,
    )
    whole = scenes.rectangle(0, 0, WIDTH, HEIGHT)
    blended = not low_bytes and color_format != ColorFormat.R5G6B5
    return Case(
        commands=(
            TexImage(label=PATTERN, texture=PATTERN, image=pattern),
            TexImage(label="checkerboard", texture="checkerboard", image=board),
            surface_memory.shown("checkerboard", "checkerboard", whole, WIDTH, HEIGHT),
            MakeCurrent(
                label="surface", surface="surface", width=WIDTH, height=HEIGHT, color_format=color_format
            ),
            *_pattern_draws(blended),
            ReadPixels(label=MEMORY, name=MEMORY),
            MakeCurrent(label="window"),
            surface_memory.host_picture(MEMORY, MEMORY, image, tuple(_shown())),
        )
    )


CASES = {
    **{f"Fmt_{color_format.name}": partial(_case, color_format) for color_format in ColorFormat},
    # Formats of blue, and of green and blue, which cannot blend.
    "Fmt_B8": partial(_case, ColorFormat.A8R8G8B8, 1),
    "Fmt_G8B8": partial(_case, ColorFormat.A8R8G8B8, 2),
}

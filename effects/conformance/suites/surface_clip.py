"""Surface_clip: the surface's clip rectangle, on the window's memory under other formats and on a surface.

Source: src/tests/surface_clip_tests.cpp of nxdk_pgraph_tests. Red quads lie around the rectangle, a dark
green one over it and light ones along its edges. On the window, a format of fewer bytes keeps the pitch, so
its pixels lie in the left part of each row. The surface's clip limits clears and draws, as a scissor box
does.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, surface_memory
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import BindTexImage, Clear, HostStep, MakeCurrent, ReadPixels, TexImage
from fixedpipe.pipeline.enums import ColorFormat, InternalFormat, TexelWord, TextureTarget, WindowOrigin
from fixedpipe.pipeline.state import Scissor

SUITE = "Surface_clip"

RECTANGLES = (  # x, y, width, height
    (0, 0, 0, 0),
    (0, 0, 512, 0),
    (0, 0, 0, 384),
    (0, 0, 512, 384),
    (16, 8, 512, 384),
    (0, 0, 640, 480),
    (8, 16, 632, 464),
    (0, 240, 640, 240),
    (320, 240, 320, 240),
)
FORMATS = ("", "_A8R8G8B8", "_B8", "_G8B8")
BACKGROUND, THICKNESS = 0xFC111155, 4.0
RED, DARK, LIGHT = (1.0, 0.0, 0.0, 1.0), (0.1, 0.6, 0.1, 1.0), (0.0, 1.0, 0.0, 1.0)
MEMORY, BELOW = 0x0004, 0xFF000000  # words that the surface holds before, and that it is cleared to


def _frame(left, top, right, bottom):
    """Four quads along the inside of a box: top, bottom, left, right."""
    return (
        (left, top, right, top + THICKNESS),
        (left, bottom - THICKNESS, right, bottom),
        (left, top, left + THICKNESS, bottom),
        (right - THICKNESS, top, right, bottom),
    )


def _quads(box, clip):
    """The image of a box, clipped."""
    x, y, width, height = box
    edges = np.array((x, y, x + width, y + height), float)
    out, t = np.array((-1.0, -1.0, 1.0, 1.0)), THICKNESS
    cx, cy, cw, ch = clip
    scissor = Scissor(cx, HEIGHT - cy - ch, cw, ch)
    state = replace(scenes.DEFAULT, blending=None, polygon=scenes.FRONT_FACES, scissor=scissor)
    parts = [(RED, part) for part in _frame(*(edges + t * out))]
    parts += [(DARK, tuple(edges + out))] + [(LIGHT, part) for part in _frame(*edges)]
    return [scenes.quad("quad", scenes.rectangle(*part, 0.1), color, state) for color, part in parts]


def _on_surface(box):
    """The image on a surface of 16 bits, shown on the window. A clip without a width has the surface's."""
    x, y, width, height = box
    clip, surface = (x, y, width or WIDTH, height or HEIGHT), ColorFormat.R5G6B5
    scissor = Scissor(x, HEIGHT - y - clip[3], clip[2], clip[3])
    unblended = replace(scenes.DEFAULT, blending=None)
    return (
        MakeCurrent(label="surface", surface="surface", width=WIDTH, height=HEIGHT, color_format=surface),
        Clear(label="memory", color=surface_memory.clear_color(MEMORY, surface)),
        Clear(label="surface", color=surface_memory.clear_color(BELOW, surface), scissor=scissor),
        *_quads(box, clip),
        BindTexImage(
            label="surface",
            texture="surface",
            surface="surface",
            target=TextureTarget.TEXTURE_RECTANGLE,
            internal_format=InternalFormat.R5_G6_B5,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        MakeCurrent(label="window"),
        scenes.clear(0xFE262422),
        surface_memory.shown(
            "surface", "surface", scenes.rectangle(0, 0, WIDTH, HEIGHT), WIDTH, HEIGHT, unblended
        ),
    )


def _words(rgba, suffix):
    """What a format keeps of colours, top row first."""
    if suffix == "_B8":
        return rgba[..., 2]
    if suffix == "_G8B8":
        return rgba[..., 1].astype("<u2") << 8 | rgba[..., 2]
    return surface_memory.words_of(rgba, ColorFormat.R5G6B5)


def _on_window(box, suffix):
    """The image in the window's memory, in another format but for A8R8G8B8."""
    if suffix == "_A8R8G8B8":
        return scenes.clear(BACKGROUND), *_quads(box, box)
    x, y, width, height = box
    color_format = ColorFormat.A8R8G8B8 if suffix else ColorFormat.R5G6B5
    label = "memory"

    def commands(pixels):
        memory = surface_memory.words_of(pixels["window"][::-1], ColorFormat.A8R8G8B8)
        words = _words(pixels["drawn"][::-1], suffix)
        rows = memory.view(words.dtype)
        rows[y : y + height, x : x + width] = words[y : y + height, x : x + width]
        image = surface_memory.image_of(surface_memory.memory_of(memory), TexelWord.A8R8G8B8, WIDTH, HEIGHT)
        whole, unblended = scenes.rectangle(0, 0, WIDTH, HEIGHT), replace(scenes.DEFAULT, blending=None)
        shown = surface_memory.shown(label, label, whole, WIDTH, HEIGHT, unblended)
        return TexImage(label=label, texture=label, image=image), shown

    return (
        scenes.clear(BACKGROUND),
        ReadPixels(label="window", name="window"),
        MakeCurrent(
            label="surface", surface="surface", width=WIDTH, height=HEIGHT, color_format=color_format
        ),
        *_quads(box, box),
        ReadPixels(label="drawn", name="drawn"),
        MakeCurrent(label="window"),
        HostStep(label=label, reads=("window", "drawn"), commands=commands),
    )


_PLACES = {"x{}y{}_w{}h{}".format(*box): box for box in RECTANGLES}
CASES = {
    **{
        place + suffix: partial(Case.of, _on_window, box, suffix)
        for place, box in _PLACES.items()
        for suffix in FORMATS
    },
    **{f"rt_{place}": partial(Case.of, _on_surface, box) for place, box in _PLACES.items()},
    # Their clears and texts change no pixel that is compared.
    "XemuBug420": partial(Case, commands=(scenes.clear(BACKGROUND),)),
    "DebugTextShouldClip": partial(Case, commands=(scenes.clear(BACKGROUND),)),
}

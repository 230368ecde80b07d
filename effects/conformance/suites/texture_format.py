"""Texture_format: a colour gradient in every texture format, on a square that a little more than fits it.

Source: src/tests/texture_format_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from effects.conformance import scenes, texture_memory, vertex_programs
from effects.conformance.case import Case
from pipeline.commands import Draw, TexImage
from pipeline.enums import PrimitiveType
from pipeline.state import TextureUnit
from pipeline.texel_words import paletted_texture

SUITE = "Texture_format"

SIZE, HALF, DEPTH, EYE = 256, 0.75, 0.1, 2.25
PALETTES = (256, 128, 64, 32)
FORMATS = {f"TexFmt_{entry.case_name}": entry for entry in texture_memory.FORMATS}
PALETTED = {f"TexFmt_SZ_Index8_p{size}": size for size in PALETTES}


def names():
    """Every case of the suite."""
    return [*FORMATS, *PALETTED]


def palette(size):
    """Words A8R8G8B8: quarters of falling blue, green, red and grey."""
    quarter = size // 4
    value = 255 - np.arange(quarter) * -(-255 // quarter)
    return (0xFF << 24) + np.concatenate(
        [value, value << 8, value << 16, value | (value << 8) | (value << 16)]
    )


def indices(size):
    """Into a palette: every colour in turn in the upper half, each four times over in the lower."""
    count = np.arange(SIZE * SIZE)
    return (np.where(count < SIZE * SIZE // 2, count, count & ~3) % size).reshape(SIZE, SIZE)


def square():
    """Two triangles with (s, t) from (0, 0) to (1, 1)."""
    corners = {"ul": (-1, 1, 0, 0), "ur": (1, 1, 1, 0), "lr": (1, -1, 1, 1), "ll": (-1, -1, 0, 1)}
    at = np.array([corners[c] for c in ("ul", "ur", "lr", "ul", "lr", "ll")], np.float64)
    points = np.column_stack([HALF * at[:, :2], np.full(6, DEPTH)])
    return vertex_programs.perspective(points, eye=EYE, depth_maximum=0x7FFF, far=10.0), at[:, 2:]


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name in FORMATS:
        entry = FORMATS[name]
        texture = texture_memory.texture_of(texture_memory.gradient(SIZE, SIZE), entry)
        scale = SIZE if entry.linear else 1
    elif name in PALETTED:
        texture, scale = paletted_texture(indices(PALETTED[name]), palette(PALETTED[name])), 1
    else:
        return None
    positions, coordinates = square()
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("texture", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    mesh = scenes.window_mesh(positions, PrimitiveType.TRIANGLES, texture_coordinates=(coordinates * scale,))
    return Case(
        commands=(
            scenes.clear(0xFE202020),
            TexImage(label=name, texture="texture", image=texture),
            Draw(label="square", mesh=mesh, state=state),
        )
    )
